//! The quantities to which a channel can be assigned: the columns of `poses.csv`, and coordinates of markers.

use std::f64::consts::TAU;

use QuantityKind as Kind;
use tautline_channels::{Dimension, Unit, parse_unit};

/// A column of `poses.csv`, or a coordinate of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Quantity {
    /// Kind.
    pub kind: QuantityKind,
    /// Index of the cable, from 0, or component within a group of columns; three components per marker in sequence.
    pub index: usize,
}

/// Kind of a column, each with its names in `poses.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum QuantityKind {
    /// `pose`
    Label,
    /// `time_s`
    Time,
    /// `temperature_c`
    Temperature,
    /// `x_m` to `qz`
    Commanded,
    /// `rev_1`
    Revolutions,
    /// `change_1_m`
    Change,
    /// `length_1_m`
    Length,
    /// `force_1_n`
    Force,
    /// `swivel_1_rad`
    Swivel,
    /// `laser_m`
    Laser,
    /// `roll_rad` to `yaw_rad`
    Inclination,
    /// `meas_x_m` to `meas_qz`
    Tracked,
    /// `meas_sd_x_m` to `meas_sd_z_m`
    TrackedSd,
    /// `group`
    Group,
    /// `marker_1_x_m` to `marker_99_z_m`: not in `poses.csv`; measured poses are computed from them
    Marker,
    /// `angle_1_rad` to `angle_3_rad`: not in `poses.csv`; the commanded quaternion is computed from them
    CommandedAngle,
    /// `meas_angle_1_rad` to `meas_angle_3_rad`: the same for the measured one
    TrackedAngle,
}

const SINGLE: [(Kind, &[&str]); 11] = [
    (Kind::Label, &["pose"]),
    (Kind::Time, &["time_s"]),
    (Kind::Temperature, &["temperature_c"]),
    (
        Kind::Commanded,
        &["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"],
    ),
    (Kind::Laser, &["laser_m"]),
    (Kind::Inclination, &["roll_rad", "pitch_rad", "yaw_rad"]),
    (
        Kind::Tracked,
        &[
            "meas_x_m", "meas_y_m", "meas_z_m", "meas_qw", "meas_qx", "meas_qy", "meas_qz",
        ],
    ),
    (
        Kind::TrackedSd,
        &["meas_sd_x_m", "meas_sd_y_m", "meas_sd_z_m"],
    ),
    (Kind::Group, &["group"]),
    (
        Kind::CommandedAngle,
        &["angle_1_rad", "angle_2_rad", "angle_3_rad"],
    ),
    (
        Kind::TrackedAngle,
        &["meas_angle_1_rad", "meas_angle_2_rad", "meas_angle_3_rad"],
    ),
];

const PER_CABLE: [(Kind, &str, &str); 5] = [
    (Kind::Revolutions, "rev_", ""),
    (Kind::Change, "change_", "_m"),
    (Kind::Length, "length_", "_m"),
    (Kind::Force, "force_", "_n"),
    (Kind::Swivel, "swivel_", "_rad"),
];

/// Maximum number of markers.
const MARKERS: usize = 99;
/// Number of markers in a list of all quantities.
const LISTED_MARKERS: usize = 6;
const AXES: [&str; 3] = ["x", "y", "z"];

/// The coordinate that a column such as `marker_2_x_m` names.
fn parse_marker(column: &str) -> Option<Quantity> {
    let (number, axis) = column
        .strip_prefix("marker_")?
        .strip_suffix("_m")?
        .split_once('_')?;
    let number: usize = number.parse().ok().filter(|n| (1..=MARKERS).contains(n))?;
    let axis = AXES.iter().position(|name| *name == axis)?;
    Some(Quantity {
        kind: Kind::Marker,
        index: 3 * (number - 1) + axis,
    })
}

impl Quantity {
    /// The quantity of a column.
    #[must_use]
    pub fn parse(column: &str) -> Option<Self> {
        let single = SINGLE.iter().find_map(|(kind, names)| {
            let index = names.iter().position(|name| *name == column)?;
            Some(Self { kind: *kind, index })
        });
        single.or_else(|| parse_marker(column)).or_else(|| {
            PER_CABLE.iter().find_map(|(kind, before, after)| {
                let number: usize = column
                    .strip_prefix(before)?
                    .strip_suffix(after)?
                    .parse()
                    .ok()?;
                Some(Self {
                    kind: *kind,
                    index: number.checked_sub(1)?,
                })
            })
        })
    }

    /// The quantity of a column whose number may be `{i}`; that of the first cable then.
    #[must_use]
    pub fn parse_pattern(column: &str) -> Option<Self> {
        let parsed = Self::parse(&column.replacen("{i}", "1", 1))?;
        (!column.contains("{i}") || parsed.is_per_cable()).then_some(parsed)
    }

    /// Name of the column.
    #[must_use]
    pub fn column(self) -> String {
        let single = SINGLE.iter().find(|(kind, _)| *kind == self.kind);
        if let Some(name) = single.and_then(|(_, names)| names.get(self.index)) {
            return (*name).into();
        }
        if self.kind == Kind::Marker {
            let (number, axis) = (self.index / 3 + 1, AXES[self.index % 3]);
            return format!("marker_{number}_{axis}_m");
        }
        self.kind.column_of(&(self.index + 1).to_string())
    }

    /// Whether the quantity exists once per cable.
    #[must_use]
    pub fn is_per_cable(self) -> bool {
        PER_CABLE.iter().any(|(kind, ..)| *kind == self.kind)
    }

    /// Whether the values are texts.
    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self.kind, Kind::Label | Kind::Group)
    }

    /// Dimension, and base units per unit of the column.
    #[must_use]
    pub fn dimension(self) -> (Dimension, f64) {
        match self.kind {
            Kind::Time => (Dimension::Time, 1.0),
            Kind::Temperature => (Dimension::Temperature, 1.0),
            Kind::Revolutions => (Dimension::Angle, TAU),
            Kind::Swivel | Kind::Inclination | Kind::CommandedAngle | Kind::TrackedAngle => {
                (Dimension::Angle, 1.0)
            }
            Kind::Force => (Dimension::Force, 1.0),
            Kind::Commanded | Kind::Tracked if self.index > 2 => (Dimension::Number, 1.0),
            Kind::Change
            | Kind::Length
            | Kind::Laser
            | Kind::Commanded
            | Kind::Tracked
            | Kind::TrackedSd
            | Kind::Marker => (Dimension::Length, 1.0),
            Kind::Label | Kind::Group => (Dimension::Number, 1.0),
        }
    }

    /// Factor and offset from a unit to that of the column; `None` if the unit is unknown or measures something else.
    #[must_use]
    pub fn conversion(self, unit: &str) -> Option<(f64, f64)> {
        let unit: Unit = parse_unit(unit)?;
        let (dimension, native) = self.dimension();
        // Encoder counts are plain numbers, scaled by the factor of the entry.
        if unit.dimension == Dimension::Number {
            return Some((1.0, 0.0));
        }
        if unit.dimension != dimension {
            return None;
        }
        // Exactly 1 where the units are the same, so that numbers keep their last digit.
        let factor = if unit.factor == native {
            1.0
        } else {
            unit.factor / native
        };
        Some((factor, unit.offset / native))
    }

    /// The permitted units, in words.
    #[must_use]
    pub fn expected_unit(self) -> &'static str {
        match self.dimension().0 {
            Dimension::Length => "a unit of length, such as m or mm",
            Dimension::Angle => "a unit of angle, such as rad, deg or rev",
            Dimension::Force => "a unit of force, such as N, kN or kg",
            Dimension::Temperature => "a unit of temperature, such as °C or K",
            Dimension::Time => "a unit of time, such as s or ms",
            Dimension::Number => "no unit",
        }
    }

    /// Usual units.
    #[must_use]
    pub fn usual_units(self) -> &'static [&'static str] {
        match self.dimension().0 {
            Dimension::Length => &["m", "cm", "mm", "in"],
            Dimension::Angle => &["rev", "rad", "deg"],
            Dimension::Force => &["N", "kN", "kg"],
            Dimension::Temperature => &["°C", "K"],
            Dimension::Time => &["s", "ms"],
            Dimension::Number => &[],
        }
    }

    /// One quantity of each kind and component, for the first cable.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let per_cable = PER_CABLE.iter().map(|(kind, ..)| Self {
            kind: *kind,
            index: 0,
        });
        let single = SINGLE
            .iter()
            .flat_map(|(kind, names)| (0..names.len()).map(|index| Self { kind: *kind, index }));
        let markers = (0..3 * LISTED_MARKERS).map(|index| Self {
            kind: Kind::Marker,
            index,
        });
        per_cable.chain(single).chain(markers).collect()
    }

    /// Title without the number of the cable.
    #[must_use]
    pub fn title(self) -> String {
        let axis = |of: &str| {
            let component = ["x", "y", "z", "qw", "qx", "qy", "qz"][self.index.min(6)];
            format!("{of} {component}")
        };
        match self.kind {
            Kind::Label => "Label of the pose".into(),
            Kind::Time => "Time".into(),
            Kind::Temperature => "Temperature".into(),
            Kind::Commanded => axis("Commanded"),
            Kind::Revolutions => "Winch revolutions".into(),
            Kind::Change => "Cable paid out since home".into(),
            Kind::Length => "Cable length".into(),
            Kind::Force => "Cable force".into(),
            Kind::Swivel => "Swivel angle".into(),
            Kind::Laser => "Laser distance".into(),
            Kind::Inclination => ["Roll", "Pitch", "Yaw"][self.index.min(2)].into(),
            Kind::Tracked => axis("Measured"),
            Kind::TrackedSd => axis("Standard deviation of measured"),
            Kind::Group => "Group of poses".into(),
            Kind::CommandedAngle => format!("Commanded angle {}", self.index + 1),
            Kind::TrackedAngle => format!("Measured angle {}", self.index + 1),
            Kind::Marker => format!("Marker {} {}", self.index / 3 + 1, AXES[self.index % 3]),
        }
    }

    /// Whether the quantity varies with the pose of the platform. Forces and laser distances do not count.
    #[must_use]
    pub fn moves(self) -> bool {
        matches!(
            self.kind,
            Kind::Revolutions
                | Kind::Change
                | Kind::Length
                | Kind::Swivel
                | Kind::Commanded
                | Kind::Tracked
                | Kind::Marker
                | Kind::Inclination
                | Kind::CommandedAngle
                | Kind::TrackedAngle
        )
    }
}

impl QuantityKind {
    /// Column for a cable number, or for `{i}`.
    #[must_use]
    pub fn column_of(self, number: &str) -> String {
        let found = PER_CABLE.iter().find(|(kind, ..)| *kind == self);
        found.map_or_else(String::new, |(_, before, after)| {
            format!("{before}{number}{after}")
        })
    }
}
