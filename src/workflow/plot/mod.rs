//! Plots: a [`Figure`] is data. The window shows it with `egui_plot`, which needs a window; [`draw::draw`] paints it on any
//! [`Canvas`] for exported files and reports.
//!
//! [`Layout`] places axes, ticks and legend; [`draw::Points`] chooses the points worth painting in a view. `emath` and
//! `ecolor` are the geometry and the colours of egui without its widgets, so that the window needs no conversion.

pub mod canvas;
pub mod colours;
pub mod contour;
pub mod draw;
pub mod drawing;
pub mod figure;
pub mod gaps;
pub mod heat;
pub mod histogram;
pub mod outline;
pub mod round;
pub mod scale;
pub mod table;
pub mod thin;

pub use canvas::{Canvas, Stroke};
pub use colours::Colours;
pub use draw::Layout;
pub use drawing::Drawing;
pub use figure::Figure;
pub use heat::limits;
pub use scale::Scale;

/// The highlighted cable, pose, or both, as a residual belongs to a cable at a pose.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Selection {
    /// Index of the cable.
    pub cable: Option<usize>,
    /// Label of the pose.
    pub pose: Option<i64>,
}

impl Selection {
    /// A cable alone.
    #[must_use]
    pub fn cable(index: usize) -> Self {
        Self {
            cable: Some(index),
            pose: None,
        }
    }

    /// A pose alone.
    #[must_use]
    pub fn pose(label: i64) -> Self {
        Self {
            cable: None,
            pose: Some(label),
        }
    }

    /// The selection with another cable.
    #[must_use]
    pub fn with_cable(self, index: usize) -> Self {
        Self {
            cable: Some(index),
            ..self
        }
    }

    /// The selection with another pose.
    #[must_use]
    pub fn with_pose(self, label: i64) -> Self {
        Self {
            pose: Some(label),
            ..self
        }
    }

    /// Whether nothing is selected.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
