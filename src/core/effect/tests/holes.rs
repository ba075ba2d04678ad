//! Missing readings: hidden effects are found nevertheless, and effects that no reading shows are rejected.

use rand::RngExt;

use super::recovery::{equipped, hide, request, typical};
use crate::effect::{CATALOGUE, EffectSetting};
use crate::estimation::{Control, EstimationError, Options, ParameterId, Problem, Solution, solve};
use crate::kinematics::samples::generator;
use crate::measurement::{Dataset, Measurements};
use crate::robot::{PerAxis, Robot, Tracker};

/// A cell that no effect of [`typical`] names: not the target, not the pose of an event.
const ROW: usize = 12;
const CABLE: usize = 1;
/// The cable to which effects are attached.
const TARGET: usize = 2;
/// Random cells that are emptied together.
const SCATTERED: usize = 10;

/// Kinds of readings, taken once per cable or per axis of an instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Length,
    Force,
    Laser,
    Swivel,
    Inclination,
    Tracker,
}

impl Quantity {
    const ALL: [Self; 6] = [
        Self::Length,
        Self::Force,
        Self::Laser,
        Self::Swivel,
        Self::Inclination,
        Self::Tracker,
    ];

    /// Number of its columns.
    fn columns(self, cables: usize) -> usize {
        match self {
            Self::Length | Self::Force | Self::Swivel => cables,
            Self::Laser => 1,
            Self::Inclination | Self::Tracker => 3,
        }
    }

    fn empty(self, data: &mut Measurements, (row, column): (usize, usize)) {
        match self {
            Self::Length if data.revolutions.is_empty() => data.length_m.set(row, column, f64::NAN),
            Self::Length => data.revolutions.set(row, column, f64::NAN),
            Self::Force => data.force_n.set(row, column, f64::NAN),
            Self::Laser => data.laser_m[row] = f64::NAN,
            Self::Swivel => data.swivel_rad.set(row, column, f64::NAN),
            Self::Inclination => data.inclination_rad[row][column] = f64::NAN,
            Self::Tracker => data.tracked_position_m[row][column] = f64::NAN,
        }
    }
}

/// Cells `(row, column)` that are emptied, by a name; the home row is left whole.
fn holes(
    quantity: Quantity,
    robot: &Robot,
    rows: usize,
) -> Vec<(&'static str, Vec<(usize, usize)>)> {
    let columns = quantity.columns(robot.cable_count());
    let column = CABLE.min(columns - 1);
    let mut rng = generator(77);
    let scattered =
        (0..SCATTERED).map(|_| (rng.random_range(1..rows), rng.random_range(0..columns)));
    vec![
        ("a cell", vec![(ROW, column)]),
        ("a cell of the target", vec![(ROW, TARGET.min(columns - 1))]),
        ("scattered cells", scattered.collect()),
        ("a row", (0..columns).map(|k| (ROW, k)).collect()),
        ("a column", (1..rows).map(|row| (row, column)).collect()),
    ]
}

/// Effects that act at the measured value of an instrument: where a reading is missing, its substitute is not exact, and
/// neither is the found size.
fn is_approximate(id: &str, quantity: Quantity) -> bool {
    match quantity {
        Quantity::Force => ["frame_compliance", "cable_stiffening"].contains(&id),
        Quantity::Inclination => id == "inclinometer_tilt",
        Quantity::Laser => id == "laser_cyclic",
        _ => false,
    }
}

/// MINI with every instrument.
fn robot_with_all() -> Robot {
    let mut robot = equipped("mini");
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-6),
        orientation_sd_rad: None,
    });
    robot
}

fn fit(dataset: &Dataset, setting: &EffectSetting) -> Result<Solution, EstimationError> {
    let mut problem = Problem::new(dataset).unwrap();
    problem.free(&[request(setting)]).unwrap();
    solve(&problem, &Options::default(), &mut |_| Control::Continue)
}

/// Largest difference between hidden and found values, relative to the hidden value; `None` if the remaining readings do not
/// determine it to a thousandth.
fn largest_error(setting: &EffectSetting, solution: &Solution) -> Option<f64> {
    let found = &solution.globals.effects[0];
    let estimated = solution.parameters.iter().enumerate();
    let mut largest = 0.0_f64;
    for (index, parameter) in estimated {
        let ParameterId::Effect { parameter, .. } = parameter.id else {
            continue;
        };
        let truth = setting.parameters[found.effect.parameters()[parameter].name];
        if solution.standard_deviation(index)? > 1e-3 * truth.abs() {
            return None;
        }
        largest = largest.max((found.values[parameter] - truth).abs() / truth.abs());
    }
    Some(largest)
}

/// Empties every pattern of cells of a run with each effect hidden; returns the number of fits that found the effect.
fn check_holes(robot: &Robot, ids: impl Iterator<Item = &'static str>) -> usize {
    let mut checked = 0;
    for setting in ids.map(typical) {
        let run = hide(robot, std::slice::from_ref(&setting));
        for quantity in Quantity::ALL {
            for (name, cells) in holes(quantity, robot, run.dataset.measurements.len()) {
                let mut dataset = run.dataset.clone();
                for cell in cells {
                    quantity.empty(&mut dataset.measurements, cell);
                }
                let case = format!("{}, {name} of {quantity:?} missing", setting.effect);
                let is_blind = setting.effect == "heading_offset" || quantity == Quantity::Laser;
                let solution = match fit(&dataset, &setting) {
                    Err(EstimationError::Unobservable(id)) if is_blind && name == "a column" => {
                        assert_eq!(id, setting.effect, "{case}");
                        continue;
                    }
                    fitted => fitted.unwrap(),
                };
                assert!(solution.converged(), "{case}: {:?}", solution.termination);
                let Some(error) = largest_error(&setting, &solution) else {
                    continue;
                };
                assert!(solution.iterations > 0, "{case}: no step");
                let allowed = if is_approximate(&setting.effect, quantity) {
                    0.05
                } else {
                    1e-6
                };
                assert!(
                    error < allowed,
                    "{case}: off by {error:e}, chi2 {:e}",
                    solution.chi2
                );
                checked += 1;
            }
        }
    }
    checked
}

#[test]
fn every_effect_is_found_whatever_is_missing() {
    let estimable = CATALOGUE.iter().filter(|effect| effect.is_estimable());
    let checked = check_holes(&robot_with_all(), estimable.map(|effect| effect.id()));
    assert!(checked > 1000, "{checked}");
}

#[test]
fn effects_are_found_in_absolute_lengths_of_which_some_are_missing() {
    let mut robot = robot_with_all();
    robot.home = None;
    let ids = [
        "winch_scale",
        "winch_scale_common",
        "winch_offset",
        "cable_slip",
        "frame_shift",
    ];
    check_holes(&robot, ids.into_iter());
}

#[test]
fn an_effect_that_no_reading_shows_is_refused() {
    let mut robot = robot_with_all();
    robot.home = None;
    let whole = hide(&robot, &[]).dataset;
    let refusal = |dataset: &Dataset, id: &str| fit(dataset, &typical(id)).unwrap_err().to_string();
    assert_eq!(
        refusal(&whole, "drum_growth"),
        "effect \"drum_growth\" cannot be estimated: none of the readings depends on it"
    );
    let mut blind = whole.clone();
    blind.measurements.laser_m.fill(f64::NAN);
    assert!(refusal(&blind, "laser_scale").contains("\"laser_scale\""));
    // An outlier in a cell that is empty.
    let mut blind = whole;
    let labels = &blind.measurements.labels;
    let row = labels.iter().position(|label| *label == 17).unwrap();
    blind.measurements.length_m.set(row, TARGET, f64::NAN);
    assert!(refusal(&blind, "encoder_outlier").contains("\"encoder_outlier\""));
}
