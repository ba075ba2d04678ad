//! Plausibility checks of measured readings, as warnings for the operator.

use tautline_core::measurement::Measurements;
use tautline_core::robot::{ForceSensor, Robot};
use tautline_core::simulation::TensionRange;

use super::channels::{encoder_factor, laser_factor};
use super::mean::mean_and_sd;
use super::options::{MeasuringOptions, Prediction};
use crate::controller::Sample;

/// Standard deviations of a mean tension by which it may be outside the limits as noise: of a hundred means of a cable that is held
/// at a limit, fewer than one is farther out.
const TENSION_NOISE: f64 = 2.5;
/// Difference between two samples at rest that counts as a jump, in standard deviations of one sample.
const JUMP: f64 = 15.0;
/// A winch that is expected to turn by more than this many standard deviations of its length must show a change.
const TURNS: f64 = 20.0;

/// Ratio to the prediction beyond which a reading has a wrong unit.
const MULTIPLE: f64 = 10.0;

/// Fraction of its standard deviation below which a force sensor shows no noise.
const SILENT: f64 = 1e-3;

/// A tension that is outside the limits by more than its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TensionFault {
    /// Below zero: a cable cannot push.
    Negative,
    /// Below the smallest allowed one.
    Low,
    /// Above the largest allowed one.
    High,
}

impl TensionFault {
    /// The fault of a tension (N), if it has one.
    #[must_use]
    pub fn of(sensor: &ForceSensor, tension_n: f64, range: &TensionRange) -> Option<Self> {
        let noise_n = TENSION_NOISE * sensor.tension_sd_n;
        if tension_n < -noise_n {
            Some(Self::Negative)
        } else if tension_n < range.lower_n - noise_n {
            Some(Self::Low)
        } else if tension_n > range.upper_n + noise_n {
            Some(Self::High)
        } else {
            None
        }
    }
}

/// A warning for the operator.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// Label of the pose.
    pub label: i64,
    /// Index of the cable, if it concerns one.
    pub cable: Option<usize>,
    /// The warning in one sentence.
    pub text: String,
    /// Whether the pose is rejected.
    pub refuses: bool,
    /// Whether a force sensor is dead, so that its cable is not protected from overload.
    pub is_dead_sensor: bool,
}

/// Readings before a motion, their prediction, and which of them changed during the motion.
#[derive(Debug, Clone)]
pub(super) struct MotionRecord {
    first: Sample,
    expected: Option<Prediction>,
    revolutions_changed: Vec<bool>,
    forces_changed: Vec<bool>,
    laser_changed: bool,
}

/// Whether a reading changed by at least one bit; a missing one does not count as a change.
fn differs(now: f64, then: f64) -> bool {
    now.is_finite() && now.to_bits() != then.to_bits()
}

impl MotionRecord {
    /// Starts with the first sample; `expected` is the prediction at the previous pose.
    pub fn from(first: Sample, expected: Option<Prediction>) -> Self {
        Self {
            revolutions_changed: vec![false; first.revolutions.len()],
            forces_changed: vec![false; first.force_n.len()],
            laser_changed: false,
            first,
            expected,
        }
    }

    /// Adds a sample.
    pub fn record(&mut self, sample: &Sample) {
        let first = &self.first;
        for (changed, now, then) in [
            (
                &mut self.revolutions_changed,
                &sample.revolutions,
                &first.revolutions,
            ),
            (&mut self.forces_changed, &sample.force_n, &first.force_n),
        ] {
            for (changed, (now, then)) in changed.iter_mut().zip(now.iter().zip(then)) {
                *changed |= differs(*now, *then);
            }
        }
        let laser = sample.laser_m.zip(first.laser_m);
        self.laser_changed |= laser.is_none_or(|(now, then)| differs(now, then));
    }

    /// A sentence if the encoder of a cable or the laser changed by a multiple of the prediction. The noise of such a
    /// channel is also multiplied, so that it never seems to be at rest.
    pub fn multiple(
        &self,
        robot: &Robot,
        cable: Option<usize>,
        (now, expected): (&Sample, &Prediction),
    ) -> Option<String> {
        let before = self.expected.as_ref()?;
        let Some(index) = cable else {
            // Unlike an encoder, a laser shows an absolute distance.
            let factor = now.laser_m? / expected.laser_m?;
            return (factor > MULTIPLE).then(|| laser_factor(factor));
        };
        let cable = robot.cables.get(index)?;
        let did = now.revolutions.get(index)? - self.first.revolutions.get(index)?;
        let should = expected.revolutions.get(index)? - before.revolutions.get(index)?;
        let per_revolution = cable.winch.cable_per_revolution_m();
        let large = should.abs() * per_revolution > TURNS * cable.winch.length_sd_m;
        let factor = did / should;
        (large && factor > MULTIPLE).then(|| encoder_factor(&cable.name, factor))
    }
}

/// Checks of the mean readings at a pose.
pub(super) struct Checks<'a> {
    pub robot: &'a Robot,
    pub options: &'a MeasuringOptions,
    /// The mean readings, one row.
    pub at: &'a Measurements,
    /// Label of the pose.
    pub label: i64,
    /// The averaged samples.
    pub samples: &'a [Sample],
    /// Reason why there is no laser distance, if known.
    pub laser_problem: Option<String>,
}

impl Checks<'_> {
    fn warning(&self, cable: Option<usize>, refuses: bool, text: &str) -> Warning {
        let name = cable.and_then(|index| self.robot.cables.get(index));
        let subject = name.map_or(String::new(), |cable| format!("{}: ", cable.name));
        let place = match self.label {
            0 => "at home".to_owned(),
            label => format!("at pose {label}"),
        };
        Warning {
            label: self.label,
            cable,
            text: format!("{subject}{text} ({place})."),
            refuses,
            is_dead_sensor: false,
        }
    }

    fn has_sensor(&self, index: usize) -> bool {
        let cable = self.robot.cables.get(index);
        cable.is_some_and(|cable| cable.force_sensor.is_some())
    }

    fn dead_sensor(&self, index: usize, text: &str) -> Warning {
        Warning {
            is_dead_sensor: true,
            ..self.warning(Some(index), false, text)
        }
    }

    /// All checks of this pose and of the motion to it.
    pub fn all(
        &self,
        motion: Option<&MotionRecord>,
        expected: Option<&Prediction>,
    ) -> Vec<Warning> {
        let mut found = self.missing();
        found.extend(self.tensions());
        found.extend(motion.into_iter().flat_map(|j| self.frozen_forces(j)));
        if let Some(expected) = expected {
            for index in 0..self.robot.cable_count() {
                found.extend(self.winch(index, motion, expected));
            }
            found.extend(self.laser(motion, expected));
        }
        found
    }

    fn missing(&self) -> Vec<Warning> {
        let mut found = Vec::new();
        for (index, value) in self.at.revolutions.row(0).iter().enumerate() {
            if !value.is_finite() {
                found.push(self.warning(Some(index), true, "its encoder shows no number"));
            }
        }
        for (index, value) in self.at.force_n.row(0).iter().enumerate() {
            // Lengths count from home, so a cable without a tension there cannot be used at all.
            if !value.is_finite() && self.has_sensor(index) {
                found.push(Warning {
                    refuses: self.label == 0,
                    ..self.dead_sensor(index, "its force sensor shows no number")
                });
            }
        }
        if self.at.laser_at(0).is_nan() && self.robot.laser.is_some() {
            let usual =
                "the laser has no return: is something in the beam, or the target out of reach?";
            let text = match &self.laser_problem {
                Some(known) => format!("there is no laser distance, {known}"),
                None => usual.to_owned(),
            };
            found.push(self.warning(None, self.options.laser_required, &text));
        }
        found
    }

    fn tensions(&self) -> Vec<Warning> {
        let range = &self.options.tension;
        let mut found = Vec::new();
        for (index, cable) in self.robot.cables.iter().enumerate() {
            let reading = self.at.force_n.get(0, index);
            let Some(sensor) = cable.force_sensor else {
                continue;
            };
            let is_zero = |sample: &Sample| sample.force_n.get(index) == Some(&0.0);
            if !self.samples.is_empty() && self.samples.iter().all(is_zero) {
                found.push(self.dead_sensor(index, "its force sensor shows exactly 0 N"));
                continue;
            }
            let tension = sensor.tension_n(reading);
            let (least, most) = (range.lower_n, range.upper_n);
            let text = match TensionFault::of(&sensor, tension, range) {
                None => continue,
                Some(TensionFault::Negative) => {
                    let text = format!(
                        "its force sensor shows {tension:.1} N, but a cable cannot push: is its sign reversed?"
                    );
                    found.push(self.dead_sensor(index, &text));
                    continue;
                }
                Some(TensionFault::Low) => {
                    format!(
                        "its tension is too low: {tension:.2} N, at least {least:.1} N are needed"
                    )
                }
                Some(TensionFault::High) => {
                    format!(
                        "its tension is too high: {tension:.2} N, at most {most:.1} N are allowed"
                    )
                }
            };
            found.push(self.warning(Some(index), false, &text));
        }
        found
    }

    /// Force sensors that did not change by a single bit while most others show noise at rest. Without noise, a cable
    /// kept at the lowest tension has the same reading everywhere.
    fn frozen_forces(&self, motion: &MotionRecord) -> Vec<Warning> {
        let changed = &motion.forces_changed;
        let noisy = self
            .robot
            .cables
            .iter()
            .enumerate()
            .filter(|(index, cable)| {
                let (_, sd_n) = mean_and_sd(self.samples, &|s| s.force_n.get(*index).copied());
                let sensor = cable.force_sensor;
                sensor.is_some_and(|s| sd_n > SILENT * s.tension_sd_n * s.tension_gain.abs())
            });
        let noisy = noisy.count();
        if 2 * noisy <= changed.len() {
            return Vec::new();
        }
        let text =
            "its force sensor shows exactly the same before and after the motion: is it connected?";
        let cables = changed.iter().enumerate();
        let frozen = cables
            .filter(|(index, changed)| !**changed && self.at.force_n.get(0, *index).is_finite())
            .filter(|(index, _)| self.has_sensor(*index));
        frozen
            .map(|(index, _)| self.dead_sensor(index, text))
            .collect()
    }

    /// The most specific fault of a winch reading.
    fn winch(
        &self,
        index: usize,
        motion: Option<&MotionRecord>,
        expected: &Prediction,
    ) -> Option<Warning> {
        let winch = self.robot.cables.get(index)?.winch;
        let per_revolution = winch.cable_per_revolution_m();
        let now = self.at.revolutions.get(0, index);
        let expected_now = *expected.revolutions.get(index)?;
        if let Some((motion, before)) = motion.and_then(|j| Some((j, j.expected.as_ref()?))) {
            let should_m = (expected_now - before.revolutions.get(index)?) * per_revolution;
            let did_m = (now - motion.first.revolutions.get(index)?) * per_revolution;
            let changed = motion.revolutions_changed.get(index).copied();
            let changed = changed.unwrap_or(true);
            if !changed && should_m.abs() > TURNS * winch.length_sd_m {
                let text = "its encoder shows exactly the same before and after the motion: is it connected?";
                return Some(self.warning(Some(index), false, text));
            }
            let large = should_m.abs() > 2.0 * self.options.plausible_m;
            if large && did_m * should_m.signum() < -0.5 * should_m.abs() {
                let text =
                    "its encoder counts against the expected direction: is its sign reversed?";
                return Some(self.warning(Some(index), false, text));
            }
        }
        let off_m = (now - expected_now) * per_revolution;
        let text = format!(
            "its length is {:.1} mm off what is expected, more than {:.0} mm are not plausible",
            off_m * 1e3,
            self.options.plausible_m * 1e3
        );
        // NaN is reported by another check.
        (off_m.abs() > self.options.plausible_m).then(|| self.warning(Some(index), false, &text))
    }

    fn laser(&self, motion: Option<&MotionRecord>, expected: &Prediction) -> Option<Warning> {
        let before = motion.filter(|motion| !motion.laser_changed);
        if let (Some(before), Some(laser)) = (before, self.robot.laser) {
            let then_m = before.expected.as_ref()?.laser_m?;
            if (expected.laser_m? - then_m).abs() > TURNS * laser.sd_m {
                let text = "the laser shows exactly the same distance before and after the motion: does it still measure?";
                return Some(self.warning(None, false, text));
            }
        }
        let off_m = self.at.laser_at(0) - expected.laser_m?;
        let text = format!(
            "the laser distance is {:.1} mm off what is expected, more than {:.0} mm are not plausible",
            off_m * 1e3,
            self.options.plausible_m * 1e3
        );
        (off_m.abs() > self.options.plausible_m).then(|| self.warning(None, false, &text))
    }
}

/// A reading that jumped between two samples at rest: its cable, or `None` for the laser, and a sentence.
pub(super) fn jump(
    robot: &Robot,
    averaged: usize,
    (before, now): (&Sample, &Sample),
) -> Option<(Option<usize>, String)> {
    let limit = JUMP * (averaged.max(1) as f64).sqrt();
    for (index, cable) in robot.cables.iter().enumerate() {
        let [a, b] = [before, now].map(|s| s.revolutions.get(index).copied());
        let jump_m = (b? - a?) * cable.winch.cable_per_revolution_m();
        if jump_m.abs() > limit * cable.winch.length_sd_m {
            let text = format!("its encoder jumped by {:.2} mm at rest", jump_m * 1e3);
            return Some((Some(index), format!("{}: {text}", cable.name)));
        }
    }
    let jump_m = now.laser_m? - before.laser_m?;
    let text = format!(
        "the laser distance jumped by {:.2} mm at rest",
        jump_m * 1e3
    );
    (jump_m.abs() > limit * robot.laser?.sd_m).then_some((None, text))
}
