//! Every derivative of every row against central differences.

use super::super::evaluator::{Equations, Evaluator, Layout};
use super::super::home::HomeRow;
use super::ports::{Traits, every_effect, sample, set_in_motion, set_lengths};
use super::*;
use crate::geometry::{Coordinate, Pose, Twist};

/// Step of the differences. All parameters are scaled to be of about unit size, so the truncated term is
/// of the order 1e-10 of a derivative; rounding is as much.
const STEP: f64 = 1e-5;
/// Allowed deviation relative to the largest derivative of the row: a thousand times the error of
/// the differences, and far below what a wrong term would cause.
const TOLERANCE: f64 = 1e-7;

/// Point at which the equations of one row are evaluated.
#[derive(Clone)]
struct Point {
    globals: Globals,
    pose: Pose,
    home_lengths: Vec<f64>,
}

fn evaluate(problem: &Problem<'_>, row: usize, at: &Point) -> (Equations<f64>, Layout) {
    let mut evaluator = Evaluator::<f64>::new((), problem, &at.globals, vec![row], &[at.pose]);
    evaluator.set_globals(&at.globals, Some(&at.home_lengths));
    let layout = evaluator.layout.clone();
    (evaluator.equations_at(0).clone(), layout)
}

impl Point {
    fn moved(&self, layout: &Layout, column: usize, step: f64) -> Self {
        let mut moved = self.clone();
        if column < layout.plane_column() {
            let (cable, axis) = (column / 4, column % 4);
            match axis {
                3 => moved.home_lengths[cable] += step,
                _ => moved.globals.entry_points[cable][axis] += step,
            }
        } else if column == layout.plane_column() {
            moved.globals.plane_offset_m += step;
        } else {
            let (effect, parameter) = layout.effect_parameters[column - layout.effect_column()];
            moved.globals.effects[effect].values[parameter] += step;
        }
        moved
    }

    fn turned(&self, coordinate: Coordinate, step: f64) -> Self {
        let mut twist = Twist::zeros();
        twist[coordinate.index()] = step;
        Self {
            pose: self.pose.perturbed(&twist),
            ..self.clone()
        }
    }
}

/// Size of a column's parameter, so that a step of it is small.
fn scale_of(problem: &Problem<'_>, layout: &Layout, column: usize) -> f64 {
    let Some(index) = column.checked_sub(layout.effect_column()) else {
        return 1.0;
    };
    let (effect, parameter) = layout.effect_parameters[index];
    let parameter = &problem.free_effects[effect].effect.parameters()[parameter];
    if parameter.name == "any" {
        1.0
    } else {
        parameter.prior_sd
    }
}

fn derivative(equations: &Equations<f64>, layout: &Layout, row: usize, column: usize) -> f64 {
    let kind = layout.kinds[row];
    if let ObservationKind::Equilibrium(axis) = kind {
        return equations.equilibrium_by_column[column][axis.index()];
    }
    if column >= layout.effect_column() {
        return equations.by_effect_column(layout, row, column);
    }
    let (cable, axis) = (column / 4, column % 4);
    match kind {
        ObservationKind::Laser if column == layout.plane_column() => equations.laser_by_plane,
        ObservationKind::Length(own) if own == cable => equations.length_by_cable[cable][axis],
        ObservationKind::Swivel(own) if own == cable => equations.swivel_by_cable[cable][axis],
        _ => 0.0,
    }
}

fn check_rows(name: &str, exact: &[f64], plus: &[f64], minus: &[f64], step: f64, scales: &[f64]) {
    for row in 0..exact.len() {
        let numeric = (plus[row] - minus[row]) / (2.0 * step);
        let off = (exact[row] - numeric).abs();
        assert!(
            off < TOLERANCE * scales[row],
            "{name}, row {row}: {} instead of {numeric}",
            exact[row]
        );
    }
}

fn check_all(traits: Traits) {
    check_in_state(traits, false);
    check_in_state(traits, true);
}

/// At rest or in motion.
fn check_in_state(traits: Traits, moves: bool) {
    let (mut dataset, poses) = sample(traits);
    if moves {
        set_in_motion(&mut dataset, traits.seed);
    }
    let effects = every_effect(&dataset.robot);
    set_lengths(&mut dataset, &poses, &effects);
    let mut problem = Problem::new(&dataset).unwrap();
    problem.free_effects = effects;
    let globals = Globals::nominal(&problem);
    let home = match problem.home_row() {
        Some(row) => {
            let mut evaluator = Evaluator::<f64>::home((), &problem, &globals, row);
            check_home(&problem, &globals, &mut evaluator);
            HomeRow::evaluate(&mut evaluator, &problem, &globals, &[], None)
        }
        None => HomeRow::absolute(&problem),
    };
    let row = poses.len() - 1;
    let point = Point {
        globals,
        pose: poses[row],
        home_lengths: home.lengths,
    };
    let (equations, layout) = evaluate(&problem, row, &point);
    assert!(
        equations.present.iter().sum::<f64>() >= (layout.rows - 6 + traits.free.len()) as f64,
        "every row is there"
    );
    let residual = |at: &Point| evaluate(&problem, row, at).0.residual;
    // Columns first, to know the size of each row's derivatives.
    let columns: Vec<Vec<f64>> = (0..layout.columns)
        .map(|c| {
            let scale = scale_of(&problem, &layout, c);
            (0..layout.rows)
                .map(|r| derivative(&equations, &layout, r, c) * scale)
                .collect()
        })
        .collect();
    let by_pose = |r: usize| {
        equations.by_pose[r]
            .iter()
            .fold(0.0_f64, |m, v| m.max(v.abs()))
    };
    let scales: Vec<f64> = (0..layout.rows)
        .map(|r| columns.iter().fold(by_pose(r), |m, c| m.max(c[r].abs())))
        .collect();
    let scales: Vec<f64> = scales.iter().map(|s| s.max(1e-9)).collect();
    for (column, exact) in columns.iter().enumerate() {
        let step = STEP * scale_of(&problem, &layout, column);
        let plus = residual(&point.moved(&layout, column, step));
        let minus = residual(&point.moved(&layout, column, -step));
        let name = format!("{traits:?}, column {column}");
        check_rows(&name, exact, &plus, &minus, STEP, &scales);
    }
    for coordinate in traits.free {
        let exact: Vec<f64> = equations
            .by_pose
            .iter()
            .map(|j| j[coordinate.index()])
            .collect();
        let plus = residual(&point.turned(*coordinate, STEP));
        let minus = residual(&point.turned(*coordinate, -STEP));
        let name = format!("{traits:?}, {coordinate:?}");
        check_rows(&name, &exact, &plus, &minus, STEP, &scales);
    }
    for coordinate in Coordinate::ALL.iter().filter(|c| !traits.free.contains(c)) {
        assert!(
            equations
                .by_pose
                .iter()
                .all(|j| j[coordinate.index()] == 0.0)
        );
    }
}

/// Checks the home row: the lengths and the other rows.
fn check_home(problem: &Problem<'_>, globals: &Globals, evaluator: &mut Evaluator<'_, f64>) {
    let parameters = problem.parameters();
    let mut at =
        |globals: &Globals| HomeRow::evaluate(evaluator, problem, globals, &parameters, None);
    let home = at(globals);
    let n = parameters.len();
    let mut gradients = vec![vec![0.0; n]; home.lengths.len()];
    for (cable, terms) in home.length_gradients.iter().enumerate() {
        for (k, value) in terms {
            gradients[cable][*k] = *value;
        }
    }
    gradients.extend(home.gradients.chunks_exact(n).map(<[f64]>::to_vec));
    let size = |p: &Parameter| match p.id {
        ParameterId::Effect { .. } => p.prior_sd.unwrap(),
        _ => 1.0,
    };
    let scales: Vec<f64> = gradients
        .iter()
        .map(|row| {
            let sized = row
                .iter()
                .zip(&parameters)
                .map(|(g, p)| (g * size(p)).abs());
            sized.fold(1e-9, f64::max)
        })
        .collect();
    let mut values = |k: usize, step: f64| {
        let mut moved = globals.clone();
        let mut change = vec![0.0; n];
        change[k] = step;
        moved.step(problem, &parameters, &change);
        let home = at(&moved);
        [home.lengths, home.residuals].concat()
    };
    for (k, parameter) in parameters.iter().enumerate() {
        let exact: Vec<f64> = gradients
            .iter()
            .map(|row| row[k] * size(parameter))
            .collect();
        let step = STEP * size(parameter);
        let (plus, minus) = (values(k, step), values(k, -step));
        check_rows(&parameter.name, &exact, &plus, &minus, STEP, &scales);
    }
}

const SPATIAL: &[Coordinate] = &Coordinate::ALL;
const PLANAR: &[Coordinate] = &[Coordinate::X, Coordinate::Y, Coordinate::Rz];
const POINT: &[Coordinate] = &[Coordinate::X, Coordinate::Y, Coordinate::Z];
const PLANAR_POINT: &[Coordinate] = &[Coordinate::X, Coordinate::Y];

#[test]
fn derivatives_match_differences_for_all_kinds_of_robots() {
    let kinds = [
        (SPATIAL, 8),
        (PLANAR, 4),
        (POINT, 4),
        (PLANAR_POINT, 3),
        (SPATIAL, 1),
        (POINT, 1),
        (SPATIAL, 3),
        (SPATIAL, 12),
    ];
    for (seed, (free, cables)) in (100..).zip(kinds) {
        for home in [true, false] {
            check_all(Traits {
                free,
                cables,
                home,
                sags: false,
                surface: false,
                seed,
            });
        }
    }
}

#[test]
fn derivatives_match_differences_with_sag_and_measured_elongation() {
    for (seed, (sags, surface)) in (200..).zip([(true, false), (false, true), (true, true)]) {
        for home in [true, false] {
            for free in [SPATIAL, PLANAR] {
                check_all(Traits {
                    free,
                    cables: 6,
                    home,
                    sags,
                    surface,
                    seed,
                });
            }
        }
    }
}
