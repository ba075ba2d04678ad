//! Lives of simulated robots with known truth. Seeds are fixed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::estimation::{Control, Options, ParameterId, Problem, Solution, solve};
use crate::measurement::Dataset;
use crate::planning::{Volume, position_weights};
use crate::robot::{Robot, presets};
use crate::simulation::{SimulationOptions, TrueGeometry, Workspace, simulate};

/// The robot in each session, and its days.
struct Life {
    drawing: Robot,
    truths: Vec<Robot>,
    days: Vec<f64>,
}

impl Life {
    fn quiet(name: &str, sessions: usize) -> Self {
        let drawing = presets::find(name).unwrap().robot;
        let options = SimulationOptions::new(1, 77);
        let truth = simulate(&drawing, &options).unwrap().truth;
        Self {
            drawing,
            truths: vec![truth; sessions],
            days: (0..sessions).map(|k| 30.0 * k as f64).collect(),
        }
    }

    fn jump(mut self, cable: usize, after: usize, by_m: [f64; 3]) -> Self {
        for truth in &mut self.truths[after + 1..] {
            for (to, by) in truth.cables[cable]
                .pulley
                .entry_point_m
                .iter_mut()
                .zip(by_m)
            {
                *to += by;
            }
        }
        self
    }

    fn drift(mut self, cable: usize, per_day_m: [f64; 3]) -> Self {
        for (truth, days) in self.truths.iter_mut().zip(&self.days) {
            for (to, rate) in truth.cables[cable]
                .pulley
                .entry_point_m
                .iter_mut()
                .zip(per_day_m)
            {
                *to += rate * days;
            }
        }
        self
    }

    /// Measures the robot in each session.
    fn measured(&self, poses: usize, seed: u64) -> Vec<Dataset> {
        let preset = presets::find(&self.drawing.name).unwrap();
        let measured = |(k, truth): (usize, &Robot)| {
            let options = SimulationOptions {
                geometry: TrueGeometry::Nominal,
                workspace: Some(preset.workspace),
                tension: Some(preset.tension),
                ..SimulationOptions::new(poses, seed + k as u64)
            };
            Dataset {
                robot: self.drawing.clone(),
                measurements: simulate(truth, &options).unwrap().dataset.measurements,
            }
        };
        self.truths.iter().enumerate().map(measured).collect()
    }

    fn history(&self, poses: usize, seed: u64) -> History {
        self.with_last(poses, seed, |history, _| history.clone())
    }

    /// A result from the history and the last session.
    fn with_last<T>(
        &self,
        poses: usize,
        seed: u64,
        then: impl FnOnce(&History, Identified<'_>) -> T,
    ) -> T {
        let datasets = self.measured(poses, seed);
        let solved: Vec<(Problem<'_>, Solution)> = datasets
            .iter()
            .map(|dataset| {
                let problem = Problem::new(dataset).unwrap();
                let solution =
                    solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
                assert!(solution.converged());
                (problem, solution)
            })
            .collect();
        let runs: Vec<DatedRun<'_>> = solved
            .iter()
            .zip(&self.days)
            .map(|((problem, solution), days)| DatedRun {
                run: Identified { problem, solution },
                days: *days,
                follows_event: false,
            })
            .collect();
        then(&smooth(&runs).unwrap(), runs[runs.len() - 1].run)
    }
}

fn certain_jumps(history: &History) -> Vec<(usize, [usize; 2])> {
    let certain = history
        .jumps
        .iter()
        .filter(|jump| jump.probability >= CERTAIN);
    certain.map(|jump| (jump.part, jump.between)).collect()
}

#[test]
fn nothing_is_found_in_a_quiet_life() {
    for (name, seed) in [("mini", 100), ("hall", 200), ("planar", 300)] {
        let history = Life::quiet(name, 6).history(25, seed);
        let jumps = history.jumps.iter().map(|jump| jump.probability);
        let drifts = history.evident_drifts().map(|drift| drift.probability);
        // What is possible may be listed, but nothing is more probable than not.
        let largest = jumps.chain(drifts).fold(0.0, f64::max);
        assert!(largest < 0.5, "{name}: {history:?}");
    }
}

#[test]
fn a_moved_pulley_is_found_and_dated() {
    let life = Life::quiet("mini", 6).jump(2, 3, [5e-3, -4e-3, 3e-3]);
    let history = life.history(25, 400);
    assert_eq!(
        certain_jumps(&history),
        [(2, [3, 4])],
        "{:?}",
        history.jumps
    );
    let jump = &history.jumps[0];
    let off = &jump.size - DVector::from_vec(vec![5e-3, -4e-3, 3e-3]);
    let chi2 = off.dot(&jump.covariance.clone().cholesky().unwrap().solve(&off));
    // The probability of a larger value is 1e-3.
    assert!(chi2 < 16.3, "{chi2}");
    assert_eq!(history.evident_drifts().count(), 0, "{:?}", history.drifts);
}

#[test]
fn a_drift_is_no_jump() {
    let rate = [6e-5, 0.0, -6e-5];
    let history = Life::quiet("mini", 10).drift(5, rate).history(25, 500);
    assert_eq!(certain_jumps(&history), [], "{:?}", history.jumps);
    let [drift] = history.evident_drifts().collect::<Vec<_>>()[..] else {
        panic!("{:?}", history.drifts);
    };
    assert!(drift.part == 5 && drift.probability > CERTAIN, "{drift:?}");
    let off = &drift.rate - DVector::from_row_slice(&rate);
    let chi2 = off.dot(&drift.covariance.clone().cholesky().unwrap().solve(&off));
    assert!(chi2 < 16.3, "{chi2}");
    let due = |limit_m: f64| forecast(&history, Tolerance::Pulley(limit_m)).unwrap();
    let found = due(4e-3);
    // 4 mm at 2.5 mm a month are reached after 47 days; a jump may come before.
    let days = found.due_days.unwrap();
    assert!((10.0..47.0).contains(&days), "{found:?}");
    let [from, to] = found.interval_days.map(Option::unwrap);
    assert!(from < days && days < to, "{found:?}");
    assert!(due(8e-3).due_days.unwrap() > days);
}

#[test]
fn the_position_of_the_platform_leaves_its_tolerance_when_a_drifting_pulley_has_moved_it() {
    let rate = [2e-4, 0.0, -2e-4];
    let life = Life::quiet("mini", 10).drift(5, rate);
    life.with_last(40, 700, |history, last| {
        let robot = &last.problem.dataset.robot;
        let parameters = &last.solution.parameters;
        let weights = position_weights(robot, &Workspace::of(robot), parameters).unwrap();
        let along = |k: usize| match parameters[k].id {
            ParameterId::EntryPoint { cable: 5, axis } => rate[axis],
            _ => 0.0,
        };
        let drift = DVector::from_iterator(parameters.len(), (0..parameters.len()).map(along));
        let per_day = drift.dot(&(&weights * &drift)).sqrt();
        let covariance = last.solution.covariance.as_ref().unwrap();
        let uncertain_m = weights.dot(covariance).sqrt();
        let due = |limit_m: f64, volume: Option<Volume>| {
            let tolerance = Tolerance::Position {
                limit_m,
                volume,
                last,
            };
            forecast(history, tolerance).unwrap()
        };
        let limit_m = 5.0 * uncertain_m;
        let found = due(limit_m, None);
        assert!(found.at_once < 1e-3, "{found:?}");
        // The drift alone takes this long; uncertain values and jumps come on top.
        let days = found.due_days.unwrap();
        let alone = limit_m / per_day;
        assert!((0.3 * alone..alone).contains(&days), "{days} of {alone}");
        assert!(due(2.0 * limit_m, None).due_days.unwrap() > days);
        assert!(due(0.5 * uncertain_m, None).at_once > 0.5);
        // Lengths count from home, so that errors are small about it.
        let home = robot.home.unwrap().position_m;
        let at_home = Volume {
            low_m: home,
            high_m: home,
        };
        assert!(
            due(limit_m, Some(at_home))
                .due_days
                .is_none_or(|later| later > days)
        );
    });
}

#[test]
fn without_a_home_pose_no_position_error_is_predicted() {
    let life = Life::quiet("mini", 2);
    life.with_last(25, 800, |history, last| {
        let mut dataset = last.problem.dataset.clone();
        dataset.robot.home = None;
        let problem = Problem::new(&dataset).unwrap();
        let tolerance = Tolerance::Position {
            limit_m: 1e-3,
            volume: None,
            last: Identified {
                problem: &problem,
                solution: last.solution,
            },
        };
        assert_eq!(forecast(history, tolerance), Err(NoPositionError));
    });
}

#[test]
fn sessions_are_checked() {
    let life = Life::quiet("planar", 2);
    let datasets = life.measured(12, 600);
    let problems: Vec<Problem<'_>> = datasets.iter().map(|d| Problem::new(d).unwrap()).collect();
    let solutions: Vec<Solution> = problems
        .iter()
        .map(|p| solve(p, &Options::default(), &mut |_| Control::Continue).unwrap())
        .collect();
    let run = |k: usize, days: f64| DatedRun {
        run: Identified {
            problem: &problems[k],
            solution: &solutions[k],
        },
        days,
        follows_event: false,
    };
    assert_eq!(smooth(&[run(0, 0.0)]), Err(HistoryError::TooFew(1)));
    let disordered = smooth(&[run(0, 5.0), run(1, 0.0)]);
    assert_eq!(disordered, Err(HistoryError::Disordered(2)));
}

/// Values in all sessions of lives with random jumps and drifts lie within their intervals as often as stated, in the datum of the
/// first session.
#[test]
fn smoothed_values_and_changes_are_as_certain_as_stated() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut inside, mut all) = (0, 0);
    let (mut found, mut false_jumps, mut hidden) = (0, 0, 0);
    for seed in 0..12 {
        let cable = rng.random_range(0..8);
        let after = rng.random_range(0..7);
        let by_m: [f64; 3] = std::array::from_fn(|_| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            4e-3 * normal
        });
        let other = (cable + rng.random_range(1..8)) % 8;
        let rate: [f64; 3] = std::array::from_fn(|_| rng.random_range(-4e-5..4e-5));
        let life = Life::quiet("mini", 8)
            .jump(cable, after, by_m)
            .drift(other, rate);
        let history = life.history(25, 1000 + 20 * seed);
        hidden += 1;
        for (part, between) in certain_jumps(&history) {
            let is_right = part == cable && between[0] <= after && after < between[1];
            found += u32::from(is_right);
            false_jumps += u32::from(!is_right);
        }
        for (part, states) in history.states.iter().enumerate().take(8) {
            for (session, state) in states.iter().enumerate() {
                let truth = life.truths[session].cables[part].pulley.entry_point_m;
                let first = life.truths[0].cables[part].pulley.entry_point_m;
                // Relative to the first session, in which the datum is.
                let change = &state.value - &states[0].value;
                for axis in 0..3 {
                    let sd = state.covariance[(axis, axis)].sqrt();
                    let off = change[axis] - (truth[axis] - first[axis]);
                    inside += u32::from(off.abs() < 1.96 * sd);
                    all += 1;
                }
            }
        }
    }
    println!("inside {inside} of {all}, found {found} of {hidden}, false {false_jumps}");
    assert!(
        found >= 10 && false_jumps == 0,
        "{found} of {hidden}, {false_jumps} false"
    );
    // The changes are smaller than the values are uncertain, so that more than 95 % are expected.
    assert!(
        f64::from(inside) > 0.95 * f64::from(all),
        "{inside} of {all}"
    );
}
