//! One finding in the report.

use tautline_core::diagnosis::{Finding, FoundParameter, Gain, Separation, Verdict};

use tautline_core::effect::{Effect, Unknown};

use super::Diagnosed;
use super::words::{count, ratio};
use crate::cli::table;
use crate::cli::units::{significant, unit_of, with_sd};

/// What stands before the lines below a heading.
const INDENT: &str = "   ";

impl Diagnosed<'_> {
    /// Heading and body of a finding.
    pub fn finding_lines(&self, number: usize, finding: &Finding) -> Vec<String> {
        let mut body = vec![finding.sentence.clone()];
        if finding.cause.effect().id() != Unknown.id() {
            body.extend(self.size(&finding.parameters));
        }
        body.push(format!("What it gains: {}", gain(&finding.gain)));
        if !finding.advice.is_empty() {
            body.push(format!("What to do: {}", finding.advice));
        }
        if let Some(separation) = &finding.separation {
            body.extend(separating(separation));
        }
        let mut lines = vec![format!("{number}. {}", self.heading(finding))];
        lines.extend(body.into_iter().map(|line| format!("{INDENT}{line}")));
        lines
    }

    /// What it is and how sure that is.
    fn heading(&self, finding: &Finding) -> String {
        let title = self.title(&finding.cause);
        match finding.verdict {
            Verdict::Named => format!("{title}, clearly"),
            Verdict::Ambiguous => {
                let others: Vec<_> = finding.alternatives.iter().map(|c| self.title(c)).collect();
                format!("{title}, cannot be told apart from: {}", others.join("; "))
            }
            Verdict::Unknown => format!("Unknown cause{}", self.on(&finding.cause)),
        }
    }

    /// The values found, where there are any.
    fn size(&self, parameters: &[FoundParameter]) -> Option<String> {
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
        (!words.is_empty()).then(|| format!("Size: {}", words.join(", ")))
    }
}

/// What the finding does to the prediction and to the robot.
fn gain(gain: &Gain) -> String {
    let position = gain.position;
    let [from, to] = position.interval_m.map(|m| significant(1e3 * m, 2));
    let moved = format!(
        "the platform is {} ({from} to {to}) away from where the old model has it, {} at most",
        short(position.rms_m),
        short(position.largest_m)
    );
    let [before, after] = [gain.before, gain.after].map(ratio);
    if gain.poses_held_out == 0 || !(gain.before.is_finite() && gain.after.is_finite()) {
        return format!("{moved}. There are too few poses to test it on others.");
    }
    let poses = count(gain.poses_held_out, "pose");
    let readings = format!("the readings at {poses} that were not used for fitting are");
    let change = if before == after {
        format!("still missed by {after} times their noise")
    } else if gain.after > gain.before {
        format!("now missed by {after} instead of {before} times their noise, which is no gain")
    } else {
        format!("now missed by {after} instead of {before} times their noise")
    };
    format!("{readings} {change}; {moved}.")
}

/// A length in millimetres with as many digits as anyone reads.
fn short(length_m: f64) -> String {
    format!("{} mm", significant(1e3 * length_m, 2))
}

/// What would tell causes apart.
fn separating(separation: &Separation) -> Vec<String> {
    let mut lines = vec![format!("To tell them apart: {}", separation.advice)];
    if separation.poses.is_empty() {
        return lines;
    }
    let mut poses = table::numbers(&["Pose", "x mm", "y mm", "z mm", "rx °", "ry °", "rz °"]);
    for (index, pose) in separation.poses.iter().enumerate() {
        let position: [f64; 3] = pose.position.into();
        let rotation: [f64; 3] = pose.orientation.scaled_axis().into();
        let mut cells = vec![(index + 1).to_string()];
        cells.extend(position.map(|v| table::mm(v, 0)));
        cells.extend(rotation.map(|angle| format!("{:.1}", angle.to_degrees())));
        table::push(&mut poses, &cells);
    }
    lines.extend(
        poses
            .to_string()
            .lines()
            .map(|row| row.trim_end().to_owned()),
    );
    lines.push("rx, ry, rz: rotation vector about the axes of the base".to_owned());
    lines
}
