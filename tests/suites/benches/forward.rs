//! Time of one forward kinematics solve on one core: `cargo bench -p tautline-validation --bench forward`.

use std::hint::black_box;
use std::time::Instant;

use tautline_core::geometry::{Pose, Twist};
use tautline_core::kinematics::{ForwardKinematics, ForwardSolution, inverse_kinematics};
use tautline_core::robot::{Robot, presets};

/// Poses per run and runs of which the median is taken.
const POSES: usize = 500;
const RUNS: usize = 41;

/// MINI with all anchors on the lines to their pulleys, so that lengths are nearly independent of the rotation about z.
fn in_line(mut robot: Robot) -> Robot {
    for cable in &mut robot.cables[4..] {
        cable.platform_anchor_m[0] = -cable.platform_anchor_m[0];
    }
    robot
}

/// Numbers in (-1, 1), the same in every run (Knuth's multiplicative generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn twist(&mut self, position_m: f64, rotation_rad: f64) -> Twist {
        Twist::from_fn(|k, _| self.next() * if k < 3 { position_m } else { rotation_rad })
    }
}

/// One solve: lengths, true pose and a start a few millimetres away.
struct Case {
    lengths: Vec<f64>,
    pose: Pose,
    near: Pose,
}

fn cases(robot: &Robot, rotation_rad: f64) -> Vec<Case> {
    let mut numbers = Numbers(1);
    let mut cases = Vec::new();
    while cases.len() < POSES {
        let pose = Pose::identity().perturbed(&numbers.twist(0.15, rotation_rad));
        let Ok(states) = inverse_kinematics(robot, &pose) else {
            continue;
        };
        cases.push(Case {
            lengths: states.iter().map(|state| state.length_m).collect(),
            pose,
            near: pose.perturbed(&numbers.twist(0.003, 0.01)),
        });
    }
    cases
}

/// Prints medians over the runs of the mean time per pose, and of the time of the slowest pose.
fn measure(name: &str, cases: &[Case], solve: impl Fn(&Case) -> ForwardSolution) {
    let mut means = Vec::new();
    for _ in 0..RUNS {
        let begin = Instant::now();
        for case in cases {
            black_box(solve(black_box(case)));
        }
        means.push(begin.elapsed().as_secs_f64() / cases.len() as f64);
    }
    let mut single: Vec<f64> = cases.iter().map(|case| time_one(case, &solve)).collect();
    let found: Vec<ForwardSolution> = cases.iter().map(&solve).collect();
    let right = found
        .iter()
        .zip(cases)
        .filter(|(f, c)| f.converged && f.pose.difference(&c.pose).norm() < 1e-8)
        .count();
    let average = |get: &dyn Fn(&ForwardSolution) -> usize| {
        found.iter().map(get).sum::<usize>() as f64 / found.len() as f64
    };
    means.sort_by(f64::total_cmp);
    single.sort_by(f64::total_cmp);
    println!(
        "{name:28} mean {:6.2} us, median pose {:6.2} us, 99 % {:6.2} us; {:4.1} steps, {:4.2} starts; {right} of {} right",
        means[means.len() / 2] * 1e6,
        single[single.len() / 2] * 1e6,
        single[single.len() * 99 / 100] * 1e6,
        average(&|f| f.iterations),
        average(&|f| f.starts_used),
        cases.len(),
    );
}

/// Median time of one pose over batches of twenty solves, so that the clock does not count.
fn time_one(case: &Case, solve: &impl Fn(&Case) -> ForwardSolution) -> f64 {
    let mut times: Vec<f64> = (0..9)
        .map(|_| {
            let begin = Instant::now();
            for _ in 0..20 {
                black_box(solve(black_box(case)));
            }
            begin.elapsed().as_secs_f64() / 20.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let Some(mini) = presets::find("mini").map(|preset| preset.robot) else {
        println!("the preset mini is missing");
        return;
    };
    let in_line = in_line(mini.clone());
    for (name, robot) in [("mini", &mini), ("mini, anchors in line", &in_line)] {
        let Ok(solver) = ForwardKinematics::new(robot) else {
            println!("{name} has no forward kinematics");
            continue;
        };
        for rotation_rad in [0.1, 0.5] {
            println!("{name}: poses within 0.15 m and {rotation_rad} rad per axis");
            let cases = cases(robot, rotation_rad);
            measure("  warm (3 mm, 10 mrad off)", &cases, |c| {
                solver.solve(&c.lengths, &c.near)
            });
            measure("  cold (workspace centre)", &cases, |c| {
                solver.solve_from_anywhere(&c.lengths)
            });
        }
    }
}
