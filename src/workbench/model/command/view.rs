//! Commands that change only what the window shows.

use egui::ThemePreference;
use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;
use tautline_session::Plots;

use crate::model::Selection;
use crate::model::manual::Page;
use crate::model::part::ScreenPart;
use crate::model::phase::Screen;

/// Changes the view; no data.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    Go(Screen),
    Select(Selection),
    /// Shows residuals of a quantity and cable along a variable, in the plots, the 3D colours and the selection.
    ShowDependence(Quantity, Option<usize>, Variable),
    /// Inspects the pulley of a cable, by its index; `None` returns to the whole robot.
    Inspect(Option<usize>),
    /// Steps to another measured pose.
    Pose(PoseStep),
    /// Selects a measured pose, even while the robot moves.
    Scrub(i64),
    /// Starts or stops the playback of the measured poses.
    Play(bool),
    /// Switches between the live pose and the selected pose while the robot moves.
    Follow(bool),
    /// Dark, light or system theme.
    Theme(ThemePreference),
    /// Maximises one part of the screen; `None` shows all parts.
    Maximise(Option<ScreenPart>),
    /// Zoom factor of the window.
    Scale(f32),
    Palette(bool),
    Log(bool),
    /// Opens the manual at a page, or closes it.
    Manual(Option<Page>),
    /// Shows or hides the *About* window.
    About(bool),
    /// Dismisses the last error.
    Dismiss,
    /// Stores which plots are shown and how they are arranged.
    SetPlots(Plots),
}

/// Step from the selected pose to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseStep {
    First,
    Previous,
    Next,
    Last,
    To(i64),
}

impl PoseStep {
    /// Label of the pose after a step from the selected one.
    #[must_use]
    pub fn from(self, labels: &[i64], selected: Option<i64>) -> Option<i64> {
        let last = labels.len().checked_sub(1)?;
        let now = selected.and_then(|pose| labels.iter().position(|label| *label == pose));
        let wanted = match (self, now) {
            (Self::To(wanted), _) => labels.iter().position(|label| *label == wanted)?,
            (Self::First, _) | (Self::Next, None) => 0,
            (Self::Last, _) | (Self::Previous, None) => last,
            (Self::Next, Some(now)) => (now + 1).min(last),
            (Self::Previous, Some(now)) => now.saturating_sub(1),
        };
        labels.get(wanted).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stay_on_the_line() {
        let labels = [0, 5, 3];
        for (selected, step, expected) in [
            (None, PoseStep::Next, 0),
            (None, PoseStep::Previous, 3),
            (Some(5), PoseStep::Next, 3),
            (Some(3), PoseStep::Next, 3),
            (Some(0), PoseStep::Previous, 0),
            (Some(5), PoseStep::First, 0),
            (Some(5), PoseStep::Last, 3),
            (Some(99), PoseStep::Next, 0),
            (Some(0), PoseStep::To(3), 3),
        ] {
            assert_eq!(step.from(&labels, selected), Some(expected));
        }
        assert_eq!(PoseStep::Next.from(&[], None), None);
    }
}
