//! Comparison of channels over the latest poses: swapped plugs, reversed signs, wrong factors.

mod balance;

use std::collections::VecDeque;

use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use super::options::Prediction;
use balance::Balance;

/// Smallest and largest number of poses compared.
const POSES: [usize; 2] = [4, 8];
/// Two channels count as swapped if the correlation with their own prediction is below the first, and with each other's above the second.
const OWN: f64 = 0.9;
const OTHERS: f64 = 0.98;
/// Smallest relevant deviation of a factor from 1: more than errors of a drawing, less than any gear.
const FACTOR: f64 = 0.2;

/// Readings and predictions at the latest poses.
#[derive(Debug, Default)]
pub(super) struct Channels {
    revolutions: VecDeque<(Vec<f64>, Vec<f64>)>,
    laser_m: VecDeque<(f64, f64)>,
    balances: VecDeque<Balance>,
    /// Faults reported already.
    reported: Vec<(FaultKind, Option<usize>)>,
}

/// Kinds of channel faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FaultKind {
    /// An encoder is swapped with that of a later cable.
    EncodersExchanged(usize),
    /// An encoder or the laser reads a multiple.
    LengthFactor,
    /// A force sensor is swapped with that of a later cable.
    ForcesExchanged(usize),
    /// A force sensor reads a multiple.
    ForceFactor,
}

/// A fault of a channel, with a sentence that describes it.
pub(super) struct Finding {
    what: FaultKind,
    /// The cable, if the fault concerns one.
    pub cable: Option<usize>,
    pub text: String,
}

fn keep<T>(list: &mut VecDeque<T>, row: T) {
    if list.len() == POSES[1] {
        list.pop_front();
    }
    list.push_back(row);
}

impl Channels {
    /// Adds a pose and returns the faults detected with it, each only once.
    pub fn compare(
        &mut self,
        robot: &Robot,
        at: &Measurements,
        expected: Option<&Prediction>,
        plausible_m: f64,
    ) -> Vec<Finding> {
        if let Some(expected) = expected {
            let row = (at.revolutions.row(0).to_vec(), expected.revolutions.clone());
            keep(&mut self.revolutions, row);
            if let Some(predicted_m) = expected.laser_m.filter(|_| at.laser_at(0).is_finite()) {
                keep(&mut self.laser_m, (at.laser_at(0), predicted_m));
            }
        }
        if let Some(balance) = Balance::of(robot, at) {
            keep(&mut self.balances, balance);
        }
        let mut found: Vec<Finding> = Vec::new();
        // The smallest number of poses detects faults that began recently.
        for poses in POSES {
            if self.revolutions.len() >= poses {
                found.extend(self.lengths(robot, poses, plausible_m));
            }
            if self.balances.len() >= poses {
                let latest: Vec<&Balance> = latest(&self.balances, poses).collect();
                found.extend(balance::explained(robot, &latest));
            }
        }
        found.retain(|f| {
            let new = !self.reported.contains(&(f.what, f.cable));
            self.reported.extend(new.then_some((f.what, f.cable)));
            new
        });
        found
    }

    /// Faults of encoders and laser over the latest poses.
    fn lengths(&self, robot: &Robot, poses: usize, plausible_m: f64) -> Vec<Finding> {
        let rows = latest(&self.revolutions, poses);
        let counts = rows.clone().map(|(m, p)| m.len().min(p.len())).min();
        let cables = counts.unwrap_or(0);
        let name = |cable: usize| robot.cables.get(cable).map_or("", |c| c.name.as_str());
        let line = |measured: usize, predicted: usize| {
            Line::through(rows.clone().map(|(m, p)| (m[measured], p[predicted])))
        };
        let mut found = Vec::new();
        let own: Vec<Line> = (0..cables).map(|i| line(i, i)).collect();
        let uncorrelated = (0..cables).filter(|i| own[*i].correlation < OWN);
        let uncorrelated: Vec<usize> = uncorrelated.collect();
        for (k, a) in uncorrelated.iter().enumerate() {
            for b in &uncorrelated[k + 1..] {
                if line(*a, *b).correlation > OTHERS && line(*b, *a).correlation > OTHERS {
                    let [a, b] = [*a, *b];
                    let text = format!(
                        "{} and {}: each encoder follows the motion of the other cable. Are their plugs swapped?",
                        name(a),
                        name(b)
                    );
                    found.push(Finding {
                        what: FaultKind::EncodersExchanged(b),
                        cable: Some(a),
                        text,
                    });
                }
            }
        }
        for (cable, (line, known)) in own.iter().zip(&robot.cables).enumerate() {
            if line.has_factor(plausible_m / known.winch.cable_per_revolution_m()) {
                let text = encoder_factor(name(cable), line.slope);
                found.push(Finding {
                    what: FaultKind::LengthFactor,
                    cable: Some(cable),
                    text,
                });
            }
        }
        let laser = Line::through(latest(&self.laser_m, poses).copied());
        if laser.has_factor(plausible_m) {
            let text = laser_factor(laser.slope);
            found.push(Finding {
                what: FaultKind::LengthFactor,
                cable: None,
                text,
            });
        }
        found
    }
}

fn latest<T>(list: &VecDeque<T>, count: usize) -> impl Iterator<Item = &T> + Clone {
    list.iter().skip(list.len().saturating_sub(count))
}

/// The sentence for an encoder that reads a multiple.
pub(super) fn encoder_factor(cable: &str, factor: f64) -> String {
    format!(
        "{cable}: its encoder counts about {} times what is expected. Are its unit, gear and drum right?",
        rounded(factor)
    )
}

/// The sentence for a laser that reads a multiple.
pub(super) fn laser_factor(factor: f64) -> String {
    format!(
        "the laser shows about {} times the distance that is expected. Is its unit right?",
        rounded(factor)
    )
}

/// The factor with two significant digits.
fn rounded(factor: f64) -> String {
    let digits = 1 - factor.abs().log10().floor().clamp(-6.0, 1.0) as i32;
    let text = format!("{factor:.*}", digits.max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Regression line of readings against predictions.
struct Line {
    slope: f64,
    /// Pearson's correlation coefficient; NaN without variation.
    correlation: f64,
    /// Standard deviation of the predictions.
    expected_sd: f64,
}

impl Line {
    fn through(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let n = pairs.clone().count() as f64;
        let (sum_a, sum_b) = (pairs.clone()).fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        let (mean_a, mean_b) = (sum_a / n, sum_b / n);
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (a, b) in pairs {
            ab += (a - mean_a) * (b - mean_b);
            aa += (a - mean_a).powi(2);
            bb += (b - mean_b).powi(2);
        }
        Self {
            slope: ab / bb,
            correlation: ab / (aa * bb).sqrt(),
            expected_sd: (bb / n).sqrt(),
        }
    }

    /// Whether readings are a multiple of the predictions, with an error of more than half the `plausible` one.
    fn has_factor(&self, plausible: f64) -> bool {
        let off = (self.slope - 1.0).abs();
        self.correlation > OTHERS && off > FACTOR && off * self.expected_sd > 0.5 * plausible
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_have_two_digits() {
        for (factor, text) in [
            (360.2, "360"),
            (2.003, "2"),
            (0.0027778, "0.0028"),
            (0.5, "0.5"),
            (-1.04, "-1"),
            (1e-9, "0"),
        ] {
            assert_eq!(rounded(factor), text);
        }
    }
}
