//! Faults as they happen in the field: each changes the readings of a sound machine, or its description, in closed form.

use rand::{Rng, RngExt};
use tautline_core::geometry::{Coordinate, Vec3};
use tautline_core::measurement::{Dataset, Measurements};

use super::answer::Right;
use super::machine::{DISTANCES, tape, wind};
use crate::tables::simulated::random_sign;

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    None,
    /// One winch pays out up to 2 % too much.
    Scale,
    /// One cable is longer by a few thousandths of the frame.
    Offset,
    /// One cable slips on its drum.
    Slip,
    /// All winches get new zeros during the session.
    Zeros,
    /// One cable is slack at some poses.
    Slack,
    /// Two channels are exchanged.
    Pair,
    /// Two pairs of channels are exchanged.
    TwoPairs,
    /// One channel has the wrong sign.
    Sign,
    /// One drive counts twice to sixteen times.
    Counts,
    /// All readings of the winches are in another unit.
    Unit,
    /// One cable has a piece that the description does not have.
    Extension,
    /// An encoder loses whole turns.
    LostTurns,
    /// A channel stops.
    Frozen,
    /// An axis of the instrument points the other way.
    Mirrored,
    /// The instrument has another origin.
    OtherOrigin,
    /// All axes of the instrument are stretched alike.
    InstrumentScale,
    /// One axis of the instrument is stretched.
    InstrumentAxis,
    /// The instrument is touched during the session.
    InstrumentMoved,
    /// One position is measured wrong.
    InstrumentOutlier,
    /// The frame is wider or higher than drawn.
    Width,
    /// The frame is turned against its drawing.
    Turn,
    /// One pulley is not where it is drawn.
    OnePulley,
    /// All drums have another diameter than stated.
    OtherDrums,
    /// The rows are there twice.
    RowsTwice,
    /// Nothing, and distances were measured.
    Distances,
    /// The tape is up to 1 % too long or too short.
    TapeScale,
    /// One distance was misread by up to 50 mm.
    Misread,
}

/// All of them with their names in the table.
pub const FAULTS: [(Fault, &str); 28] = [
    (Fault::None, "nothing"),
    (Fault::Scale, "scale of a winch"),
    (Fault::Offset, "offset of a cable"),
    (Fault::Slip, "cable slip"),
    (Fault::Zeros, "new zeros of all winches"),
    (Fault::Slack, "slack cable"),
    (Fault::Pair, "two channels exchanged"),
    (Fault::TwoPairs, "two pairs exchanged"),
    (Fault::Sign, "sign of a channel"),
    (Fault::Counts, "counts of a drive"),
    (Fault::Unit, "unit of all winches"),
    (Fault::Extension, "piece of cable"),
    (Fault::LostTurns, "lost turns"),
    (Fault::Frozen, "channel that stops"),
    (Fault::Mirrored, "axis of the instrument reversed"),
    (Fault::OtherOrigin, "other origin of the instrument"),
    (Fault::InstrumentScale, "scale of the instrument"),
    (Fault::InstrumentAxis, "scale of one axis of the instrument"),
    (Fault::InstrumentMoved, "instrument moved"),
    (Fault::InstrumentOutlier, "position measured wrong"),
    (Fault::Width, "width of the drawing"),
    (Fault::Turn, "turn of the drawing"),
    (Fault::OnePulley, "place of one pulley"),
    (Fault::OtherDrums, "drums of another machine"),
    (Fault::RowsTwice, "rows twice"),
    (Fault::Distances, "nothing, with distances"),
    (Fault::TapeScale, "scale of the tape"),
    (Fault::Misread, "distance misread"),
];

/// Where and when a fault acts.
struct Place {
    cables: Vec<usize>,
    row: usize,
    sign: f64,
}

impl Place {
    fn random(data: &Measurements, cables: usize, rng: &mut impl Rng) -> Self {
        let mut order: Vec<usize> = (0..cables).collect();
        for k in (1..cables).rev() {
            order.swap(k, rng.random_range(0..=k));
        }
        Self {
            cables: order,
            row: rng.random_range(data.len() / 4..3 * data.len() / 4),
            sign: random_sign(rng),
        }
    }
}

/// Adds a length (m) to the readings of a cable from a row on.
fn add_from(dataset: &mut Dataset, cable: usize, row: usize, by_m: f64) {
    wind(dataset, cable, |at, value| {
        value + if at < row { 0.0 } else { by_m }
    });
}

fn column(dataset: &Dataset, cable: usize) -> String {
    let number = cable + 1;
    match dataset.measurements.revolutions.is_empty() {
        true => format!("length_{number}_m"),
        false => format!("rev_{number}"),
    }
}

/// Multiplies the readings of all winches.
fn scale_all(dataset: &mut Dataset, factor: f64) -> Option<Right> {
    let cables = 0..dataset.robot.cable_count();
    for cable in cables.clone() {
        wind(dataset, cable, |_, value| factor * value);
    }
    let columns = cables.map(|cable| column(dataset, cable));
    Some(Right::Mistake(columns.collect()))
}

fn exchange(dataset: &mut Dataset, [a, b]: [usize; 2]) {
    let data = &mut dataset.measurements;
    let grid = match data.revolutions.is_empty() {
        true => &mut data.length_m,
        false => &mut data.revolutions,
    };
    for row in 0..grid.rows() {
        let [of_a, of_b] = [a, b].map(|cable| grid.get(row, cable));
        grid.set(row, a, of_b);
        grid.set(row, b, of_a);
    }
}

/// Puts a fault of a random size into a data set, and returns the right answer; `None` if the machine has not got what it
/// concerns, or the fault cannot be told from nothing.
pub fn put(fault: Fault, dataset: &mut Dataset, rng: &mut impl Rng) -> Option<Right> {
    let count = dataset.robot.cable_count();
    let place = Place::random(&dataset.measurements, count, rng);
    let frame_m = dataset.robot.frame_size_m()?;
    let share = |rng: &mut dyn Rng, from: f64, to: f64| frame_m * rng.random_range(from..to);
    let Place { row, sign, .. } = place;
    let cable = place.cables[0];
    let first = usize::from(dataset.measurements.home_row().is_some());
    let of_one = |effect| Right::Causes(vec![(effect, vec![cable + 1])]);
    let counts_turns = !dataset.measurements.revolutions.is_empty();
    match fault {
        Fault::None => Some(Right::Nothing),
        Fault::Scale => {
            let factor = 1.0 - sign * rng.random_range(0.005..0.02);
            wind(dataset, cable, |_, value| factor * value);
            Some(of_one("winch_scale"))
        }
        Fault::Offset => {
            let by_m = sign * share(rng, 0.003, 0.01);
            add_from(dataset, cable, first, by_m);
            // Two lengths and a frame that nothing fixes do not tell the cables apart.
            let cables = if count > 2 { vec![cable + 1] } else { vec![] };
            Some(Right::Causes(vec![("winch_offset", cables)]))
        }
        Fault::Slip => {
            let by_m = sign * share(rng, 0.002, 0.008);
            add_from(dataset, cable, row, by_m);
            Some(of_one("cable_slip"))
        }
        Fault::Zeros => {
            for cable in 0..count {
                let by_m = random_sign(rng) * share(rng, 0.002, 0.008);
                add_from(dataset, cable, row, by_m);
            }
            let cables = (1..=count).collect();
            Some(Right::Causes(vec![("cable_slip", cables)]))
        }
        // With force readings the tensions of all cables would change.
        Fault::Slack if !dataset.robot.has_force_sensors() => {
            let poses = rng.random_range(2..5);
            let by_m: Vec<f64> = (0..poses).map(|_| share(rng, 0.002, 0.01)).collect();
            wind(dataset, cable, |at, value| {
                let more = at.checked_sub(row).and_then(|k| by_m.get(k));
                value + more.copied().unwrap_or(0.0)
            });
            let labels = &dataset.measurements.labels[row..row + poses];
            Some(Right::Slack(cable + 1, labels.to_vec()))
        }
        Fault::Pair | Fault::TwoPairs => {
            let pairs = if fault == Fault::Pair { 1 } else { 2 };
            let pairs = place.cables.chunks_exact(2).take(pairs);
            let pairs: Vec<[usize; 2]> = pairs.map(|pair| [pair[0], pair[1]]).collect();
            // Exchanged, two of two cables are the mirror image of the machine.
            if count == 2 || (fault == Fault::TwoPairs && pairs.len() < 2) {
                return None;
            }
            let mut columns = Vec::new();
            for pair in pairs {
                exchange(dataset, pair);
                columns.extend(pair.map(|cable| column(dataset, cable)));
            }
            Some(Right::Mistake(columns))
        }
        Fault::Sign => {
            wind(dataset, cable, |_, value| -value);
            Some(Right::Mistake(vec![column(dataset, cable)]))
        }
        Fault::Counts => {
            let factor = [2.0, 4.0, 8.0, 16.0][rng.random_range(0..4)];
            let factor = if sign > 0.0 { factor } else { 1.0 / factor };
            wind(dataset, cable, |_, value| factor * value);
            Some(Right::Mistake(vec![column(dataset, cable)]))
        }
        Fault::Unit => {
            let factor = match counts_turns {
                true => 360.0,
                false => [1e3, 1e2, 1.0 / 0.0254][rng.random_range(0..3)],
            };
            scale_all(dataset, factor)
        }
        Fault::Extension if !counts_turns => {
            let by_m = share(rng, 0.15, 0.4);
            wind(dataset, cable, |_, value| value + by_m);
            Some(Right::Mistake(vec![column(dataset, cable)]))
        }
        Fault::LostTurns if counts_turns => {
            let turns = sign * f64::from(rng.random_range(1..4_u8));
            let by_m = turns * dataset.robot.cables[cable].winch.cable_per_revolution_m();
            // A turn of a small drum is a slip like others.
            if by_m.abs() < 0.01 * frame_m {
                return None;
            }
            add_from(dataset, cable, row, by_m);
            Some(Right::Mistake(vec![column(dataset, cable)]))
        }
        Fault::Frozen => {
            let row = row.min(dataset.measurements.len() - 8);
            let mut last = f64::NAN;
            wind(dataset, cable, |at, value| {
                last = if at < row { value } else { last };
                last
            });
            Some(Right::Mistake(vec![column(dataset, cable)]))
        }
        Fault::Width | Fault::Turn | Fault::OnePulley => {
            let sd_m = dataset.robot.cables[cable].pulley.entry_point_sd_m.each()[0]?;
            if sd_m > 0.02 * frame_m {
                return None;
            }
            redraw(
                fault,
                dataset,
                sign * rng.random_range(10.0..25.0) * sd_m,
                cable,
            )
        }
        Fault::OtherDrums if counts_turns => {
            let factor = 1.0 + sign * rng.random_range(0.1..0.3);
            scale_all(dataset, factor)
        }
        Fault::RowsTwice => {
            let mut again = dataset.measurements.clone();
            again = again.select(&(first..again.len()).collect::<Vec<_>>());
            dataset.measurements.append(again);
            Some(Right::Nothing)
        }
        Fault::Distances => {
            tape(dataset, rng, |_, distance_m| distance_m);
            Some(Right::Nothing)
        }
        Fault::TapeScale => {
            let factor = 1.0 + sign * rng.random_range(0.003..0.01);
            tape(dataset, rng, |_, distance_m| factor * distance_m);
            Some(Right::Causes(vec![("tape_scale", vec![])]))
        }
        Fault::Misread => {
            let wrong = rng.random_range(1..=DISTANCES);
            let by_m = sign * rng.random_range(0.01..0.05);
            tape(dataset, rng, |number, distance_m| {
                distance_m + if number == wrong { by_m } else { 0.0 }
            });
            Some(Right::WrongReading("tape_outlier", wrong as i64))
        }
        Fault::Slack | Fault::Extension | Fault::LostTurns | Fault::OtherDrums => None,
        _ => measure(fault, dataset, &place, rng),
    }
}

/// Displaces the pulleys of the description: along an axis from the middle, about the axis of the plane, or one of them.
fn redraw(fault: Fault, dataset: &mut Dataset, by_m: f64, one: usize) -> Option<Right> {
    // Without a fixed pose and without an instrument the whole machine may be turned.
    if fault == Fault::Turn && dataset.robot.tracker.is_none() && dataset.robot.home.is_none() {
        return None;
    }
    // A spatial frame turns about the vertical, a planar one about its normal.
    let along_y = Coordinate::ALL[1];
    let normal = match dataset.robot.platform.free.contains(&along_y) {
        true => Vec3::z(),
        false => Vec3::y(),
    };
    let cables = &mut dataset.robot.cables;
    let places: Vec<Vec3> = cables
        .iter()
        .map(|c| c.pulley.entry_point_m.into())
        .collect();
    let middle = places.iter().sum::<Vec3>() / places.len() as f64;
    let radius_m = places.iter().map(|at| (at - middle).norm()).sum::<f64>() / places.len() as f64;
    for (cable, pulley) in cables.iter_mut().map(|cable| &mut cable.pulley).enumerate() {
        let out = (places[cable] - middle) / radius_m;
        let by = match fault {
            Fault::Width => Vec3::new(out.x, 0.0, 0.0),
            Fault::Turn => normal.cross(&out),
            _ if cable == one => Vec3::x(),
            _ => Vec3::zeros(),
        };
        let displaced = places[cable] + by_m * by;
        pulley.entry_point_m = displaced.into();
    }
    Some(Right::Drawing(None))
}

/// Faults of the external instrument.
fn measure(
    fault: Fault,
    dataset: &mut Dataset,
    place: &Place,
    rng: &mut impl Rng,
) -> Option<Right> {
    let frame_m = dataset.robot.frame_size_m()?;
    let label = dataset.measurements.labels[place.row];
    let measured = &mut dataset.measurements.tracked_position_m;
    let axes: Vec<usize> = (0..3)
        .filter(|axis| {
            let values = measured.iter().map(|at| at[*axis]);
            let spread = values.clone().fold(f64::NEG_INFINITY, f64::max)
                - values.fold(f64::INFINITY, f64::min);
            spread > 0.01 * frame_m
        })
        .collect();
    if axes.is_empty() {
        return None;
    }
    let axis = axes[rng.random_range(0..axes.len())];
    let mut change = |change: &dyn Fn(usize, usize, f64) -> f64| {
        for (row, at) in measured.iter_mut().enumerate() {
            *at = [0, 1, 2].map(|axis| change(row, axis, at[axis]));
        }
    };
    let Place { row, sign, .. } = *place;
    let by_m = sign * frame_m * rng.random_range(0.002..0.006);
    let stretched = 1.0 + sign * rng.random_range(0.003..0.009);
    let column = ["meas_x_m", "meas_y_m", "meas_z_m"];
    let cause = |effect| Some(Right::Causes(vec![(effect, vec![])]));
    match fault {
        Fault::Mirrored => {
            let mirrored = |value| 0.5 * frame_m - value;
            change(&|_, k, value| if k == axis { mirrored(value) } else { value });
            Some(Right::Mistake(vec![column[axis].to_owned()]))
        }
        Fault::OtherOrigin => {
            change(&|_, k, value| value + if k == axis { 0.4 * frame_m } else { 0.0 });
            Some(Right::Mistake(vec![column[axis].to_owned()]))
        }
        Fault::InstrumentScale => {
            change(&|_, _, value| stretched * value);
            cause("tracker_scale")
        }
        Fault::InstrumentAxis => {
            change(&|_, k, value| if k == axis { stretched * value } else { value });
            cause("tracker_axes")
        }
        Fault::InstrumentMoved => {
            change(&|at, k, value| {
                let is_moved = at >= row && axes.contains(&k);
                let by = if is_moved { [1.0, -0.7, 0.5][k] } else { 0.0 };
                value + by_m * by
            });
            cause("tracker_moved")
        }
        Fault::InstrumentOutlier => {
            let is_wrong = |at, k| at == row && k == axis;
            change(&|at, k, value| value + if is_wrong(at, k) { 3.0 * by_m } else { 0.0 });
            Some(Right::WrongReading("tracker_outlier", label))
        }
        _ => None,
    }
}
