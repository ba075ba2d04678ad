//! Vector drawings: shapes in points (1/72 inch), y downwards, which are rendered to SVG or to a PDF page.

use std::fmt::Write as _;

use ecolor::Color32;
use emath::{Align, Align2, Pos2, Rect};

use super::canvas::{Canvas, Stroke};

/// Horizontal alignment of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The text starts at the point.
    Start,
    /// The text is centred at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// One shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Clips the shapes that follow to a rectangle (upper left corner, width and height), or ends clipping.
    Clip(Option<[[f64; 2]; 2]>),
    /// A line through points.
    Line {
        /// The points.
        places: Vec<[f64; 2]>,
        /// Its width.
        width: f64,
        /// Its colour.
        colour: Color32,
        /// Whether the line is dashed.
        dashed: bool,
    },
    /// A filled rectangle.
    Area {
        /// Upper left corner.
        at: [f64; 2],
        /// Width and height.
        size: [f64; 2],
        /// Its colour.
        colour: Color32,
    },
    /// A filled polygon.
    Polygon {
        /// Its corners.
        corners: Vec<[f64; 2]>,
        /// Its colour.
        colour: Color32,
    },
    /// A filled disc.
    Disc {
        /// Centre.
        at: [f64; 2],
        /// Radius.
        radius: f64,
        /// Its colour.
        colour: Color32,
    },
    /// A circle.
    Ring {
        /// Centre.
        at: [f64; 2],
        /// Radius.
        radius: f64,
        /// Width of the line.
        width: f64,
        /// Its colour.
        colour: Color32,
    },
    /// A line of text.
    Text {
        /// A point on its baseline.
        at: [f64; 2],
        /// Size of the font.
        size: f64,
        /// Alignment relative to the point.
        anchor: Anchor,
        /// Its colour.
        colour: Color32,
        /// Whether the text is bold.
        bold: bool,
        /// The text.
        text: String,
    },
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Text alternative for readers who cannot see it.
    pub label: String,
    /// Width and height.
    pub size: [f64; 2],
    /// Shapes, from bottom to top.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// Records what `draw` puts on a canvas within `part`, magnified by `scale`.
    pub fn record(
        label: impl Into<String>,
        part: Rect,
        scale: f64,
        draw: impl FnOnce(&mut dyn Canvas),
    ) -> Self {
        let mut recorder = Recorder {
            origin: part.min,
            scale,
            shapes: Vec::new(),
        };
        draw(&mut recorder);
        Self {
            label: label.into(),
            size: [part.width(), part.height()].map(|side| scale * f64::from(side)),
            shapes: recorder.shapes,
        }
    }

    /// The drawing as an SVG element for HTML.
    #[must_use]
    pub fn svg(&self) -> String {
        self.element("")
    }

    /// The drawing as an SVG file.
    #[must_use]
    pub fn svg_file(&self) -> String {
        self.element(" xmlns=\"http://www.w3.org/2000/svg\"")
    }

    fn element(&self, namespace: &str) -> String {
        let [width, height] = self.size;
        let mut svg = format!(
            "<svg{namespace} role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width:.2} {height:.2}\" \
             width=\"{width:.2}pt\" height=\"{height:.2}pt\" font-family=\"Inter, sans-serif\">",
            escaped(&self.label)
        );
        for shape in &self.shapes {
            // Writing to a string cannot fail.
            let _ = shape.write(&mut svg);
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl Shape {
    /// A straight line.
    #[must_use]
    pub fn segment(from: [f64; 2], to: [f64; 2], width: f64, colour: Color32) -> Self {
        Self::Line {
            places: vec![from, to],
            width,
            colour,
            dashed: false,
        }
    }

    /// The shape moved by an offset.
    #[must_use]
    pub fn moved(&self, by: [f64; 2]) -> Self {
        let mut moved = self.clone();
        let places = match &mut moved {
            Self::Line { places, .. } => places,
            Self::Polygon { corners, .. } => corners,
            Self::Area { at, .. }
            | Self::Disc { at, .. }
            | Self::Ring { at, .. }
            | Self::Text { at, .. }
            | Self::Clip(Some([at, _])) => std::slice::from_mut(at),
            Self::Clip(None) => &mut [],
        };
        for at in places {
            *at = [at[0] + by[0], at[1] + by[1]];
        }
        moved
    }

    fn write(&self, svg: &mut String) -> std::fmt::Result {
        match self {
            Self::Clip(None) => svg.write_str("</svg>"),
            // A nested svg element clips without an identifier that other drawings on the page could share.
            Self::Clip(Some([[x, y], [w, h]])) => write!(
                svg,
                "<svg x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\" viewBox=\"{x:.2} {y:.2} {w:.2} {h:.2}\">"
            ),
            Self::Line {
                places,
                width,
                colour,
                dashed,
            } => {
                let dashes = if *dashed {
                    " stroke-dasharray=\"5 4\""
                } else {
                    ""
                };
                write!(
                    svg,
                    "<polyline points=\"{}\" fill=\"none\" {} stroke-width=\"{width:.2}\"{dashes}/>",
                    points(places),
                    paint("stroke", *colour)
                )
            }
            Self::Area {
                at: [x, y],
                size: [w, h],
                colour,
            } => write!(
                svg,
                "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\" {}/>",
                paint("fill", *colour)
            ),
            Self::Polygon { corners, colour } => write!(
                svg,
                "<polygon points=\"{}\" {}/>",
                points(corners),
                paint("fill", *colour)
            ),
            Self::Disc {
                at: [x, y],
                radius,
                colour,
            } => write!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {}/>",
                paint("fill", *colour)
            ),
            Self::Ring {
                at: [x, y],
                radius,
                width,
                colour,
            } => write!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"none\" {} stroke-width=\"{width:.2}\"/>",
                paint("stroke", *colour)
            ),
            Self::Text {
                at: [x, y],
                size,
                anchor,
                colour,
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
                    "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" text-anchor=\"{anchor}\" font-weight=\"{weight}\" {}>{}</text>",
                    paint("fill", *colour),
                    escaped(text)
                )
            }
        }
    }
}

fn points(places: &[[f64; 2]]) -> String {
    let places = places.iter().map(|[x, y]| format!("{x:.2},{y:.2}"));
    places.collect::<Vec<_>>().join(" ")
}

/// The attributes of a colour, for `fill` or `stroke`.
fn paint(name: &str, colour: Color32) -> String {
    let [r, g, b, alpha] = colour.to_srgba_unmultiplied();
    let mut text = format!("{name}=\"#{r:02x}{g:02x}{b:02x}\"");
    if alpha < 255 {
        // Writing to a string cannot fail.
        let _ = write!(text, " {name}-opacity=\"{:.3}\"", f32::from(alpha) / 255.0);
    }
    text
}

/// Text with markup characters escaped.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    // Writing to a string cannot fail.
    let _ = maud::Escaper::new(&mut escaped).write_str(text);
    escaped
}

/// Canvas that records shapes.
struct Recorder {
    /// Point of the canvas at the upper left corner of the drawing.
    origin: Pos2,
    scale: f64,
    shapes: Vec<Shape>,
}

impl Recorder {
    fn at(&self, place: Pos2) -> [f64; 2] {
        let offset = place - self.origin;
        [self.length(offset.x), self.length(offset.y)]
    }

    fn length(&self, points: f32) -> f64 {
        self.scale * f64::from(points)
    }

    fn size(&self, rect: Rect) -> [f64; 2] {
        [self.length(rect.width()), self.length(rect.height())]
    }
}

impl Canvas for Recorder {
    fn clip(&mut self, part: Option<Rect>) {
        let part = part.map(|part| [self.at(part.min), self.size(part)]);
        self.shapes.push(Shape::Clip(part));
    }

    fn fill(&mut self, rect: Rect, colour: Color32) {
        self.shapes.push(Shape::Area {
            at: self.at(rect.min),
            size: self.size(rect),
            colour,
        });
    }

    fn line(&mut self, places: &[Pos2], stroke: Stroke, dashed: bool) {
        self.shapes.push(Shape::Line {
            places: places.iter().map(|place| self.at(*place)).collect(),
            width: self.length(stroke.width),
            colour: stroke.colour,
            dashed,
        });
    }

    fn polygon(&mut self, corners: Vec<Pos2>, colour: Color32) {
        let corners = corners.into_iter().map(|place| self.at(place)).collect();
        self.shapes.push(Shape::Polygon { corners, colour });
    }

    fn disc(&mut self, centre: Pos2, radius: f32, colour: Color32) {
        self.shapes.push(Shape::Disc {
            at: self.at(centre),
            radius: self.length(radius),
            colour,
        });
    }

    fn ring(&mut self, centre: Pos2, radius: f32, stroke: Stroke) {
        self.shapes.push(Shape::Ring {
            at: self.at(centre),
            radius: self.length(radius),
            width: self.length(stroke.width),
            colour: stroke.colour,
        });
    }

    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32) {
        // A canvas aligns the bounding box of a text, a drawing its baseline.
        let down = match align.y() {
            Align::Min => 0.95,
            Align::Center => 0.36,
            Align::Max => -0.24,
        };
        let [x, y] = self.at(at);
        let size = self.length(size);
        self.shapes.push(Shape::Text {
            at: [x, y + down * size],
            size,
            anchor: match align.x() {
                Align::Min => Anchor::Start,
                Align::Center => Anchor::Middle,
                Align::Max => Anchor::End,
            },
            colour,
            bold: false,
            text: text.to_owned(),
        });
    }
}
