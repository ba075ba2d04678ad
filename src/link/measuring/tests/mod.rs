//! Tests of measuring runs on simulated robots.

mod faults;

use tautline_core::effect::{EffectRequest, EffectSetting};
use tautline_core::estimation::{ParameterId, Problem};
use tautline_core::simulation::TensionRange;

use super::*;
use crate::clock::Clock;
use crate::simulated::Fault;
use crate::testing::{
    armed, drive, identified, measured, preset, readings, run_of, solved, warnings,
};

fn labels(events: &[MeasuringEvent]) -> Vec<i64> {
    readings(events).labels
}

fn reason(events: &[MeasuringEvent]) -> String {
    match events.last() {
        Some(MeasuringEvent::Paused { reason, .. } | MeasuringEvent::Failed(reason)) => {
            reason.clone()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn readings_have_the_statistics_of_a_simulated_run() {
    // Chi-square less its degrees of freedom, in standard deviations sqrt(2 dof): beyond 5 with probability below
    // 1e-5 each.
    for name in ["mini", "planar", "hall", "suspended"] {
        let preset = preset(name);
        let (mut robot, clock) = armed(&preset, |_| ());
        let data = measured(&preset, 25, &mut robot, &clock);
        let took_s = clock.now_s();
        let solution = identified(&data);
        let dof = solution.degrees_of_freedom;
        let off = (solution.chi2 - dof) / (2.0 * dof).sqrt();
        assert!(off.abs() < 5.0, "{name}: {} of {dof}", solution.chi2);
        assert!((60.0..180.0).contains(&took_s), "{name}: {took_s} s");
    }
}

#[test]
fn a_hidden_effect_shows_and_is_found() {
    let preset = preset("mini");
    for (effect, targets, parameter, size) in [
        ("winch_scale", vec!["cable-3".to_owned()], "scale", 0.01),
        ("cable_creep", Vec::new(), "c", 0.01),
    ] {
        let (mut robot, clock) = armed(&preset, |setup| {
            setup.truth.effects = vec![EffectSetting {
                effect: effect.into(),
                targets,
                parameters: [(parameter.to_owned(), size)].into(),
            }];
        });
        let data = measured(&preset, 25, &mut robot, &clock);
        let blind = identified(&data);
        let mut problem = Problem::new(&data).unwrap();
        let request = EffectRequest {
            effect: effect.into(),
            cables: (effect == "winch_scale")
                .then(|| "cable-3".to_owned())
                .into_iter()
                .collect(),
            values: Vec::new(),
        };
        problem.free(&[request]).unwrap();
        let solution = solved(&problem);
        let is_effect = |id: &ParameterId| matches!(id, ParameterId::Effect { .. });
        let index = solution.parameters.iter().position(|p| is_effect(&p.id));
        let sd = solution.standard_deviation(index.unwrap()).unwrap();
        let found = solution.globals.effects[0].values[0];
        let dof = solution.degrees_of_freedom;
        // 5 standard deviations: a false failure has probability below 1e-5.
        assert!((found - size).abs() < 5.0 * sd, "{effect}: {found} +- {sd}");
        assert!((solution.chi2 - dof).abs() < 5.0 * (2.0 * dof).sqrt());
        if effect == "winch_scale" {
            assert!(blind.chi2 > solution.chi2 + 30.0, "{effect}");
        }
    }
}

#[test]
fn the_next_pose_waits_until_the_last_is_stored() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 2, 1);
    while run.stage() != Stage::Storing {
        clock.advance(0.05);
        run.tick(&mut robot, clock.now_s());
    }
    let label = run.current().unwrap();
    for _ in 0..1000 {
        clock.advance(0.05);
        assert_eq!(run.tick(&mut robot, clock.now_s()), Vec::new());
    }
    run.confirm_stored(label + 1);
    assert_eq!(run.stage(), Stage::Storing);
    run.confirm_stored(label);
    clock.advance(0.05);
    let events = run.tick(&mut robot, clock.now_s());
    assert_eq!(events, vec![MeasuringEvent::Commanded { label: 1 }]);
}

#[test]
fn continues_repeats_skips_and_pauses() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 5, 1).continuing(&[1, 3]);
    assert_eq!(run.remaining(), 4);
    run.skip();
    assert!(run.repeat(3) && !run.repeat(77));
    run.pause();
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(events[0], MeasuringEvent::Skipped { label: 0 });
    assert_eq!(reason(&events), "paused by the operator");
    assert!(run.tick(&mut robot, clock.now_s()).is_empty());
    run.resume();
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(labels(&events), vec![3, 2, 4, 5]);
    assert_eq!(run.stage(), Stage::Ended);
}

#[test]
fn an_open_ended_run_waits_for_poses_until_it_is_closed() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 1, 1).open_ended();
    let mut tick = |run: &mut MeasuringRun| {
        clock.advance(0.05);
        let events = run.tick(&mut robot, clock.now_s());
        if let Some(label) = run.current().filter(|_| run.stage() == Stage::Storing) {
            run.confirm_stored(label);
        }
        events
    };
    while run.remaining() > 0 {
        tick(&mut run);
    }
    for _ in 0..200 {
        assert_eq!(tick(&mut run), Vec::new());
    }
    assert_eq!(run.stage(), Stage::Ready);
    let home = preset.robot.home.unwrap().pose();
    run.add(9, home);
    assert_eq!(tick(&mut run), vec![MeasuringEvent::Commanded { label: 9 }]);
    while run.remaining() > 0 {
        tick(&mut run);
    }
    run.close();
    let ended = tick(&mut run);
    assert_eq!(ended.last(), Some(&MeasuringEvent::Finished));
    assert_eq!(run.stage(), Stage::Ended);
}

#[test]
fn values_are_read_before_anything_moves_and_at_the_end() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let before = robot.parameters().unwrap();
    let mut run = run_of(&preset, 2, 1);
    clock.advance(0.05);
    let events = run.tick(&mut robot, clock.now_s());
    assert_eq!(events, vec![MeasuringEvent::ValuesAtStart(before.clone())]);
    assert_eq!(robot.state().activity, Activity::Still);
    // Another client writes at a pose.
    while run.stage() != Stage::Storing {
        clock.advance(0.05);
        run.tick(&mut robot, clock.now_s());
    }
    let (name, value) = (before[0].name.clone(), before[0].value + 0.01);
    robot.write(&[(name, value)]).unwrap();
    run.confirm_stored(0);
    let events = drive(&mut run, &mut robot, &clock);
    let [
        ..,
        MeasuringEvent::ValuesAtEnd(after),
        MeasuringEvent::Finished,
    ] = &events[..]
    else {
        panic!("{events:?}");
    };
    assert_eq!(after[0].value, value);
    assert_eq!(after[1..], before[1..]);
    assert_eq!(run.values_at_end(&mut robot), None, "once");
}

#[test]
fn a_run_that_is_ended_reads_the_values_where_it_can() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 2, 1);
    assert_eq!(run.values_at_end(&mut robot), None, "nothing was begun");
    clock.advance(0.05);
    run.tick(&mut robot, clock.now_s());
    run.abort(&mut robot).unwrap();
    let held = robot.parameters().unwrap();
    robot.disconnect();
    assert_eq!(run.values_at_end(&mut robot), None, "it cannot be read");
    robot.connect().unwrap();
    let read = run.values_at_end(&mut robot);
    assert_eq!(read, Some(MeasuringEvent::ValuesAtEnd(held)));
}

#[test]
fn a_pause_under_way_approaches_the_pose_anew() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 2, 1).continuing(&[0]);
    // The values of the controller are read before it moves.
    for stage in [Stage::Ready, Stage::Approaching] {
        clock.advance(0.05);
        run.tick(&mut robot, clock.now_s());
        assert_eq!(run.stage(), stage);
    }
    run.pause();
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(reason(&events), "paused by the operator");
    run.resume();
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(labels(&events), vec![1, 2]);
}

#[test]
fn a_disarmed_or_lost_controller_is_noticed() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    robot.disarm();
    let mut run = run_of(&preset, 2, 1);
    let events = drive(&mut run, &mut robot, &clock);
    assert!(reason(&events).contains("not armed"));
    robot.arm().unwrap();
    run.resume();
    clock.advance(0.05);
    run.tick(&mut robot, clock.now_s());
    robot.inner_mut().set_faults(vec![Fault::ConnectionLost]);
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(reason(&events), "The connection to the controller is lost.");
    let (mut robot, clock) = armed(&preset, |_| ());
    let fault = Fault::Drive("motor 3 is too hot".to_owned());
    robot.inner_mut().set_faults(vec![fault]);
    let events = drive(&mut run_of(&preset, 2, 1), &mut robot, &clock);
    assert_eq!(
        reason(&events),
        "The controller reports a fault: motor 3 is too hot."
    );
}

#[test]
fn poses_outside_the_limits_are_not_commanded() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut far = preset.workspace.centre;
    far.position.x += 0.25;
    let options = MeasuringOptions::of(&preset.robot);
    let mut run = MeasuringRun::new(vec![(1, far)], &preset.robot, options);
    let events = drive(&mut run, &mut robot, &clock);
    assert!(
        reason(&events).contains("not in the workspace"),
        "{events:?}"
    );
    run.skip();
    let events = drive(&mut run, &mut robot, &clock);
    assert_eq!(events.last(), Some(&MeasuringEvent::Finished));
}

/// Warnings of a run in which faults begin after a pose, and how it ended.
fn with_faults(poses: usize, begin: usize, faults: Vec<Fault>) -> (Vec<String>, MeasuringEvent) {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, poses, 1);
    let mut events = Vec::new();
    let mut stored = 0;
    loop {
        clock.advance(0.05);
        for event in run.tick(&mut robot, clock.now_s()) {
            if let MeasuringEvent::Measured(pose) = &event {
                run.confirm_stored(pose.label());
                stored += 1;
                if stored == begin + 1 {
                    robot.inner_mut().set_faults(faults.clone());
                }
            }
            let stops = matches!(
                event,
                MeasuringEvent::Finished
                    | MeasuringEvent::Failed(_)
                    | MeasuringEvent::Paused { .. }
            );
            events.push(event.clone());
            if stops {
                return (warnings(&events), event);
            }
        }
    }
}

fn assert_warns(faults: Vec<Fault>, cable: &str, words: &str) {
    let (warnings, end) = with_faults(6, 0, faults);
    assert_eq!(end, MeasuringEvent::Finished);
    let fitting = |text: &&String| text.starts_with(cable) && text.contains(words);
    assert!(warnings.iter().any(|text| fitting(&text)), "{warnings:?}");
    let strangers = warnings.iter().find(|text| !text.starts_with(cable));
    assert_eq!(strangers, None);
}

#[test]
fn a_run_without_faults_has_no_warnings() {
    let (warnings, end) = with_faults(6, 0, Vec::new());
    assert_eq!((warnings, end), (Vec::new(), MeasuringEvent::Finished));
}

#[test]
fn faults_of_one_cable_are_named() {
    let stuck = Fault::StuckEncoder {
        cable: 2,
        revolutions: 0.1,
    };
    assert_warns(vec![stuck], "cable-3", "exactly the same");
    assert_warns(
        vec![Fault::Reversed { cable: 4 }],
        "cable-5",
        "against the expected direction",
    );
    let jump = Fault::Jump {
        cable: 1,
        revolutions: 1.0,
    };
    assert_warns(vec![jump], "cable-2", "off what is expected");
    let slack = Fault::ForceFactor {
        cable: 6,
        factor: 0.1,
    };
    assert_warns(vec![slack], "cable-7", "too low: 2.75 N, at least 10.0 N");
}

#[test]
fn a_tension_is_outside_of_the_limits_where_its_noise_does_not_explain_it() {
    let robot = preset("mini").robot;
    let sensor = robot.cables[6].force_sensor.expect("a sensor");
    let range = TensionRange::of(&robot);
    let fault = |limit_n: f64, sds: f64| {
        TensionFault::of(&sensor, limit_n + sds * sensor.tension_sd_n, &range)
    };
    assert_eq!(fault(range.lower_n, -2.7), Some(TensionFault::Low));
    assert_eq!(fault(range.lower_n, -2.3), None);
    assert_eq!(fault(range.upper_n, 2.3), None);
    assert_eq!(fault(range.upper_n, 2.7), Some(TensionFault::High));
    assert_eq!(fault(0.0, -2.7), Some(TensionFault::Negative));
}

#[test]
fn a_dead_force_sensor_pauses_the_run_until_the_operator_has_decided() {
    let preset = preset("mini");
    let dead = |reading_n| Fault::Tension {
        cable: 3,
        reading_n,
    };
    let factor = |factor| Fault::ForceFactor { cable: 3, factor };
    for (fault, words) in [
        (factor(f64::NAN), "shows no number"),
        (dead(0.0), "shows exactly 0 N"),
        (dead(81.5), "exactly the same before and after"),
        (factor(-1.0), "a cable cannot push"),
    ] {
        let (mut robot, clock) = armed(&preset, |_| ());
        let mut run = run_of(&preset, 4, 1);
        while run.stage() != Stage::Storing {
            clock.advance(0.05);
            run.tick(&mut robot, clock.now_s());
        }
        robot.inner_mut().set_faults(vec![fault]);
        run.confirm_stored(0);
        let events = drive(&mut run, &mut robot, &clock);
        let Some(MeasuringEvent::Paused {
            reason,
            is_overload: true,
        }) = events.last()
        else {
            panic!("{words}: {events:?}");
        };
        assert!(reason.starts_with("cable-4: its force sensor "), "{reason}");
        assert!(reason.contains(words), "{reason}");
        assert_eq!(labels(&events), [0; 0], "nothing is measured without it");
        assert_eq!(robot.state().activity, Activity::Still);
        // Once the operator has decided it is only a warning.
        run.resume();
        let events = drive(&mut run, &mut robot, &clock);
        assert_eq!(events.last(), Some(&MeasuringEvent::Finished), "{words}");
        assert_eq!(labels(&events), [1, 2, 3, 4]);
    }
}

#[test]
fn exchanged_encoders_are_noticed() {
    let (warnings, end) = with_faults(8, 0, vec![Fault::Exchanged { cables: [0, 6] }]);
    assert_eq!(end, MeasuringEvent::Finished);
    let exchanged = warnings.iter().filter(|text| text.contains("swapped"));
    let exchanged: Vec<_> = exchanged.collect();
    assert_eq!(exchanged.len(), 1, "{warnings:?}");
    assert!(exchanged[0].starts_with("cable-1 and cable-7"));
}

#[test]
fn what_cannot_be_used_pauses_the_run() {
    let paused = |faults: Vec<Fault>| match with_faults(3, 1, faults) {
        (_, MeasuringEvent::Paused { reason, .. }) => reason,
        (_, other) => panic!("{other:?}"),
    };
    let laser = paused(vec![Fault::LaserLost]);
    assert!(laser.contains("the laser has no return"), "{laser}");
    let number = paused(vec![Fault::NotANumber { cable: 3 }]);
    assert!(
        number.contains("cable-4: its encoder shows no number"),
        "{number}"
    );
    let restless = Fault::Restless {
        cable: 5,
        revolutions_per_s: 0.05,
    };
    let restless = paused(vec![restless]);
    assert!(
        restless.contains("does not come to rest at pose 2 within 60 s: the winch of cable-6"),
        "{restless}"
    );
    let overload = Fault::Tension {
        cable: 0,
        reading_n: 500.0,
    };
    let overload = paused(vec![overload]);
    assert!(overload.contains("cable-1 pulls with 250 N"), "{overload}");
}

#[test]
fn a_jump_at_rest_is_settled_anew() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 1, 1);
    while run.stage() != Stage::Sampling {
        clock.advance(0.05);
        run.tick(&mut robot, clock.now_s());
    }
    let jump = Fault::Jump {
        cable: 1,
        revolutions: 0.1,
    };
    robot.inner_mut().set_faults(vec![jump]);
    clock.advance(0.05);
    let events = run.tick(&mut robot, clock.now_s());
    let text = warnings(&events).concat();
    assert!(
        text.starts_with("cable-2: its encoder jumped by 12."),
        "{text}"
    );
    assert_eq!(run.stage(), Stage::Approaching);
}

#[test]
fn a_silent_controller_ends_the_run() {
    let preset = preset("mini");
    let (mut robot, _) = armed(&preset, |_| ());
    let mut run = run_of(&preset, 1, 1);
    // The controller's clock stands still.
    let events: Vec<_> = (0..200)
        .flat_map(|k| run.tick(&mut robot, f64::from(k)))
        .collect();
    assert_eq!(reason(&events), "The controller sends no new readings.");
}

#[test]
fn a_fast_simulation_needs_few_ticks() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |setup| setup.speed = 20.0);
    measured(&preset, 25, &mut robot, &clock);
    assert!(clock.now_s() < 30.0, "{} s", clock.now_s());
}

#[test]
fn more_poses_leave_less_open_until_it_is_good_enough() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let data = measured(&preset, 20, &mut robot, &clock);
    let after = |rows: usize| {
        let mut part = data.clone();
        part.measurements = part.measurements.select(&(0..=rows).collect::<Vec<_>>());
        largest_sd_m(&identified(&part)).unwrap()
    };
    let [few, some, many] = [5, 10, 20].map(after);
    assert!(few > some && some > many, "{few} {some} {many}");
    assert!(many < 0.8 * few, "{few} {many}");
    let mut open = identified(&data);
    open.covariance = None;
    assert_eq!(largest_sd_m(&open), None);
}

#[test]
fn a_typed_distance_is_that_of_the_pose_at_which_it_was_asked_for() {
    let preset = preset("mini");
    let (robot, clock) = armed(&preset, |_| ());
    let laser = ManualLaser::default();
    let mut robot = robot.with_laser(Some(Box::new(laser.clone())));
    robot.connect().unwrap();
    robot.arm().unwrap();
    let mut run = run_of(&preset, 3, 1).asking(Some(laser.clone()));
    let mut tick = |run: &mut MeasuringRun| {
        clock.advance(0.05);
        run.tick(&mut robot, clock.now_s())
    };
    for label in 0..=3 {
        let wanted = std::iter::repeat_with(|| tick(&mut run)).take(10_000);
        let wanted = wanted.flatten().find_map(|event| match event {
            MeasuringEvent::LaserWanted { label } => Some(label),
            _ => None,
        });
        assert_eq!((wanted, laser.wanted()), (Some(label), Some(label)));
        // However long it takes, nothing moves and nothing is measured.
        for _ in 0..2000 {
            assert_eq!(tick(&mut run), Vec::new());
        }
        assert_eq!(run.stage(), Stage::Asking);
        assert!(laser.answer(label - 1, Some(0.4)).is_err());
        let typed_m = 0.4 + 0.01 * label as f64;
        laser.answer(label, Some(typed_m)).unwrap();
        while run.stage() != Stage::Storing {
            for event in tick(&mut run) {
                if let MeasuringEvent::Measured(pose) = event {
                    let read = (pose.label(), pose.readings.laser_at(0));
                    assert_eq!(read, (label, typed_m));
                }
            }
        }
        run.confirm_stored(label);
    }
}

#[test]
fn a_pose_that_is_left_needs_another_typed_distance() {
    let preset = preset("mini");
    let (robot, clock) = armed(&preset, |_| ());
    let laser = ManualLaser::default();
    let mut robot = robot.with_laser(Some(Box::new(laser.clone())));
    robot.connect().unwrap();
    robot.arm().unwrap();
    let mut run = run_of(&preset, 1, 1).asking(Some(laser.clone()));
    let mut until = |run: &mut MeasuringRun, stage: Stage| {
        let mut events = Vec::new();
        for _ in 0..10_000 {
            clock.advance(0.05);
            events.extend(run.tick(&mut robot, clock.now_s()));
            if run.stage() == stage || run.is_paused() {
                return events;
            }
        }
        panic!("it never comes to {stage:?}");
    };
    until(&mut run, Stage::Asking);
    run.pause();
    run.resume();
    until(&mut run, Stage::Approaching);
    assert!(laser.answer(0, Some(0.5)).is_err(), "it moves again");
    until(&mut run, Stage::Asking);
    // The operator says that there is no return: the pose cannot be used.
    laser.answer(0, None).unwrap();
    let events = until(&mut run, Stage::Storing);
    assert!(
        reason(&events).contains("the laser has no return"),
        "{events:?}"
    );
}
