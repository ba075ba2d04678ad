//! The linear score test against complete refits.

use super::super::report::Cause;
use super::super::scores::{Scan, Scored, scan};
use super::{Fit, based, run_with, setting};
use crate::effect::EffectSetting;
use crate::measurement::Dataset;

/// The data with hidden effects and the noise of one seed.
fn hidden(poses: usize, effects: &[EffectSetting]) -> Dataset {
    run_with("mini", poses, 31, effects).dataset
}

fn answer<'s>(scan: &'s Scan, id: &str, cables: &[usize]) -> &'s Scored {
    let is_asked = |s: &&Scored| s.cause.effect().id() == id && s.cause.cables() == cables;
    scan.scored.iter().find(is_asked).unwrap()
}

fn refit<'a>(base: &crate::estimation::Problem<'a>, cause: &Cause) -> Fit<'a> {
    Fit::new(base, std::slice::from_ref(cause)).unwrap()
}

/// The linear gain of a small effect is what a complete refit gains, and the linear estimate is what it finds.
#[test]
fn the_linear_gain_is_that_of_a_refit() {
    let small: [(EffectSetting, &[usize], usize); 4] = [
        (
            setting("winch_scale", &["cable-3"], &[("scale", 0.003)]),
            &[2],
            0,
        ),
        (
            setting("force_bias", &["cable-5"], &[("bias", 1.0)]),
            &[4],
            0,
        ),
        (setting("laser_drift", &[], &[("drift", 0.001)]), &[], 0),
        (
            setting("encoder_drift", &["cable-1"], &[("rate", 0.002)]),
            &[0],
            0,
        ),
    ];
    for (effect, cables, parameter) in small {
        let dataset = hidden(40, std::slice::from_ref(&effect));
        let base = based(&dataset);
        let without = Fit::new(&base, &[]).unwrap();
        let scan = scan(&without);
        let linear = answer(&scan, &effect.effect, cables);
        let with = refit(&base, &linear.cause);
        let gain = without.solution.chi2 - with.solution.chi2;
        assert!(
            (linear.gain - gain).abs() < 0.01 * gain,
            "{}",
            effect.effect
        );
        let (estimate, fitted) = (
            linear.cause.instances[0].values[parameter],
            with.causes[0].instances[0].values[parameter],
        );
        assert!(
            (estimate - fitted).abs() < 0.01 * fitted.abs(),
            "{estimate} {fitted}"
        );
    }
}

/// Hides an event on one cable or on the laser, and insists that it is the best answer to all questions.
fn check_event(id: &str, cable: Option<usize>, values: &[(&str, f64)]) {
    let target = cable.map(|cable| format!("cable-{}", cable + 1));
    let targets: Vec<&str> = target.as_deref().into_iter().collect();
    let dataset = hidden(40, &[setting(id, &targets, values)]);
    let scan = scan(&Fit::new(&based(&dataset), &[]).unwrap());
    let best = scan.scored.iter();
    let best = best.max_by(|a, b| a.score().total_cmp(&b.score())).unwrap();
    assert_eq!(best.cause.effect().id(), id);
    assert_eq!(best.cause.cables(), Vec::from_iter(cable));
    let pose = best.cause.effect().pose_parameter().unwrap();
    let hidden = values.iter().find(|(name, _)| *name == "pose").unwrap().1;
    assert_eq!(best.cause.instances[0].values[pose], hidden, "{id}");
}

/// Events are found at their pose, and explain more than any other single cause. They are 10 to 100 standard deviations
/// large: noise leads to another pose with a probability far below 1e-6.
#[test]
fn an_event_is_found_at_its_pose() {
    let error = |pose| [("error", 0.02), ("pose", pose)];
    check_event("cable_slip", Some(1), &[("step", 0.01), ("pose", 17.0)]);
    let shift = [("x", 0.01), ("y", -0.01), ("z", 0.01), ("pose", 12.0)];
    check_event("frame_shift", Some(5), &shift);
    check_event("encoder_outlier", Some(7), &error(23.0));
    check_event("laser_outliers", None, &error(5.0));
}

/// A wave is found at its period, within a quarter of a wave over the range of distances, with its amplitude.
/// Amplitude and period are known to a twentieth of what is allowed: a failure by noise is far below 1e-6.
#[test]
fn a_wave_is_found_at_its_period() {
    let (amplitude, period) = (0.002, 0.05);
    let effect = setting(
        "laser_cyclic",
        &[],
        &[("amplitude", amplitude), ("period", period), ("phase", 0.4)],
    );
    let dataset = hidden(60, &[effect]);
    let base = based(&dataset);
    let scan = scan(&Fit::new(&base, &[]).unwrap());
    let wave = answer(&scan, "laser_cyclic", &[]);
    let read = &dataset.measurements.laser_m;
    let range = read.iter().fold(0.0_f64, |m, d| m.max(*d))
        - read.iter().fold(f64::INFINITY, |m, d| m.min(*d));
    let values = &wave.cause.instances[0].values;
    assert!(
        (values[1].recip() - period.recip()).abs() * range < 0.25,
        "{values:?}"
    );
    assert!(
        (values[0] - amplitude).abs() < 0.3 * amplitude,
        "{values:?}"
    );
    let fitted = refit(&base, &wave.cause);
    let values = &fitted.causes[0].instances[0].values;
    assert!((values[1] - period).abs() < 0.02 * period, "{values:?}");
    assert!(
        (values[0] - amplitude).abs() < 0.2 * amplitude,
        "{values:?}"
    );
}

/// What no reading shows has no visible direction and no size: there is no temperature effect at one temperature.
#[test]
fn what_is_not_measured_is_not_visible() {
    let mut dataset = hidden(20, &[]);
    dataset.measurements.temperature_c.clear();
    let scan = scan(&Fit::new(&based(&dataset), &[]).unwrap());
    for id in [
        "cable_thermal",
        "frame_thermal",
        "heading_offset",
        "inclinometer_tilt",
    ] {
        let scored = answer(&scan, id, &[]);
        assert_eq!((scored.visible, scored.sd), (0, None), "{id}");
        assert!(scored.gain.abs() < 1e-9, "{id}");
    }
}
