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

/// A table of quantities: name, unit, value and definition.
macro_rules! quantities {
    ($($source:ident, is_of_motion: $is_of_motion:literal {
        $($name:literal, $unit:literal, $value:expr, $meaning:literal;)*
    })*) => {
        &[$($(FormulaQuantity {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            source: Source::$source($value),
            is_of_motion: $is_of_motion,
        },)*)*]
    };
}

/// A table of targets: name, unit, port and definition.
macro_rules! targets {
    ($($owner:ident, $ports:ident {
        $($name:literal, $unit:literal, $port:ident $(($axis:literal))?, $meaning:literal;)*
    })*) => {
        &[$($(FormulaTarget {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            port: Port::$owner($ports::$port $(($axis))?),
        },)*)*]
    };
}

/// All quantities that formulas may use; those of a cable also of another one, as `paid_of(next)`.
pub const FORMULA_QUANTITIES: &[FormulaQuantity] = quantities! {
    Cable, is_of_motion: false {
        "paid", "m", |at| at.paid_m, "cable paid out since home, or its length where lengths are read";
        "tension", "N", |at| at.tension_n, "tension; the mean where it was not read";
        "mean_tension", "N", |at| at.mean_tension_n, "mean tension over all poses";
        "sensor_gain", "1", |at| at.tension_gain, "reading of the force sensor per tension; 0 where it is not read";
        "revolutions", "rev", |at| at.revolutions, "motor revolutions since home";
        "drum_revolutions", "rev", |at| at.revolutions * at.drum_per_motor, "drum revolutions since home";
        "direction", "1", |at| at.direction, "1 where the cable was paid out on the way to the pose, -1 where it was reeled in";
        "length", "m", |at| at.length_m, "length from pulley to platform";
        "wrap", "rad", |at| at.wrap_rad, "wrap angle on the pulley";
        "swivel", "rad", |at| at.swivel_rad, "swivel angle of the pulley; 0 without a stated zero direction";
        "pulley_radius", "m", |at| at.radius_m, "stated radius of the pulley";
        "entry_x", "m", |at| at.entry_point_m[0], "nominal entry point, base frame";
        "entry_y", "m", |at| at.entry_point_m[1], "nominal entry point, base frame";
        "entry_z", "m", |at| at.entry_point_m[2], "nominal entry point, base frame";
        "pull_x", "1", |at| at.pull_horizontal[0], "horizontal part of the unit vector from the pulley to the platform";
        "pull_y", "1", |at| at.pull_horizontal[1], "horizontal part of the unit vector from the pulley to the platform";
        "pull_z", "1", |at| at.pull_horizontal[2], "horizontal part of the unit vector from the pulley to the platform";
    }
    Cable, is_of_motion: true {
        "paid_rate", "m/s", |at| at.paid_rates[0], "speed at which the cable is paid out";
        "paid_acceleration", "m/s^2", |at| at.paid_rates[1], "acceleration of the cable paid out";
        "tension_rate", "N/s", |at| at.tension_rates[0], "time derivative of the tension";
    }
    Pose, is_of_motion: false {
        "time", "s", |at| at.time_s, "time since home, or since the first pose";
        "temperature", "K", |at| at.temperature_change_k, "change of temperature since home, or since the first pose";
        "at_home", "1", |at| f64::from(u8::from(at.is_home)), "1 at the home pose, else 0";
        "position_x", "m", |at| at.position_m[0], "position of the platform";
        "position_y", "m", |at| at.position_m[1], "position of the platform";
        "position_z", "m", |at| at.position_m[2], "position of the platform";
        "rotation_x", "rad", |at| at.rotation_rad[0], "rotation vector of the platform, base frame";
        "rotation_y", "rad", |at| at.rotation_rad[1], "rotation vector of the platform, base frame";
        "rotation_z", "rad", |at| at.rotation_rad[2], "rotation vector of the platform, base frame";
        "laser", "m", |at| at.laser_m, "laser reading; 0 without one";
        "roll", "rad", |at| at.inclination_rad[0], "roll reading of the inclinometer";
        "pitch", "rad", |at| at.inclination_rad[1], "pitch reading of the inclinometer";
        "yaw", "rad", |at| at.inclination_rad[2], "yaw reading of the attitude sensor";
        "tracked_x", "m", |at| at.tracked_m[0], "position read by the external instrument; 0 where not read";
        "tracked_y", "m", |at| at.tracked_m[1], "position read by the external instrument; 0 where not read";
        "tracked_z", "m", |at| at.tracked_m[2], "position read by the external instrument; 0 where not read";
    }
    Pose, is_of_motion: true {
        "velocity_x", "m/s", |at| at.twists[0][0], "velocity of the platform";
        "velocity_y", "m/s", |at| at.twists[0][1], "velocity of the platform";
        "velocity_z", "m/s", |at| at.twists[0][2], "velocity of the platform";
        "laser_rate", "m/s", |at| at.laser_rates[0], "time derivative of the laser reading";
    }
};

/// All quantities that formulas may change. Directions are not among them: their components are not independent.
pub const FORMULA_TARGETS: &[FormulaTarget] = targets! {
    Cable, CablePort {
        "paid", "m", Paid, "cable paid out since home according to the reading, or the length where lengths are read";
        "tension", "N", Tension, "tension at the platform according to the reading";
        "strain", "1", Strain, "extra strain of the cable";
        "compliance", "1/N", Compliance, "reciprocal axial stiffness";
        "weight", "N/m", Weight, "weight of the cable per metre";
        "radius", "m", Radius, "pulley radius";
        "entry_shift_x", "m", EntryShift(0), "added to the entry point, base frame";
        "entry_shift_y", "m", EntryShift(1), "added to the entry point, base frame";
        "entry_shift_z", "m", EntryShift(2), "added to the entry point, base frame";
        "anchor_x", "m", Anchor(0), "attachment point, platform frame";
        "anchor_y", "m", Anchor(1), "attachment point, platform frame";
        "anchor_z", "m", Anchor(2), "attachment point, platform frame";
        "swivel_offset", "rad", SwivelOffset, "added to the swivel angle";
    }
    Platform, PlatformPort {
        "mass", "kg", Mass, "mass of the platform";
        "center_of_mass_x", "m", CenterOfMass(0), "centre of mass, platform frame";
        "center_of_mass_y", "m", CenterOfMass(1), "centre of mass, platform frame";
        "center_of_mass_z", "m", CenterOfMass(2), "centre of mass, platform frame";
        "laser_gain", "1", LaserGain, "laser reading per distance";
        "laser_bias", "m", LaserBias, "added to the laser reading";
        "roll_offset", "rad", InclinationOffset(0), "added to the roll reading";
        "pitch_offset", "rad", InclinationOffset(1), "added to the pitch reading";
        "yaw_offset", "rad", InclinationOffset(2), "added to the yaw reading";
        "tracker_point_x", "m", TrackerPoint(0), "point that the external instrument measures, platform frame";
        "tracker_point_y", "m", TrackerPoint(1), "point that the external instrument measures, platform frame";
        "tracker_point_z", "m", TrackerPoint(2), "point that the external instrument measures, platform frame";
        "tracker_shift_x", "m", TrackerShift(0), "added to the position read by the external instrument";
        "tracker_shift_y", "m", TrackerShift(1), "added to the position read by the external instrument";
        "tracker_shift_z", "m", TrackerShift(2), "added to the position read by the external instrument";
    }
};

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
