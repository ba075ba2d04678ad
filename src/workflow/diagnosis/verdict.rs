//! The verdict on a model, its noise and the unexplained dependences, in words.

use tautline_core::diagnosis::{Adequacy, GlobalTest, NoiseStatement, Quantity, ToleranceFactor};

use super::Diagnosed;
use super::dependences::all_groups;
use crate::wording::units::significant;
use crate::wording::{count, list, odds, ratio, readings, sentence};

/// Factor of the tolerances below which parts are called exact.
const EXACT: f64 = 0.1;
/// Ratio to the stated noise above which another mistake is likelier than a poor sensor.
const LARGEST_NOISE_RATIO: f64 = 10.0;

/// Root mean square of the residuals over that of noise alone; `None` if nothing is redundant.
#[must_use]
pub fn residual_ratio(test: &GlobalTest) -> Option<f64> {
    (test.degrees_of_freedom > 0.0).then(|| (test.chi2 / test.degrees_of_freedom).sqrt())
}

/// Probability from which on residuals as large are nothing unusual.
const USUAL: f64 = 0.05;

/// Goodness of fit in words.
#[must_use]
pub fn adequacy(adequacy: &Adequacy) -> String {
    let test = &adequacy.global;
    match residual_ratio(test) {
        Some(by) if adequacy.adequate => {
            format!(
                "Its residuals are {} times the expected noise; about 1 is normal.",
                ratio(by)
            )
        }
        // The tests of the readings' dependences judge it, not their size.
        Some(by) if test.p_value > USUAL => format!(
            "Its residuals are only {} times the expected noise, but they are not random.",
            ratio(by)
        ),
        Some(by) if test.p_value.is_finite() => format!(
            "Its residuals are {} times the expected noise; with a correct model they would be as large {}.",
            ratio(by),
            odds(test.p_value)
        ),
        _ => "There are only just enough readings to identify the pulleys, so the model cannot be tested.".to_owned(),
    }
}

impl Diagnosed {
    /// Heading: goodness of fit of the model, with reasons to doubt it.
    #[must_use]
    pub fn headline(&self) -> String {
        let doubt = match self.diagnosis.extended_solution.converged() {
            true => "",
            false => "the fit did NOT converge, do not rely on these results; ",
        };
        let mistakes = self
            .mistakes_in_words()
            .map_or_else(String::new, |found| format!("{found}; then "));
        format!(
            "{}: {mistakes}{doubt}{}",
            self.robot().name,
            self.judgement("NOT")
        )
    }

    /// Number of mistakes in the readings that are undone, in words; `None` if there are none.
    fn mistakes_in_words(&self) -> Option<String> {
        match self.mistakes.len() {
            0 => None,
            1 => Some("a mistake in the readings is undone".to_owned()),
            several => Some(format!("{several} mistakes in the readings are undone")),
        }
    }

    /// Sentences on the scatter of the parts relative to their tolerances.
    fn tolerances_line(&self) -> String {
        let diagnosis = &self.diagnosis;
        let ToleranceFactor { factor, are_stated } = diagnosis.tolerances;
        let tolerances = match are_stated {
            true => "the stated tolerances",
            false => "typical tolerances",
        };
        let scatter = match factor {
            EXACT.. => format!("{factor:.1} of {tolerances}"),
            _ => format!("less than {EXACT} of {tolerances}, as if they were exact"),
        };
        let fault = match self.robot().effects.is_empty() {
            true => "No fault",
            false => "No further fault",
        };
        match diagnosis.findings.is_empty() {
            true if 2 * diagnosis.invisible.len() > diagnosis.readable => {
                "Not enough readings to say whether there is a fault: most kinds would not show at their usual size.".to_owned()
            }
            true if diagnosis.extended.adequate && diagnosis.drawing.is_some() => format!(
                "No part is outside its tolerance, but see the drawing. The parts scatter by {scatter}."
            ),
            true if diagnosis.extended.adequate && self.is_slack() => format!(
                "All parts lie within their tolerances. They scatter by {scatter}."
            ),
            true if diagnosis.base.adequate => format!(
                "{fault}: all parts lie within their tolerances. They scatter by {scatter}."
            ),
            _ if self.cause_count() == 0 => format!("The parts scatter by {scatter}."),
            _ => format!(
                "A finding is a part outside its tolerance. All other parts scatter by {scatter}."
            ),
        }
    }

    /// Sentence on whether the model explains the readings, without the robot's name; `not` is the word for "not".
    #[must_use]
    pub fn judgement(&self, not: &str) -> String {
        let diagnosis = &self.diagnosis;
        let used = self.dataset.measurements.len();
        let poses = match count(self.measured, "pose") {
            all if used < self.measured => format!("{used} of {all}"),
            all => all,
        };
        let found = match self.cause_count() {
            0 => None,
            1 => Some("the cause".to_owned()),
            several => Some(format!("the {several} causes")),
        };
        let end = match found {
            _ if diagnosis.base.adequate => {
                let with = match (self.is_slack(), &diagnosis.drawing) {
                    (true, _) => " without those of a slack cable",
                    (false, Some(_)) => " with other places of the pulleys than stated",
                    (false, None) => "",
                };
                return format!("the model explains the readings of {poses}{with}.");
            }
            Some(found) if diagnosis.extended.adequate => format!("With {found} below it does."),
            Some(found) if self.comes_closer() => {
                format!("With {found} below it comes closer; what remains is below, too.")
            }
            None if diagnosis.cancelled => {
                "The diagnosis ended before it could name a cause.".to_owned()
            }
            None if diagnosis.findings.is_empty() && diagnosis.noise.is_empty() => {
                "No cause was found.".to_owned()
            }
            None if diagnosis.findings.is_empty() => {
                "No cause was found, but the noise is not what robot.json states.".to_owned()
            }
            _ => "No cause of the catalogue explains them.".to_owned(),
        };
        format!("the model does {not} explain the readings of {poses}. {end}")
    }

    /// Whether readings of a slack cable are left out.
    fn is_slack(&self) -> bool {
        let slack = self.diagnosis.slack.as_ref();
        slack.is_some_and(|slack| slack.is_left_out)
    }

    /// Number of findings that are causes.
    fn cause_count(&self) -> usize {
        let findings = self.diagnosis.findings.iter();
        findings.filter(|finding| finding.cause().is_some()).count()
    }

    /// Whether the ratio of the residuals to the noise differs with the findings, after rounding.
    fn comes_closer(&self) -> bool {
        let of = |adequacy: &Adequacy| residual_ratio(&adequacy.global);
        let pair = of(&self.diagnosis.extended).zip(of(&self.diagnosis.base));
        pair.is_some_and(|(with, without)| with < without && ratio(with) != ratio(without))
    }

    /// Goodness of fit, scatter of the parts, and reasons to doubt the result as a whole.
    #[must_use]
    pub fn fit(&self) -> Vec<String> {
        let diagnosis = &self.diagnosis;
        let mut lines = vec![adequacy(&diagnosis.base)];
        let is_extended = !diagnosis.findings.is_empty() && self.comes_closer();
        if is_extended && !diagnosis.base_solution.converged() {
            lines.push("Its fit did not converge, so this figure is only approximate.".to_owned());
        }
        if let Some(after) = residual_ratio(&diagnosis.extended.global).filter(|_| is_extended) {
            lines.push(format!(
                "With the findings included, the residuals are {} times the expected noise.",
                ratio(after)
            ));
        }
        lines.push(match diagnosis.cancelled {
            true if self.ended_at_limit => format!(
                "The diagnosis ended at its time limit of {} s: causes are possible ones only, and faults may be missing.",
                significant(self.limit_s, 3)
            ),
            true => "The diagnosis was cancelled: causes are possible ones only, and faults may be missing.".to_owned(),
            false => self.tolerances_line(),
        });
        lines
    }

    /// Noise that differs from the robot's description, in a sentence.
    #[must_use]
    pub fn noise_line(&self, noise: &NoiseStatement) -> String {
        let cable = self.cable(noise.cable);
        let readings = sentence(&readings(noise.quantity, cable.as_deref()));
        let [from, to] = noise.interval.map(|ratio| significant(ratio, 2));
        let ratio = significant(noise.ratio, 2);
        let only = if noise.ratio < 1.0 { "only " } else { "" };
        let key = noise_key(noise.quantity);
        let advice = if noise.ratio > LARGEST_NOISE_RATIO {
            format!(
                "no sensor is so much worse than its data sheet, so leave {key} as it is, and look for a wrong unit, sign, channel or \
                 frame with `tautline check`"
            )
        } else if !self.diagnosis.extended_solution.converged() {
            format!("the fit did not converge, so leave {key} as it is")
        } else {
            let file = match noise.quantity {
                Quantity::Distance => "distances.csv",
                _ => "robot.json",
            };
            format!("correct {key} in {file}")
        };
        format!("{readings} have {only}{ratio} times the stated noise ({from} to {to}): {advice}.")
    }

    /// Remaining dependences with the extended model, one sentence for each kind of reading and cable.
    #[must_use]
    pub fn remaining_lines(&self) -> Vec<String> {
        let left = &self.diagnosis.remaining;
        let groups = all_groups(left).into_iter();
        groups
            .map(|group| {
                let first = &left[group[0]];
                // Components of a reading may depend on the same variable.
                let mut names: Vec<&str> = Vec::new();
                for name in group.iter().map(|&k| left[k].variable.name()) {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                format!(
                    "Unexplained: residuals of {} are {:.2} times the expected noise and depend on {}.",
                    readings(first.quantity, self.cable(first.cable).as_deref()),
                    first.rms_over_sd,
                    list(&names)
                )
            })
            .collect()
    }
}

/// Field of robot.json that states the noise of a kind of reading.
fn noise_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Length => "winch.length_sd_m",
        Quantity::Tension => "force_sensor.tension_sd_n",
        Quantity::Laser => "laser.sd_m",
        Quantity::Swivel => "pulley.swivel_sd_rad",
        Quantity::Inclination => "inclinometer.sd_rad",
        Quantity::TrackerPosition => "tracker.position_sd_m",
        Quantity::TrackerOrientation => "tracker.orientation_sd_rad",
        Quantity::Distance => "sd_m",
    }
}
