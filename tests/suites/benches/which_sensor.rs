//! Time of an answer of the screen *Which sensor?* while a slider moves:
//! `cargo bench -p tautline-validation --bench which_sensor`.

use std::hint::black_box;
use std::time::Instant;

use tautline_core::robot::{Robot, presets};
use tautline_study::which_sensor::{Advisor, Question};

/// Answers of which the median is taken.
const ANSWERS: usize = 9;

/// MINI with more cables beside its own.
fn with_cables(count: usize) -> Robot {
    let mut robot = presets::find("mini").expect("a preset").robot;
    let own = robot.cables.len();
    for index in own..count {
        let mut cable = robot.cables[index % own].clone();
        let share = (index / own) as f64 / (count / own) as f64;
        cable.name = format!("cable-{}", index + 1);
        cable.pulley.entry_point_m[1] *= 1.0 - 0.7 * share;
        cable.platform_anchor_m[1] *= 1.0 - 0.7 * share;
        robot.cables.push(cable);
    }
    robot
}

/// Median time of an answer (ms) to questions of which each differs a little from the one before.
fn time_ms(advisor: &Advisor, question: impl Fn(usize) -> Question) -> f64 {
    let mut times: Vec<f64> = (0..ANSWERS)
        .map(|step| {
            let asked = question(step);
            let begin = Instant::now();
            black_box(advisor.answer(&asked).expect("an answer"));
            1e3 * begin.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[ANSWERS / 2]
}

fn main() {
    for cables in [8, 64] {
        let advisor = Advisor::new(&with_cables(cables)).expect("poses");
        let usual = advisor.question();
        let grown = |sd: f64, step: usize| sd * 1.02_f64.powi(1 + step as i32);
        let sliders = [
            time_ms(&advisor, |step| Question {
                laser_sd_m: usual.laser_sd_m.map(|sd| grown(sd, step)),
                ..usual
            }),
            time_ms(&advisor, |step| Question {
                poses: 26 + step,
                ..usual
            }),
            time_ms(&advisor, |step| Question {
                home_sd_m: grown(usual.home_sd_m, step),
                ..usual
            }),
        ];
        let [laser, poses, home] = sliders;
        println!(
            "{cables} cables: laser {laser:.1} ms, poses {poses:.1} ms, home position {home:.1} ms"
        );
    }
}
