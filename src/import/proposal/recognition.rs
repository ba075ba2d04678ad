//! Recognition of channels by their names, units and values.

use tautline_channels::{Channel, Dimension, Unit, parse_unit};

use super::evidence::{are_counts, are_settings, are_tensions};
use crate::naming::words::{
    ACTUAL, ANGLES, EXTERNAL, LASER, LETTERS, MACHINES, NEUTRAL, OTHER, PER_CABLE, POSE, STATES,
    WANTED,
};
use crate::naming::words_of;
use crate::recipe::{AngleOrder, QuantityKind as Kind};

pub(super) fn is_any(words: &[String], known: &[&str]) -> bool {
    words.iter().any(|word| known.contains(&word.as_str()))
}

/// Whether a name denotes a commanded value. In German, `des` is also an article.
pub(super) fn is_wanted(words: &[String]) -> bool {
    let ends = [words.first(), words.last()];
    let is_article = |word: &String| word == "des" && !ends.contains(&Some(word));
    let said = words.iter().filter(|word| !is_article(word));
    said.into_iter().any(|word| WANTED.contains(&word.as_str()))
}

pub(super) fn is_whole(channel: &Channel) -> bool {
    channel.values.iter().all(|value| value.fract() == 0.0)
}

pub(super) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Force => "forces",
        Kind::Swivel => "swivel angles",
        Kind::Change | Kind::Length => "lengths",
        _ => "positions",
    }
}

/// Recognised quantity of a family of channels, one for each cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Recognised {
    pub kind: Kind,
    /// Certainty of the recognition, by which one of several families of a quantity is chosen.
    pub score: i32,
    /// Whether the values are encoder counts.
    pub is_counts: bool,
    /// Whether the quantity was recognised by the values rather than by the name.
    pub by_values: bool,
}

/// Recognises a family of channels that exists once per cable.
pub(super) fn kind_of(channels: &[&Channel]) -> Option<Recognised> {
    let first = channels.first()?;
    let words = words_of(&first.name);
    let is_component = |word: Option<&String>| word.is_some_and(|word| is_axis(word));
    let is_derivative = words.iter().any(|word| word.ends_with("dot"));
    // `Axis1.Status.ActPos` is not a status; `exp.F` is a force.
    let leaf = words_of(first.name.rsplit('.').next().unwrap_or_default());
    if is_any(&words, OTHER)
        || is_any(&leaf, STATES)
        || is_derivative
        || is_wanted(&words)
        || is_component(words.first())
        || is_component(words.last())
        || ANGLES.iter().any(|angle| is_any(&words, angle))
        || are_settings(channels)
    {
        return None;
    }
    let (named, by_values) = match named_kind(&words).or_else(|| named_kind(&leaf)) {
        // Torques and temperatures are called `T` as well.
        None if leaf == ["t"] && are_tensions(channels) => (Some(Kind::Force), true),
        named => (named, false),
    };
    let dimension = match first.unit.as_deref() {
        None => None,
        // An unknown unit measures no quantity of ours.
        Some(unit) => Some(parse_unit(unit)?.dimension),
    };
    let kind = match dimension {
        Some(Dimension::Force) => Some(Kind::Force),
        Some(Dimension::Length) if is_any(&words, LASER) => None,
        Some(Dimension::Length) => Some(Kind::Length),
        Some(Dimension::Angle) if named == Some(Kind::Swivel) => Some(Kind::Swivel),
        Some(Dimension::Angle) => Some(Kind::Revolutions),
        Some(Dimension::Temperature | Dimension::Time) => None,
        Some(Dimension::Number) | None => named,
    }?;
    let is_counts = matches!(kind, Kind::Revolutions | Kind::Swivel)
        && dimension.is_none_or(|dimension| dimension == Dimension::Number)
        && (dimension == Some(Dimension::Number) || are_counts(channels));
    let score = i32::from(named == Some(kind)) + 2 * i32::from(is_any(&words, ACTUAL));
    Some(Recognised {
        kind: since_home(kind, channels),
        score,
        is_counts,
        by_values,
    })
}

/// Lengths of which some pass zero count from home, since lengths of cables are positive.
pub(super) fn since_home(kind: Kind, channels: &[&Channel]) -> Kind {
    let passes_zero = |channel: &&Channel| {
        let [low, high] = channel.summary().range;
        low < 0.0 && high > 0.0
    };
    match kind {
        Kind::Length if channels.iter().any(passes_zero) => Kind::Change,
        kind => kind,
    }
}

/// The kind that a name states.
fn named_kind(words: &[String]) -> Option<Kind> {
    // `l_enc` is a length that an encoder reads, `F_meas` a measured force.
    let is_length = words.first().is_some_and(|word| word == "l");
    let says_more = |word: &&String| {
        let word = word.as_str();
        let is_unit = word.len() > 1 && parse_unit(word).is_some();
        let is_usual = ACTUAL.contains(&word) || NEUTRAL.contains(&word) || is_unit;
        let is_source = is_length && matches!(word, "enc" | "encoder");
        !is_usual && !is_source
    };
    let rest: Vec<&String> = words.iter().filter(says_more).collect();
    if let [letter] = rest[..]
        && let Some((kind, _)) = LETTERS
            .iter()
            .find(|(_, letters)| letters.contains(&letter.as_str()))
    {
        return Some(*kind);
    }
    let stated = PER_CABLE
        .iter()
        .find(|(_, known)| is_any(words, known))
        .map(|(kind, _)| *kind);
    match stated {
        None if is_any(words, &["load"]) && is_any(words, &["cell"]) => Some(Kind::Force),
        // The angle of a pulley is that about its swivel axis.
        Some(Kind::Revolutions) if is_any(words, &["pulley", "rolle"]) => Some(Kind::Swivel),
        Some(kind) => Some(kind),
        None => {
            let last = rest.last().or(words.last().as_ref()).copied()?;
            MACHINES
                .contains(&last.as_str())
                .then_some(Kind::Revolutions)
        }
    }
}

/// Origin of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    /// The controller, as a command.
    Commanded,
    /// An instrument outside of the robot.
    Measured,
    /// Unknown: the name does not state the origin.
    Open,
}

/// A component of a pose, x, y, z, or w, x, y, z of a quaternion, counted from 0, with its body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Component {
    pub index: usize,
    /// Name of the body.
    pub owner: String,
    pub origin: Origin,
    /// Whether the name consists only of words for poses.
    pub is_pose: bool,
}

fn is_axis(word: &str) -> bool {
    matches!(word, "x" | "y" | "z")
}

/// The component of a pose that a name begins or ends with.
pub(super) fn component(name: &str) -> Option<Component> {
    let mut words = words_of(name);
    // A unit may follow, `ee_x_m`; `x_d` is a desired coordinate.
    let is_desired = words.len() == 2 && is_axis(&words[0]) && words[1] == "d";
    if words.len() > 1 && words.last().is_some_and(|last| parse_unit(last).is_some()) {
        words.pop();
    }
    let is_rotation = words.iter().any(|word| {
        matches!(
            word.as_str(),
            "rotation" | "quat" | "quaternion" | "orientation" | "q"
        )
    });
    let place = |word: &String| match (word.as_str(), is_rotation) {
        ("x", false) => Some(0),
        ("y", false) => Some(1),
        ("z", false) => Some(2),
        ("w" | "qw", _) => Some(3),
        ("x", true) | ("qx", _) => Some(4),
        ("y", true) | ("qy", _) => Some(5),
        ("z", true) | ("qz", _) => Some(6),
        _ => None,
    };
    let (index, at) = match (words.last().and_then(place), words.first().and_then(place)) {
        (Some(index), _) => (index, words.len() - 1),
        (None, Some(index)) => (index, 0),
        (None, None) => return None,
    };
    let word = words.remove(at);
    let origin = match origin_of(&words) {
        Origin::Open if is_desired => Origin::Commanded,
        origin => origin,
    };
    Some(Component {
        index,
        owner: owner_of(name, &word, at == 0),
        origin,
        is_pose: words.iter().all(|word| is_of_pose(word)),
    })
}

/// An angle of a pose about the axis of this index, with the order in which such angles turn if their names state it: roll, pitch
/// and yaw of vehicles, A, B and C of KUKA.
pub(super) fn angle(name: &str) -> Option<(Component, Option<AngleOrder>)> {
    let mut words = words_of(name);
    if words.len() > 1
        && words
            .last()
            .is_some_and(|last| parse_unit(last).is_some_and(is_angle))
    {
        words.pop();
    }
    let place = |word: &String| {
        let of_vehicle = ANGLES
            .iter()
            .position(|names| names.contains(&word.as_str()));
        match (of_vehicle, word.as_str()) {
            (Some(axis), _) => Some((axis, Some(AngleOrder::ZYX))),
            (None, "rx") => Some((0, None)),
            (None, "ry") => Some((1, None)),
            (None, "rz") => Some((2, None)),
            (None, "a") => Some((2, Some(AngleOrder::ZYX))),
            (None, "b") => Some((1, Some(AngleOrder::ZYX))),
            (None, "c") => Some((0, Some(AngleOrder::ZYX))),
            _ => None,
        }
    };
    let ((index, order), at) = match (words.last().and_then(place), words.first().and_then(place)) {
        (Some(found), _) => (found, words.len() - 1),
        (None, Some(found)) => (found, 0),
        (None, None) => return None,
    };
    let word = words.remove(at);
    let component = Component {
        index,
        owner: owner_of(name, &word, at == 0),
        origin: origin_of(&words),
        is_pose: words.iter().all(|word| is_of_pose(word)),
    };
    Some((component, order))
}

fn is_angle(unit: Unit) -> bool {
    unit.dimension == Dimension::Angle
}

/// Origin of the pose that these words name.
pub(super) fn origin_of(words: &[String]) -> Origin {
    if is_wanted(words) {
        Origin::Commanded
    } else if is_any(words, EXTERNAL) {
        Origin::Measured
    } else {
        Origin::Open
    }
}

/// Whether a word is used in names of poses.
pub(super) fn is_of_pose(word: &str) -> bool {
    let lists = [POSE, ACTUAL, WANTED, EXTERNAL];
    let rotations = [
        "rotation",
        "quat",
        "quaternion",
        "orientation",
        "orient",
        "q",
        "d",
        "robot",
        "gvl",
        "main",
    ];
    lists.iter().any(|list| list.contains(&word)) || rotations.contains(&word)
}

/// Words for the position or the orientation in the name of a component.
const PARTS: [&str; 9] = [
    "Rotation",
    "Position",
    "rotation",
    "position",
    "quaternion",
    "orientation",
    "quat",
    "translation",
    "q",
];

/// Name of the body: the name of a component without the component and without words such as `position`.
fn owner_of(name: &str, component: &str, is_first: bool) -> String {
    let lower = name.to_lowercase();
    let is_between = |letter: char| !letter.is_alphanumeric();
    let found = match is_first {
        true => lower.find(component),
        false => lower.rfind(component),
    };
    let at = found.unwrap_or(name.len());
    let owner = match is_first {
        true => name.get(at + component.len()..),
        false => name.get(..at),
    };
    let owner = owner.unwrap_or_default().trim_matches(is_between);
    let owner = PARTS.iter().fold(owner, |owner, part| {
        owner.strip_suffix(part).unwrap_or(owner)
    });
    owner.trim_matches(is_between).to_owned()
}
