//! What does not look right in measured readings, in words for the operator.

use tautline_core::robot::Robot;

use super::accepted::Accepted;
use super::options::{MeasuringOptions, Prediction};
use crate::controller::Sample;

/// Standard deviations of a mean tension that count as noise.
const TENSION_NOISE: f64 = 3.0;
/// Difference of two samples of a platform at rest that is a jump, in standard deviations of one sample.
const JUMP: f64 = 15.0;
/// A winch that should turn by more than this many standard deviations of its length must show something else.
const TURNS: f64 = 20.0;
/// Poses after which channels are compared with the predictions of other cables.
const COMPARED_POSES: usize = 4;
/// Correlation with the own prediction below which, and with each other's above which, two channels are exchanged.
const OWN: f64 = 0.9;
const OTHERS: f64 = 0.98;

/// Something that the operator should look at.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// Label of the pose.
    pub label: i64,
    /// Index of the cable, where it is about one.
    pub cable: Option<usize>,
    /// One sentence.
    pub text: String,
    /// Whether the pose cannot be used like this.
    pub refuses: bool,
}

/// Readings before a motion and what was expected of them, and which of them changed on the way.
#[derive(Debug, Clone)]
pub(super) struct Journey {
    first: Sample,
    expected: Option<Prediction>,
    changed: Vec<bool>,
}

impl Journey {
    /// From a sample; `expected` at the pose that was commanded before.
    pub fn from(first: Sample, expected: Option<Prediction>) -> Self {
        Self {
            changed: vec![false; first.revolutions.len()],
            first,
            expected,
        }
    }

    /// Follows the readings on the way.
    pub fn follow(&mut self, sample: &Sample) {
        let pairs = sample.revolutions.iter().zip(&self.first.revolutions);
        for (changed, (now, then)) in self.changed.iter_mut().zip(pairs) {
            *changed |= now.to_bits() != then.to_bits();
        }
    }
}

/// Checks of the readings of a robot.
pub(super) struct Checks<'a> {
    pub robot: &'a Robot,
    pub options: &'a MeasuringOptions,
    pub at: &'a Accepted,
    /// Why there is no laser distance, where that is known.
    pub laser_trouble: Option<String>,
}

impl Checks<'_> {
    fn warning(&self, cable: Option<usize>, refuses: bool, text: &str) -> Warning {
        let name = cable.and_then(|index| self.robot.cables.get(index));
        let subject = name.map_or(String::new(), |cable| format!("{}: ", cable.name));
        let place = match self.at.label {
            0 => "at home".to_owned(),
            label => format!("at pose {label}"),
        };
        Warning {
            label: self.at.label,
            cable,
            text: format!("{subject}{text} ({place})."),
            refuses,
        }
    }

    /// Everything that can be seen at this pose alone and on the way to it.
    pub fn all(&self, journey: Option<&Journey>, expected: Option<&Prediction>) -> Vec<Warning> {
        let mut found = self.missing();
        found.extend(self.tensions());
        if let Some(expected) = expected {
            for index in 0..self.robot.cable_count() {
                found.extend(self.winch(index, journey, expected));
            }
            found.extend(self.laser(expected));
        }
        found
    }

    fn missing(&self) -> Vec<Warning> {
        let mut found = Vec::new();
        for (index, value) in self.at.revolutions.iter().enumerate() {
            if !value.is_finite() {
                found.push(self.warning(Some(index), true, "its encoder shows no number"));
            }
        }
        for (index, value) in self.at.force_n.iter().enumerate() {
            // Lengths count from home: without the tension there a cable cannot be used at all.
            if !value.is_finite() {
                let refuses = self.at.label == 0;
                found.push(self.warning(Some(index), refuses, "its force sensor shows no number"));
            }
        }
        if self.at.laser_m.is_nan() && self.robot.laser.is_some() {
            let usual =
                "the laser has no return: is something in the beam, or the target out of reach?";
            let text = match &self.laser_trouble {
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
            let reading = self.at.force_n.get(index).copied().unwrap_or(f64::NAN);
            let Some(sensor) = cable.force_sensor else {
                continue;
            };
            let tension = sensor.tension_n(reading);
            let noise = TENSION_NOISE * sensor.tension_sd_n;
            if tension < range.lower_n - noise {
                let least = range.lower_n;
                let text = format!("it is slack: {tension:.1} N, at least {least:.1} N are needed");
                found.push(self.warning(Some(index), false, &text));
            } else if tension > range.upper_n + noise {
                let most = range.upper_n;
                let text =
                    format!("it is overloaded: {tension:.1} N, at most {most:.1} N are allowed");
                found.push(self.warning(Some(index), false, &text));
            }
        }
        found
    }

    /// The most telling of what is wrong with a winch's reading.
    fn winch(
        &self,
        index: usize,
        journey: Option<&Journey>,
        expected: &Prediction,
    ) -> Option<Warning> {
        let winch = self.robot.cables.get(index)?.winch;
        let per_revolution = winch.cable_per_revolution_m();
        let now = *self.at.revolutions.get(index)?;
        let expected_now = *expected.revolutions.get(index)?;
        if let Some((journey, before)) = journey.and_then(|j| Some((j, j.expected.as_ref()?))) {
            let should_m = (expected_now - before.revolutions.get(index)?) * per_revolution;
            let did_m = (now - journey.first.revolutions.get(index)?) * per_revolution;
            let changed = journey.changed.get(index).copied().unwrap_or(true);
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
        // NaN has been told.
        (off_m.abs() > self.options.plausible_m).then(|| self.warning(Some(index), false, &text))
    }

    fn laser(&self, expected: &Prediction) -> Option<Warning> {
        let off_m = self.at.laser_m - expected.laser_m?;
        let text = format!(
            "the laser distance is {:.1} mm off what is expected, more than {:.0} mm are not plausible",
            off_m * 1e3,
            self.options.plausible_m * 1e3
        );
        (off_m.abs() > self.options.plausible_m).then(|| self.warning(None, false, &text))
    }
}

/// A reading that jumped between two samples of a platform at rest: cable, or `None` for the laser, and words.
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

/// Pairs of cables whose encoders follow each other's prediction instead of their own.
pub(super) fn exchanged(rows: &[(Vec<f64>, Vec<f64>)]) -> Vec<[usize; 2]> {
    let cables = rows.iter().map(|(m, p)| m.len().min(p.len())).min();
    let cables = cables.filter(|_| rows.len() >= COMPARED_POSES).unwrap_or(0);
    let follows = |measured: usize, predicted: usize| {
        let pairs = rows.iter().map(|(m, p)| (m[measured], p[predicted]));
        correlation(&pairs.collect::<Vec<_>>())
    };
    let strangers: Vec<usize> = (0..cables).filter(|i| follows(*i, *i) < OWN).collect();
    let mut pairs = Vec::new();
    for (k, a) in strangers.iter().enumerate() {
        for b in &strangers[k + 1..] {
            if follows(*a, *b) > OTHERS && follows(*b, *a) > OTHERS {
                pairs.push([*a, *b]);
            }
        }
    }
    pairs
}

/// Pearson's; NaN without variation.
fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let mean_a = pairs.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_b = pairs.iter().map(|p| p.1).sum::<f64>() / n;
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        ab += (a - mean_a) * (b - mean_b);
        aa += (a - mean_a).powi(2);
        bb += (b - mean_b).powi(2);
    }
    ab / (aa * bb).sqrt()
}
