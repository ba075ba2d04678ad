//! The quantities that formulas may use, and those that they may change.

use super::super::{CableContext, CablePort, PlatformContext, PlatformPort};

/// Source of the value of a quantity.
#[derive(Clone, Copy)]
pub(super) enum Source {
    /// A value for each cable.
    Cable(fn(&CableContext) -> f64),
    /// One value for all cables at a pose.
    Pose(fn(&PlatformContext) -> f64),
}

/// A quantity that formulas may use: as read, before any effect, or from the nominal geometry at an approximate pose.
#[derive(Clone, Copy)]
pub struct FormulaQuantity {
    /// Name in formulas.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Definition of the quantity.
    pub meaning: &'static str,
    pub(super) source: Source,
    /// Whether the quantity differs from zero only on a moving platform.
    pub(super) is_of_motion: bool,
}

/// A quantity of the prediction that formulas may change.
#[derive(Debug, Clone, Copy)]
pub struct FormulaTarget {
    /// Name in files.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Definition of the quantity.
    pub meaning: &'static str,
    pub(super) port: Port,
}

/// A port of a cable or of the platform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Port {
    Cable(CablePort),
    Platform(PlatformPort),
}

const fn of_cable(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&CableContext) -> f64,
) -> FormulaQuantity {
    FormulaQuantity {
        name,
        unit,
        meaning,
        source: Source::Cable(value),
        is_of_motion: false,
    }
}

const fn of_pose(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&PlatformContext) -> f64,
) -> FormulaQuantity {
    FormulaQuantity {
        name,
        unit,
        meaning,
        source: Source::Pose(value),
        is_of_motion: false,
    }
}

const fn in_motion(quantity: FormulaQuantity) -> FormulaQuantity {
    FormulaQuantity {
        is_of_motion: true,
        ..quantity
    }
}

/// All quantities that formulas may use; those of a cable also of another one, as `paid_of(next)`.
pub const FORMULA_QUANTITIES: &[FormulaQuantity] = &[
    of_cable(
        "paid",
        "m",
        "cable paid out since home, or its length where lengths are read",
        |at| at.paid_m,
    ),
    of_cable(
        "tension",
        "N",
        "tension; the mean where it was not read",
        |at| at.tension_n,
    ),
    of_cable("mean_tension", "N", "mean tension over all poses", |at| {
        at.mean_tension_n
    }),
    of_cable(
        "sensor_gain",
        "1",
        "reading of the force sensor per tension; 0 where it is not read",
        |at| at.tension_gain,
    ),
    of_cable("revolutions", "rev", "motor revolutions since home", |at| {
        at.revolutions
    }),
    of_cable(
        "drum_revolutions",
        "rev",
        "drum revolutions since home",
        |at| at.revolutions * at.drum_per_motor,
    ),
    of_cable(
        "direction",
        "1",
        "1 where the cable was paid out on the way to the pose, -1 where it was reeled in",
        |at| at.direction,
    ),
    of_cable("length", "m", "length from pulley to platform", |at| {
        at.length_m
    }),
    of_cable("wrap", "rad", "wrap angle on the pulley", |at| at.wrap_rad),
    of_cable(
        "swivel",
        "rad",
        "swivel angle of the pulley; 0 without a stated zero direction",
        |at| at.swivel_rad,
    ),
    of_cable("pulley_radius", "m", "stated radius of the pulley", |at| {
        at.radius_m
    }),
    of_cable("entry_x", "m", "nominal entry point, base frame", |at| {
        at.entry_point_m[0]
    }),
    of_cable("entry_y", "m", "nominal entry point, base frame", |at| {
        at.entry_point_m[1]
    }),
    of_cable("entry_z", "m", "nominal entry point, base frame", |at| {
        at.entry_point_m[2]
    }),
    of_cable(
        "pull_x",
        "1",
        "horizontal part of the unit vector from the pulley to the platform",
        |at| at.pull_horizontal[0],
    ),
    of_cable(
        "pull_y",
        "1",
        "horizontal part of the unit vector from the pulley to the platform",
        |at| at.pull_horizontal[1],
    ),
    of_cable(
        "pull_z",
        "1",
        "horizontal part of the unit vector from the pulley to the platform",
        |at| at.pull_horizontal[2],
    ),
    in_motion(of_cable(
        "paid_rate",
        "m/s",
        "speed at which the cable is paid out",
        |at| at.paid_rates[0],
    )),
    in_motion(of_cable(
        "paid_acceleration",
        "m/s^2",
        "acceleration of the cable paid out",
        |at| at.paid_rates[1],
    )),
    in_motion(of_cable(
        "tension_rate",
        "N/s",
        "time derivative of the tension",
        |at| at.tension_rates[0],
    )),
    of_pose(
        "time",
        "s",
        "time since home, or since the first pose",
        |at| at.time_s,
    ),
    of_pose(
        "temperature",
        "K",
        "change of temperature since home, or since the first pose",
        |at| at.temperature_change_k,
    ),
    of_pose("at_home", "1", "1 at the home pose, else 0", |at| {
        f64::from(u8::from(at.is_home))
    }),
    of_pose("position_x", "m", "position of the platform", |at| {
        at.position_m[0]
    }),
    of_pose("position_y", "m", "position of the platform", |at| {
        at.position_m[1]
    }),
    of_pose("position_z", "m", "position of the platform", |at| {
        at.position_m[2]
    }),
    of_pose(
        "rotation_x",
        "rad",
        "rotation vector of the platform, base frame",
        |at| at.rotation_rad[0],
    ),
    of_pose(
        "rotation_y",
        "rad",
        "rotation vector of the platform, base frame",
        |at| at.rotation_rad[1],
    ),
    of_pose(
        "rotation_z",
        "rad",
        "rotation vector of the platform, base frame",
        |at| at.rotation_rad[2],
    ),
    of_pose("laser", "m", "laser reading; 0 without one", |at| {
        at.laser_m
    }),
    of_pose("roll", "rad", "roll reading of the inclinometer", |at| {
        at.inclination_rad[0]
    }),
    of_pose("pitch", "rad", "pitch reading of the inclinometer", |at| {
        at.inclination_rad[1]
    }),
    of_pose("yaw", "rad", "yaw reading of the attitude sensor", |at| {
        at.inclination_rad[2]
    }),
    of_pose(
        "tracked_x",
        "m",
        "position read by the external instrument; 0 where not read",
        |at| at.tracked_m[0],
    ),
    of_pose(
        "tracked_y",
        "m",
        "position read by the external instrument; 0 where not read",
        |at| at.tracked_m[1],
    ),
    of_pose(
        "tracked_z",
        "m",
        "position read by the external instrument; 0 where not read",
        |at| at.tracked_m[2],
    ),
    in_motion(of_pose(
        "velocity_x",
        "m/s",
        "velocity of the platform",
        |at| at.twists[0][0],
    )),
    in_motion(of_pose(
        "velocity_y",
        "m/s",
        "velocity of the platform",
        |at| at.twists[0][1],
    )),
    in_motion(of_pose(
        "velocity_z",
        "m/s",
        "velocity of the platform",
        |at| at.twists[0][2],
    )),
    in_motion(of_pose(
        "laser_rate",
        "m/s",
        "time derivative of the laser reading",
        |at| at.laser_rates[0],
    )),
];

const fn cable_target(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    port: CablePort,
) -> FormulaTarget {
    FormulaTarget {
        name,
        unit,
        meaning,
        port: Port::Cable(port),
    }
}

const fn platform_target(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    port: PlatformPort,
) -> FormulaTarget {
    FormulaTarget {
        name,
        unit,
        meaning,
        port: Port::Platform(port),
    }
}

/// All quantities that formulas may change. Directions are not among them: their components are not independent.
pub const FORMULA_TARGETS: &[FormulaTarget] = &[
    cable_target(
        "paid",
        "m",
        "cable paid out since home according to the reading, or the length where lengths are read",
        CablePort::Paid,
    ),
    cable_target(
        "tension",
        "N",
        "tension at the platform according to the reading",
        CablePort::Tension,
    ),
    cable_target(
        "strain",
        "1",
        "extra strain of the cable",
        CablePort::Strain,
    ),
    cable_target(
        "compliance",
        "1/N",
        "reciprocal axial stiffness",
        CablePort::Compliance,
    ),
    cable_target(
        "weight",
        "N/m",
        "weight of the cable per metre",
        CablePort::Weight,
    ),
    cable_target("radius", "m", "pulley radius", CablePort::Radius),
    cable_target(
        "entry_shift_x",
        "m",
        "added to the entry point, base frame",
        CablePort::EntryShift(0),
    ),
    cable_target(
        "entry_shift_y",
        "m",
        "added to the entry point, base frame",
        CablePort::EntryShift(1),
    ),
    cable_target(
        "entry_shift_z",
        "m",
        "added to the entry point, base frame",
        CablePort::EntryShift(2),
    ),
    cable_target(
        "anchor_x",
        "m",
        "attachment point, platform frame",
        CablePort::Anchor(0),
    ),
    cable_target(
        "anchor_y",
        "m",
        "attachment point, platform frame",
        CablePort::Anchor(1),
    ),
    cable_target(
        "anchor_z",
        "m",
        "attachment point, platform frame",
        CablePort::Anchor(2),
    ),
    cable_target(
        "swivel_offset",
        "rad",
        "added to the swivel angle",
        CablePort::SwivelOffset,
    ),
    platform_target("mass", "kg", "mass of the platform", PlatformPort::Mass),
    platform_target(
        "center_of_mass_x",
        "m",
        "centre of mass, platform frame",
        PlatformPort::CenterOfMass(0),
    ),
    platform_target(
        "center_of_mass_y",
        "m",
        "centre of mass, platform frame",
        PlatformPort::CenterOfMass(1),
    ),
    platform_target(
        "center_of_mass_z",
        "m",
        "centre of mass, platform frame",
        PlatformPort::CenterOfMass(2),
    ),
    platform_target(
        "laser_gain",
        "1",
        "laser reading per distance",
        PlatformPort::LaserGain,
    ),
    platform_target(
        "laser_bias",
        "m",
        "added to the laser reading",
        PlatformPort::LaserBias,
    ),
    platform_target(
        "roll_offset",
        "rad",
        "added to the roll reading",
        PlatformPort::InclinationOffset(0),
    ),
    platform_target(
        "pitch_offset",
        "rad",
        "added to the pitch reading",
        PlatformPort::InclinationOffset(1),
    ),
    platform_target(
        "yaw_offset",
        "rad",
        "added to the yaw reading",
        PlatformPort::InclinationOffset(2),
    ),
    platform_target(
        "tracker_point_x",
        "m",
        "point that the external instrument measures, platform frame",
        PlatformPort::TrackerPoint(0),
    ),
    platform_target(
        "tracker_point_y",
        "m",
        "point that the external instrument measures, platform frame",
        PlatformPort::TrackerPoint(1),
    ),
    platform_target(
        "tracker_point_z",
        "m",
        "point that the external instrument measures, platform frame",
        PlatformPort::TrackerPoint(2),
    ),
    platform_target(
        "tracker_shift_x",
        "m",
        "added to the position read by the external instrument",
        PlatformPort::TrackerShift(0),
    ),
    platform_target(
        "tracker_shift_y",
        "m",
        "added to the position read by the external instrument",
        PlatformPort::TrackerShift(1),
    ),
    platform_target(
        "tracker_shift_z",
        "m",
        "added to the position read by the external instrument",
        PlatformPort::TrackerShift(2),
    ),
];

/// The quantity with this name.
pub(super) fn quantity(name: &str) -> Option<&'static FormulaQuantity> {
    FORMULA_QUANTITIES.iter().find(|q| q.name == name)
}

/// The changeable quantity with this name.
pub(super) fn target(name: &str) -> Option<&'static FormulaTarget> {
    FORMULA_TARGETS.iter().find(|t| t.name == name)
}

impl FormulaQuantity {
    /// Whether each cable has a value of the quantity.
    #[must_use]
    pub fn is_of_cable(&self) -> bool {
        matches!(self.source, Source::Cable(_))
    }
}

impl FormulaTarget {
    /// Whether each cable has a value of the quantity.
    #[must_use]
    pub fn is_of_cable(&self) -> bool {
        matches!(self.port, Port::Cable(_))
    }
}
