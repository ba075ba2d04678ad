//! Files of the tables of phases 1 and 2.

use std::path::Path;

use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_session::{
    ElongationPoint, ForcePair, HomeReading, Loaded, PhaseData, WinchPair, read_elongation,
    read_force, read_home, read_table_file, read_winch,
};

/// A table of phase 1 or 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// Revolutions and lengths of winches.
    Winch,
    /// Readings and loads of force sensors.
    Force,
    /// Readings of the home platform.
    Home,
    /// Elongations of a cable.
    Elongation,
}

/// Rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableRows {
    /// Of winches.
    Winch(Vec<WinchPair>),
    /// Of force sensors.
    Force(Vec<ForcePair>),
    /// Of the home platform.
    Home(Vec<HomeReading>),
    /// Of a cable's elongation.
    Elongation(Vec<ElongationPoint>),
}

impl Table {
    /// All tables.
    pub const ALL: [Self; 4] = [Self::Winch, Self::Force, Self::Home, Self::Elongation];

    /// Usual file name.
    #[must_use]
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Winch => "winch.csv",
            Self::Force => "force.csv",
            Self::Home => "home.csv",
            Self::Elongation => "elongation.csv",
        }
    }

    /// Required columns.
    #[must_use]
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Winch => &["cable", "rev", "length_m"],
            Self::Force => &["cable", "reading_n", "load_n"],
            Self::Home => &["sensor", "reading"],
            Self::Elongation => &["length_m", "tension_n", "elongation_m"],
        }
    }

    /// Reads the rows from a file.
    ///
    /// # Errors
    /// With the place of the error in the file.
    pub fn read(self, path: &Path, robot: &Robot) -> Result<Loaded<TableRows>, ReadError> {
        fn rows<T>(
            loaded: Loaded<Vec<T>>,
            wrap: impl FnOnce(Vec<T>) -> TableRows,
        ) -> Loaded<TableRows> {
            let Loaded { value, notices } = loaded;
            Loaded {
                value: wrap(value),
                notices,
            }
        }
        read_table_file(path, |reader, file| match self {
            Self::Winch => read_winch(reader, file, robot).map(|l| rows(l, TableRows::Winch)),
            Self::Force => read_force(reader, file, robot).map(|l| rows(l, TableRows::Force)),
            Self::Home => read_home(reader, file).map(|l| rows(l, TableRows::Home)),
            Self::Elongation => {
                read_elongation(reader, file).map(|l| rows(l, TableRows::Elongation))
            }
        })
    }
}

impl TableRows {
    /// The table of these rows.
    #[must_use]
    pub fn table(&self) -> Table {
        match self {
            Self::Winch(_) => Table::Winch,
            Self::Force(_) => Table::Force,
            Self::Home(_) => Table::Home,
            Self::Elongation(_) => Table::Elongation,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn row_count(&self) -> usize {
        match self {
            Self::Winch(rows) => rows.len(),
            Self::Force(rows) => rows.len(),
            Self::Home(rows) => rows.len(),
            Self::Elongation(rows) => rows.len(),
        }
    }

    /// Whether every row refers to a cable of a robot with `cables` cables.
    #[must_use]
    pub fn suit(&self, cables: usize) -> bool {
        match self {
            Self::Winch(rows) => rows.iter().all(|row| row.cable < cables),
            Self::Force(rows) => rows.iter().all(|row| row.cable < cables),
            Self::Home(_) | Self::Elongation(_) => true,
        }
    }

    /// Replaces the rows of the table.
    pub fn replace(self, phases: &mut PhaseData) {
        match self {
            Self::Winch(rows) => phases.winch = rows,
            Self::Force(rows) => phases.force = rows,
            Self::Home(rows) => phases.home = rows,
            Self::Elongation(rows) => phases.elongation = rows,
        }
    }
}
