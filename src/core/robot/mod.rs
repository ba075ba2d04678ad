//! The nominal description of a robot, from drawings and the first two calibration phases.

mod check;
mod description;
mod limits;
mod part_tolerances;
pub mod presets;

pub use check::FieldError;
pub use description::{
    Cable, CableMaterial, DistanceCurve, ForceSensor, FrameTransform, Home, HomePlatform,
    HomeSensor, Inclinometer, Laser, PerAxis, Plane, Platform, Pulley, Robot, TargetPlane, Tracker,
    Winch, WrenchSd,
};
pub use limits::{Limits, TensionLimits, WorkspaceLimits};
pub use part_tolerances::{PartTolerances, StatedTolerances, Tolerance, Typical};
