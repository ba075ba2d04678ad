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
                    Scope::Robot | Scope::Reading => vec![],
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
                let base = crate::estimation::solve(
                    &problem,
                    &crate::estimation::Options::default(),
                    &mut |_| crate::estimation::Control::Continue,
                )
                .unwrap();
                let problem = problem.at_poses_of(&base);
                let clock = std::time::Instant::now();
                let selection = selection::select(
                    &problem,
                    &DiagnosisOptions::default(),
                    &mut progress::Reporter::new(&mut |_| Control::Continue),
                )
                .unwrap();
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
    if std::env::var("OUTSIDE").is_ok() {
        for name in &robots {
            let preset = presets::find(name).unwrap();
            for kind in 0..8 {
                for seed in 0..seeds {
                    let options = SimulationOptions {
                        workspace: Some(preset.workspace),
                        tension: Some(preset.tension),
                        ..SimulationOptions::new(poses, seed)
                    };
                    let run = simulate(&preset.robot, &options).unwrap();
                    let mut data = run.dataset.clone();
                    let size: f64 = std::env::var("SIZE")
                        .ok()
                        .and_then(|s| s.parse().ok())
                        .unwrap_or(4.0);
                    let m = &mut data.measurements;
                    let c = (seed as usize * 3 + 1) % preset.robot.cable_count();
                    let ls = preset.robot.laser.map_or(0.0, |l| l.sd_m);
                    let es = preset.robot.cables[c].winch.length_sd_m
                        / preset.robot.cables[c].winch.cable_per_revolution_m();
                    let fs = preset.robot.cables[c]
                        .force_sensor
                        .map_or(0.0, |f| f.tension_sd_n * f.tension_gain);
                    let span = |v: &[f64]| {
                        let lo = v.iter().copied().fold(f64::INFINITY, f64::min);
                        let hi = v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                        v.iter()
                            .map(|x| 2.0 * (x - lo) / (hi - lo) - 1.0)
                            .collect::<Vec<_>>()
                    };
                    let x = span(
                        &m.truth
                            .poses
                            .iter()
                            .map(|p| p.position.x)
                            .collect::<Vec<_>>(),
                    );
                    let y = span(
                        &m.truth
                            .poses
                            .iter()
                            .map(|p| p.position.y)
                            .collect::<Vec<_>>(),
                    );
                    let t = span(&m.time_s);
                    let n = m.len();
                    let f: Vec<f64> = (0..n).map(|i| m.force_n.get(i, c)).collect();
                    let f = span(&f);
                    let r: Vec<f64> = (0..n).map(|i| m.revolutions.get(i, c)).collect();
                    let r1 = span(&r);
                    for i in 1..n {
                        match kind {
                            0 => m.laser_m[i] += size * ls * x[i] * x[i],
                            1 => m.revolutions.set(
                                i,
                                c,
                                m.revolutions.get(i, c) + size * es * (5.0 * t[i]).sin(),
                            ),
                            2 => m
                                .force_n
                                .set(i, c, m.force_n.get(i, c) + size * fs * f[i] * f[i]),
                            3 => m.revolutions.set(
                                i,
                                c,
                                m.revolutions.get(i, c) + size * es * (r1[i] * 4.0).sin(),
                            ),
                            4 => m.revolutions.set(
                                i,
                                c,
                                m.revolutions.get(i, c)
                                    + size
                                        * es
                                        * (-((x[i] - 0.4).powi(2) + (y[i] - 0.4).powi(2)) * 8.0)
                                            .exp()
                                        * 2.0,
                            ),
                            5 => m.laser_m[i] += size * ls * (4.0 * t[i]).sin(),
                            6 => m.force_n.set(
                                i,
                                c,
                                m.force_n.get(i, c) + size * fs * (6.0 * t[i]).cos(),
                            ),
                            _ => {
                                for k in 0..preset.robot.cable_count() {
                                    let e = preset.robot.cables[k].winch.length_sd_m
                                        / preset.robot.cables[k].winch.cable_per_revolution_m();
                                    m.revolutions.set(
                                        i,
                                        k,
                                        m.revolutions.get(i, k) + 0.6 * size * e * y[i].powi(2),
                                    )
                                }
                            }
                        }
                    }
                    let problem = Problem::new(&data).unwrap();
                    let base = crate::estimation::solve(
                        &problem,
                        &crate::estimation::Options::default(),
                        &mut |_| crate::estimation::Control::Continue,
                    )
                    .unwrap();
                    let problem = problem.at_poses_of(&base);
                    let clock = std::time::Instant::now();
                    let selection = selection::select(
                        &problem,
                        &DiagnosisOptions::default(),
                        &mut progress::Reporter::new(&mut |_| Control::Continue),
                    )
                    .unwrap();
                    let time = clock.elapsed().as_secs_f64();
                    let found: Vec<String> = selection
                        .fit
                        .causes
                        .iter()
                        .map(|c| {
                            format!(
                                "{}{:?}{}",
                                c.effect().id(),
                                c.cables(),
                                if c.effect().id() == "unknown" {
                                    format!(
                                        "{} {}",
                                        c.instances[0].values[0],
                                        Variable::ALL[c.instances[0].values[1] as usize].name()
                                    )
                                } else {
                                    String::new()
                                }
                            )
                        })
                        .collect();
                    let rank: Vec<String> = selection
                        .rounds
                        .iter()
                        .flat_map(|r| {
                            r.contenders
                                .iter()
                                .filter(|c| c.score() > r.contenders[0].score() - 15.0)
                                .take(4)
                        })
                        .map(|c| {
                            format!(
                                "{}{:?} {:.1}-{:.1}",
                                c.cause().effect().id(),
                                c.cause().cables(),
                                c.gain,
                                c.freedom
                            )
                        })
                        .collect();
                    let ok = found.iter().all(|f| f.starts_with("unknown"));
                    total += 1;
                    if ok && !found.is_empty() {
                        good += 1
                    }
                    if !found.is_empty() {
                        seen += 1
                    }
                    println!(
                        "{} {name:10} {seed} outside {kind} on {c} | chi2 {:.0}/{:.0} -> {:.0} | {}  <{}> {:.0} ms",
                        if ok {
                            if found.is_empty() { "-- " } else { "ok " }
                        } else {
                            "XX "
                        },
                        selection.base.solution.chi2,
                        selection.base.solution.degrees_of_freedom,
                        selection.fit.solution.chi2,
                        found.join(" + "),
                        rank.join(" | "),
                        time * 1e3
                    );
                }
            }
        }
    }
    println!("total {total} good {good} found something {seen}");
}
