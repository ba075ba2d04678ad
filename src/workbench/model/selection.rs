//! What is selected, once for the 3D view, plots and tables.

/// A cable, a pose, or both: a residual is a cable at a pose.
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

    /// Whether nothing is selected.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
