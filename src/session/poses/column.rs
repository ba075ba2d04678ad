//! The numeric columns of a table of poses, and their names.

/// A numeric column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PoseColumn {
    /// Time of measurement.
    Time,
    /// Temperature.
    Temperature,
    /// Laser distance.
    Laser,
    /// One component of a group.
    Component(Group, usize),
    /// One quantity of the cable with this number, from 1.
    Cable(PerCable, usize),
}

/// Columns that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Group {
    /// Commanded pose.
    Commanded,
    /// Roll, pitch, yaw.
    Inclination,
    /// Pose measured by the external instrument.
    Tracked,
    /// Standard deviation of the tracked position.
    TrackedSd,
    /// True pose of simulated data.
    TruePose,
}

/// Quantities with one column per cable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PerCable {
    /// Motor revolutions since home.
    Revolutions,
    /// Cable paid out since home, another form of revolutions.
    Change,
    /// Absolute length.
    Length,
    /// Raw force reading.
    Force,
    /// Swivel angle.
    Swivel,
    /// True tension of simulated data.
    TrueTension,
}

impl Group {
    pub const ALL: [Self; 5] = [
        Self::Commanded,
        Self::Inclination,
        Self::Tracked,
        Self::TrackedSd,
        Self::TruePose,
    ];

    /// Names of the columns; a pose is a position and a quaternion, w first.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::Commanded => &["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"],
            Self::Inclination => &["roll_rad", "pitch_rad", "yaw_rad"],
            Self::Tracked => &[
                "meas_x_m", "meas_y_m", "meas_z_m", "meas_qw", "meas_qx", "meas_qy", "meas_qz",
            ],
            Self::TrackedSd => &["meas_sd_x_m", "meas_sd_y_m", "meas_sd_z_m"],
            Self::TruePose => &[
                "true_x_m", "true_y_m", "true_z_m", "true_qw", "true_qx", "true_qy", "true_qz",
            ],
        }
    }
}

impl PerCable {
    pub const ALL: [Self; 6] = [
        Self::Revolutions,
        Self::Change,
        Self::Length,
        Self::Force,
        Self::Swivel,
        Self::TrueTension,
    ];

    /// Prefix and suffix of the cable's number in a column name.
    fn around_number(self) -> (&'static str, &'static str) {
        match self {
            Self::Revolutions => ("rev_", ""),
            Self::Change => ("change_", "_m"),
            Self::Length => ("length_", "_m"),
            Self::Force => ("force_", "_n"),
            Self::Swivel => ("swivel_", "_rad"),
            Self::TrueTension => ("true_tension_", "_n"),
        }
    }

    /// Name of the column of a cable, numbered from 1.
    pub fn name(self, number: usize) -> String {
        let (before, after) = self.around_number();
        format!("{before}{number}{after}")
    }

    fn parse(self, name: &str) -> Option<usize> {
        let (before, after) = self.around_number();
        let number = name.strip_prefix(before)?.strip_suffix(after)?;
        let canonical = number == "0" || !number.starts_with(['0', '+']);
        number.parse().ok().filter(|_| canonical)
    }
}

impl PoseColumn {
    const SINGLE: [(Self, &'static str); 3] = [
        (Self::Time, "time_s"),
        (Self::Temperature, "temperature_c"),
        (Self::Laser, "laser_m"),
    ];

    /// The column with this name in any case, if known.
    pub fn parse(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        let single = Self::SINGLE.iter().find(|(_, known)| *known == name);
        single.map(|(column, _)| *column).or_else(|| {
            let component = |group: Group| {
                let k = group.names().iter().position(|known| *known == name)?;
                Some(Self::Component(group, k))
            };
            let cable = |quantity: PerCable| Some(Self::Cable(quantity, quantity.parse(&name)?));
            Group::ALL
                .into_iter()
                .find_map(component)
                .or_else(|| PerCable::ALL.into_iter().find_map(cable))
        })
    }

    /// Name of the column.
    pub fn name(self) -> String {
        match self {
            Self::Component(group, k) => group.names()[k].into(),
            Self::Cable(quantity, number) => quantity.name(number),
            Self::Time | Self::Temperature | Self::Laser => {
                let single = Self::SINGLE.iter().find(|(column, _)| *column == self);
                single.map_or_else(String::new, |(_, name)| (*name).into())
            }
        }
    }
}
