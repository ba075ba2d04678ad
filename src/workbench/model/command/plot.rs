//! Preparing and saving plots.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ColorImage;
use tautline_workflow::plot::Figure;

use crate::model::Selection;

#[derive(Debug, Clone)]
pub enum PlotCommand {
    /// Computes the variables, and the residuals before and after the findings of a diagnosis.
    Prepare,
    /// Asks for a path to save a plot to; the text is the suggested file name.
    AskSave(String, PlotFile),
    /// Saves a plot to a path.
    Save(PathBuf, PlotFile),
}

#[derive(Debug, Clone)]
pub enum PlotFile {
    /// Table or vector drawing.
    Text(String),
    /// Picture, rendered when it is saved.
    Picture(PlotPicture),
    /// Part of the window.
    Screenshot(Arc<ColorImage>),
}

/// Plot with the function that renders it as a picture.
#[derive(Debug, Clone)]
pub struct PlotPicture {
    pub figure: Arc<Figure>,
    /// Visible range: least and greatest value of each axis.
    pub view: [[f64; 2]; 2],
    /// Highlighted items.
    pub selection: Selection,
    /// Width over height.
    pub aspect: f32,
    /// Renders the PNG; or an error message.
    pub render: fn(&Self) -> Result<Vec<u8>, String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Csv,
    Svg,
    /// Picture with the size of a page.
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

    /// File extension.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}
