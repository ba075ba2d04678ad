//! Parts of a screen. A small window shows one at a time, a large one all of them unless one is maximised.

/// Part of a phase's screen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ScreenPart {
    /// Instructions, inputs and tables.
    #[default]
    Panel,
    /// The robot in 3D.
    Robot,
    Plots,
}

impl ScreenPart {
    pub const ALL: [Self; 3] = [Self::Panel, Self::Robot, Self::Plots];

    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Panel => "Panel",
            Self::Robot => "3D view",
            Self::Plots => "Plots",
        }
    }
}
