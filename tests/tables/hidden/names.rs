//! Serialisation of the names of robots, effects and parameters.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};
use tautline_core::effect::CATALOGUE;

use super::OUTSIDE;
use super::robots::all_names;

/// A name known to the program.
pub type Name = &'static str;

/// The known name equal to `text`.
fn known(text: &str) -> Option<Name> {
    let parameters = CATALOGUE.iter().flat_map(|effect| effect.parameters());
    let mut all = all_names()
        .chain(CATALOGUE.iter().map(|effect| effect.id()))
        .chain(OUTSIDE.iter().map(|effect| effect.id))
        .chain(parameters.map(|parameter| parameter.name));
    all.find(|name| *name == text)
}

/// Writes a name.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(name: &Name, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(name)
}

/// Reads a name.
///
/// # Errors
/// If there is no such name.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Name, D::Error> {
    let text = String::deserialize(from)?;
    known(&text)
        .ok_or_else(|| Error::custom(format!("there is no robot, effect or parameter {text}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_robots_effects_and_parameters() {
        for name in ["planar", "winch_scale", "obstacle", "amplitude"] {
            assert_eq!(known(name), Some(name));
        }
        assert_eq!(known("nothing of the kind"), None);
    }
}
