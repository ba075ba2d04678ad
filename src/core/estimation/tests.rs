use super::*;
use crate::robot::presets;
use crate::simulation::{SimulationOptions, TrueGeometry, simulate};

fn quiet(_: &Progress) -> Control {
    Control::Continue
}

fn options(preset: &presets::Preset, poses: usize, seed: u64) -> SimulationOptions {
    SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    }
}

#[test]
fn noise_free_data_give_back_the_truth() {
    for name in presets::NAMES {
        let preset = presets::find(name).unwrap();
        for method in [Method::Joint, Method::Simple] {
            let mut o = options(&preset, 30, 5);
            o.noise = false;
            o.geometry = TrueGeometry::Nominal;
            let run = simulate(&preset.robot, &o).unwrap();
            let problem = Problem::new(&run.dataset).unwrap().with_method(method);
            let s = solve(&problem, &Options::default(), &mut quiet).unwrap();
            println!(
                "{name} {method:?} {} it chi2 {:e} dof {} {:?}",
                s.iterations, s.chi2, s.degrees_of_freedom, s.termination
            );
        }
        let run = simulate(&preset.robot, &options(&preset, 30, 5)).unwrap();
        for method in [Method::Joint, Method::Simple] {
            let problem = Problem::new(&run.dataset).unwrap().with_method(method);
            let s = solve(&problem, &Options::default(), &mut |p| {
                println!("  {p:?}");
                Control::Continue
            })
            .unwrap();
            println!(
                "{name} {method:?} {} it chi2 {:.1} dof {} {:?}",
                s.iterations, s.chi2, s.degrees_of_freedom, s.termination
            );
        }
    }
}
