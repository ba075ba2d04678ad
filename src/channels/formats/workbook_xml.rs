//! Tags, attributes and texts of the XML in spreadsheets.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

/// Calls `visit` with each opening tag; `None` if the text is not XML.
pub(super) fn for_each_tag(text: &str, mut visit: impl FnMut(&BytesStart<'_>)) -> Option<()> {
    let mut reader = Reader::from_str(text);
    loop {
        match reader.read_event().ok()? {
            Event::Start(tag) | Event::Empty(tag) => visit(&tag),
            Event::Eof => return Some(()),
            _ => {}
        }
    }
}

/// An attribute by its name without prefix.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag
        .attributes()
        .flatten()
        .find(|attribute| attribute.key.local_name().as_ref() == name.as_bytes())?;
    found
        .normalized_value(XmlVersion::Implicit1_0)
        .ok()
        .map(|value| value.into_owned())
}

/// Appends the content of an event to a text.
pub(super) fn add_text(event: &Event<'_>, wanted: bool, to: &mut String) -> Option<()> {
    match event {
        Event::Text(text) if wanted => to.push_str(&text.decode().ok()?),
        Event::CData(text) if wanted => to.push_str(&text.decode().ok()?),
        Event::GeneralRef(name) if wanted => match name.resolve_char_ref().ok()? {
            Some(letter) => to.push(letter),
            None => to.push_str(quick_xml::escape::resolve_xml_entity(&name.decode().ok()?)?),
        },
        _ => {}
    }
    Some(())
}
