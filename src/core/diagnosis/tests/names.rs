//! Hidden effects are named. They are so large that the probability of a false failure is below 1e-3 for each test with
//! random seeds.

use super::super::Verdict;
use super::{diagnosed, found, names, run_with, setting};

#[test]
fn exchanged_channels_are_found() {
    let swap = setting("cable_swap", &["cable-2", "cable-7"], &[]);
    let run = run_with("mini", 30, 61, &[swap]);
    let diagnosis = diagnosed(&run.dataset);
    assert_eq!(found(&diagnosis), [("cable_swap", vec![1, 6])]);
    let finding = &diagnosis.findings[0];
    assert_eq!(finding.verdict(), Verdict::Named);
    assert!(finding.evidence.p_value < 1e-6 && finding.parameters.is_empty());
    assert!(!diagnosis.base.adequate && diagnosis.extended.adequate);
    let effects = &diagnosis.extended_solution.globals.effects;
    assert_eq!(effects.len(), 1);
}

#[test]
fn an_exchange_hides_no_second_effect() {
    let swap = setting("cable_swap", &["cable-2", "cable-7"], &[]);
    let scale = setting("winch_scale", &["cable-4"], &[("scale", 0.02)]);
    let run = run_with("mini", 40, 62, &[swap, scale]);
    let names = found(&diagnosed(&run.dataset));
    assert_eq!(
        names,
        [("cable_swap", vec![1, 6]), ("winch_scale", vec![3])]
    );
}

#[test]
fn different_values_on_all_cables_are_one_finding() {
    let scales = [0.02, -0.015, 0.018, -0.02, 0.014, 0.021, -0.017, 0.016];
    let effects: Vec<_> = scales
        .iter()
        .enumerate()
        .map(|(k, scale)| {
            let cable = format!("cable-{}", k + 1);
            setting("winch_scale", &[&cable], &[("scale", *scale)])
        })
        .collect();
    let run = run_with("mini", 60, 63, &effects);
    let diagnosis = diagnosed(&run.dataset);
    assert_eq!(found(&diagnosis).len(), 1, "{:?}", found(&diagnosis));
    let finding = &diagnosis.findings[0];
    let cause = finding.cause().unwrap();
    assert_eq!(cause.effect().id(), "winch_scale");
    assert!(cause.instances.len() >= 7);
    for parameter in &finding.parameters {
        let truth = scales[parameter.cable.unwrap()];
        let sd = parameter.sd.unwrap();
        assert!((parameter.value - truth).abs() < 5.0 * sd, "{parameter:?}");
    }
}

#[test]
fn two_waves_of_different_periods_are_two_findings() {
    let wave = |amplitude: f64, period: f64| {
        let values = [("amplitude", amplitude), ("period", period), ("phase", 0.4)];
        setting("laser_cyclic", &[], &values)
    };
    let run = run_with("mini", 80, 64, &[wave(0.006, 0.3), wave(0.004, 0.13)]);
    let diagnosis = diagnosed(&run.dataset);
    let wave = ("laser_cyclic", Vec::new());
    assert_eq!(found(&diagnosis), [wave.clone(), wave]);
    let findings = diagnosis.findings.iter();
    let periods: Vec<f64> = findings.map(|f| f.parameters[1].value).collect();
    for (period, truth) in periods.iter().zip([0.3, 0.13]) {
        assert!((period / truth - 1.0).abs() < 0.02, "{periods:?}");
    }
}

#[test]
fn different_values_on_two_cables_are_two_findings() {
    let one = setting("winch_scale", &["cable-2"], &[("scale", 0.02)]);
    let other = setting("winch_scale", &["cable-7"], &[("scale", -0.02)]);
    let run = run_with("mini", 40, 64, &[one, other]);
    let mut names = found(&diagnosed(&run.dataset));
    names.sort();
    assert_eq!(names, [("winch_scale", vec![1]), ("winch_scale", vec![6])]);
}

#[test]
fn a_value_common_to_several_cables_is_one_finding() {
    let cables = ["cable-2", "cable-4", "cable-7"];
    let shared = setting("winch_scale", &cables, &[("scale", 0.02)]);
    let run = run_with("mini", 60, 65, &[shared]);
    let diagnosis = diagnosed(&run.dataset);
    assert_eq!(found(&diagnosis), [("winch_scale", vec![1, 3, 6])]);
    let finding = &diagnosis.findings[0];
    assert_eq!(finding.cause().unwrap().instances.len(), 1);
    let [scale] = &finding.parameters[..] else {
        panic!("{:?}", finding.parameters);
    };
    assert!((scale.value - 0.02).abs() < 5.0 * scale.sd.unwrap());
}

#[test]
fn two_effects_are_both_named() {
    let scale = setting("winch_scale", &["cable-3"], &[("scale", 0.02)]);
    let bias = setting("force_bias", &["cable-6"], &[("bias", 12.0)]);
    let run = run_with("mini", 40, 66, &[scale, bias]);
    let diagnosis = diagnosed(&run.dataset);
    let all: Vec<_> = diagnosis.findings.iter().flat_map(names).collect();
    assert!(all.contains(&("winch_scale", vec![2])), "{all:?}");
    assert!(all.contains(&("force_bias", vec![5])), "{all:?}");
    assert_eq!(diagnosis.findings.len(), 2);
    assert!(diagnosis.extended.adequate);
}

/// At the default level the probability of a finding in 30 clean datasets is below 0.3, of three or more below 0.004.
#[test]
fn clean_data_have_no_findings() {
    let alarms: Vec<_> = (0..30)
        .map(|seed| found(&diagnosed(&run_with("mini", 20, 700 + seed, &[]).dataset)))
        .filter(|names| !names.is_empty())
        .collect();
    assert!(alarms.len() < 3, "{alarms:?}");
}

/// A step of an anchor along its cable looks like a slip of the cable, so both must be listed however large the step
/// is.
#[test]
fn a_strong_step_along_a_cable_is_not_named_a_slip() {
    let shift = setting(
        "frame_shift",
        &["cable-1"],
        &[
            ("x", 0.0064),
            ("y", -0.0034),
            ("z", -0.0014),
            ("pose", 18.0),
        ],
    );
    let run = run_with("planar", 41, 64, &[shift]);
    let diagnosis = diagnosed(&run.dataset);
    let said = names(&diagnosis.findings[0]);
    assert!(said.contains(&("frame_shift", vec![0])), "{said:?}");
    assert!(diagnosis.findings[0].evidence.delta_chi2 > 1000.0);
}

/// Rows of one standstill share part of their errors. Taken as independent they would seem full of errors.
#[test]
fn rows_of_a_standstill_count_once() {
    let mut dataset = run_with("mini", 41, 65, &[]).dataset;
    let data = &dataset.measurements;
    let rows: Vec<usize> = (0..data.len())
        .flat_map(|row| [row, row, row])
        .skip(2)
        .collect();
    let mut repeated = data.select(&rows);
    repeated.labels = (0..rows.len() as i64).collect();
    repeated.groups = rows.iter().map(ToString::to_string).collect();
    let once = diagnosed(&dataset);
    dataset.measurements = repeated;
    let thrice = diagnosed(&dataset);
    assert!(thrice.findings.is_empty() && thrice.noise.is_empty());
    let (one, other) = (once.base_solution.chi2, thrice.base_solution.chi2);
    assert!((one - other).abs() < 1e-6 * one, "{one} {other}");
}

#[test]
fn a_cyclic_error_of_a_long_period_is_that_of_the_laser() {
    // Two and a half times the noise, with half the wavelength of a modulation by 250 MHz as its period.
    let parameters = [("amplitude", 0.0025), ("period", 0.6), ("phase", 1.0)];
    let cyclic = setting("laser_cyclic", &[], &parameters);
    for (name, seed) in [("hall", 71), ("suspended", 72)] {
        let run = run_with(name, 40, seed, std::slice::from_ref(&cyclic));
        let diagnosis = diagnosed(&run.dataset);
        assert_eq!(found(&diagnosis), [("laser_cyclic", vec![])], "{name}");
        let period = &diagnosis.findings[0].parameters[1];
        assert!((period.value / 0.6 - 1.0).abs() < 0.1, "{period:?}");
    }
}
