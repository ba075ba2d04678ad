//! Columns of a topic: the first message defines them, later messages fill them.

use std::collections::{BTreeSet, HashMap, HashSet};

use serde_json::Value;
use tautline_files::quoted;

use super::definitions::{Count, Definitions, Field, FieldType};
use super::wire::Wire;

/// Longest list that becomes columns: a covariance has 36 elements; images and scans have more.
const MOST_ELEMENTS: usize = 64;
/// Most columns of a topic.
const MOST_COLUMNS: usize = 1000;
/// Maximum nesting depth of types.
const DEEPEST: usize = 20;
/// Longest name of an element (bytes).
const LONGEST_LABEL: usize = 60;
/// Longest text that is kept (bytes): names and states are short, and documents are not readings.
const LONGEST_TEXT: usize = 200;

/// A column of numbers.
pub(super) struct NumberColumn {
    pub name: String,
    pub is_time: bool,
}

/// The columns of a topic and its last message.
#[derive(Default)]
pub(super) struct Layout {
    pub columns: Vec<NumberColumn>,
    pub texts: Vec<String>,
    /// Values of the message by column.
    pub row: Vec<f64>,
    pub row_texts: Vec<String>,
    /// Time stamp in the header of the message (s).
    pub stamp_s: Option<f64>,
    /// Parts of the messages that are left out.
    pub left_out: BTreeSet<String>,
    /// Whether a first message has defined the columns.
    is_known: bool,
    root: Node,
    /// Columns by path, for self-describing messages.
    by_path: HashMap<String, Destination>,
}

/// Part of a message with its destination.
#[derive(Default)]
struct Node {
    place: Option<Destination>,
    /// Names of the elements of a list, if another list of the message states them.
    labels: Vec<String>,
    /// Fields of the part, or elements of the list.
    inner: Vec<Node>,
}

#[derive(Clone, Copy)]
enum Destination {
    Number(usize),
    Text(usize),
    /// The time of the row.
    Stamp,
    /// Left out.
    Nowhere,
}

impl Node {
    /// Destination of the element `k` of a list with these element names in this message.
    fn element(&mut self, k: usize, labels: &[&str]) -> Option<&mut Self> {
        let at = match (self.labels.get(k), labels.get(k)) {
            _ if self.labels.is_empty() => k,
            (Some(known), Some(label)) if known == label => k,
            (_, Some(label)) => self.labels.iter().position(|known| known == label)?,
            (_, None) => return None,
        };
        self.inner.get_mut(at)
    }
}

/// Notice about fields that only later messages have.
const LATER: &str = "fields that its first message does not have";

impl Layout {
    /// Reads a message of this type into the row; `None` where it does not fit. A message that is nothing but data gives
    /// them the name `root`.
    pub fn read(
        &mut self,
        definitions: &Definitions,
        kind: FieldType,
        wire: &mut Wire<'_>,
        root: &str,
    ) -> Option<()> {
        self.clear();
        let mut node = std::mem::take(&mut self.root);
        let mut walk = Walk {
            layout: self,
            definitions,
            wire,
        };
        let read = walk.part(kind, Some(&mut node), root, &[], 0);
        self.root = node;
        self.finish(read)
    }

    /// Reads a message in JSON.
    pub fn read_json(&mut self, message: &[u8]) -> Option<()> {
        self.clear();
        let value: Option<Value> = serde_json::from_slice(message).ok();
        let read = value.filter(Value::is_object).map(|value| {
            let stamp = value.pointer("/header/stamp").or(value.get("timestamp"));
            self.stamp_s = stamp.and_then(time_of).filter(|time_s| *time_s != 0.0);
            self.json(&value, "");
        });
        self.finish(read)
    }

    fn clear(&mut self) {
        self.row.fill(f64::NAN);
        self.row_texts.iter_mut().for_each(String::clear);
        self.stamp_s = None;
    }

    /// Keeps the columns of the first message that fits.
    fn finish(&mut self, read: Option<()>) -> Option<()> {
        if read.is_some() {
            self.is_known = true;
        } else if !self.is_known {
            *self = Self::default();
        }
        read
    }

    /// A new column of numbers.
    fn column(&mut self, name: &str, is_time: bool) -> Option<Destination> {
        if !self.has_room() {
            return None;
        }
        let name = name.to_owned();
        self.columns.push(NumberColumn { name, is_time });
        self.row.push(f64::NAN);
        Some(Destination::Number(self.columns.len() - 1))
    }

    /// A new column of text.
    fn text(&mut self, name: &str) -> Option<Destination> {
        if !self.has_room() {
            return None;
        }
        self.texts.push(name.to_owned());
        self.row_texts.push(String::new());
        Some(Destination::Text(self.texts.len() - 1))
    }

    fn has_room(&mut self) -> bool {
        let has_room = self.columns.len() + self.texts.len() < MOST_COLUMNS;
        if !has_room {
            let what = format!("all after the first {MOST_COLUMNS} columns");
            self.left_out.insert(what);
        }
        has_room
    }

    fn put(&mut self, place: Option<Destination>, number: f64) {
        match place {
            Some(Destination::Number(column)) => self.row[column] = number,
            Some(Destination::Stamp) => self.stamp_s = Some(number).filter(|time_s| *time_s != 0.0),
            _ => {}
        }
    }

    fn put_text(&mut self, place: Option<Destination>, text: &str) {
        let Some(Destination::Text(column)) = place else {
            return;
        };
        if text.len() <= LONGEST_TEXT {
            self.row_texts[column].push_str(text);
        } else {
            let what = format!("texts of more than {LONGEST_TEXT} bytes");
            self.left_out.insert(what);
        }
    }

    fn json(&mut self, value: &Value, path: &str) {
        match value {
            Value::Object(fields) => match time_of(value) {
                Some(time_s) => self.put_json(path, true, time_s),
                None => {
                    for (name, value) in fields {
                        self.json(value, &below(path, name));
                    }
                }
            },
            Value::Array(elements) if elements.len() > MOST_ELEMENTS => {
                self.left_out.insert(long_list(path));
            }
            Value::Array(elements) => {
                for (k, value) in elements.iter().enumerate() {
                    self.json(value, &format!("{path}[{k}]"));
                }
            }
            Value::String(text) => {
                let place = self.place_of(path, |layout| layout.text(path));
                self.put_text(place, text);
            }
            Value::Bool(is_on) => self.put_json(path, false, f64::from(u8::from(*is_on))),
            Value::Number(number) => {
                self.put_json(path, false, number.as_f64().unwrap_or(f64::NAN));
            }
            Value::Null => {}
        }
    }

    fn put_json(&mut self, path: &str, is_time: bool, number: f64) {
        let place = self.place_of(path, |layout| layout.column(path, is_time));
        self.put(place, number);
    }

    /// The column of a path, a new one in the first message.
    fn place_of(
        &mut self,
        path: &str,
        new: impl FnOnce(&mut Self) -> Option<Destination>,
    ) -> Option<Destination> {
        let known = self.by_path.get(path).copied();
        if known.is_some() {
            return known;
        }
        if self.is_known {
            self.left_out.insert(LATER.into());
            return None;
        }
        let place = new(self)?;
        self.by_path.insert(path.into(), place);
        Some(place)
    }
}

/// Reads a message part by part.
struct Walk<'w, 'a> {
    layout: &'w mut Layout,
    definitions: &'w Definitions,
    wire: &'w mut Wire<'a>,
}

impl<'a> Walk<'_, 'a> {
    /// Reads a part of a message; `node` is its destination, and `path` its name in the first message. `labels` are element names
    /// from a sibling list.
    fn part(
        &mut self,
        kind: FieldType,
        node: Option<&mut Node>,
        path: &str,
        labels: &[&'a str],
        depth: usize,
    ) -> Option<()> {
        let is_first = !self.layout.is_known;
        match kind {
            FieldType::Nested(at) => return self.fields(at, node, path, labels, depth),
            FieldType::Number(number) => {
                let value = self.wire.number(number)?;
                let Some(node) = node else { return Some(()) };
                if is_first {
                    node.place = self.layout.column(path, false);
                }
                self.layout.put(node.place, value);
            }
            FieldType::Time(parts) => {
                let time_s = self.wire.time_s(parts)?;
                let Some(node) = node else { return Some(()) };
                if is_first && node.place.is_none() {
                    node.place = self.layout.column(path, true);
                }
                self.layout.put(node.place, time_s);
            }
            FieldType::Text => {
                let text = self.wire.text()?;
                let Some(node) = node else { return Some(()) };
                if is_first {
                    node.place = self.layout.text(path);
                }
                self.layout.put_text(node.place, text);
            }
        }
        Some(())
    }

    /// The fields of a type.
    fn fields(
        &mut self,
        at: usize,
        mut node: Option<&mut Node>,
        path: &str,
        labels: &[&'a str],
        depth: usize,
    ) -> Option<()> {
        let definition = self.definitions.get(at);
        if depth > DEEPEST {
            return None;
        }
        if definition.fields.is_empty() {
            return self.wire.skip_empty();
        }
        let is_first = !self.layout.is_known;
        let is_data = depth == 0 && !path.is_empty();
        let is_header = definition.name == "std_msgs/Header";
        let is_stamped = depth == 0 || depth == 1 && is_header;
        let mut own: Option<Vec<&'a str>> = None;
        for (k, field) in definition.fields.iter().enumerate() {
            if are_names(field) {
                own = Some(self.names(field)?);
                continue;
            }
            let mut inner = node.as_deref_mut();
            if is_first && let Some(node) = inner.as_deref_mut() {
                node.inner.resize_with(k + 1, Node::default);
                if is_stamped && matches!(field.kind, FieldType::Time(_)) && field.name == "stamp" {
                    node.inner[k].place = Some(Destination::Stamp);
                }
            }
            let part = inner.and_then(|node| node.inner.get_mut(k));
            // Array layouts and the sequence numbers of ROS 1 are not readings.
            let is_number = is_header && field.name == "seq";
            let part = part.filter(|_| !is_number && !self.definitions.is_array_layout(field.kind));
            let path = match is_first {
                true if is_data => path.to_owned(),
                true => below(path, &field.name),
                false => String::new(),
            };
            let labels = own.as_deref().unwrap_or(labels);
            match field.count {
                Count::One => self.part(field.kind, part, &path, labels, depth + 1)?,
                _ => self.list(field, part, &path, labels, depth + 1)?,
            }
        }
        Some(())
    }

    /// Names that a message gives the elements of its other lists.
    fn names(&mut self, field: &Field) -> Option<Vec<&'a str>> {
        let mut names = Vec::new();
        for _ in 0..self.count(field)? {
            names.push(self.wire.text()?);
        }
        Some(names)
    }

    fn count(&mut self, field: &Field) -> Option<usize> {
        match field.count {
            Count::One => Some(1),
            Count::Fixed(count) => Some(count),
            Count::Sequence => self.wire.count(),
        }
    }

    fn list(
        &mut self,
        field: &Field,
        mut node: Option<&mut Node>,
        path: &str,
        labels: &[&'a str],
        depth: usize,
    ) -> Option<()> {
        let count = self.count(field)?;
        let is_first = !self.layout.is_known;
        if is_first && let Some(node) = node.as_deref_mut() {
            if count > MOST_ELEMENTS {
                self.layout.left_out.insert(long_list(path));
                node.place = Some(Destination::Nowhere);
            } else if !self.layout.has_room() {
                node.place = Some(Destination::Nowhere);
            } else {
                node.inner.resize_with(count, Node::default);
                if labels.len() == count && are_distinct(labels) {
                    node.labels = labels.iter().map(|&label| label.to_owned()).collect();
                }
            }
        }
        let node = node.filter(|node| node.place.is_none());
        let Some(node) = node else {
            if let FieldType::Number(number) = field.kind {
                return self.wire.skip(number, count);
            }
            return (0..count).try_for_each(|_| self.part(field.kind, None, "", &[], depth));
        };
        for k in 0..count {
            let path = match (is_first, node.labels.get(k)) {
                (true, Some(label)) => format!("{path}[{label}]"),
                (true, None) => format!("{path}[{k}]"),
                (false, _) => String::new(),
            };
            let element = node.element(k, labels);
            if element.is_none() {
                self.layout.left_out.insert(LATER.into());
            }
            self.part(field.kind, element, &path, &[], depth)?;
        }
        Some(())
    }
}

/// Whether a field is a list of names for the elements of its sibling lists, such as `name` in `JointState`.
fn are_names(field: &Field) -> bool {
    let is_called = field.name == "name" || field.name == "names" || field.name.ends_with("_names");
    is_called && field.kind == FieldType::Text && field.count != Count::One
}

/// Whether all labels are unique, short and without control characters.
fn are_distinct(labels: &[&str]) -> bool {
    let mut seen = HashSet::new();
    labels.iter().all(|label| {
        let is_name = !label.is_empty() && label.len() <= LONGEST_LABEL;
        is_name && !label.contains(char::is_control) && seen.insert(label)
    })
}

fn below(path: &str, name: &str) -> String {
    match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    }
}

fn long_list(path: &str) -> String {
    format!("{}, a list of more than {MOST_ELEMENTS}", quoted(path))
}

/// The time (s) of a JSON object with seconds and nanoseconds.
fn time_of(value: &Value) -> Option<f64> {
    let fields = value.as_object().filter(|fields| fields.len() == 2)?;
    let nanoseconds = fields.get("nanosec").or(fields.get("nsec"))?.as_f64()?;
    Some(fields.get("sec")?.as_f64()? + nanoseconds * 1e-9)
}
