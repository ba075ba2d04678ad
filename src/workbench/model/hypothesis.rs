//! The hypothesis being written, its preview, and the gallery of all effects.

use std::path::PathBuf;
use std::sync::Arc;

use tautline_core::effect::{Hypothesis, HypothesisError, MAX_HYPOTHESIS_BYTES};
use tautline_core::geometry::Pose;
use tautline_core::robot::{Robot, presets};
use tautline_workflow::signature::Gallery;

use super::Model;
use super::command::PreviewResult;

/// Initial text of a new hypothesis: a complete example, to be edited.
pub const TEMPLATE: &str = r#"# What you suspect, as a formula. This one works: change it.
id = "my_hypothesis"
title = "Encoder picks up its neighbour"
scope = "cable"            # cable, cable_or_all, cable_pair, robot, tension, laser
cause = "The encoder of {cable} picks up {share} of the revolutions of its neighbour."
workshop = "Separate the encoder cables and ground their shields."

[parameters.share]
unit = "1"
typical = [0.001, 0.01]    # smallest and largest size to expect

[change]                   # the quantity that changes, and its new value
paid = "paid + share * paid_of(next)"
"#;

/// Text of a hypothesis while it is edited.
#[derive(Debug)]
pub struct HypothesisDraft {
    text: String,
    /// Last text that was saved to a session or file, or the initial text.
    kept: String,
    checked: Result<Hypothesis, HypothesisError>,
    /// File of the hypothesis, if any.
    pub file: Option<PathBuf>,
    /// Effect of the hypothesis on the residuals.
    pub preview: Option<Preview>,
    /// Index of the target that is shown.
    pub placement: usize,
    /// Number that distinguishes it from other drafts.
    pub number: u64,
}

/// Effect of a hypothesis on the residuals of some inputs.
#[derive(Debug)]
pub struct Preview {
    text: String,
    inputs: Option<u64>,
    pub result: Result<PreviewResult, String>,
}

/// Action that waits for the answer about an unsaved text.
#[derive(Debug, Clone)]
pub enum AfterHypothesis {
    /// Begins with another text.
    Begin {
        text: String,
        file: Option<PathBuf>,
    },
    Quit,
}

/// State of the hypotheses.
#[derive(Debug, Default)]
pub struct HypothesisState {
    pub draft: Option<HypothesisDraft>,
    /// Action that waits for the answer about the unsaved text.
    pub(crate) asking: Option<AfterHypothesis>,
    /// Gallery, or an error message, with the robot it was computed for.
    pub gallery: Option<(Robot, Result<Arc<Gallery>, String>)>,
    drafts: u64,
}

impl HypothesisDraft {
    fn new(text: String, file: Option<PathBuf>, number: u64) -> Self {
        Self {
            kept: text.clone(),
            checked: check(&text),
            text,
            file,
            preview: None,
            placement: 0,
            number,
        }
    }

    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Hypothesis of the text, or its first error.
    pub fn checked(&self) -> Result<&Hypothesis, &HypothesisError> {
        self.checked.as_ref()
    }

    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.text != self.kept
    }

    /// Marks a text as saved to a file or session.
    pub(crate) fn keep(&mut self, text: &str) {
        text.clone_into(&mut self.kept);
    }

    pub(crate) fn set_text(&mut self, text: String) {
        if text != self.text {
            self.checked = check(&text);
            self.text = text;
        }
    }

    /// Whether the preview for these inputs has still to be computed.
    #[must_use]
    pub fn lacks_preview(&self, inputs: Option<u64>) -> bool {
        let is_of = |preview: &Preview| preview.text == self.text && preview.inputs == inputs;
        self.checked.is_ok() && !self.preview.as_ref().is_some_and(is_of)
    }

    /// Stores a preview if it belongs to the present text.
    pub(crate) fn take_preview(
        &mut self,
        text: String,
        inputs: Option<u64>,
        result: Result<PreviewResult, String>,
    ) {
        if text == self.text {
            self.placement = 0;
            self.preview = Some(Preview {
                text,
                inputs,
                result,
            });
        }
    }
}

fn check(text: &str) -> Result<Hypothesis, HypothesisError> {
    if text.len() > MAX_HYPOTHESIS_BYTES {
        return Err(HypothesisError {
            line: 1,
            column: 1,
            message: format!("found more than {MAX_HYPOTHESIS_BYTES} bytes, too large"),
        });
    }
    Hypothesis::parse(text)
}

impl HypothesisState {
    /// Whether the text of the draft is unsaved.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        let draft = self.draft.as_ref();
        draft.is_some_and(HypothesisDraft::is_unsaved)
    }

    /// Begins a new draft, dropping the one before.
    pub(crate) fn begin(&mut self, text: String, file: Option<PathBuf>) {
        self.drafts += 1;
        self.draft = Some(HypothesisDraft::new(text, file, self.drafts));
    }
}

impl Model {
    /// Robot of the session with its identified poses; without a session, an example robot.
    #[must_use]
    pub fn robot_of_effects(&self) -> Option<(Robot, Vec<Pose>)> {
        let Some(open) = &self.open else {
            return presets::find("mini").map(|mini| (mini.robot, Vec::new()));
        };
        let robot = open.session().robot.clone();
        let home = robot.home.map(|_| 0);
        let fit = open.fit().map(|fit| fit.solution.poses.iter());
        let away = fit
            .into_iter()
            .flatten()
            .filter(|(row, _)| Some(*row) != home);
        Some((robot, away.map(|(_, pose)| *pose).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_works_and_a_changed_text_is_unsaved_until_it_is_kept() {
        let mut state = HypothesisState::default();
        state.begin(TEMPLATE.to_owned(), None);
        let draft = state.draft.as_mut().expect("a draft");
        assert_eq!(draft.checked().expect("a hypothesis").id(), "my_hypothesis");
        assert!(!draft.is_unsaved());
        draft.set_text(TEMPLATE.replace("next", "nxt"));
        let error = draft.checked().expect_err("a mistake").to_string();
        assert!(error.starts_with("line 13, column "), "{error}");
        assert!(draft.is_unsaved() && !draft.lacks_preview(None));
        let text = draft.text().to_owned();
        draft.keep(&text);
        assert!(!draft.is_unsaved());
        draft.set_text("#".repeat(MAX_HYPOTHESIS_BYTES + 1));
        assert!(
            draft
                .checked()
                .expect_err("endless")
                .message
                .contains("too large")
        );
    }
}
