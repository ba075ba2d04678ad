//! Reasons for which identified values are not written unless the operator allows it.

use tautline_core::robot::Robot;
use tautline_link::parameters::parameters_of;
use tautline_session::{Session, VersionedFile};

use crate::diagnosis::DiagnosisDocument;
use crate::identification::{FitVerdict, Identification};
use crate::wording::parameters::title;
use crate::wording::{count, units};

/// Prior standard deviations beyond which a parameter is implausible: of a thousand parameters with a correct prior, one
/// exceeds the limit with probability 6e-4.
const FAR: f64 = 5.0;

/// A reason not to write identified values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DoubtKind {
    /// The identification did not converge.
    Unconverged,
    /// The model does not explain the readings.
    Unexplained,
    /// A parameter lies far outside its prior.
    Implausible,
    /// The diagnosis has a finding that is not in the model.
    Finding,
    /// The controller has no parameter for an effect of the model.
    Unsupported,
}

/// A reason not to write identified values, with its details.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Doubt {
    /// Kind of the reason.
    pub kind: DoubtKind,
    /// The details: one sentence without full stop.
    pub sentence: String,
}

impl Doubt {
    /// A reason with its details.
    #[must_use]
    pub fn new(kind: DoubtKind, sentence: impl Into<String>) -> Self {
        Self {
            kind,
            sentence: sentence.into(),
        }
    }
}

/// The reasons against writing an identification of a session.
#[must_use]
pub fn doubts(session: &Session, fit: &Identification) -> Vec<Doubt> {
    let mut found = Vec::new();
    let solution = &fit.solution;
    if !solution.converged() {
        let text = format!(
            "The identification did not converge in {} steps",
            solution.iterations
        );
        found.push(Doubt::new(DoubtKind::Unconverged, text));
    }
    let p_value = solution.p_value();
    if FitVerdict::of(p_value) == FitVerdict::Inadequate {
        let ratio = fit.residual_ratio().unwrap_or(f64::NAN);
        let text = format!(
            "The model does not explain the readings: the residuals are {} times the expected noise",
            units::significant(ratio, 2)
        );
        found.push(Doubt::new(DoubtKind::Unexplained, text));
    }
    found.extend(implausible(&session.robot, &fit.model));
    found.extend(unanswered(session));
    found
}

/// The parameter that lies farthest outside its prior, if it exceeds the limit.
#[must_use]
pub fn implausible(description: &Robot, model: &Robot) -> Option<Doubt> {
    let mut far: Vec<(String, f64, f64)> = priors(description)
        .into_iter()
        .filter_map(|(name, sd)| {
            let value = |robot: &Robot| {
                let all = parameters_of(robot);
                all.into_iter().find(|p| p.name == name).map(|p| p.value)
            };
            let off = value(model)? - value(description)?;
            // NaN is implausible, too.
            (off.is_nan() || off.abs() > FAR * sd).then_some((name, off, sd))
        })
        .collect();
    far.sort_by(|a, b| (b.1 / b.2).abs().total_cmp(&(a.1 / a.2).abs()));
    let (name, off, sd) = far.first()?;
    let more = match far.len() - 1 {
        0 => String::new(),
        1 => ", and so does 1 more".to_owned(),
        more => format!(", and so do {more} more"),
    };
    let text = format!(
        "{} lies {} mm from the description, whose standard deviation is {} mm{more}",
        title(name, &description.cables),
        units::significant(off.abs() * 1e3, 3),
        units::significant(sd * 1e3, 3)
    );
    Some(Doubt::new(DoubtKind::Implausible, text))
}

/// Lengths with a finite prior standard deviation, by the name of their parameter: entry points and the offset of the laser's plane.
fn priors(robot: &Robot) -> Vec<(String, f64)> {
    let mut list = Vec::new();
    for cable in &robot.cables {
        let each = cable.pulley.entry_point_sd_m.each();
        for (axis, sd) in ["x", "y", "z"].iter().zip(each) {
            let name = format!("{}.entry_point.{axis}_m", cable.name);
            list.extend(sd.filter(|sd| *sd > 0.0).map(|sd| (name, sd)));
        }
    }
    let plane = robot.laser.and_then(|laser| laser.target_plane.offset_sd_m);
    let name = "laser.target_plane.offset_m".to_owned();
    list.extend(plane.filter(|sd| *sd > 0.0).map(|sd| (name, sd)));
    list
}

/// The findings of the last diagnosis of the present inputs. Any response to it, such as adding an effect to the model, changes the inputs.
#[must_use]
pub fn unanswered(session: &Session) -> Option<Doubt> {
    let basis = session.basis();
    let mut results = session.results().iter().rev();
    let last = results.find(|result| {
        result.format() == Some(DiagnosisDocument::FORMAT)
            && result.basis.as_deref() == Some(&basis)
    })?;
    let document = last.document.value();
    let findings = document["findings"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    finding(
        findings
            .iter()
            .filter_map(|finding| finding["cause"].as_str()),
    )
}

/// The doubt about findings with these causes; `None` if there are none.
#[must_use]
pub fn finding<'a>(causes: impl Iterator<Item = &'a str>) -> Option<Doubt> {
    let causes: Vec<&str> = causes.collect();
    let first = causes.first()?;
    let text = format!(
        "The diagnosis has {} missing from the model: {}",
        count(causes.len(), "finding"),
        first.trim_end_matches('.')
    );
    Some(Doubt::new(DoubtKind::Finding, text))
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use tautline_core::robot::presets;
    use tautline_session::{ResultDocument, ResultRecord, Timestamp};

    use super::*;

    #[test]
    fn a_pulley_far_from_its_drawing_is_named() {
        let robot = presets::find("mini").expect("a preset").robot;
        let sd = robot.cables[2].pulley.entry_point_sd_m.each()[1].expect("a prior");
        let mut model = robot.clone();
        model.cables[2].pulley.entry_point_m[1] += 4.9 * sd;
        assert_eq!(implausible(&robot, &model), None);
        model.cables[2].pulley.entry_point_m[1] += 15.0 * sd;
        model.cables[1].pulley.entry_point_m[0] -= 6.0 * sd;
        let doubt = implausible(&robot, &model).expect("a doubt");
        assert_eq!(doubt.kind, DoubtKind::Implausible);
        let far = units::significant(19.9 * sd * 1e3, 3);
        assert!(
            doubt
                .sentence
                .contains(&format!("{far} mm from the description")),
            "{}",
            doubt.sentence
        );
        assert!(doubt.sentence.starts_with("3 "), "{}", doubt.sentence);
        assert!(
            doubt.sentence.ends_with("and so does 1 more"),
            "{}",
            doubt.sentence
        );
        model.cables[2].pulley.entry_point_m[1] = f64::NAN;
        assert!(implausible(&robot, &model).is_some());
    }

    #[test]
    fn findings_count_until_the_data_or_the_model_change() {
        let robot = presets::find("mini").expect("a preset").robot;
        let now = Timestamp::from_unix_seconds(0);
        let mut session = Session::new("test", robot, now);
        let document = json!({
            "format": DiagnosisDocument::FORMAT,
            "findings": [{"cause": "The winch of cable-2 pays out too much."}],
        });
        session.add_result(ResultRecord {
            time: now,
            title: "Diagnosis".into(),
            document: ResultDocument::of(&document).expect("JSON"),
            basis: Some(session.basis()),
        });
        let doubt = unanswered(&session).expect("a doubt");
        assert_eq!(
            doubt.sentence,
            "The diagnosis has 1 finding missing from the model: The winch of cable-2 pays out too much"
        );
        session.robot.cables[0].pulley.radius_m *= 2.0;
        assert_eq!(unanswered(&session), None);
    }
}
