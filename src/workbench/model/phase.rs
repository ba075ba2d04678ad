//! Screens and phases.

use egui_material_icons::{MaterialIcon, icons};

/// Screen of the window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Screen {
    /// No session is open.
    #[default]
    Start,
    Phase(Phase),
    Compare,
    /// Comparison of the user's simulator with the machine.
    Simulator,
    /// Sessions of one robot over time.
    Record,
    /// Import of files of other programs.
    Import,
    /// Choice of sensors and number of poses.
    WhichSensor,
    /// Editor of a hypothesis.
    Hypothesis,
    /// Effects with their signatures in the residuals.
    Gallery,
    /// New robot from an empty table of cables.
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
    /// All phases, in order.
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
    /// No data.
    NotStarted,
    InProgress,
    /// Complete and good.
    Done,
    /// Complete, but with a problem or a doubt.
    Attention,
    /// Complete, but its inputs have changed since.
    OutOfDate,
}

impl Progress {
    /// Name, also for screen readers.
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

    /// Icon, in addition to the colour.
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
    /// Result in one line, such as "8 of 8 winches within 0.1 mm".
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
