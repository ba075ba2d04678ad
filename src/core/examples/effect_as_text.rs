//! Compares the time of an identification with an effect of the catalogue and with the same effect as text.
//!
//! `cargo run --release -p tautline-core --example effect_as_text`

use std::error::Error;
use std::time::Instant;

use tautline_core::effect::{EffectRequest, Hypothesis, every_effect};
use tautline_core::estimation::{Control, Options, Problem, solve};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};

/// Number of solutions of each kind, of which the fastest counts.
const SOLUTIONS: usize = 40;
/// Number of poses.
const POSES: usize = 41;

fn main() -> Result<(), Box<dyn Error>> {
    let mini = presets::find("mini").ok_or("there is no such preset")?;
    let options = SimulationOptions {
        workspace: Some(mini.workspace),
        tension: Some(mini.tension),
        ..SimulationOptions::new(POSES, 1)
    };
    let mut dataset = simulate(&mini.robot, &options)?.dataset;
    let mut worst = 0.0_f64;
    for effect in every_effect().filter(|effect| effect.is_estimable() && !effect.is_in_motion()) {
        let Ok(text) = effect.as_text(&mini.robot) else {
            continue;
        };
        let hypothesis = Hypothesis::parse(&text)?;
        let given = match effect.pose_parameter() {
            Some(_) => ":pose=20",
            None => "",
        };
        let requests = [effect.id(), hypothesis.id()].map(|id| format!("{id}{given}"));
        dataset.robot.hypotheses = vec![text];
        // Instruments that this robot does not have cannot show their effects.
        if seconds(&dataset, &requests[0]).is_err() {
            continue;
        }
        let mut fastest = [f64::INFINITY; 2];
        // In turns, so that other load on the computer slows both equally.
        for _ in 0..SOLUTIONS {
            for (fastest, request) in fastest.iter_mut().zip(&requests) {
                *fastest = fastest.min(seconds(&dataset, request)?);
            }
        }
        let ratio = fastest[1] / fastest[0];
        worst = worst.max(ratio);
        let [catalogue, text] = fastest.map(|seconds| 1e3 * seconds);
        println!(
            "{:20} {catalogue:8.3} ms {text:8.3} ms as text: {ratio:.2}",
            effect.id()
        );
    }
    println!("largest ratio {worst:.2}");
    Ok(())
}

/// Time of the solution with an effect freed (s), the setup of the problem included.
fn seconds(dataset: &Dataset, request: &str) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    let mut problem = Problem::new(dataset)?;
    problem.free(&[EffectRequest::parse(request)?])?;
    solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
    Ok(start.elapsed().as_secs_f64())
}
