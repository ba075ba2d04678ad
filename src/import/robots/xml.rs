//! XML as a tree.

use std::borrow::Cow;
use std::ops::Range;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use tautline_files::{Location, ReadError, quoted};

/// Deepest nesting of elements.
const MAX_DEPTH: usize = 64;

/// An element with its content.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub name: String,
    pub line: u64,
    attributes: Vec<Attribute>,
    text: String,
    /// Bytes of its text in the document, if it is in one piece.
    text_at: Option<Range<usize>>,
    pub children: Vec<Element>,
}

#[derive(Debug)]
struct Attribute {
    name: String,
    value: String,
    /// Bytes of the value in the text.
    at: Range<usize>,
}

impl Element {
    fn found(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|one| one.name == name)
    }

    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.found(name).map(|one| one.value.as_str())
    }

    /// The bytes of the value of an attribute in the text.
    pub fn place(&self, name: &str) -> Option<Range<usize>> {
        self.found(name).map(|one| one.at.clone())
    }

    /// The text in it.
    pub fn text(&self) -> &str {
        self.text.trim()
    }

    /// The bytes of its text in the document.
    pub fn text_place(&self) -> Option<Range<usize>> {
        self.text_at.clone()
    }

    /// The first child of this name.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The children of this name.
    pub fn of_kind<'x>(&'x self, name: &'static str) -> impl Iterator<Item = &'x Self> {
        let children = self.children.iter();
        children.filter(move |child| child.name == name)
    }

    /// The value of an attribute of a child.
    pub fn in_child(&self, child: &str, name: &str) -> Option<&str> {
        self.child(child)?.attribute(name)
    }

    /// A number in an attribute, or in the text or the value of a child, `None` where there is none.
    pub fn value(&self, file: &str, name: &str) -> Result<Option<f64>, ReadError> {
        match self.child(name) {
            None => self.number(file, name),
            Some(child) if child.text().is_empty() => child.number(file, "value"),
            Some(child) => child.numbers::<1>(file).map(|[value]| Some(value)),
        }
    }

    /// The numbers in its text.
    pub fn numbers<const N: usize>(&self, file: &str) -> Result<[f64; N], ReadError> {
        let parts: Vec<&str> = self.text.split_whitespace().collect();
        let numbers: Option<Vec<f64>> = parts
            .iter()
            .map(|part| part.parse().ok().filter(|value: &f64| value.is_finite()))
            .collect();
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| {
                let expected = if N == 1 {
                    "a number".to_owned()
                } else {
                    format!("{N} numbers")
                };
                self.error(
                    file,
                    &format!("found {}, expected {expected}", quoted(self.text.trim())),
                )
            })
    }

    /// The numbers in an attribute, `None` where there is none.
    pub fn list(
        &self,
        file: &str,
        name: &str,
        count: usize,
    ) -> Result<Option<Vec<f64>>, ReadError> {
        let Some(text) = self.attribute(name) else {
            return Ok(None);
        };
        let numbers: Option<Vec<f64>> = text
            .split_whitespace()
            .map(|part| part.parse().ok().filter(|value: &f64| value.is_finite()))
            .collect();
        match numbers {
            Some(numbers) if numbers.len() == count => Ok(Some(numbers)),
            _ => Err(self.error(
                file,
                &format!("found {name}={}, expected {count} numbers", quoted(text)),
            )),
        }
    }

    /// The number in an attribute, `None` where there is none.
    pub fn number(&self, file: &str, name: &str) -> Result<Option<f64>, ReadError> {
        let Some(text) = self.attribute(name) else {
            return Ok(None);
        };
        match text.trim().parse() {
            Ok(value) if f64::is_finite(value) => Ok(Some(value)),
            _ => Err(self.error(
                file,
                &format!("found {name}={}, expected a number", quoted(text)),
            )),
        }
    }

    /// The numbers in attributes that come together, `None` where there is none of them.
    pub fn vector<const N: usize>(
        &self,
        file: &str,
        names: [&str; N],
    ) -> Result<Option<[f64; N]>, ReadError> {
        let mut values = [0.0; N];
        let mut missing = Vec::new();
        for (value, name) in values.iter_mut().zip(names) {
            match self.number(file, name)? {
                Some(number) => *value = number,
                None => missing.push(name),
            }
        }
        match missing.len() {
            0 => Ok(Some(values)),
            count if count == N => Ok(None),
            _ => Err(self.error(
                file,
                &format!(
                    "found no {}, expected {}",
                    missing.join(", "),
                    names.join(", ")
                ),
            )),
        }
    }

    /// An error about this element.
    pub fn error(&self, file: &str, message: &str) -> ReadError {
        ReadError::new(
            file,
            Location::Line(self.line),
            format!("<{}>: {message}", self.name),
        )
    }
}

/// Whether a text is XML with a tag that begins like `tag`.
pub(super) fn has_tag(text: &str, tag: &str) -> bool {
    text.trim_start().starts_with('<') && text.contains(tag)
}

/// The root of a document.
pub(super) fn parse(text: &str, file: &str) -> Result<Element, ReadError> {
    let mut reader = Reader::from_str(text);
    let line_at = |position: u64| {
        1 + text
            .bytes()
            .take(position as usize)
            .filter(|byte| *byte == b'\n')
            .count() as u64
    };
    let fail = |position: u64, message: &str| {
        ReadError::new(file, Location::Line(line_at(position)), message)
    };
    let mut open: Vec<Element> = vec![Element::default()];
    loop {
        let at = reader.buffer_position();
        let event = reader
            .read_event()
            .map_err(|error| fail(reader.error_position(), &format!("is not XML ({error})")))?;
        match event {
            Event::Start(tag) => {
                if open.len() > MAX_DEPTH {
                    return Err(fail(at, "found elements nested too deeply"));
                }
                open.push(element(&tag, line_at(at), text));
            }
            Event::Empty(tag) => {
                let element = element(&tag, line_at(at), text);
                if let Some(parent) = open.last_mut() {
                    parent.children.push(element);
                }
            }
            Event::End(_) => {
                if let (Some(element), Some(parent)) = (open.pop(), open.last_mut()) {
                    parent.children.push(element);
                }
            }
            Event::Text(part) => {
                let decoded = part
                    .decode()
                    .map_err(|_| fail(at, "found text that is not UTF-8"))?;
                if let Some(element) = open.last_mut() {
                    if !decoded.trim().is_empty() {
                        let (is_first, at) = (element.text().is_empty(), at as usize);
                        element.text_at = is_first.then_some(at..at + part.len());
                    }
                    element.text.push_str(&decoded);
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    match (
        open.len(),
        open.pop()
            .and_then(|document| document.children.into_iter().next()),
    ) {
        (1, Some(root)) => Ok(root),
        (1, None) => Err(ReadError::new(
            file,
            Location::File,
            "found no element, expected XML",
        )),
        _ => Err(ReadError::new(
            file,
            Location::File,
            "ends within an element, expected the complete file",
        )),
    }
}

fn element(tag: &BytesStart<'_>, line: u64, text: &str) -> Element {
    let owned = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let attributes = tag.attributes().flatten().filter_map(|attribute| {
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).ok()?;
        let start = match &attribute.value {
            Cow::Borrowed(raw) => raw.as_ptr() as usize - text.as_ptr() as usize,
            Cow::Owned(_) => 0,
        };
        Some(Attribute {
            name: owned(attribute.key.local_name().as_ref()),
            at: start..start + attribute.value.len(),
            value: value.into_owned(),
        })
    });
    Element {
        name: owned(tag.local_name().as_ref()),
        line,
        attributes: attributes.collect(),
        ..Element::default()
    }
}
