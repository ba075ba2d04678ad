//! Faults of real machines, with simulated data of the same kind.

use tautline_core::diagnosis::{Diagnosis, DiagnosisOptions, Finding, Verdict, diagnose};
use tautline_core::effect::{EffectRequest, EffectSetting};
use tautline_core::estimation::{
    Control, EstimationError, Options, ParameterId, Problem, Solution, solve,
};
use tautline_core::measurement::Dataset;
use tautline_validation::tables::hidden::{Conditions, Hidden, Setup, robot};

fn setup(name: &str, seed: u64) -> Setup {
    Setup {
        robot: robot(name).expect("a robot"),
        seed,
        conditions: Conditions::default(),
    }
}

fn measured(setup: &Setup, effects: Vec<EffectSetting>) -> Dataset {
    let run = setup.measured(&Hidden::Effects(effects));
    run.expect("measurements").dataset
}

fn effect(id: &str, cables: &[&str], parameters: &[(&str, f64)]) -> EffectSetting {
    let parameters = parameters.iter().map(|(k, v)| ((*k).to_owned(), *v));
    EffectSetting {
        effect: id.to_owned(),
        targets: cables.iter().map(|&name| name.to_owned()).collect(),
        parameters: parameters.collect(),
    }
}

fn asked(dataset: &Dataset) -> Diagnosis {
    let options = DiagnosisOptions::default();
    diagnose(dataset, &options, &mut |_| Control::Continue).expect("a diagnosis")
}

fn fit(dataset: &Dataset, effects: &[&str]) -> Result<Solution, EstimationError> {
    let mut problem = Problem::new(dataset)?;
    let requests: Vec<_> = (effects.iter())
        .map(|text| EffectRequest::parse(text).expect("an effect"))
        .collect();
    problem.free(&requests)?;
    solve(&problem, &Options::default(), &mut |_| Control::Continue)
}

fn fitted(dataset: &Dataset, effects: &[&str]) -> Solution {
    fit(dataset, effects).expect("a solution")
}

fn name(finding: &Finding) -> (&'static str, Vec<usize>) {
    let id = finding
        .cause()
        .map_or("unknown", |cause| cause.effect().id());
    (id, finding.subject.cables())
}

/// Chi-square over degrees of freedom.
fn ratio(solution: &Solution) -> f64 {
    solution.chi2 / solution.degrees_of_freedom
}

/// Absolute lengths, anchors of which nothing is known, one offset that all cables have in common, a model that is
/// slightly wrong everywhere: the offset is the first thing said, and nothing without a name takes its place.
#[test]
fn one_offset_of_all_cables_comes_before_anything_without_a_name() {
    let mut setup = setup("planar-unmeasured", 600_901);
    setup.conditions.model_error = 1.5;
    let offset = 0.155;
    let hidden = effect("winch_offset", &[], &[("offset", offset)]);
    let diagnosis = asked(&measured(&setup, vec![hidden]));
    let first = &diagnosis.findings[0];
    assert_eq!(first.verdict(), Verdict::Named, "{:?}", first.subject);
    assert_eq!(name(first).0, "winch_offset");
    let found = &first.parameters[0];
    let sd = found.sd.expect("a standard deviation");
    // Five standard deviations: once in a million times.
    assert!(
        (found.value - offset).abs() < 5.0 * sd.max(1e-3),
        "{found:?}"
    );
    for finding in &diagnosis.findings[1..] {
        let gained = finding.evidence.delta_chi2;
        assert!(
            gained < 0.1 * first.evidence.delta_chi2,
            "{:?}",
            finding.subject
        );
    }
}

/// Every winch with a scale and an offset, every force sensor with a gain and a bias, and a heading that counts from
/// elsewhere: together they are found, and nothing else is.
#[test]
fn families_are_found_together() {
    let setup = setup("hanging", 600_902);
    let cables = ["cable-1", "cable-2", "cable-3", "cable-4"];
    let families = [
        ("winch_scale", "scale", [0.021, -0.014, 0.017, 0.026]),
        ("winch_offset", "offset", [0.03, -0.05, 0.02, 0.06]),
        ("force_gain", "change", [0.08, -0.05, 0.11, 0.06]),
        ("force_bias", "bias", [12.0, -7.0, 9.0, 15.0]),
    ];
    let mut hidden = vec![effect("heading_offset", &[], &[("offset", 0.6)])];
    for (id, parameter, values) in families {
        for (cable, value) in cables.iter().zip(values) {
            hidden.push(effect(id, &[cable], &[(parameter, value)]));
        }
    }
    let dataset = measured(&setup, hidden);
    let before = ratio(&fitted(&dataset, &[]));
    assert!(before > 10.0, "{before}");
    let diagnosis = asked(&dataset);
    let after = ratio(&diagnosis.extended_solution);
    assert!(after < 1.5, "{after}");
    let found: Vec<_> = (diagnosis.findings.iter()).map(|f| name(f).0).collect();
    for (id, ..) in families {
        assert!(found.contains(&id), "no {id} in {found:?}");
    }
    assert!(found.contains(&"heading_offset"), "{found:?}");
    assert!(!found.contains(&"unknown"), "{found:?}");
}

/// The scale of an absolute length multiplies the reading: a large one would shrink residuals by itself. Where the model
/// is wrong in another way, the scale is about as large as what is wrong is of the lengths, and not larger.
#[test]
fn a_scale_of_absolute_lengths_does_not_shrink_residuals_by_itself() {
    for (seed, offset) in [(600_903, 0.155), (600_904, -0.155)] {
        let hidden = effect("winch_offset", &[], &[("offset", offset)]);
        let dataset = measured(&setup("planar-unmeasured", seed), vec![hidden]);
        for freed in ["winch_scale", "winch_scale_common"] {
            for bound in &fitted(&dataset, &[freed]).globals.effects {
                // 155 mm of the shortest lengths, about 1 m.
                assert!(bound.values[0].abs() < 0.2, "{bound:?}");
            }
        }
    }
}

/// With one empty cell, the fit with an effect on that cable gives the same result as with the cell, and names the cause.
#[test]
fn an_empty_cell_stops_no_fit() {
    let setup = setup("planar", 600_909);
    let hidden = effect("winch_scale", &["cable-2"], &[("scale", 0.02)]);
    let whole = measured(&setup, vec![hidden]);
    let mut dataset = whole.clone();
    dataset.measurements.revolutions.set(7, 1, f64::NAN);
    for effects in [
        &["winch_scale:cable-2"][..],
        &["winch_scale", "drum_growth"],
    ] {
        let (full, holed) = (fitted(&whole, effects), fitted(&dataset, effects));
        assert!(holed.converged() && holed.iterations > 0, "{effects:?}");
        // One reading less: chi-square changes by its own square, and by its influence on the other residuals.
        let difference = full.chi2 - holed.chi2;
        assert!(difference.abs() < 30.0, "{effects:?}: {difference}");
    }
    let diagnosis = asked(&dataset);
    assert_eq!(name(&diagnosis.findings[0]), ("winch_scale", vec![1]));
    assert_eq!(diagnosis.findings[0].verdict(), Verdict::Named);
}

/// Friction is not negative for any data.
#[test]
fn parameters_keep_their_physical_sign() {
    let hidden = effect("pulley_friction", &["cable-2"], &[("mu", -0.1)]);
    let dataset = measured(&setup("planar", 600_910), vec![hidden]);
    for finding in asked(&dataset).findings {
        if let Some(cause) = finding.cause()
            && cause.effect().id() == "pulley_friction"
        {
            let mut found = cause.instances.iter().map(|bound| bound.values[0]);
            assert!(found.all(|mu| mu >= 0.0), "{cause:?}");
        }
    }
}

/// Readings that scatter far less than stated do not lead to a noise statement at a bound of the search.
#[test]
fn a_noise_at_its_bound_is_no_statement() {
    for seed in 600_911..600_914 {
        let mut setup = setup("mini-tracked", seed);
        setup.conditions.noise.position = 1e-6;
        setup.conditions.noise.orientation = 1e-6;
        for statement in asked(&measured(&setup, vec![])).noise {
            assert!(statement.ratio > 2e-3, "{statement:?}");
            assert!(statement.interval[0] > 0.0, "{statement:?}");
        }
    }
}

/// Without force readings the weight is known and the tensions are not: an effect that acts through them is estimated
/// with what is known of them, or refused in a sentence; it is never said to be nothing.
#[test]
fn effects_of_tension_without_force_readings_are_estimated_or_refused() {
    let dataset = measured(&setup("mini-forceless", 600_916), vec![]);
    for id in [
        "cable_stiffness",
        "pulley_friction",
        "payload_mass",
        "frame_compliance",
    ] {
        match fit(&dataset, &[id]) {
            Err(error) => assert!(error.to_string().contains(id), "{error}"),
            Ok(solution) => {
                let mut parameters = solution.parameters.iter();
                let column = parameters.position(|p| matches!(p.id, ParameterId::Effect { .. }));
                let sd = column.and_then(|k| solution.standard_deviation(k));
                assert!(sd.is_some_and(|sd| sd > 0.0), "{id}");
            }
        }
    }
}

/// An effect that no reading could show is refused in a sentence.
#[test]
fn growth_of_a_drum_is_refused_where_lengths_are_absolute() {
    let dataset = measured(&setup("mini-absolute", 600_917), vec![]);
    let refused = fit(&dataset, &["drum_growth"]).expect_err("nothing to estimate");
    let text = refused.to_string();
    assert!(
        text.contains("drum_growth") && text.contains("none of the readings"),
        "{text}"
    );
}

/// An error that is constant, linear or quadratic in the cable paid out is named.
#[test]
fn what_the_catalogue_can_express_is_never_unknown() {
    let settings = [
        effect("winch_offset", &["cable-1"], &[("offset", 0.08)]),
        effect("winch_scale", &["cable-3"], &[("scale", 0.03)]),
        effect("drum_growth", &["cable-2"], &[("growth", 0.002)]),
    ];
    for (seed, hidden) in (600_918..).zip(settings) {
        let dataset = measured(&setup("planar", seed), vec![hidden.clone()]);
        let findings = asked(&dataset).findings;
        let unknown = findings.iter().find(|f| f.verdict() == Verdict::Unknown);
        assert!(unknown.is_none(), "{hidden:?}: {unknown:?}");
        assert_eq!(name(&findings[0]).0, hidden.effect);
    }
}
