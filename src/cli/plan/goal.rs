//! `--for` and `--volume`.

use crate::BadInput;
use anyhow::Result;
use clap::ValueEnum;
use tautline_core::planning::{Goal, Volume};

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
pub fn goal(name: GoalName, volume: Option<&str>) -> Result<Goal> {
    match (name, volume) {
        (GoalName::Accuracy, Some(text)) => Ok(Goal::Accuracy(parse(text)?)),
        (GoalName::Accuracy, None) => Err(BadInput::new(
            "--for accuracy: no --volume was given, expected X0,X1,Y0,Y1,Z0,Z1 in metres",
        )),
        (_, Some(_)) => Err(BadInput::new("--volume: expected only with --for accuracy")),
        (GoalName::Geometry, None) => Ok(Goal::Geometry),
        (GoalName::Faults, None) => Ok(Goal::Faults),
        (GoalName::Both, None) => Ok(Goal::Both),
    }
}

fn parse(text: &str) -> Result<Volume> {
    let bad = || {
        BadInput::new(format!(
            "--volume: found \"{text}\", expected X0,X1,Y0,Y1,Z0,Z1 in metres, each first number at most the second"
        ))
    };
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.map_err(|_| bad())?;
    let [x0, x1, y0, y1, z0, z1] = numbers[..] else {
        return Err(bad());
    };
    let volume = Volume {
        low_m: [x0, y0, z0],
        high_m: [x1, y1, z1],
    };
    let is_box = (0..3)
        .all(|k| volume.low_m[k] <= volume.high_m[k] && volume.high_m[k] - volume.low_m[k] < 1e4);
    if is_box && numbers.iter().all(|n| n.is_finite()) {
        Ok(volume)
    } else {
        Err(bad())
    }
}

#[cfg(test)]
mod tests {
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
