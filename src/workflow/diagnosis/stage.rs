//! The stages of a running diagnosis, in words.

use tautline_core::diagnosis::Stage;

/// A stage in words.
#[must_use]
pub fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::BaseFit => "fitting the model as it is",
        Stage::Discrepancy => "testing the residuals",
        Stage::Scores => "testing every possible cause",
        Stage::Refits => "fitting the likeliest causes",
        Stage::HeldOut => "testing on held-out poses",
        Stage::Separation => "searching for poses that separate the causes",
    }
}
