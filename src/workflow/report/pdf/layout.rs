//! Page layout.

use std::io::Cursor;

use ecolor::Color32;
use image::{ImageFormat, ImageReader};

use super::faces::Faces;
use super::wrap::wrap;
use crate::plot::drawing::{Anchor, Drawing, Shape};
use crate::report::colours;
use crate::report::document::{Block, Document, Section};

/// A4 (pt).
pub const PAGE: [f64; 2] = [595.28, 841.89];
/// Width of the text (pt).
pub const WIDTH: f64 = 484.0;
/// Left edge of the text (pt).
pub const LEFT: f64 = 0.5 * (PAGE[0] - WIDTH);
/// Upper edge of the text (pt).
const TOP: f64 = 54.0;
/// Lower edge of the text (pt).
pub const BOTTOM: f64 = PAGE[1] - 60.0;
/// Space between plots side by side (pt).
const GAP: f64 = 12.0;
/// Largest height of a picture (pt).
const PICTURE_HEIGHT: f64 = 270.0;
/// Space for a signature above its line (pt).
const SIGNATURE: f64 = 44.0;
/// Space that must remain below a heading on the same page (pt).
const BELOW_HEADING: f64 = 72.0;

/// A picture on a page.
pub struct PlacedPicture {
    /// PNG.
    pub png: Vec<u8>,
    /// Upper left corner (pt).
    pub at: [f64; 2],
    /// Width and height (pt).
    pub size: [f64; 2],
}

/// Content of a page.
#[derive(Default)]
pub struct Page {
    /// Shapes, the lowest first.
    pub shapes: Vec<Shape>,
    /// Pictures.
    pub pictures: Vec<PlacedPicture>,
}

/// A heading with its position, for the outline.
pub struct OutlineEntry {
    /// The heading.
    pub title: String,
    /// Page, from 0.
    pub page: usize,
    /// Upper edge (pt).
    pub y: f64,
}

/// Size, line height and colour of text.
#[derive(Clone, Copy)]
pub struct Style {
    /// Size of the font (pt).
    pub size: f64,
    /// Line spacing (pt).
    pub leading: f64,
    /// Whether it is bold.
    pub bold: bool,
    /// Its colour.
    pub colour: Color32,
}

const fn style(size: f64, leading: f64, bold: bool, colour: Color32) -> Style {
    Style {
        size,
        leading,
        bold,
        colour,
    }
}

const TITLE: Style = style(21.0, 26.0, true, colours::DARK);
const SUBTITLE: Style = style(9.5, 13.5, false, colours::MUTED);
const SECTION: Style = style(14.0, 18.0, true, colours::DARK);
const HEADING: Style = style(10.5, 14.0, true, colours::DARK);
const LEAD: Style = style(10.5, 14.5, true, colours::DARK);
const TEXT: Style = style(9.5, 13.5, false, colours::DARK);
const NAME: Style = style(9.5, 13.5, false, colours::MUTED);
/// Small print and captions.
pub const SMALL: Style = style(8.5, 12.0, false, colours::MUTED);

/// Fills pages from top to bottom.
pub struct Layout<'a> {
    /// Measures text.
    pub faces: &'a Faces,
    /// The pages so far.
    pub pages: Vec<Page>,
    /// Headings so far.
    pub marks: Vec<OutlineEntry>,
    /// Upper edge of the next block (pt).
    pub y: f64,
}

impl<'a> Layout<'a> {
    /// Lays out a whole report.
    pub fn of(document: &Document, faces: &'a Faces) -> Self {
        let mut layout = Self {
            faces,
            pages: vec![Page::default()],
            marks: Vec::new(),
            y: TOP,
        };
        if !document.header.is_empty() {
            layout.text(&document.header, SUBTITLE, 0.0);
        }
        layout.text(&document.title, TITLE, 0.0);
        layout.y += 2.0;
        for line in &document.subtitle {
            layout.text(line, SUBTITLE, 0.0);
        }
        for section in &document.sections {
            layout.section(section);
        }
        layout
    }

    /// The page that is being filled.
    pub fn page(&mut self) -> &mut Page {
        if self.pages.is_empty() {
            self.pages.push(Page::default());
        }
        let last = self.pages.len() - 1;
        &mut self.pages[last]
    }

    /// Starts a new page.
    pub fn turn(&mut self) {
        self.pages.push(Page::default());
        self.y = TOP;
    }

    /// Starts a new page unless there is room for this height.
    pub fn reserve(&mut self, height: f64) {
        if self.y + height > BOTTOM && self.y > TOP {
            self.turn();
        }
    }

    /// Adds space before a block, except at the top of a page.
    fn space(&mut self, height: f64) {
        if self.y > TOP {
            self.y += height;
        }
    }

    fn section(&mut self, section: &Section) {
        self.space(20.0);
        self.reserve(SECTION.leading + BELOW_HEADING);
        self.marks.push(OutlineEntry {
            title: section.title.clone(),
            page: self.pages.len() - 1,
            y: self.y,
        });
        self.text(&section.title, SECTION, 0.0);
        let y = self.y + 1.0;
        let rule = Shape::segment([LEFT, y], [LEFT + WIDTH, y], 0.75, colours::FAINT);
        self.page().shapes.push(rule);
        self.y += 3.0;
        for (k, block) in section.blocks.iter().enumerate() {
            self.block(block, section.blocks.get(k + 1..).unwrap_or_default());
        }
    }

    /// Lays out a block that is followed by `after`.
    fn block(&mut self, block: &Block, after: &[Block]) {
        match block {
            Block::Heading(text) => {
                self.space(10.0);
                self.reserve(HEADING.leading + below_heading(after));
                self.text(text, HEADING, 0.0);
            }
            Block::Lead(text) => self.paragraph(text, LEAD),
            Block::Paragraph(text) => self.paragraph(text, TEXT),
            Block::Note(text) => self.paragraph(text, SMALL),
            Block::List(lines) => self.list(lines),
            Block::Facts(facts) => self.facts(facts),
            Block::Table(table) => {
                self.space(8.0);
                self.table(table);
            }
            Block::Plots(plots) => self.plots(plots),
            Block::Signatures(lines) => self.signatures(lines),
            Block::Picture { png, caption } => self.picture(png, caption),
        }
        // A lead stays with the block below it.
        if matches!(block, Block::Lead(_)) && !after.is_empty() {
            self.y += 1.0;
        }
    }

    fn paragraph(&mut self, text: &str, style: Style) {
        self.space(5.0);
        self.text(text, style, 0.0);
    }

    /// Lays out text in lines; at least two lines of a paragraph stay together.
    fn text(&mut self, text: &str, style: Style, indent: f64) {
        let lines = wrap(self.faces, text, style.size, style.bold, WIDTH - indent);
        let count = lines.len();
        for (k, line) in lines.into_iter().enumerate() {
            let together = if k == 0 || k + 2 == count {
                2.min(count - k)
            } else {
                1
            };
            self.reserve(together as f64 * style.leading);
            self.line(line, style, LEFT + indent, Anchor::Start);
            self.y += style.leading;
        }
    }

    /// Places one line of text at the current height.
    pub fn line(&mut self, text: String, style: Style, x: f64, anchor: Anchor) {
        let baseline = self.y + 0.5 * style.leading + 0.36 * style.size;
        self.page().shapes.push(Shape::Text {
            at: [x, baseline],
            size: style.size,
            anchor,
            colour: style.colour,
            bold: style.bold,
            text,
        });
    }

    fn list(&mut self, lines: &[String]) {
        self.space(4.0);
        for line in lines {
            self.reserve(TEXT.leading);
            let y = self.y + 0.5 * TEXT.leading;
            self.page().shapes.push(Shape::Disc {
                at: [LEFT + 4.0, y],
                radius: 1.3,
                colour: colours::MUTED,
            });
            self.text(line, TEXT, 12.0);
            self.y += 1.5;
        }
    }

    fn facts(&mut self, facts: &[(String, String)]) {
        self.space(5.0);
        let widest = facts
            .iter()
            .map(|(name, _)| self.faces.width(name, NAME.size, NAME.bold))
            .fold(60.0, f64::max);
        let indent = widest.min(0.35 * WIDTH) + 14.0;
        for (name, value) in facts {
            self.reserve(2.0 * TEXT.leading);
            self.line(name.clone(), NAME, LEFT, Anchor::Start);
            self.text(value, TEXT, indent);
        }
    }

    fn plots(&mut self, plots: &[Drawing]) {
        self.space(8.0);
        let mut rest = plots;
        while let Some(first) = rest.first() {
            let mut count = 1;
            let mut width = first.size[0];
            while let Some(next) = rest.get(count) {
                if width + GAP + next.size[0] > WIDTH + 0.01 {
                    break;
                }
                width += GAP + next.size[0];
                count += 1;
            }
            let (row, after) = rest.split_at(count);
            rest = after;
            let height = row.iter().map(|p| p.size[1]).fold(0.0, f64::max);
            self.reserve(height);
            let mut x = LEFT;
            for plot in row {
                let y = self.y;
                let moved = plot.shapes.iter().map(|shape| shape.moved([x, y]));
                self.page().shapes.extend(moved);
                x += plot.size[0] + GAP;
            }
            self.y += height + 4.0;
        }
    }

    /// Lays out lines for signatures side by side.
    fn signatures(&mut self, lines: &[(String, String)]) {
        let count = lines.len().max(1) as f64;
        let width = (WIDTH - (count - 1.0) * 2.0 * GAP) / count;
        self.reserve(SIGNATURE + SMALL.leading);
        let top = self.y;
        for (k, (what, who)) in lines.iter().enumerate() {
            let x = LEFT + k as f64 * (width + 2.0 * GAP);
            self.y = top + SIGNATURE - TEXT.leading;
            self.line(who.clone(), TEXT, x, Anchor::Start);
            self.y = top + SIGNATURE;
            let rule = Shape::segment([x, self.y], [x + width, self.y], 0.75, colours::DARK);
            self.page().shapes.push(rule);
            let caption = format!("{what}: name, date, signature");
            self.line(caption, SMALL, x, Anchor::Start);
        }
        self.y = top + SIGNATURE + SMALL.leading;
    }

    fn picture(&mut self, png: &[u8], caption: &str) {
        let [width, height] = pixels(png).unwrap_or([WIDTH, PICTURE_HEIGHT]);
        let scale = (WIDTH / width).min(PICTURE_HEIGHT / height);
        let size = [scale * width, scale * height];
        self.space(8.0);
        self.reserve(size[1] + SMALL.leading);
        let at = [LEFT, self.y];
        self.page().pictures.push(PlacedPicture {
            png: png.to_vec(),
            at,
            size,
        });
        self.y += size[1] + 2.0;
        self.text(caption, SMALL, 0.0);
    }
}

/// Height to reserve below a heading (pt): plots stay with it, and the note between them.
fn below_heading(after: &[Block]) -> f64 {
    let first = |plots: &[Drawing]| plots.first().map_or(0.0, |plot| plot.size[1]);
    match after {
        [Block::Plots(plots), ..] => 8.0 + first(plots),
        [Block::Note(_), Block::Plots(plots), ..] => {
            // A note has at most three lines.
            13.0 + 3.0 * SMALL.leading + first(plots)
        }
        _ => BELOW_HEADING,
    }
}

/// Width and height of a picture; `None` if it cannot be read or has none.
fn pixels(png: &[u8]) -> Option<[f64; 2]> {
    let reader = ImageReader::with_format(Cursor::new(png), ImageFormat::Png);
    let (width, height) = reader.into_dimensions().ok()?;
    (width > 0 && height > 0).then(|| [f64::from(width), f64::from(height)])
}
