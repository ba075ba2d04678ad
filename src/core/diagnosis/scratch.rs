use super::*;
use crate::effect::*;
use crate::robot::presets;
use crate::simulation::{SimulationOptions, simulate};

#[test]
fn scratch() {
    let var = |n: &str| std::env::var(n).unwrap_or_default();
    let mut preset = presets::find(&var("ROBOT")).unwrap();
    match var("VARIANT").as_str() {
        "absolute" => preset.robot.home = None,
        "forceless" => preset
            .robot
            .cables
            .iter_mut()
            .for_each(|c| c.force_sensor = None),
        _ => {}
    }
    let settings: Vec<EffectSetting> = var("HIDE")
        .split(';')
        .filter(|s| !s.is_empty())
        .map(|s| {
            let mut parts = s.split('/');
            EffectSetting {
                effect: parts.next().unwrap().into(),
                targets: parts
                    .next()
                    .unwrap()
                    .split('+')
                    .filter(|t| !t.is_empty())
                    .map(String::from)
                    .collect(),
                parameters: parts
                    .next()
                    .unwrap_or("")
                    .split(',')
                    .filter(|t| !t.is_empty())
                    .map(|p| {
                        let (n, v) = p.split_once('=').unwrap();
                        (n.to_string(), v.parse().unwrap())
                    })
                    .collect(),
            }
        })
        .collect();
    let poses = var("POSES").parse().unwrap_or(41);
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects: settings,
        ..SimulationOptions::new(poses, var("SEED").parse().unwrap())
    };
    let run = simulate(&preset.robot, &options).unwrap();
    let problem = crate::estimation::Problem::new(&run.dataset).unwrap();
    let base = crate::estimation::solve(
        &problem,
        &crate::estimation::Options::default(),
        &mut |_| crate::estimation::Control::Continue,
    )
    .unwrap();
    println!("base {:.1}/{}", base.chi2, base.degrees_of_freedom);
    let problem = problem.at_poses_of(&base);
    let clock = std::time::Instant::now();
    let selection = selection::select(
        &problem,
        &DiagnosisOptions::default(),
        &mut progress::Reporter::new(&mut |_| Control::Continue),
    )
    .unwrap();
    println!("select {:.0} ms", clock.elapsed().as_secs_f64() * 1e3);
    for round in &selection.rounds {
        println!("round q{}", round.questions);
        for c in round.contenders.iter().take(8) {
            println!(
                "   {}{:?} gain {:.1} linear {:.1} freedom {:.1} visible {} p {:.1e} {:.5?} {:?}",
                c.cause().effect().id(),
                c.cause().cables(),
                c.gain,
                c.scored.gain,
                c.freedom,
                c.scored.visible,
                c.p_value(),
                c.cause().instances[0].values,
                c.fit.solution.termination
            );
        }
        if let Ok(id) = std::env::var("SHOW") {
            for s in round
                .scan
                .scored
                .iter()
                .filter(|s| s.cause.effect().id() == id)
            {
                println!(
                    "   scored {}{:?} gain {:.1} freedom {:.1} visible {} {:.5?}",
                    id,
                    s.cause.cables(),
                    s.gain,
                    s.freedom,
                    s.visible,
                    s.cause.instances[0].values
                );
            }
        }
    }
    let clock = std::time::Instant::now();
    let d = diagnose(&run.dataset, &DiagnosisOptions::default(), &mut |_| {
        Control::Continue
    })
    .unwrap();
    println!(
        "diagnose {:.0} ms adequate {}",
        clock.elapsed().as_secs_f64() * 1e3,
        d.base.adequate
    );
    for f in &d.findings {
        println!(
            "{:?} {} | {:?} | {} | {:?} sep {:?}",
            f.verdict,
            f.sentence,
            f.alternatives
                .iter()
                .map(|a| a.effect().id())
                .collect::<Vec<_>>(),
            f.evidence.delta_chi2,
            f.gain,
            f.separation
                .as_ref()
                .map(|s| (s.expected_delta_chi2, &s.advice))
        );
    }
    println!("noise {:?}", d.noise);
}
