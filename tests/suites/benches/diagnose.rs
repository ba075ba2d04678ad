//! Time of a whole diagnosis on one core: `cargo bench -p tautline-validation --bench diagnose [-- ROBOT]`.

use std::time::Instant;

use anyhow::{Context, Result};
use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_validation::tables::simulated::preset_options;

/// Robots, numbers of poses without home, and most hidden effects.
const CASES: [(&str, usize, usize); 5] = [
    ("mini", 41, 2),
    ("hall", 41, 2),
    ("suspended", 41, 2),
    ("planar", 41, 2),
    ("mini", 1_001, 1),
];
/// Seeds; the time is that of the slowest.
const SEEDS: [u64; 3] = [1, 2, 3];

/// The hidden effects: the scale of one winch, and that of another cable's force sensor.
fn hidden() -> [EffectSetting; 2] {
    let of = |effect: &str, cable: &str, parameter: &str, value| EffectSetting {
        effect: effect.to_owned(),
        targets: vec![cable.to_owned()],
        parameters: [(parameter.to_owned(), value)].into(),
    };
    [
        of("winch_scale", "cable-3", "scale", 0.005),
        of("force_gain", "cable-2", "change", 0.05),
    ]
}

/// Least and largest time (s) over the seeds, and how many effects were found.
fn measure(name: &str, poses: usize, effects: usize) -> Result<(f64, f64, Vec<usize>)> {
    let preset = presets::find(name).with_context(|| format!("no preset {name}"))?;
    let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
    let mut found = Vec::new();
    for seed in SEEDS {
        let mut options = preset_options(&preset, poses, seed);
        options.effects = hidden()[..effects].to_vec();
        let dataset: Dataset = simulate(&preset.robot, &options)?.dataset;
        let begin = Instant::now();
        let options = DiagnosisOptions::default();
        let diagnosis = diagnose(&dataset, &options, &mut |_| Control::Continue)?;
        let seconds = begin.elapsed().as_secs_f64();
        least = least.min(seconds);
        largest = largest.max(seconds);
        found.push(diagnosis.findings.len());
    }
    Ok((least, largest, found))
}

fn main() -> Result<()> {
    // Cargo itself adds --bench.
    let only = std::env::args().skip(1).find(|a| a != "--bench");
    println!("robot      poses  hidden   least s  largest s  findings");
    for (name, poses, most) in CASES {
        if only.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        for effects in 0..=most {
            let (least, largest, found) = measure(name, poses, effects)?;
            println!("{name:9} {poses:>6} {effects:>7} {least:>9.3} {largest:>10.3}  {found:?}");
        }
    }
    Ok(())
}
