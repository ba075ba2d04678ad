//! A finding in words.

use tautline_core::diagnosis::{Alternative, Cause, Finding, FoundParameter, Gain, Verdict};
use tautline_core::effect::EffectSetting;

use super::Diagnosed;
use crate::wording::probability::{certainty, degree, odds_between, percent};
use crate::wording::units::{significant, unit_of, with_sd};
use crate::wording::{count, first_lower, list, ratio, sentence};

impl Diagnosed {
    /// The cause and its certainty.
    #[must_use]
    pub fn heading(&self, finding: &Finding) -> String {
        match finding.verdict() {
            Verdict::Ambiguous if !finding.is_list() => {
                let title = first_lower(&self.subject(&finding.subject));
                let degree = sentence(degree(finding.probability));
                format!("{degree} {title}, {}", percent(finding.probability))
            }
            Verdict::Named | Verdict::Ambiguous => {
                let title = self.subject(&finding.subject);
                format!("{title}, {}", certainty(finding.probability))
            }
            Verdict::Unknown => self.subject(&finding.subject),
        }
    }

    /// Alternatives to the cause, each with its probability; `None` if the cause is named.
    #[must_use]
    pub fn otherwise(&self, finding: &Finding) -> Option<String> {
        if finding.verdict() != Verdict::Ambiguous {
            return None;
        }
        if !finding.is_list() {
            let rest = percent(1.0 - finding.probability);
            return Some(format!(
                "{rest} for something that is not in the catalogue."
            ));
        }
        let odds = |other: &Alternative| {
            let title = self.subject(&other.subject);
            let odds = odds_between(finding.probability, other.probability);
            format!(
                "{title} ({}; {odds} against it)",
                percent(other.probability)
            )
        };
        let others: Vec<_> = finding.alternatives.iter().map(odds).collect();
        Some(format!(
            "These data cannot tell it from: {}.",
            others.join("; ")
        ))
    }

    /// Measurements that decide between the causes of a finding, or confirm a probable one: a heading, and the poses to measure
    /// and the checks in the workshop. `None` if the cause is named or unknown.
    #[must_use]
    pub fn decides(&self, finding: &Finding) -> Option<(&'static str, String)> {
        if finding.verdict() != Verdict::Ambiguous {
            return None;
        }
        let heading = match finding.is_list() {
            true => "What decides between them",
            false => "To be sure",
        };
        let mut advice: Vec<String> = Vec::new();
        advice.extend(finding.separation.iter().map(|s| s.advice.clone()));
        for cause in finding.causes() {
            advice.extend(cause.effect().check().map(str::to_owned));
        }
        let mut different: Vec<String> = Vec::new();
        for text in advice {
            // What separates two causes may already quote the checks of both.
            if !different.iter().any(|known| known.contains(&text)) {
                different.push(text);
            }
        }
        if different.is_empty() {
            different.push("Measure more poses.".to_owned());
        }
        Some((heading, different.join(" ")))
    }

    /// Possible but not established causes, in a sentence.
    #[must_use]
    pub fn possible_line(&self) -> Option<String> {
        let possible = self.diagnosis.possible.iter();
        let each: Vec<String> = possible
            .map(|p| format!("{}, {}", self.title(&p.cause), percent(p.probability)))
            .collect();
        (!each.is_empty()).then(|| format!("Possible, but not established: {}.", list(&each)))
    }

    /// The effects of a cause as settings of a model.
    #[must_use]
    pub fn settings(&self, cause: &Cause) -> Vec<EffectSetting> {
        let instances = cause.instances.iter();
        instances.map(|bound| bound.setting(self.robot())).collect()
    }

    /// The estimated sizes, if there are any.
    #[must_use]
    pub fn size(&self, parameters: &[FoundParameter]) -> Option<String> {
        let name_each = parameters
            .iter()
            .any(|p| p.name != parameters[0].name && p.sd.is_some());
        let words = |p: &FoundParameter| {
            let value = match p.sd {
                None => return format!("{} {}", p.name, significant(p.value, 6)),
                Some(sd) => with_sd(p.value, sd, unit_of(p.name, p.unit)),
            };
            let name = if name_each { Some(p.name) } else { None };
            let cable = self.cable(p.cable);
            let before = cable.as_deref().into_iter().chain(name);
            let words: Vec<_> = before.chain([value.as_str()]).collect();
            words.join(" ")
        };
        let words: Vec<_> = parameters.iter().map(words).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}

/// Whether held-out poses are predicted better: visibly after rounding, and significantly.
#[must_use]
pub fn is_improvement(gain: &Gain) -> bool {
    ratio(gain.before) != ratio(gain.after) && gain.interval[0] > 0.0
}

/// Improvement by a finding, of the prediction and of the robot.
#[must_use]
pub fn gain(gain: &Gain) -> String {
    let position = gain.position;
    let [from, to] = position.interval_m.map(|m| significant(1e3 * m, 2));
    let moved = format!(
        "the platform is {} ({from} to {to}) from where the previous model puts it, at most {}",
        short(position.rms_m),
        short(position.largest_m)
    );
    let [before, after] = [gain.before, gain.after].map(ratio);
    if gain.poses_held_out == 0 || !(gain.before.is_finite() && gain.after.is_finite()) {
        return format!("{moved}. There are too few poses for a test on held-out poses.");
    }
    let poses = count(gain.poses_held_out, "pose");
    let readings = format!("at {poses} held out of the fit, residuals are");
    let change = if before == after {
        format!("unchanged at {after} times the expected noise")
    } else if !is_improvement(gain) {
        format!("{after} instead of {before} times the expected noise, which is no improvement")
    } else {
        format!("{after} instead of {before} times the expected noise")
    };
    format!("{readings} {change}; {moved}.")
}

/// A length in millimetres with a sensible number of digits.
fn short(length_m: f64) -> String {
    format!("{} mm", significant(1e3 * length_m, 2))
}
