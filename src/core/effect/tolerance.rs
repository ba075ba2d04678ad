//! Typical tolerances: deviations of the parts of a sound machine from its drawing.

use crate::robot::Robot;

/// Diagonal of the frame (m) from which a machine is built like a crane rather than like a machine tool.
const LARGE_FRAME_M: f64 = 4.0;

/// Class of construction of a machine, on which the accuracy of its parts depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineClass {
    /// A machined frame that fits into a room.
    Small,
    /// A welded or bolted structure of many metres.
    Large,
}

impl MachineClass {
    /// The class of a robot by the size of its frame.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        match robot.frame_diagonal_m() {
            LARGE_FRAME_M.. => Self::Large,
            _ => Self::Small,
        }
    }
}

/// Standard deviation of a parameter over sound parts. Where a standard or data sheet states limits, they are taken as
/// two standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypicalTolerance {
    /// Standard deviation on a smaller machine, in the unit of the parameter.
    pub small: f64,
    /// Standard deviation on a machine whose frame is larger than 4 m.
    pub large: f64,
    /// Source of the value.
    pub source: &'static str,
    /// Whether sound parts deviate to the positive side only, as play without a reversal of tension.
    pub is_one_sided: bool,
}

impl TypicalTolerance {
    /// Standard deviation for a class of machine.
    #[must_use]
    pub fn sd(&self, class: MachineClass) -> f64 {
        match class {
            MachineClass::Small => self.small,
            MachineClass::Large => self.large,
        }
    }
}
