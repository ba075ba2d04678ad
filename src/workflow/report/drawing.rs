//! Vector drawings: shapes in points (1/72 inch), y downwards, that become SVG or part of a PDF page.

use std::fmt::Write as _;

/// Colours of drawings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Text and strong lines.
    Dark,
    /// Text and lines that stand back.
    Muted,
    /// Grid lines.
    Faint,
    /// The area of what is to be expected.
    Band,
    /// The data.
    Accent,
    /// What is outside of what is to be expected.
    Warning,
}

impl Ink {
    /// Red, green, blue.
    pub const fn rgb(self) -> [u8; 3] {
        match self {
            Self::Dark => [0x1f, 0x24, 0x2b],
            Self::Muted => [0x5b, 0x64, 0x70],
            Self::Faint => [0xd9, 0xdd, 0xe2],
            Self::Band => [0xee, 0xf3, 0xf8],
            Self::Accent => [0x1f, 0x5f, 0xa8],
            Self::Warning => [0xc2, 0x41, 0x0c],
        }
    }

    /// As HTML and SVG write it.
    pub fn hex(self) -> String {
        let [r, g, b] = self.rgb();
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// One shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line {
        /// Start.
        from: [f64; 2],
        /// End.
        to: [f64; 2],
        /// Its colour.
        ink: Ink,
        /// Its width.
        width: f64,
    },
    /// A filled rectangle.
    Area {
        /// Upper left corner.
        at: [f64; 2],
        /// Width and height.
        size: [f64; 2],
        /// Its colour.
        ink: Ink,
    },
    /// A filled disc.
    Dot {
        /// Centre.
        at: [f64; 2],
        /// Radius.
        radius: f64,
        /// Its colour.
        ink: Ink,
    },
    /// A line of text.
    Text {
        /// A point on its base line.
        at: [f64; 2],
        /// Size of the font.
        size: f64,
        /// Where it stands relative to the point.
        anchor: Anchor,
        /// Its colour.
        ink: Ink,
        /// Whether it is bold.
        bold: bool,
        /// What it says.
        text: String,
    },
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// What it shows, for those who do not see it.
    pub label: String,
    /// Width and height.
    pub size: [f64; 2],
    /// Its shapes, the lowest first.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// As an SVG element that HTML takes as it is.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let mut svg = format!(
            "<svg role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width} {height}\" width=\"{width}pt\" height=\"{height}pt\">",
            escaped(&self.label)
        );
        for shape in &self.shapes {
            // Writing to a text cannot fail.
            let _ = shape.write(&mut svg);
        }
        svg.push_str("</svg>");
        svg
    }
}

impl Shape {
    /// The shape elsewhere.
    pub fn moved(&self, by: [f64; 2]) -> Self {
        let there = |at: &mut [f64; 2]| *at = [at[0] + by[0], at[1] + by[1]];
        let mut moved = self.clone();
        match &mut moved {
            Self::Line { from, to, .. } => {
                there(from);
                there(to);
            }
            Self::Area { at, .. } | Self::Dot { at, .. } | Self::Text { at, .. } => there(at),
        }
        moved
    }

    fn write(&self, svg: &mut String) -> std::fmt::Result {
        match self {
            Self::Line {
                from: [x1, y1],
                to: [x2, y2],
                ink,
                width,
            } => write!(
                svg,
                "<path d=\"M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}\" stroke=\"{}\" stroke-width=\"{width}\"/>",
                ink.hex()
            ),
            Self::Area {
                at: [x, y],
                size: [w, h],
                ink,
            } => write!(
                svg,
                "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\" fill=\"{}\"/>",
                ink.hex()
            ),
            Self::Dot {
                at: [x, y],
                radius,
                ink,
            } => write!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{}\"/>",
                ink.hex()
            ),
            Self::Text {
                at: [x, y],
                size,
                anchor,
                ink,
                bold,
                text,
            } => {
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let weight = if *bold { 600 } else { 400 };
                write!(
                    svg,
                    "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" font-weight=\"{weight}\" fill=\"{}\">{}</text>",
                    ink.hex(),
                    escaped(text)
                )
            }
        }
    }
}

/// Text in which no character is markup.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    // A text takes everything that is written to it.
    let _ = maud::Escaper::new(&mut escaped).write_str(text);
    escaped
}
