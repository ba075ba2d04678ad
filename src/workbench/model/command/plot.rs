//! Preparing and saving plots.

use std::path::PathBuf;

use egui::Rect;

/// Prepares and saves plots.
#[derive(Debug, Clone)]
pub enum PlotCommand {
    /// Computes variables, and the residuals before and after what a diagnosis found.
    Prepare,
    /// Asks for a place to save a plot at.
    Ask(Format),
    /// Puts the place that was picked into the form of the plot that is being saved.
    SetPath(PathBuf),
    /// Saves a text at a place.
    SaveText(PathBuf, String),
    /// Saves a part of the window as a picture.
    SavePicture(PathBuf, Rect),
}

/// Format of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A table.
    Csv,
    /// A drawing.
    Svg,
    /// A picture of the window.
    Png,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Svg, Self::Png];

    /// What the operator reads.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Csv => "Table (CSV)",
            Self::Svg => "Drawing (SVG)",
            Self::Png => "Picture (PNG)",
        }
    }

    /// Ending of its files.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}
