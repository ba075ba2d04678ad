//! Validation of study files.

use tautline_core::effect;
use tautline_core::robot::{FieldError, Robot};

use super::{Axis, Design, Fault, Simulation, StudyFile};

/// Maximum numbers of poses of a cell, and of faults and calibrations of a study.
const MOST_POSES: usize = 1000;
const MOST_FAULTS: usize = 8;
const MOST_CALIBRATIONS: u64 = 1_000_000_000;

/// Checks that the robots of a study can have its faults.
pub fn faults(study: &StudyFile, robots: &[Robot]) -> Result<(), FieldError> {
    for (index, fault) in study.faults.iter().enumerate() {
        for robot in robots {
            fault.check_on(robot, &format!("/faults/{index}"))?;
        }
    }
    Ok(())
}

/// Checks a study file.
pub fn study(study: &StudyFile) -> Result<(), FieldError> {
    study.design.check()?;
    study.simulation.check()?;
    let count = study.faults.len();
    let most = format!("at most {MOST_FAULTS} faults");
    expect(count <= MOST_FAULTS, "/faults", count, &most)?;
    for (index, fault) in study.faults.iter().enumerate() {
        fault.check(&format!("/faults/{index}"))?;
    }
    let wanted = study.wanted_m.unwrap_or(1.0);
    let is_good = wanted > 0.0 && wanted.is_finite();
    expect(is_good, "/wanted_m", wanted, "a number greater than 0")
}

fn is_part(value: f64) -> bool {
    (0.0..=1.0).contains(&value)
}

impl Simulation {
    fn check(&self) -> Result<(), FieldError> {
        for (key, value) in [("calibrations", self.calibrations), ("chunk", self.chunk)] {
            let is_good = (1..=MOST_CALIBRATIONS).contains(&value);
            let pointer = format!("/simulation/{key}");
            expect(is_good, &pointer, value, "a number from 1 to 1e9")?;
        }
        let share = self.share;
        let pointer = "/simulation/share";
        expect(is_part(share), pointer, share, "a fraction from 0 to 1")?;
        let alpha = self.alpha;
        let is_good = alpha > 0.0 && alpha < 1.0;
        expect(
            is_good,
            "/simulation/alpha",
            alpha,
            "a level between 0 and 1",
        )
    }
}

impl Fault {
    fn check(&self, pointer: &str) -> Result<(), FieldError> {
        let pointer = format!("{pointer}/rate");
        let rate = self.rate;
        expect(is_part(rate), &pointer, rate, "a fraction from 0 to 1")
    }

    /// Checks that a robot can have it.
    fn check_on(&self, robot: &Robot, pointer: &str) -> Result<(), FieldError> {
        let at = |key: &str| format!("{pointer}/{key}");
        let named = format!("\"{}\"", self.effect);
        let Some(found) = robot.effect(&self.effect) else {
            let expected = "an effect that the command effects lists";
            return expect(false, &at("effect"), named, expected);
        };
        let is_drawn = !matches!(found.scope(), effect::Scope::Pair);
        let expected = "an effect of one cable or of the robot";
        expect(is_drawn, &at("effect"), named, expected)?;
        let names: Vec<&str> = found.parameters().iter().map(|p| p.name).collect();
        let mut given = self.parameters.keys();
        match given.find(|name| !names.contains(&name.as_str())) {
            Some(unknown) => {
                let found = format!("the parameter \"{unknown}\"");
                expect(false, &at("parameters"), found, &names.join(", "))
            }
            None => Ok(()),
        }
    }
}

impl Design {
    fn check(&self) -> Result<(), FieldError> {
        for (key, is_empty) in [
            ("robots", self.robots.is_empty()),
            ("lasers", self.lasers.is_empty()),
            ("poses", self.poses.is_empty()),
            ("choice", self.choice.is_empty()),
            ("methods", self.methods.is_empty()),
        ] {
            if is_empty {
                return fail(
                    format!("/design/{key}"),
                    "found an empty array, expected one value or more",
                );
            }
        }
        for (index, poses) in self.poses.iter().enumerate() {
            let good = (1..=MOST_POSES).contains(poses);
            expect(
                good,
                &format!("/design/poses/{index}"),
                poses,
                "a number from 1 to 1000",
            )?;
        }
        let random = self.random_cells;
        if random == Some(0) {
            return fail("/design/random_cells", "found 0, expected 1 or more");
        }
        for (key, axis, may_be_0) in [
            ("size_m", &self.size_m, false),
            ("home_sd_m", &self.home_sd_m, false),
            ("inclinometer_sd_rad", &self.inclinometer_sd_rad, true),
            ("length_sd_m", &self.length_sd_m, false),
            ("tension_sd_n", &self.tension_sd_n, false),
        ] {
            axis.check(&format!("/design/{key}"), may_be_0, random.is_some())?;
        }
        Ok(())
    }
}

impl Axis {
    fn check(&self, pointer: &str, may_be_0: bool, is_random: bool) -> Result<(), FieldError> {
        let good = |value: f64| value.is_finite() && (value > 0.0 || may_be_0 && value == 0.0);
        match self {
            Self::Values(values) => match values.iter().position(|value| !good(*value)) {
                Some(index) => expect(
                    false,
                    &format!("{pointer}/{index}"),
                    values[index],
                    "a number greater than 0",
                ),
                None => Ok(()),
            },
            Self::Range { from, to } if !(*from > 0.0 && to > from && to.is_finite()) => fail(
                pointer,
                format!("found {from} to {to}, expected a rising range above 0"),
            ),
            Self::Range { .. } if !is_random => fail(
                pointer,
                "found a range, expected values; ranges require random_cells",
            ),
            Self::Range { .. } => Ok(()),
        }
    }
}

fn expect(
    is_good: bool,
    pointer: &str,
    found: impl std::fmt::Display,
    expected: &str,
) -> Result<(), FieldError> {
    if is_good {
        return Ok(());
    }
    fail(pointer, format!("found {found}, expected {expected}"))
}

fn fail<T>(pointer: impl Into<String>, message: impl Into<String>) -> Result<T, FieldError> {
    Err(FieldError {
        pointer: pointer.into(),
        message: message.into(),
    })
}
