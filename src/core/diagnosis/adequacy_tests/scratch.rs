use super::*;
use super::super::adequacy::adequacy;
use super::super::discrepancy::{dependence_tests, discrepancies};
use super::super::noise::noise_statements;
use crate::estimation::{RowKind, ReadingKind};
use std::time::Instant;
#[test]
fn signs() {
    for name in ["mini","hall"] {
    let run = run_with(name, 60, 31, &[]);
    let preset = presets::find(name).unwrap();
    let options = SimulationOptions { workspace: Some(preset.workspace), tension: Some(preset.tension), noise: false, ..SimulationOptions::new(60, 31) };
    let exact = simulate(&preset.robot, &options).unwrap();
    let f = Fitted::new(&run.dataset);
    let (mut t, mut l, mut c) = (0.0, 0.0, 0.0);
    let (a, b) = (&exact.dataset.measurements, &run.dataset.measurements);
    for (at, r) in f.linear.rows.iter().zip(&f.linear.residual) {
        let Some(row) = at.row else { continue };
        match at.kind {
            RowKind::Tension(k) => t += r * (a.force_n.get(row, k) - b.force_n.get(row, k)) / 2.0 / at.sd,
            RowKind::Reading(ReadingKind::Laser) => l += r * (a.laser_at(row) - b.laser_at(row)) / at.sd,
            RowKind::Reading(ReadingKind::Length(k)) => c += r * (a.revolutions.get(row, k) - b.revolutions.get(row, k)) * 0.05 / at.sd,
            _ => {}
        }
    }
    println!("{name} exact minus reading times residual: tension {t} laser {l} length {c}");
    }
}
#[test]
fn times() {
    for poses in [40, 1000] {
        let run = run_with("mini", poses, 31, &[]);
        let problem = Problem::new(&run.dataset).unwrap();
        let mut quiet = |_: &Progress| Control::Continue;
        let solution = solve(&problem, &Options::default(), &mut quiet).unwrap();
        for _ in 0..2 {
        let t = Instant::now();
        let linear = Linearisation::new(&problem, &solution);
        println!("{poses} linearisation {:?}", t.elapsed());
        let t = Instant::now();
        let space = ResidualSpace::new(&linear);
        println!("space {:?}", t.elapsed());
        let t = Instant::now();
        let a = adequacy(&space, &solution, 0.01);
        println!("adequacy {:?} {}", t.elapsed(), a.groups.len());
        let t = Instant::now();
        let v = Variables::new(&problem, &solution, &linear);
        println!("variables {:?}", t.elapsed());
        let t = Instant::now();
        let d = dependence_tests(&space, &v);
        println!("dependences {:?} {}", t.elapsed(), d.len());
        let t = Instant::now();
        let d = discrepancies(&space, &d, 0.01);
        println!("discrepancies {:?} {:?}", t.elapsed(), d.iter().map(|d|(d.quantity,d.cable,d.variable,d.p_value)).collect::<Vec<_>>());
        let t = Instant::now();
        let n = noise_statements(&space, &d, 0.01);
        println!("noise {:?} {}", t.elapsed(), n.len());
        for g in &a.groups { println!("   {:?} {:?} n {} ratio {:.3} p {:.3}", g.quantity, g.cable, g.readings, g.rms_over_sd, g.p_value); }
        }
    }
}
