//! Quantities against which residuals are plotted and modelled.

/// A variable on which a residual may depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Variable {
    /// Length of the cable (m).
    CableLength,
    /// Motor revolutions since home.
    Revolutions,
    /// Fraction of a drum revolution.
    DrumFraction,
    /// Tension of the cable (N).
    Tension,
    /// Wrap angle on the pulley (rad).
    WrapAngle,
    /// Swivel angle of the pulley (rad).
    SwivelAngle,
    /// Direction of travel, +1 paid out, -1 reeled in.
    Direction,
    /// Time since the first row (s).
    Time,
    /// Change of temperature (K).
    Temperature,
    /// Laser distance (m).
    Distance,
    /// Coordinate of the position, 0, 1, 2 (m).
    Position(usize),
    /// Coordinate of the orientation, rotation vector from home, 0, 1, 2 (rad).
    Rotation(usize),
}

impl Variable {
    /// Number of variables.
    pub const COUNT: usize = 16;

    /// All variables.
    pub const ALL: [Self; Self::COUNT] = [
        Self::CableLength,
        Self::Revolutions,
        Self::DrumFraction,
        Self::Tension,
        Self::WrapAngle,
        Self::SwivelAngle,
        Self::Direction,
        Self::Time,
        Self::Temperature,
        Self::Distance,
        Self::Position(0),
        Self::Position(1),
        Self::Position(2),
        Self::Rotation(0),
        Self::Rotation(1),
        Self::Rotation(2),
    ];

    /// Index into [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        Self::ALL
            .iter()
            .position(|v| *v == self)
            .unwrap_or_default()
    }

    /// Name for reports and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::CableLength => "cable length",
            Self::Revolutions => "revolutions",
            Self::DrumFraction => "fraction of a drum revolution",
            Self::Tension => "tension",
            Self::WrapAngle => "wrap angle",
            Self::SwivelAngle => "swivel angle",
            Self::Direction => "direction of travel",
            Self::Time => "time",
            Self::Temperature => "temperature",
            Self::Distance => "laser distance",
            Self::Position(0) => "position x",
            Self::Position(1) => "position y",
            Self::Position(_) => "position z",
            Self::Rotation(0) => "rotation about x",
            Self::Rotation(1) => "rotation about y",
            Self::Rotation(_) => "rotation about z",
        }
    }
}
