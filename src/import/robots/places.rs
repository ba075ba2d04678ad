//! Tables of the positions of pulleys and platform anchors, one row for each cable: sheets, texts, arrays of MATLAB and NumPy.
//!
//! A heading names the part and the axis of a column, in English or German: `pulley x [mm]`, `Rolle x`, `platform_y_m`, or
//! the letters of equations, `geom.A` for the pulleys and `geom.B` for the platform anchors. Missing values are assumed and
//! reported.

use tautline_channels::{Channel, Dimension, Series, Source, TextChannel, Values, parse_unit};
use tautline_core::geometry::Coordinate;
use tautline_core::robot::{Cable, Home, Platform, Robot};
use tautline_files::ReadError;
use tautline_session::Loaded;

use super::description::{
    Description, Guide, cable_of, home_at, know_normal_to_plane, pose_of, robot_of,
};
use crate::naming::{families, words_of};

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Most cables of a table; longer ones are readings.
const MAX_CABLES: usize = 64;
/// Largest frame of coordinates without a unit that are taken as metres; the largest of others are millimetres.
const LARGEST_IN_METRES: f64 = 60.0;
/// Standard deviation of an assumed home in the middle of the frame, as a fraction of the frame's size.
const HOME_SD: f64 = 0.05;
/// Standard deviation of the rotation of an assumed home (rad).
const HOME_ROTATION_SD_RAD: f64 = 0.05;

/// Property of a cable that a column states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Property {
    Pulley,
    Platform,
    PulleyRadius,
    DrumDiameter,
    GearRatio,
}

/// Lists of word beginnings, with the property and its factor: a heading has one word of each list. The most specific first.
const HEADINGS: [(&[&[&str]], Property, f64); 7] = [
    (&[DRUM, RADIUS], Property::DrumDiameter, 2.0),
    (&[DRUM, DIAMETER], Property::DrumDiameter, 1.0),
    (
        &[&["gear", "getriebe", "übersetzung"]],
        Property::GearRatio,
        1.0,
    ),
    (&[PULLEY, RADIUS], Property::PulleyRadius, 1.0),
    (&[PULLEY, DIAMETER], Property::PulleyRadius, 0.5),
    (&[PLATFORM], Property::Platform, 1.0),
    (&[PULLEY], Property::Pulley, 1.0),
];
const DRUM: &[&str] = &["drum", "spool", "trommel"];
const RADIUS: &[&str] = &["radi"];
const DIAMETER: &[&str] = &["diam", "durchm"];
const PLATFORM: &[&str] = &[
    "platform",
    "plattform",
    "effector",
    "effektor",
    "mobile",
    "anlenk",
];
const PULLEY: &[&str] = &[
    "pulley", "rolle", "umlenk", "frame", "rahmen", "gestell", "base", "basis", "eyelet", "öse",
    "anchor",
];
/// Words for the rows of a table.
const ROWS: &[&str] = &["cable", "seil", "rope", "pulley", "rolle"];

/// The positions and sizes of the parts of each cable; each list has one element per cable or is empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PartPlaces {
    /// Names of the cables.
    pub names: Vec<String>,
    /// Points at which the cables come from their pulleys (m); NaN along an axis that is not stated.
    pub pulleys_m: Vec<[f64; 3]>,
    /// Platform anchors (m, platform frame).
    pub platform_m: Vec<[f64; 3]>,
    /// Radii of the pulleys (m).
    pub radii_m: Vec<f64>,
    /// Diameters of the drums (m).
    pub drum_diameters_m: Vec<f64>,
    /// Revolutions of the motors per revolution of the drums.
    pub gear_ratios: Vec<f64>,
}

/// A column of a property of the cables.
struct CableColumn<'s> {
    property: Property,
    /// Axis, or number of the column in its matrix.
    index: usize,
    /// Unit of the column in metres, 1 for a ratio; `None` if the heading does not state it.
    unit: Option<f64>,
    /// Factor from the numbers of the column to the property: 2 from a radius to a diameter.
    ratio: f64,
    values: &'s Values,
}

/// The positions that a file states, and the assumptions about their unit; `None` if it has other content.
pub(crate) fn places_of(source: &Source) -> Option<(PartPlaces, Vec<String>)> {
    let is_short = |table: &&Series| (2..=MAX_CABLES).contains(&table.rows);
    let tables = || source.series.iter().filter(is_short);
    let columns: Vec<CableColumn<'_>> = tables().flat_map(columns).collect();
    let pulleys = columns
        .iter()
        .filter(|column| column.property == Property::Pulley);
    let is_large = |column: &CableColumn<'_>| {
        column
            .values
            .iter()
            .any(|value| value.abs() > LARGEST_IN_METRES)
    };
    let (assumed, unit) = match pulleys.clone().any(is_large) {
        true => (1e-3, "millimetres"),
        false => (1.0, "metres"),
    };
    let pulleys_m = points(&columns, Property::Pulley, assumed)?;
    let count = pulleys_m.len();
    let numbers = |property: Property| -> Vec<f64> {
        let mut own = columns
            .iter()
            .filter(|column| column.property == property && column.values.len() == count);
        own.next()
            .map(|column| column.in_si(assumed))
            .unwrap_or_default()
    };
    // Texts that all differ are names.
    let is_name = |text: &&TextChannel| text.codes.len() == count && text.distinct.len() == count;
    let named = tables().flat_map(|table| &table.texts).find(is_name);
    let name = |text: &TextChannel| (0..count).map(|row| text.at(row).to_owned()).collect();
    let platform_m = points(&columns, Property::Platform, assumed);
    let places = PartPlaces {
        names: named.map(name).unwrap_or_default(),
        platform_m: platform_m
            .filter(|found| found.len() == count)
            .unwrap_or_default(),
        radii_m: numbers(Property::PulleyRadius),
        drum_diameters_m: numbers(Property::DrumDiameter),
        gear_ratios: numbers(Property::GearRatio),
        pulleys_m,
    };
    let is_assumed = columns.iter().any(|column| column.unit.is_none());
    let notice = format!(
        "{}: columns without a unit are taken as {unit}",
        source.file
    );
    let notices = source.notices.iter().cloned();
    Some((
        places,
        notices.chain(is_assumed.then_some(notice)).collect(),
    ))
}

impl CableColumn<'_> {
    fn in_si(&self, assumed: f64) -> Vec<f64> {
        let factor = self.ratio * self.unit.unwrap_or(assumed);
        self.values.iter().map(|value| value * factor).collect()
    }
}

/// The columns of a table that state positions or sizes; none if other columns are numbered, like readings of cables.
fn columns(table: &Series) -> Vec<CableColumn<'_>> {
    let names = || table.channels.iter().map(|channel| &*channel.name);
    // Columns of x, y and z alone are those of the pulleys in a table whose rows are different pulleys or cables.
    let texts = (table.texts.iter()).filter(|text| text.distinct.len() == table.rows);
    let is_counted = |channel: &&Channel| {
        (1..table.rows).all(|row| channel.values.at(row) > channel.values.at(row - 1))
    };
    let counts = table.channels.iter().filter(is_counted);
    let is_of_parts = (texts.map(|text| &text.name))
        .chain(counts.map(|channel| &channel.name))
        .any(|name| has_word(name, ROWS));
    // One letter alone also stands for accelerations.
    let is_symbol = |letter: &str| names().any(|name| symbol_of(name).as_deref() == Some(letter));
    let has_letters = is_symbol("a") && is_symbol("b");
    let column = |channel: &'_ Channel| {
        let name = &channel.name;
        let is_meant = |(words, ..): &&(&[&[&str]], Property, f64)| {
            words.iter().all(|stems| has_word(name, stems))
        };
        match (HEADINGS.iter().find(is_meant), symbol_of(name).as_deref()) {
            (Some((_, property, ratio)), _) => Some((*property, *ratio)),
            (None, Some("a")) if has_letters => Some((Property::Pulley, 1.0)),
            (None, Some("b")) if has_letters => Some((Property::Platform, 1.0)),
            (None, None) if is_of_parts => Some((Property::Pulley, 1.0)),
            _ => None,
        }
    };
    let others = table.channels.iter().filter(|one| column(one).is_none());
    if families(others.map(|one| &*one.name))
        .iter()
        .any(|one| one.count > 1)
    {
        return Vec::new();
    }
    let found = table.channels.iter().filter_map(|channel| {
        let (property, ratio) = column(channel)?;
        let is_point = matches!(property, Property::Pulley | Property::Platform);
        let unit = channel.unit.as_deref().and_then(parse_unit);
        let unit = unit.filter(|unit| unit.dimension == Dimension::Length);
        Some(CableColumn {
            property,
            index: if is_point {
                index_of(&channel.name)?
            } else {
                0
            },
            unit: match property {
                Property::GearRatio => Some(1.0),
                _ => unit.map(|unit| unit.factor),
            },
            ratio,
            values: &channel.values,
        })
    });
    found.collect()
}

fn has_word(name: &str, stems: &[&str]) -> bool {
    let is_meant = |word: &String| stems.iter().any(|stem| word.starts_with(stem));
    words_of(name).iter().any(is_meant)
}

/// The last word of a heading that is neither an axis nor a unit: `a` of `geom.A(:,2)`.
fn symbol_of(name: &str) -> Option<String> {
    let is_symbol = |word: &String| !AXES.contains(&word.as_str()) && parse_unit(word).is_none();
    words_of(name).into_iter().rfind(is_symbol)
}

/// The axis of a heading, or the number from 0 of a column of a matrix: `A(:,2)` of MATLAB and `A[1]` of NumPy have the same.
fn index_of(name: &str) -> Option<usize> {
    let of_word = |word: &String| AXES.iter().position(|axis| axis == word);
    let number = |open: &str, close: &str| {
        let (_, number) = name.strip_suffix(close)?.rsplit_once(open)?;
        number.parse::<usize>().ok()
    };
    let axis = words_of(name).iter().rev().find_map(of_word);
    let of_matlab = || number("(:,", ")")?.checked_sub(1);
    axis.or_else(of_matlab).or_else(|| number("[", "]"))
}

/// The points of a property, one for each cable; matrices may have them in rows or in columns.
fn points(columns: &[CableColumn<'_>], property: Property, assumed: f64) -> Option<Vec<[f64; 3]>> {
    let mut own: Vec<&CableColumn<'_>> = columns
        .iter()
        .filter(|column| column.property == property)
        .collect();
    own.sort_by_key(|column| column.index);
    let rows = own.first()?.values.len();
    let is_turned = own.len() > 3 && rows <= 3;
    let follows =
        |pair: &[&CableColumn<'_>]| pair[0].index < pair[1].index && pair[1].values.len() == rows;
    if own.len() < 2 || (own.len() > 3 && !is_turned) || !own.windows(2).all(follows) {
        return None;
    }
    let values = own
        .iter()
        .map(|column| (column.index, column.in_si(assumed)));
    if is_turned {
        let stated = |axis: usize, values: &[f64]| values.get(axis).copied().unwrap_or(f64::NAN);
        return Some(
            values
                .map(|(_, values)| [0, 1, 2].map(|axis| stated(axis, &values)))
                .collect(),
        );
    }
    let mut points = vec![[f64::NAN; 3]; rows];
    for (axis, values) in values.filter(|(axis, _)| *axis < 3) {
        points
            .iter_mut()
            .zip(values)
            .for_each(|(point, value)| point[axis] = value);
    }
    let count = own.len();
    points.retain(|point| point.iter().filter(|value| value.is_finite()).count() == count);
    Some(points)
}

impl PartPlaces {
    /// The robot with these positions. A platform without anchors is a point; without a third coordinate it moves in the plane.
    /// Winches, home and noise are assumed where they are not stated.
    ///
    /// # Errors
    /// If no robot can have these positions; names `file`.
    pub fn robot(&self, file: &str, mut notices: Vec<String>) -> Result<Loaded<Robot>, ReadError> {
        let normal = (0..3).find(|axis| {
            let points = self.pulleys_m.iter().chain(&self.platform_m);
            let all = || points.clone().map(|point| point[*axis]);
            all().all(|value| value.is_nan())
                || (!self.platform_m.is_empty() && all().all(|value| value == 0.0))
        });
        let is_point = self
            .platform_m
            .iter()
            .flatten()
            .all(|value| value.is_nan() || *value == 0.0);
        let moves = |coordinate: &Coordinate| match (*coordinate as usize, normal) {
            (axis, None) => axis < 3 || !is_point,
            (axis, Some(normal)) if axis < 3 => axis != normal,
            (axis, Some(normal)) => !is_point && axis - 3 == normal,
        };
        let mut platform = Platform::spatial(None);
        platform.free = Coordinate::ALL.into_iter().filter(moves).collect();
        let stated = |point: &[f64; 3]| point.map(|value| if value.is_nan() { 0.0 } else { value });
        let pulleys: Vec<[f64; 3]> = self.pulleys_m.iter().map(stated).collect();
        let mean = |axis: usize| {
            pulleys.iter().map(|point| point[axis]).sum::<f64>() / pulleys.len() as f64
        };
        let middle: [f64; 3] = std::array::from_fn(mean);
        let up = if normal == Some(2) { 1 } else { 2 };
        let cable = |index: usize| {
            let entry_point_m = pulleys[index];
            let mut swivel_axis = [0.0; 3];
            swivel_axis[up] = 1.0_f64.copysign(entry_point_m[up] - middle[up]);
            let radius_m = self.radii_m.get(index).copied().unwrap_or(0.0);
            let guide = Guide {
                entry_point_m,
                swivel_axis,
                radius_m,
            };
            let anchor = self.platform_m.get(index).map_or([0.0; 3], stated);
            let mut cable = cable_of(self.names.get(index).cloned(), index + 1, guide, anchor);
            if let Some(diameter) = self.drum_diameters_m.get(index) {
                cable.winch.drum_diameter_m = *diameter;
            }
            cable.winch.gear_ratio = self.gear_ratios.get(index).copied().unwrap_or(1.0);
            cable
        };
        let mut cables: Vec<Cable> = (0..pulleys.len()).map(cable).collect();
        know_normal_to_plane(&platform, &mut cables);
        notices.push(format!("{file}: the home pose, at which revolutions are 0, is assumed to be about the middle of the frame; correct robot.json"));
        let middle = middle.map(|value| (1e3 * value).round() / 1e3);
        let home = home_at(&pose_of(middle, [0.0; 3]));
        let description = Description {
            platform,
            cables,
            home: None,
            limits: None,
            has_winches: !self.drum_diameters_m.is_empty(),
        };
        let mut read = robot_of(file, description, notices)?;
        let size_m = read.value.frame_size_m().unwrap_or_default();
        read.value.home = Some(Home {
            position_sd_m: HOME_SD * size_m,
            orientation_sd_rad: HOME_ROTATION_SD_RAD,
            ..home
        });
        Ok(read)
    }
}
