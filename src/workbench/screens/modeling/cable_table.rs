//! Geometry and winches of all cables as a table of numbers in display units, with empty cells for missing numbers. A
//! block copied from a spreadsheet can be pasted.

use tautline_core::geometry::Vec3;
use tautline_core::robot::{
    Cable, CableMaterial, PartTolerances, PerAxis, Platform, Pulley, Robot, Winch,
};
use tautline_workflow::wording::{count, list};

use crate::widgets::parse_number;

/// Largest number of cells named in an error message; a wrong column would fill the screen.
const MOST_NAMED: usize = 3;

/// Meaning of an empty cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Empty {
    /// Required: the robot cannot be used without the number.
    Missing,
    /// Unknown, or the part is rigid.
    Unknown,
    /// Default of `robot.json`, in the display unit.
    Default(f64),
}

pub(crate) struct CableTableColumn {
    pub(crate) title: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) decimals: usize,
    pub(crate) empty: Empty,
    /// Display units per SI unit.
    per_si: f64,
    number: CableNumber,
}

/// Accessor of a number of a cable.
#[derive(Clone, Copy)]
enum CableNumber {
    Always(fn(&mut Cable) -> &mut f64),
    Optional {
        get: fn(&Cable) -> Option<f64>,
        set: fn(&mut Cable, Option<f64>),
    },
}

impl CableTableColumn {
    const fn new(
        title: &'static str,
        unit: &'static str,
        per_si: f64,
        decimals: usize,
        number: fn(&mut Cable) -> &mut f64,
    ) -> Self {
        Self {
            title,
            unit,
            decimals,
            empty: Empty::Missing,
            per_si,
            number: CableNumber::Always(number),
        }
    }

    const fn mm(title: &'static str, decimals: usize, number: fn(&mut Cable) -> &mut f64) -> Self {
        Self::new(title, "mm", 1e3, decimals, number)
    }

    const fn or(self, default: f64) -> Self {
        Self {
            empty: Empty::Default(default),
            ..self
        }
    }

    /// Whether the number can be the same for all cables.
    pub(crate) fn is_common(&self) -> bool {
        !self.title.ends_with(['x', 'y', 'z'])
    }

    fn get(&self, cable: &mut Cable) -> Option<f64> {
        let value = match self.number {
            CableNumber::Always(number) => Some(*number(cable)),
            CableNumber::Optional { get, .. } => get(cable),
        };
        value.map(|value| value * self.per_si)
    }

    fn put(&self, cable: &mut Cable, value: Option<f64>) {
        let value = match self.empty {
            Empty::Default(default) => value.or(Some(default)),
            Empty::Missing | Empty::Unknown => value,
        };
        let value = value.map(|value| value / self.per_si);
        match (self.number, value) {
            (CableNumber::Always(number), Some(value)) => *number(cable) = value,
            (CableNumber::Always(_), None) => {}
            (CableNumber::Optional { set, .. }, value) => set(cable, value),
        }
    }
}

/// Pulley and platform anchor in the frames of base and platform, then winch and cable.
pub(crate) static COLUMNS: [CableTableColumn; 18] = [
    CableTableColumn::mm("Pulley x", 2, |c| &mut c.pulley.entry_point_m[0]),
    CableTableColumn::mm("Pulley y", 2, |c| &mut c.pulley.entry_point_m[1]),
    CableTableColumn::mm("Pulley z", 2, |c| &mut c.pulley.entry_point_m[2]),
    CableTableColumn::mm("Anchor x", 2, |c| &mut c.platform_anchor_m[0]),
    CableTableColumn::mm("Anchor y", 2, |c| &mut c.platform_anchor_m[1]),
    CableTableColumn::mm("Anchor z", 2, |c| &mut c.platform_anchor_m[2]),
    CableTableColumn::new("Swivel axis x", "", 1.0, 4, |c| {
        &mut c.pulley.swivel_axis[0]
    }),
    CableTableColumn::new("Swivel axis y", "", 1.0, 4, |c| {
        &mut c.pulley.swivel_axis[1]
    }),
    CableTableColumn::new("Swivel axis z", "", 1.0, 4, |c| {
        &mut c.pulley.swivel_axis[2]
    }),
    CableTableColumn::mm("Pulley radius", 2, |c| &mut c.pulley.radius_m),
    CableTableColumn {
        title: "Position known to ±",
        unit: "mm",
        decimals: 1,
        empty: Empty::Unknown,
        per_si: 1e3,
        number: CableNumber::Optional {
            get: |c| match c.pulley.entry_point_sd_m {
                PerAxis::Same(sd) => sd,
                PerAxis::Each(_) => None,
            },
            set: |c, sd| c.pulley.entry_point_sd_m = PerAxis::Same(sd),
        },
    },
    CableTableColumn::mm("Drum diameter", 2, |c| &mut c.winch.drum_diameter_m),
    CableTableColumn::mm("Drum pitch", 2, |c| &mut c.winch.drum_pitch_m).or(0.0),
    CableTableColumn::new("Gear ratio", "", 1.0, 4, |c| &mut c.winch.gear_ratio).or(1.0),
    CableTableColumn::mm("Cable length winch to pulley", 0, |c| {
        &mut c.winch.length_to_pulley_m
    })
    .or(0.0),
    CableTableColumn::mm("Length noise", 3, |c| &mut c.winch.length_sd_m),
    CableTableColumn {
        title: "Axial stiffness",
        unit: "kN",
        decimals: 1,
        empty: Empty::Unknown,
        per_si: 1e-3,
        number: CableNumber::Optional {
            get: |c| c.cable.axial_stiffness_n,
            set: |c, stiffness| c.cable.axial_stiffness_n = stiffness,
        },
    },
    CableTableColumn::new("Weight", "N/m", 1.0, 3, |c| &mut c.cable.weight_n_per_m).or(0.0),
];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CableTable {
    pub(crate) names: Vec<String>,
    /// Cells by rows, in display units.
    pub(crate) cells: Vec<[Option<f64>; COLUMNS.len()]>,
}

impl CableTable {
    pub(crate) fn of(robot: &Robot) -> Self {
        let cells = |cable: &Cable| {
            let mut cable = cable.clone();
            COLUMNS.each_ref().map(|column| column.get(&mut cable))
        };
        Self {
            names: robot.cables.iter().map(|c| c.name.clone()).collect(),
            cells: robot.cables.iter().map(cells).collect(),
        }
    }

    /// Resizes the table to `count` rows; new ones are empty.
    pub(crate) fn resize(&mut self, count: usize) {
        let new = self.names.len()..count;
        self.names.truncate(count);
        self.names.extend(new.map(|k| format!("cable-{}", k + 1)));
        self.cells.resize(count, [None; COLUMNS.len()]);
    }

    pub(crate) fn cell_name(&self, row: usize, column: usize) -> String {
        format!("{} of {}", COLUMNS[column].title, self.names[row])
    }

    /// Number that all cables share; `None` if they differ.
    pub(crate) fn common(&self, column: usize) -> Option<f64> {
        let mut values = self.cells.iter().map(|row| row[column]);
        let first = values.next()??;
        values.all(|value| value == Some(first)).then_some(first)
    }

    pub(crate) fn set_all(&mut self, column: usize, value: Option<f64>) {
        self.cells.iter_mut().for_each(|row| row[column] = value);
    }

    /// Required numbers that are missing, by columns, with their cables.
    pub(crate) fn missing(&self) -> Vec<String> {
        let required = COLUMNS.iter().enumerate();
        let required = required.filter(|(_, column)| column.empty == Empty::Missing);
        required
            .filter_map(|(k, column)| {
                let lacking = self.names.iter().zip(&self.cells);
                let lacking = lacking.filter(|(_, row)| row[k].is_none());
                let names: Vec<&String> = lacking.map(|(name, _)| name).collect();
                match names.len() {
                    0 => None,
                    some if some == self.names.len() => {
                        Some(format!("{} of all cables", column.title))
                    }
                    _ => Some(format!("{} of {}", column.title, list(&names))),
                }
            })
            .collect()
    }

    /// Pastes a block of cells separated by tabs or semicolons, with decimal points or commas, at the cell and to the
    /// right and below it. Returns the number of cells; nothing changes if one is invalid.
    pub(crate) fn paste(
        &mut self,
        row: usize,
        column: usize,
        text: &str,
        may_lack: bool,
    ) -> Result<usize, String> {
        let block = block(text);
        let rows = block.len();
        let columns = block.iter().map(Vec::len).max().unwrap_or(0);
        let room = [self.cells.len() - row, COLUMNS.len() - column];
        if rows > room[0] || columns > room[1] {
            return Err(format!(
                "The block has {} and {}; from {} there is room for {} and {}.",
                count(rows, "row"),
                count(columns, "column"),
                self.cell_name(row, column),
                room[0],
                room[1],
            ));
        }
        let mut changed = self.cells.clone();
        let (mut wrong, mut done) = (Vec::new(), 0);
        for (i, cells) in block.iter().enumerate() {
            for (k, cell) in cells.iter().enumerate() {
                let may_be_empty = may_lack || COLUMNS[column + k].empty != Empty::Missing;
                let value = match cell.trim() {
                    "" if may_be_empty => Ok(None),
                    text => parse_number(text).map(Some),
                };
                match value {
                    Ok(value) => changed[row + i][column + k] = value,
                    Err(message) => wrong.push(format!(
                        "row {}, column {} ({}): {message}",
                        i + 1,
                        k + 1,
                        self.cell_name(row + i, column + k)
                    )),
                }
                done += 1;
            }
        }
        if wrong.is_empty() {
            self.cells = changed;
            return Ok(done);
        }
        let more = wrong.len().saturating_sub(MOST_NAMED);
        wrong.truncate(MOST_NAMED);
        if more > 0 {
            wrong.push(format!("{} more", count(more, "cell")));
        }
        Err(format!("Nothing was pasted. {}.", wrong.join("; ")))
    }

    /// Robot with the numbers of this table; unchanged numbers keep all their digits.
    pub(crate) fn applied_to(&self, robot: &Robot) -> Result<Robot, String> {
        let before = Self::of(robot);
        let mut robot = robot.clone();
        let rows = self.cells.iter().zip(&before.cells);
        for (cable, (row, before)) in robot.cables.iter_mut().zip(rows) {
            put(cable, row, Some(before))?;
        }
        checked(robot)
    }

    /// Robot from this table; home pose, instruments and payload are described later.
    pub(crate) fn to_robot(&self, name: &str) -> Result<Robot, String> {
        let rows = self.names.iter().zip(&self.cells);
        let cables = rows.map(|(name, row)| {
            let mut cable = empty_cable(name);
            put(&mut cable, row, None).map(|()| cable)
        });
        let cables = cables.collect::<Result<_, _>>()?;
        checked(Robot {
            tolerances: Some(PartTolerances::typical()),
            ..Robot::new(name, Platform::spatial(None), cables)
        })
    }
}

/// Cells of a block, by rows.
fn block(text: &str) -> Vec<Vec<&str>> {
    let separator = if text.contains('\t') { '\t' } else { ';' };
    let lines = text.trim_end_matches(['\r', '\n']).lines();
    lines.map(|line| line.split(separator).collect()).collect()
}

/// Whether a text has more than one cell.
pub(crate) fn is_block(text: &str) -> bool {
    text.trim_end_matches(['\r', '\n'])
        .contains(['\t', ';', '\n'])
}

fn put(
    cable: &mut Cable,
    row: &[Option<f64>; COLUMNS.len()],
    before: Option<&[Option<f64>; COLUMNS.len()]>,
) -> Result<(), String> {
    let axis = cable.pulley.swivel_axis;
    for (k, column) in COLUMNS.iter().enumerate() {
        if before.is_none_or(|before| before[k] != row[k]) {
            column.put(cable, row[k]);
        }
    }
    if cable.pulley.swivel_axis != axis {
        let unit = Vec3::from(cable.pulley.swivel_axis).try_normalize(1e-6);
        let unit = unit.ok_or_else(|| {
            format!(
                "Swivel axis of {}: found 0 in all three coordinates, expected a direction. Set another coordinate first.",
                cable.name
            )
        })?;
        cable.pulley.swivel_axis = unit.into();
    }
    Ok(())
}

fn checked(robot: Robot) -> Result<Robot, String> {
    match robot.check() {
        Ok(()) => Ok(robot),
        Err(error) => Err(format!("This makes the robot invalid: {error}.")),
    }
}

/// Cable without any number.
fn empty_cable(name: &str) -> Cable {
    Cable {
        name: name.to_owned(),
        pulley: Pulley::new([f64::NAN; 3], [f64::NAN; 3], f64::NAN),
        platform_anchor_m: [f64::NAN; 3],
        winch: Winch {
            drum_diameter_m: f64::NAN,
            drum_pitch_m: f64::NAN,
            gear_ratio: f64::NAN,
            length_to_pulley_m: f64::NAN,
            length_sd_m: f64::NAN,
        },
        cable: CableMaterial::default(),
        force_sensor: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;

    #[test]
    fn a_block_of_a_spreadsheet_fills_cells_to_the_right_and_below() {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut table = CableTable::of(&robot);
        let done = table.paste(2, 1, "-360,5\t12\r\n1.25e2\t\u{2212}7\r\n", false);
        assert_eq!(done, Ok(4));
        assert_eq!(table.cells[2][1..3], [Some(-360.5), Some(12.0)]);
        assert_eq!(table.cells[3][1..3], [Some(125.0), Some(-7.0)]);
        let changed = table.applied_to(&robot).expect("a robot");
        assert!((changed.cables[2].pulley.entry_point_m[1] + 0.3605).abs() < 1e-12);
        let mut expected = robot.clone();
        for k in [2, 3] {
            let entry = &changed.cables[k].pulley.entry_point_m;
            expected.cables[k].pulley.entry_point_m[1..].copy_from_slice(&entry[1..]);
        }
        assert_eq!(changed, expected, "what was not pasted keeps its digits");
        assert_eq!(table.paste(0, 0, "1;2,5;3", false), Ok(3));
        assert_eq!(table.cells[0][1], Some(2.5));
    }

    #[test]
    fn cells_that_cannot_be_read_are_named_and_nothing_changes() {
        let mut table = CableTable::of(&presets::find("mini").expect("a preset").robot);
        let before = table.clone();
        let message = table
            .paste(1, 0, "1\t2\n3\tabc\n\t5", false)
            .expect_err("a word and an empty cell");
        for part in [
            "row 2, column 2 (Pulley y of cable-3): found \"abc\"",
            "row 3, column 1 (Pulley x of cable-4): found nothing",
        ] {
            assert!(message.contains(part), "{message}");
        }
        let message = table.paste(7, 0, "1\n2", false).expect_err("no room");
        assert!(
            message.contains("2 rows and 1 column; from Pulley x of cable-8"),
            "{message}"
        );
        assert_eq!(table, before);
    }

    #[test]
    fn a_blank_table_names_its_empty_cells_until_it_is_a_robot() {
        let robot = presets::find("mini").expect("a preset").robot;
        let full = CableTable::of(&robot);
        let mut blank = CableTable {
            names: Vec::new(),
            cells: Vec::new(),
        };
        blank.resize(8);
        assert_eq!(blank.missing()[0], "Pulley x of all cables");
        assert_eq!(blank.missing().len(), 12);
        assert!(blank.to_robot("new").is_err(), "no number is invented");
        blank.cells.clone_from(&full.cells);
        blank.cells[3][4] = None;
        assert_eq!(blank.missing(), ["Anchor y of cable-4"]);
        blank.cells[3] = full.cells[3];
        let made = blank.to_robot("new").expect("a robot");
        assert_eq!(CableTable::of(&made).cells.len(), 8);
        assert!(
            (made.cables[3].platform_anchor_m[1] - robot.cables[3].platform_anchor_m[1]).abs()
                < 1e-12
        );
    }
}
