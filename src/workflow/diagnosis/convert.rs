//! Conversion of a diagnosis to its JSON document.

use tautline_core::diagnosis::{
    Adequacy, Alternative, Cause, Discrepancy, DrawingPattern, ErrorForm, Evidence, Finding,
    FoundParameter, Gain, GlobalTest, GroupTest, Invisible, NoiseStatement, PositionChange,
    PossibleCause, Rival, Subject, UnmodelledError, Variable, WrongDrawing,
};
use tautline_core::geometry::Pose;

use super::Diagnosed;
use super::document::{
    AlternativeDocument, CauseDocument, DiagnosisDocument, DiscrepancyDocument, DrawingDocument,
    ErrorDocument, ErrorFormDocument, EvidenceDocument, ExtendedDocument, FindingDocument,
    GainDocument, GlobalTestDocument, GroupTestDocument, InvisibleDocument, ModelDocument,
    NoiseDocument, ParameterDocument, PointDocument, PoseDocument, PositionChangeDocument,
    ReadingGainDocument, RemainderDocument, RemainingReadingDocument, RivalDocument,
    RunnerUpDocument, SlackDocument, SubjectDocument,
};
use super::verdict::residual_ratio;

/// Name in place of an effect where none explains an error.
const UNKNOWN: &str = "unknown";
/// Effect of a drawing that is wrong in machine-readable results.
const DRAWING: &str = "drawing";
/// The same of a slack cable.
const SLACK: &str = "slack";
/// Unit of the held-out figures.
const HOLDOUT_UNIT: &str = "rms over sd";

/// JSON has no NaN.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn finite_pair(pair: [f64; 2]) -> Option<[f64; 2]> {
    pair.iter().all(|v| v.is_finite()).then_some(pair)
}

impl Diagnosed {
    /// Machine-readable form.
    pub fn document(&self) -> DiagnosisDocument {
        let diagnosis = &self.diagnosis;
        let discrepancies = |found: &[Discrepancy]| -> Vec<DiscrepancyDocument> {
            found.iter().map(|d| self.discrepancy(d)).collect()
        };
        let effects = diagnosis.extended_solution.globals.effects.iter();
        DiagnosisDocument {
            adequate: diagnosis.base.adequate && self.gross().is_empty(),
            mistakes: self.mistakes.clone(),
            slack: diagnosis.slack.as_ref().map(|found| SlackDocument {
                target: self.robot().cables[found.cable].name.clone(),
                poses: found.poses.clone(),
                excess_m: found.excess_m,
                log_odds: found.log_odds,
            }),
            drawing: diagnosis.drawing.as_ref().map(|found| self.drawing(found)),
            global_test: global_test(&diagnosis.base.global),
            discrepancy: discrepancies(&diagnosis.discrepancies),
            findings: diagnosis.findings.iter().map(|f| self.finding(f)).collect(),
            possible: diagnosis
                .possible
                .iter()
                .map(|one| self.possible(one))
                .collect(),
            model: ModelDocument {
                effects: effects.map(|bound| bound.setting(self.robot())).collect(),
            },
            alpha: self.alpha,
            seconds: self.seconds,
            complete: !diagnosis.cancelled,
            groups: self.groups(&diagnosis.base),
            extended: ExtendedDocument {
                adequate: diagnosis.extended.adequate,
                global_test: global_test(&diagnosis.extended.global),
                groups: self.groups(&diagnosis.extended),
            },
            remainder: Some(RemainderDocument {
                rms_over_sd: residual_ratio(&diagnosis.extended.global),
                readings: diagnosis
                    .remaining
                    .iter()
                    .map(|d| self.remaining(d))
                    .collect(),
            }),
            remaining_discrepancy: discrepancies(&diagnosis.remaining),
            tolerances: Some(diagnosis.tolerances),
            noise: diagnosis.noise.iter().map(|n| self.noise(n)).collect(),
            not_visible: diagnosis.invisible.iter().map(|i| self.hidden(i)).collect(),
        }
    }

    fn drawing(&self, found: &WrongDrawing) -> DrawingDocument {
        let on_axis = |k: usize| Some(["x", "y", "z"][k].to_owned());
        let (pattern, axis, target) = match found.pattern {
            DrawingPattern::Extent(k) => ("extent", on_axis(k), None),
            DrawingPattern::Turn(k) => ("turn", on_axis(k), None),
            DrawingPattern::Pulley(cable) => ("pulley", None, self.cable(Some(cable))),
        };
        DrawingDocument {
            pattern: pattern.to_owned(),
            axis,
            target,
            size: found.size,
            sd: finite(found.sd),
            stated_sd: found.stated_sd,
            displacements_m: found
                .displacements_m
                .iter()
                .map(|by| (*by).into())
                .collect(),
            log_odds: found.log_odds,
            worth_m: found.worth_m.and_then(finite),
        }
    }

    fn cause(&self, cause: &Cause) -> CauseDocument {
        CauseDocument {
            effect: cause.effect().id().to_owned(),
            targets: self.targets(cause),
        }
    }

    fn alternative(&self, alternative: &Alternative) -> AlternativeDocument {
        AlternativeDocument {
            subject: self.subject_document(&alternative.subject),
            probability: alternative.probability,
        }
    }

    fn possible(&self, possible: &PossibleCause) -> AlternativeDocument {
        AlternativeDocument {
            subject: self.known(&possible.cause),
            probability: possible.probability,
        }
    }

    fn known(&self, cause: &Cause) -> SubjectDocument {
        let CauseDocument { effect, targets } = self.cause(cause);
        SubjectDocument {
            effect,
            targets,
            error: None,
        }
    }

    fn subject_document(&self, subject: &Subject) -> SubjectDocument {
        match subject {
            Subject::Cause(cause) => self.known(cause),
            Subject::UnmodelledError(error) => SubjectDocument {
                effect: UNKNOWN.to_owned(),
                targets: self.cable(error.readings.cable).into_iter().collect(),
                error: Some(self.error_document(error)),
            },
            Subject::WrongDrawing(_) | Subject::Slack(_) => SubjectDocument {
                effect: match subject {
                    Subject::Slack(_) => SLACK.to_owned(),
                    _ => DRAWING.to_owned(),
                },
                targets: (subject.cables().into_iter())
                    .filter_map(|cable| self.cable(Some(cable)))
                    .collect(),
                error: None,
            },
        }
    }

    fn error_document(&self, error: &UnmodelledError) -> ErrorDocument {
        let on = |variable: Variable| Some(variable.name().to_owned());
        let (form, depends_on) = match error.form {
            ErrorForm::Smooth(variable) => (ErrorFormDocument::Smooth, on(variable)),
            ErrorForm::Wave(variable, _) => (ErrorFormDocument::Wave, on(variable)),
            ErrorForm::Crosstalk(_) => (ErrorFormDocument::Crosstalk, on(Variable::Tension)),
            ErrorForm::Position(_) => (ErrorFormDocument::Field, Some("position".to_owned())),
            ErrorForm::Orientation(_) => (ErrorFormDocument::Field, Some("orientation".to_owned())),
            ErrorForm::Scatter => (ErrorFormDocument::Scatter, None),
        };
        ErrorDocument {
            reading: error.readings.quantity.name().to_owned(),
            component: error.readings.component,
            form,
            depends_on,
            of_cable: match error.form {
                ErrorForm::Crosstalk(cable) => self.cable(Some(cable)),
                _ => None,
            },
            period: match error.form {
                ErrorForm::Wave(_, period) => finite(period),
                _ => None,
            },
            rms: error.rms.and_then(finite),
        }
    }

    fn groups(&self, adequacy: &Adequacy) -> Vec<GroupTestDocument> {
        let group = |group: &GroupTest| GroupTestDocument {
            reading: group.quantity.name().to_owned(),
            target: self.cable(group.cable),
            readings: group.readings,
            rms_over_sd: finite(group.rms_over_sd),
            p_value: finite(group.p_value),
        };
        adequacy.groups.iter().map(group).collect()
    }

    fn remaining(&self, left: &Discrepancy) -> RemainingReadingDocument {
        RemainingReadingDocument {
            reading: left.quantity.name().to_owned(),
            target: self.cable(left.cable),
            rms_over_sd: finite(left.rms_over_sd),
            depends_on: left.variable.name().to_owned(),
        }
    }

    fn discrepancy(&self, discrepancy: &Discrepancy) -> DiscrepancyDocument {
        let points = discrepancy.points.iter();
        let point = |(row, variable, residual): &(usize, f64, f64)| PointDocument {
            pose: self.label(*row),
            variable: finite(*variable),
            residual: finite(*residual),
        };
        DiscrepancyDocument {
            reading: discrepancy.quantity.name().to_owned(),
            target: self.cable(discrepancy.cable),
            rms_over_sd: finite(discrepancy.rms_over_sd),
            depends_on: discrepancy.variable.name().to_owned(),
            p_value: finite(discrepancy.p_value),
            points: points.map(point).collect(),
        }
    }

    fn noise(&self, noise: &NoiseStatement) -> NoiseDocument {
        NoiseDocument {
            reading: noise.quantity.name().to_owned(),
            target: self.cable(noise.cable),
            ratio: noise.ratio,
            interval: noise.interval,
            p_value: finite(noise.p_value),
        }
    }

    fn hidden(&self, invisible: &Invisible) -> InvisibleDocument {
        let (parameter, unit) = invisible.parameter;
        InvisibleDocument {
            cause: self.cause(&invisible.cause),
            parameter: parameter.to_owned(),
            unit: unit.to_owned(),
            smallest_visible: invisible.smallest_visible.and_then(finite),
        }
    }

    fn finding(&self, finding: &Finding) -> FindingDocument {
        let separation = finding.separation.as_ref();
        let poses = separation.iter().flat_map(|s| &s.poses);
        FindingDocument {
            verdict: finding.verdict(),
            subject: self.subject_document(&finding.subject),
            cause: self.text(finding),
            advice: finding.advice.clone(),
            probability: finding.probability,
            alternatives: finding
                .alternatives
                .iter()
                .map(|a| self.alternative(a))
                .collect(),
            parameters: finding
                .parameters
                .iter()
                .map(|p| self.parameter(p))
                .collect(),
            evidence: self.evidence(&finding.evidence),
            gain: gain(&finding.gain),
            separating_poses: poses.map(pose).collect(),
            separating_delta_chi2: separation.and_then(|s| finite(s.expected_delta_chi2)),
            separating_advice: separation.map(|s| s.advice.clone()),
        }
    }

    /// The sentence; for an ambiguous cause with its alternatives and the measurements that would separate them.
    fn text(&self, finding: &Finding) -> String {
        let separation = finding.separation.as_ref().map(|s| s.advice.clone());
        let others = self.otherwise(finding).map(|others| {
            let advice = separation.map_or_else(String::new, |advice| format!(" {advice}"));
            format!(" {others}{advice}")
        });
        format!("{}{}", finding.sentence, others.unwrap_or_default())
    }

    fn parameter(&self, parameter: &FoundParameter) -> ParameterDocument {
        ParameterDocument {
            name: parameter.name.to_owned(),
            target: self.cable(parameter.cable),
            value: parameter.value,
            unit: parameter.unit.to_owned(),
            sd: parameter.sd.and_then(finite),
        }
    }

    fn evidence(&self, evidence: &Evidence) -> EvidenceDocument {
        let rival = |rival: &Rival| RivalDocument {
            cause: self.cause(&rival.cause),
            delta_chi2: rival.delta_chi2,
            parameters: rival.parameters,
            holdout: finite(rival.holdout),
        };
        EvidenceDocument {
            delta_chi2: evidence.delta_chi2,
            parameters: evidence.parameters,
            p_value: finite(evidence.p_value),
            questions: evidence.questions,
            runner_up: evidence.ranking.get(1).map(|rival| RunnerUpDocument {
                cause: self.cause(&rival.cause),
                delta_chi2: rival.delta_chi2,
            }),
            ranking: evidence.ranking.iter().map(rival).collect(),
        }
    }
}

fn global_test(test: &GlobalTest) -> GlobalTestDocument {
    GlobalTestDocument {
        chi2: test.chi2,
        dof: test.degrees_of_freedom,
        p_value: finite(test.p_value),
    }
}

fn gain(gain: &Gain) -> GainDocument {
    let PositionChange {
        rms_m,
        interval_m,
        largest_m,
    } = gain.position;
    let kinds = gain.kinds.iter().map(|kind| ReadingGainDocument {
        reading: kind.quantity.name().to_owned(),
        holdout_before: finite(kind.before),
        holdout_after: finite(kind.after),
    });
    GainDocument {
        holdout_before: finite(gain.before),
        holdout_after: finite(gain.after),
        unit: HOLDOUT_UNIT.to_owned(),
        poses_held_out: gain.poses_held_out,
        interval: finite_pair(gain.interval),
        per_reading: kinds.collect(),
        position_change_m: PositionChangeDocument {
            rms: finite(rms_m),
            interval: finite_pair(interval_m),
            largest: finite(largest_m),
        },
    }
}

fn pose(pose: &Pose) -> PoseDocument {
    PoseDocument {
        position_m: pose.position.into(),
        orientation_wxyz: pose.orientation_wxyz(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};
    use tautline_core::diagnosis::Verdict;
    use tautline_session::versioned;

    use super::super::samples::{dataset, diagnosed};
    use super::*;

    fn machine_form(verdicts: &[Verdict]) -> Value {
        let dataset = dataset();
        let diagnosed = diagnosed(&dataset, verdicts);
        serde_json::to_value(versioned(&diagnosed.document())).expect("JSON")
    }

    #[test]
    fn a_clean_diagnosis_has_no_findings() {
        let value = machine_form(&[]);
        assert_eq!(value["format"], "tautline-diagnosis");
        assert_eq!(value["version"], 1);
        assert_eq!(value["adequate"], true);
        assert_eq!(value["findings"], json!([]));
        assert_eq!(value["model"], json!({"effects": []}));
    }

    #[test]
    fn the_remainder_is_as_the_contract_says() {
        let value = machine_form(&[Verdict::Named]);
        let left = &value["remainder"];
        assert_eq!(left["rms_over_sd"], 1.0);
        let readings = json!([{"reading": "length", "target": "cable-3", "rms_over_sd": 2.1, "depends_on": "cable length"}]);
        assert_eq!(left["readings"], readings);
    }

    #[test]
    fn a_finding_is_as_the_contract_says() {
        let value = machine_form(&[Verdict::Named]);
        let finding = &value["findings"][0];
        assert_eq!(finding["verdict"], "named");
        assert_eq!(finding["effect"], "winch_scale");
        assert_eq!(finding["targets"], json!(["cable-3"]));
        assert_eq!(finding["cause"], "Winch 3 pays out too much.");
        assert_eq!(finding["alternatives"], json!([]));
        assert_eq!(
            finding["parameters"],
            json!([{"name": "scale", "value": 0.0031, "unit": "1", "sd": 0.0004}])
        );
        assert_eq!(
            finding["evidence"]["runner_up"],
            json!({"effect": "pulley_radius", "targets": ["cable-3"], "delta_chi2": 20.0})
        );
        assert_eq!(finding["gain"]["unit"], "rms over sd");
        assert_eq!(value["model"]["effects"][0]["effect"], "winch_scale");
    }

    #[test]
    fn what_is_not_known_is_null() {
        let value = machine_form(&[Verdict::Ambiguous]);
        let found = &value["discrepancy"][0];
        assert_eq!(found["reading"], "length");
        assert_eq!(found["target"], "cable-3");
        assert_eq!(found["depends_on"], "cable length");
        assert_eq!(found["points"][0]["pose"], 1);
        assert_eq!(found["points"][1]["variable"], Value::Null);
        assert_eq!(value["noise"][0]["target"], Value::Null);
        let finding = &value["findings"][0];
        assert_eq!(
            finding["alternatives"],
            json!([{"effect": "winch_offset", "targets": ["cable-3"], "probability": 0.4}])
        );
        let pose =
            json!({"position_m": [0.25, -0.1, 0.0], "orientation_wxyz": [1.0, 0.0, 0.0, 0.0]});
        assert_eq!(finding["separating_poses"], json!([pose]));
    }

    #[test]
    fn what_is_written_can_be_read() {
        let dataset = dataset();
        let written = diagnosed(&dataset, &[Verdict::Named, Verdict::Unknown]).document();
        let text = serde_json::to_string(&versioned(&written)).expect("JSON");
        let read = tautline_session::parse_versioned::<DiagnosisDocument>(text.as_bytes(), "d");
        let read = read.expect("a document");
        assert_eq!(read.value, written);
        assert!(read.notices.is_empty(), "{:?}", read.notices);
    }
}
