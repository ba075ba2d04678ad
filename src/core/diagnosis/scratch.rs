use super::*;
use crate::effect::*;
use crate::estimation::Problem;
use crate::robot::presets;
use crate::simulation::{SimulationOptions, simulate};
use rand::{RngExt, SeedableRng};

#[test]
fn scratch() {
    let robots: Vec<String> = std::env::var("ROBOTS")
        .unwrap_or("mini".into())
        .split(',')
        .map(String::from)
        .collect();
    let only = std::env::var("EFFECT").ok();
    let seeds: u64 = std::env::var("SEEDS")
        .ok()
        .and_then(|s| s.parse().ok())
        .unwrap_or(1);
    let poses: usize = std::env::var("POSES")
        .ok()
        .and_then(|s| s.parse().ok())
        .unwrap_or(41);
    let (mut total, mut good, mut seen) = (0, 0, 0);
    for name in &robots {
        let preset = presets::find(name).unwrap();
        for effect in CATALOGUE {
            if only
                .as_ref()
                .is_some_and(|o| !o.split(',').any(|o| o == effect.id()))
            {
                continue;
            }
            for seed in 0..seeds {
                let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed * 1000 + 7);
                let n = preset.robot.cable_count();
                let targets = match effect.scope() {
                    Scope::Robot => vec![],
                    Scope::Cable => vec![rng.random_range(0..n)],
                    Scope::CableOrAll => {
                        if rng.random::<bool>() {
                            vec![]
                        } else {
                            vec![rng.random_range(0..n)]
                        }
                    }
                    Scope::Pair => {
                        let a = rng.random_range(0..n - 1);
                        vec![a, a + 1]
                    }
                };
                let parameters = effect
                    .parameters()
                    .iter()
                    .map(|p| {
                        let v = if p.name == "pose" {
                            f64::from(rng.random_range(8..34))
                        } else if p.typical[0] < 0.0 {
                            p.typical[0] + (p.typical[1] - p.typical[0]) * rng.random::<f64>()
                        } else {
                            let (a, b) = (p.typical[0].ln(), p.typical[1].ln());
                            let v = (a + (b - a) * rng.random::<f64>()).exp();
                            if rng.random::<bool>()
                                || p.name == "period"
                                || p.name == "weight"
                                || p.name == "mu"
                                || p.name == "c"
                            {
                                v
                            } else {
                                -v
                            }
                        };
                        (p.name.to_string(), v)
                    })
                    .collect();
                let setting = EffectSetting {
                    effect: effect.id().into(),
                    targets: targets
                        .iter()
                        .map(|i| preset.robot.cables[*i].name.clone())
                        .collect(),
                    parameters,
                };
                let options = SimulationOptions {
                    workspace: Some(preset.workspace),
                    tension: Some(preset.tension),
                    effects: vec![setting.clone()],
                    ..SimulationOptions::new(poses, seed)
                };
                let Ok(run) = simulate(&preset.robot, &options) else {
                    println!("{name} {} cannot be simulated", effect.id());
                    continue;
                };
                let problem = Problem::new(&run.dataset).unwrap();
                let clock = std::time::Instant::now();
                let selection = selection::select(&problem, &DiagnosisOptions::default()).unwrap();
                let time = clock.elapsed().as_secs_f64();
                let found: Vec<String> = selection
                    .fit
                    .causes
                    .iter()
                    .map(|c| {
                        format!(
                            "{}{:?}{:.2?}",
                            c.effect().id(),
                            c.cables(),
                            c.instances
                                .iter()
                                .flat_map(|i| i.values.clone())
                                .collect::<Vec<_>>()
                        )
                    })
                    .collect();
                let ok = selection.fit.causes.len() == 1
                    && selection.fit.causes[0].effect().id() == effect.id()
                    && selection.fit.causes[0].cables() == targets;
                total += 1;
                if ok {
                    good += 1
                }
                if selection.fit.causes.is_empty() {
                } else {
                    seen += 1
                }
                println!(
                    "{} {name:10} {seed} {}{:?} {:?} | chi2 {:.0}/{:.0} -> {:.0} | {} | {:.0} ms q{}",
                    if ok {
                        "ok "
                    } else if found.is_empty() {
                        "-- "
                    } else {
                        "XX "
                    },
                    effect.id(),
                    targets,
                    setting
                        .parameters
                        .values()
                        .map(|v| format!("{v:.2e}"))
                        .collect::<Vec<_>>()
                        .join(","),
                    selection.base.solution.chi2,
                    selection.base.solution.degrees_of_freedom,
                    selection.fit.solution.chi2,
                    found.join(" + "),
                    time * 1e3,
                    selection.first.questions
                );
            }
        }
    }
    println!("total {total} good {good} found something {seen}");
}
