//! Recognition of one channel by its name, unit and values.

use crate::naming::words::{ACTUAL, OTHER, PER_CABLE, WANTED};
use crate::naming::words_of;
use crate::recipe::Kind;
use crate::source::Channel;
use crate::units::{Dimension, parse_unit};

/// Name of a body, whether it is commanded rather than measured, and its components.
pub(super) type Body<'a> = (String, bool, Vec<(usize, &'a Channel)>);

pub(super) fn is_any(words: &[String], known: &[&str]) -> bool {
    words.iter().any(|word| known.contains(&word.as_str()))
}

pub(super) fn is_whole(channel: &Channel) -> bool {
    channel.values.iter().all(|value| value.fract() == 0.0)
}

pub(super) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Force => "forces",
        Kind::Swivel => "swivel angles",
        Kind::Length => "lengths",
        _ => "positions",
    }
}

/// Kind of a channel that exists once per cable, with a score.
pub(super) fn kind_of(channel: &Channel) -> Option<(Kind, i32)> {
    let words = words_of(&channel.name);
    if is_any(&words, OTHER) {
        return None;
    }
    let named = PER_CABLE
        .iter()
        .find(|(_, known)| is_any(&words, known))
        .map(|(kind, _)| *kind);
    let dimension = channel
        .unit
        .as_deref()
        .map(|unit| parse_unit(unit).map(|unit| unit.dimension));
    let kind = match dimension {
        Some(Some(Dimension::Force)) => Kind::Force,
        Some(Some(Dimension::Length)) => Kind::Length,
        Some(Some(Dimension::Angle)) if named == Some(Kind::Swivel) => Kind::Swivel,
        Some(Some(Dimension::Angle)) => Kind::Revolutions,
        Some(Some(Dimension::Number)) | None => match (named, &words[..]) {
            (Some(kind), _) => kind,
            // `F1` and `l1` are what equations call forces and lengths.
            (None, [letter]) if letter == "f" => Kind::Force,
            (None, [letter]) if letter == "l" => Kind::Length,
            _ => return None,
        },
        Some(_) => return None,
    };
    let score = i32::from(named.is_some()) + 2 * i32::from(is_any(&words, ACTUAL))
        - 4 * i32::from(is_any(&words, WANTED));
    Some((kind, score))
}

/// The component of a pose that a name ends with, x, y, z, and w, x, y, z of a quaternion, and the name without it.
pub(super) fn component(name: &str, words: &[String]) -> Option<(usize, String)> {
    let last = words.last()?;
    // A unit may follow: `ee_x_m`.
    let (last, dropped) = match parse_unit(last) {
        Some(_) if words.len() > 1 && last != "x" => (&words[words.len() - 2], last.len() + 1),
        _ => (last, 0),
    };
    let is_rotation = words.iter().any(|word| {
        matches!(
            word.as_str(),
            "rotation" | "quat" | "quaternion" | "orientation" | "q"
        )
    });
    let place = match (last.as_str(), is_rotation) {
        ("x", false) => 0,
        ("y", false) => 1,
        ("z", false) => 2,
        ("w" | "qw", _) => 3,
        ("x", true) | ("qx", _) => 4,
        ("y", true) | ("qy", _) => 5,
        ("z", true) | ("qz", _) => 6,
        _ => return None,
    };
    let end = name.len().checked_sub(dropped + last.len())?;
    let owner = name
        .get(..end)?
        .trim_end_matches(|letter: char| !letter.is_alphanumeric());
    let kinds = [
        "Rotation",
        "Position",
        "rotation",
        "position",
        "quaternion",
        "orientation",
        "quat",
        "translation",
    ];
    let owner = kinds.iter().fold(owner, |owner, kind| {
        owner.strip_suffix(kind).unwrap_or(owner)
    });
    Some((
        place,
        owner
            .trim_end_matches(|letter: char| !letter.is_alphanumeric())
            .to_owned(),
    ))
}
