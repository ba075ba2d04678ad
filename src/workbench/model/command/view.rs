//! What the window shows.

use egui::ThemePreference;
use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;
use tautline_session::Plots;

use crate::model::Selection;
use crate::model::manual::Page;
use crate::model::part::Part;
use crate::model::phase::Screen;

/// Changes what is shown, nothing else.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    Go(Screen),
    Select(Selection),
    /// Shows residuals of a kind of reading along a variable: plot, colours in 3D and selection go there.
    ShowDependence(Quantity, Option<usize>, Variable),
    /// Inspects the pulley of a cable, by its index, or goes back to the whole robot.
    Inspect(Option<usize>),
    /// Selects another of the measured poses.
    Pose(PoseStep),
    /// Selects a measured pose, and shows it even while the robot is elsewhere.
    Scrub(i64),
    /// Plays the measured poses one after the other, or stops.
    Play(bool),
    /// Switches between the present and the selected pose while the robot moves.
    Follow(bool),
    /// Dark, light or as the system has it.
    Theme(ThemePreference),
    /// Gives the window to one part of the screen, or to all again.
    Maximise(Option<Part>),
    /// Size of everything; 1 is 100 %.
    Scale(f32),
    Palette(bool),
    Log(bool),
    /// Opens the manual at a page, or closes it.
    Manual(Option<Page>),
    /// Shows or hides what the program is made of.
    About(bool),
    /// The last error was seen.
    Dismiss,
    /// Keeps which plots are shown, and how they are arranged.
    SetPlots(Plots),
}

/// From the selected pose to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseStep {
    First,
    Previous,
    Next,
    Last,
    To(i64),
}

impl PoseStep {
    /// The pose that a step from the selected one leads to.
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
