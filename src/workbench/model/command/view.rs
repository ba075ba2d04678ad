//! What the window shows.

use egui::ThemePreference;

use crate::model::Selection;
use crate::model::phase::Screen;

/// Changes what is shown, nothing else.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    /// Goes to a screen.
    Go(Screen),
    /// Selects everywhere.
    Select(Selection),
    /// Selects another of the measured poses.
    Pose(PoseStep),
    /// Selects a measured pose, and shows it even while the robot is elsewhere.
    Scrub(i64),
    /// Plays the measured poses one after the other, or stops.
    Play(bool),
    /// Draws the robot where it is while something goes on, or at the selected pose.
    Follow(bool),
    /// Dark, light or as the system has it.
    Theme(ThemePreference),
    /// Size of everything; 1 is 100 %.
    Scale(f32),
    /// Shows or hides the command palette.
    Palette(bool),
    /// Shows or hides the log.
    Log(bool),
}

/// From the selected pose to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseStep {
    /// The first that was measured.
    First,
    /// The one before.
    Previous,
    /// The one after.
    Next,
    /// The last that was measured.
    Last,
}
