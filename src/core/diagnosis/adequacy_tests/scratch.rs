use super::super::adequacy::adequacy;
use super::super::discrepancy::{dependence_tests, discrepancies};
use super::super::noise::noise_statements;
use super::*;
use crate::estimation::{ReadingKind, RowKind};
use std::time::Instant;
#[test]
fn signs() {
    for name in ["mini", "hall"] {
        let run = run_with(name, 60, 31, &[]);
        let preset = presets::find(name).unwrap();
        let options = SimulationOptions {
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            noise: false,
            ..SimulationOptions::new(60, 31)
        };
        let exact = simulate(&preset.robot, &options).unwrap();
        let f = Fitted::new(&run.dataset);
        let (mut t, mut l, mut c) = (0.0, 0.0, 0.0);
        let (a, b) = (&exact.dataset.measurements, &run.dataset.measurements);
        for (at, r) in f.linear.rows.iter().zip(&f.linear.residual) {
            let Some(row) = at.row else { continue };
            match at.kind {
                RowKind::Tension(k) => {
                    t += r * (a.force_n.get(row, k) - b.force_n.get(row, k)) / 2.0 / at.sd
                }
                RowKind::Reading(ReadingKind::Laser) => {
                    l += r * (a.laser_at(row) - b.laser_at(row)) / at.sd
                }
                RowKind::Reading(ReadingKind::Length(k)) => {
                    c += r * (a.revolutions.get(row, k) - b.revolutions.get(row, k)) * 0.05 / at.sd
                }
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
            println!(
                "discrepancies {:?} {:?}",
                t.elapsed(),
                d.iter()
                    .map(|d| (d.quantity, d.cable, d.variable, d.p_value))
                    .collect::<Vec<_>>()
            );
            let t = Instant::now();
            let n = noise_statements(&space, &d, 0.01);
            println!("noise {:?} {}", t.elapsed(), n.len());
            for g in &a.groups {
                println!(
                    "   {:?} {:?} n {} ratio {:.3} p {:.3}",
                    g.quantity, g.cable, g.readings, g.rms_over_sd, g.p_value
                );
            }
        }
    }
}
#[test]
fn many() {
    for name in ["mini", "hall", "planar", "suspended"] {
        let (mut small, mut away, mut n) = (0, 0.0, 0.0);
        let mut dof = 0.0;
        let (mut alarms, mut noise) = (0, 0);
        for seed in 0..600 {
            let run = run_with(name, 30, 90_000 + seed, &[]);
            let f = Fitted::new(&run.dataset);
            let a = adequacy(&f.space, &f.solution, 0.05);
            small += usize::from(!a.adequate);
            away += f.solution.chi2 - f.solution.degrees_of_freedom;
            dof += f.solution.degrees_of_freedom;
            n += 1.0;
            let d = f.discrepancies(0.05);
            alarms += usize::from(!d.is_empty());
            noise += usize::from(!noise_statements(&f.space, &d, 0.05).is_empty());
        }
        println!(
            "{name}: fraction {} mean chi2-dof {:.2} sd {:.2} dof {}; alarms {alarms} noise {noise}",
            f64::from(small as u32) / n,
            away / n,
            away / (2.0 * dof).sqrt(),
            dof / n
        );
    }
}
