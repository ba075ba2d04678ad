//! `--for`, with the volume of an accuracy.

use crate::{BadInput, volume};
use anyhow::Result;
use clap::ValueEnum;
use tautline_core::planning::Goal;

/// Goal of a plan by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GoalName {
    /// Small standard deviations of the geometry.
    Geometry,
    /// Faults that can be detected and separated.
    Faults,
    /// Both of these.
    Both,
    /// Accurate positions of the platform in a volume.
    Accuracy,
}

/// The goal that the two arguments state.
pub fn goal(name: GoalName, given: Option<&str>) -> Result<Goal> {
    match (name, given) {
        (GoalName::Accuracy, Some(text)) => Ok(Goal::Accuracy(volume::parse(text)?)),
        (GoalName::Accuracy, None) => Err(BadInput::new(
            "--for accuracy: no --volume was given, expected X0,X1,Y0,Y1,Z0,Z1 in metres",
        )),
        (_, Some(_)) => Err(BadInput::new("--volume: expected only with --for accuracy")),
        (GoalName::Geometry, None) => Ok(Goal::Geometry),
        (GoalName::Faults, None) => Ok(Goal::Faults),
        (GoalName::Both, None) => Ok(Goal::Both),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::planning::Volume;

    use super::*;

    #[test]
    fn a_volume_belongs_to_accuracy() {
        let found = goal(GoalName::Accuracy, Some("-1,1, -0.5,0.5,0,0.2")).expect("a goal");
        let expected = Volume {
            low_m: [-1.0, -0.5, 0.0],
            high_m: [1.0, 0.5, 0.2],
        };
        assert_eq!(found, Goal::Accuracy(expected));
        for (name, text) in [
            (GoalName::Accuracy, None),
            (GoalName::Faults, Some("0,1,0,1,0,1")),
            (GoalName::Accuracy, Some("1,0,0,1,0,1")),
            (GoalName::Accuracy, Some("0,1,0,1")),
            (GoalName::Accuracy, Some("0,nan,0,1,0,1")),
        ] {
            let error = goal(name, text).expect_err("refused").to_string();
            assert!(
                error.starts_with("--") && error.contains("expected"),
                "{error}"
            );
        }
        assert_eq!(goal(GoalName::Both, None).expect("a goal"), Goal::Both);
    }
}
