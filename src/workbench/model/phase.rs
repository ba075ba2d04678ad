//! The places one can be in.

use egui_material_icons::{MaterialIcon, icons};

/// What the window shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Screen {
    /// Nothing is open yet.
    #[default]
    Start,
    Phase(Phase),
    Compare,
    /// The user's simulator beside the machine.
    Simulator,
    /// The sessions of one robot over time.
    Record,
    /// Files of other programs on their way into the session.
    Import,
    /// Which sensor, how many poses.
    WhichSensor,
    /// The hypothesis that is being written.
    Hypothesis,
    /// What each effect leaves in the residuals.
    Gallery,
    /// A new robot from an empty table of its cables.
    NewRobot,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Phase 1: winches, force sensors, home platform.
    Precalibration,
    /// Phase 2: elongation, pulleys.
    Modeling,
    /// Phase 3: measured poses.
    Measuring,
    /// Phase 4: identification and the model doctor.
    Identification,
    /// Phase 5: writing to the controller, verification.
    Adjustment,
}

impl Phase {
    /// All, in their order.
    pub const ALL: [Self; 5] = [
        Self::Precalibration,
        Self::Modeling,
        Self::Measuring,
        Self::Identification,
        Self::Adjustment,
    ];

    #[must_use]
    pub fn number(self) -> usize {
        self as usize + 1
    }

    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Precalibration => "Pre-calibration",
            Self::Modeling => "Modeling",
            Self::Measuring => "Measuring",
            Self::Identification => "Identification",
            Self::Adjustment => "Adjustment",
        }
    }

    #[must_use]
    pub fn next(self) -> Option<Self> {
        Self::ALL.get(self.number()).copied()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Nothing is there.
    NotStarted,
    /// Begun.
    InProgress,
    /// Finished, and good.
    Done,
    /// Finished, but something is wrong or doubtful.
    Attention,
    /// Finished, but something it depends on has changed since.
    OutOfDate,
}

impl Progress {
    /// In words, for the reader of the screen.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::NotStarted => "not started",
            Self::InProgress => "in progress",
            Self::Done => "done",
            Self::Attention => "needs attention",
            Self::OutOfDate => "out of date",
        }
    }

    /// A sign besides the colour.
    #[must_use]
    pub fn icon(self) -> MaterialIcon {
        match self {
            Self::NotStarted => icons::ICON_RADIO_BUTTON_UNCHECKED,
            Self::InProgress => icons::ICON_PENDING,
            Self::Done => icons::ICON_CHECK_CIRCLE,
            Self::Attention => icons::ICON_ERROR,
            Self::OutOfDate => icons::ICON_UPDATE,
        }
    }
}

/// State of a phase with one line of result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhaseStatus {
    pub progress: Progress,
    /// One line, such as "8 of 8 winches within 0.1 mm".
    pub line: String,
}

impl PhaseStatus {
    #[must_use]
    pub fn new(progress: Progress, line: impl Into<String>) -> Self {
        Self {
            progress,
            line: line.into(),
        }
    }
}
