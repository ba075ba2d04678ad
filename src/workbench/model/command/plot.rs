//! Preparing and saving plots.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ColorImage;
use tautline_workflow::plot::Figure;

use crate::model::Selection;

#[derive(Debug, Clone)]
pub enum PlotCommand {
    /// Computes variables, and the residuals before and after what a diagnosis found.
    Prepare,
    /// Asks where to save a plot; a name of the file is suggested.
    AskSave(String, PlotFile),
    /// Saves a plot at a place.
    Save(PathBuf, PlotFile),
}

#[derive(Debug, Clone)]
pub enum PlotFile {
    /// A table or a drawing.
    Text(String),
    /// A picture, which is drawn when it is saved.
    Picture(PlotPicture),
    /// Part of the window as it was drawn.
    Screenshot(Arc<ColorImage>),
}

/// A plot that becomes a picture, with the function that draws it.
#[derive(Debug, Clone)]
pub struct PlotPicture {
    /// What is plotted.
    pub figure: Arc<Figure>,
    /// Which values are shown.
    pub view: [[f64; 2]; 2],
    /// What is highlighted.
    pub selection: Selection,
    /// Width over height.
    pub aspect: f32,
    /// Gives the PNG, or one sentence on why there is none.
    pub render: fn(&Self) -> Result<Vec<u8>, String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Csv,
    Svg,
    /// A picture of the size of a page.
    Png,
}

impl Format {
    pub const ALL: [Self; 3] = [Self::Csv, Self::Svg, Self::Png];

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
