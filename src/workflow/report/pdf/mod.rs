//! A report as PDF: A4 with page numbers, an outline, selectable text and vector plots.

mod faces;
mod layout;
mod paint;
mod table;
mod wrap;

use krilla::Document as Pdf;
use krilla::destination::XyzDestination;
use krilla::geom::Point;
use krilla::metadata::{DateTime, Metadata};
use krilla::outline::{Outline, OutlineNode};
use krilla::page::PageSettings;
use tautline_session::Timestamp;

use super::colours;
use super::document::Document;
use crate::plot::drawing::{Anchor, Shape};
use crate::wording::PROGRAM;
use faces::Faces;
use layout::{BOTTOM, LEFT, Layout, PAGE, Page, WIDTH};

/// Errors of creating a PDF.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// A built-in font cannot be used.
    #[error("the fonts of the program cannot be read")]
    Font,
    /// The picture is not a PNG.
    #[error("the picture of the robot cannot be read: {0}")]
    Picture(String),
    /// The PDF library failed.
    #[error("the PDF cannot be created: {0}")]
    Library(String),
}

/// Renders the report as the bytes of a PDF file.
///
/// # Errors
/// If the picture is not a PNG.
pub fn render(document: &Document, now: Timestamp) -> Result<Vec<u8>, PdfError> {
    let faces = Faces::new()?;
    let Layout { pages, marks, .. } = whole_pages(document, &faces);
    let mut pdf = Pdf::new();
    pdf.set_metadata(
        Metadata::new()
            .title(document.title.clone())
            .language("en".to_owned())
            .creator(PROGRAM.to_owned())
            .creation_date(date(now)),
    );
    for page in &pages {
        draw(&mut pdf, page, &faces)?;
    }
    let mut outline = Outline::new();
    for mark in marks {
        let at = Point::from_xy(LEFT as f32, mark.y as f32);
        outline.push_child(OutlineNode::new(
            mark.title,
            XyzDestination::new(mark.page, at),
        ));
    }
    pdf.set_outline(outline);
    pdf.finish()
        .map_err(|error| PdfError::Library(format!("{error:?}")))
}

/// The pages with what is at the head and at the foot of each.
fn whole_pages<'a>(document: &Document, faces: &'a Faces) -> Layout<'a> {
    let mut layout = Layout::of(document, faces);
    let count = layout.pages.len();
    for (k, page) in layout.pages.iter_mut().enumerate() {
        page.shapes.push(marking(document.marking));
        page.shapes.extend(footer(document.foot(), k + 1, count));
    }
    layout
}

fn draw(pdf: &mut Pdf, page: &Page, faces: &Faces) -> Result<(), PdfError> {
    let settings = PageSettings::from_wh(PAGE[0] as f32, PAGE[1] as f32)
        .ok_or_else(|| PdfError::Library("the size of a page".to_owned()))?;
    let mut sheet = pdf.start_page_with(settings);
    let mut surface = sheet.surface();
    for shape in &page.shapes {
        paint::shape(&mut surface, shape, faces);
    }
    for picture in &page.pictures {
        paint::picture(&mut surface, picture)?;
    }
    surface.finish();
    sheet.finish();
    Ok(())
}

/// The marking at the head of a page.
fn marking(text: &str) -> Shape {
    Shape::Text {
        at: [0.5 * PAGE[0], 36.0],
        size: 10.0,
        anchor: Anchor::Middle,
        colour: colours::WARNING,
        bold: true,
        text: text.to_owned(),
    }
}

/// Name and page number.
fn footer(name: &str, number: usize, count: usize) -> [Shape; 2] {
    let text = |x: f64, anchor, text: String| Shape::Text {
        at: [x, BOTTOM + 30.0],
        size: 7.5,
        anchor,
        colour: colours::MUTED,
        bold: false,
        text,
    };
    [
        text(LEFT, Anchor::Start, name.chars().take(90).collect()),
        text(
            LEFT + WIDTH,
            Anchor::End,
            format!("Page {number} of {count}"),
        ),
    ]
}

fn date(now: Timestamp) -> DateTime {
    let text = now.to_string();
    let number = |from: usize, to: usize| text.get(from..to).and_then(|t| t.parse::<u16>().ok());
    let part = |from: usize| number(from, from + 2).map_or(0, |n| n as u8);
    DateTime::new(number(0, 4).unwrap_or(0))
        .month(part(5))
        .day(part(8))
        .hour(part(11))
        .minute(part(14))
        .second(part(17))
        .utc_offset_hour(0)
}

/// The lines of text on each page.
#[cfg(test)]
pub fn page_texts(document: &Document) -> Vec<Vec<String>> {
    let faces = Faces::new().expect("fonts");
    let text = |shape: Shape| match shape {
        Shape::Text { text, .. } => Some(text),
        _ => None,
    };
    let pages = whole_pages(document, &faces).pages.into_iter();
    pages
        .map(|page| page.shapes.into_iter().filter_map(text).collect())
        .collect()
}

/// Asserts that every line of text and every shape is inside the margins.
#[cfg(test)]
pub fn assert_on_pages(document: &Document) {
    let faces = Faces::new().expect("fonts");
    let layout = Layout::of(document, &faces);
    assert!(layout.pages.len() > 1);
    for shape in layout.pages.iter().flat_map(|page| &page.shapes) {
        let ([from, _], [to, y]) = match shape {
            Shape::Clip(None) => continue,
            Shape::Clip(Some([at, size])) | Shape::Area { at, size, .. } => {
                (*at, [at[0] + size[0], at[1] + size[1]])
            }
            Shape::Line { places, .. }
            | Shape::Polygon {
                corners: places, ..
            } => {
                let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
                    let all = places.iter().map(|place| place[axis]);
                    all.reduce(pick).expect("a point")
                };
                (
                    [bound(0, f64::min), bound(1, f64::min)],
                    [bound(0, f64::max), bound(1, f64::max)],
                )
            }
            Shape::Disc { at, radius, .. } | Shape::Ring { at, radius, .. } => {
                (at.map(|x| x - radius), at.map(|x| x + radius))
            }
            Shape::Text {
                at,
                size,
                anchor,
                bold,
                text,
                ..
            } => {
                let width = faces.width(text, *size, *bold);
                let start = match anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - 0.5 * width,
                    Anchor::End => at[0] - width,
                };
                ([start, at[1]], [start + width, at[1]])
            }
        };
        let is_inside = from >= LEFT - 0.5 && to <= LEFT + WIDTH + 0.5 && y <= BOTTOM + 0.5;
        assert!(is_inside, "{shape:?}");
    }
}
