//! Diagnoses put together by hand, around plain solutions of a small simulated dataset.

use std::sync::Arc;

use tautline_core::diagnosis::{
    Adequacy, Alternative, Cause, Diagnosis, Discrepancy, ErrorForm, Evidence, Finding,
    FoundParameter, Gain, GlobalTest, GroupTest, Invisible, KindGain, NoiseStatement,
    PositionChange, PossibleCause, Quantity, ReadingId, Rival, Separation, Subject,
    ToleranceFactor, UnmodelledError, Variable, Verdict,
};
use tautline_core::effect::EffectRequest;
use tautline_core::estimation::{Control, Method, Options, Problem, Solution, solve};
use tautline_core::geometry::Pose;
use tautline_core::measurement::Dataset;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

use super::Diagnosed;
use crate::identification::{Identification, IdentificationRequest, identify};

/// [`dataset`], identified.
pub fn identified() -> Identification {
    let request = IdentificationRequest::new(dataset(), Method::Joint, &[]);
    let request = request.expect("a request");
    identify(&request, &mut |_| Control::Continue).expect("identified")
}

/// A planar robot with four cables at twelve poses.
pub fn dataset() -> Dataset {
    let preset = presets::find("planar").expect("a preset");
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(12, 3)
    };
    simulate(&preset.robot, &options)
        .expect("measurements")
        .dataset
}

fn solution(dataset: &Dataset, effects: &[&str]) -> Solution {
    let mut problem = Problem::new(dataset).expect("a problem");
    let requests: Vec<_> = effects
        .iter()
        .map(|e| EffectRequest::parse(e).expect("an effect"))
        .collect();
    problem.free(&requests).expect("effects");
    solve(&problem, &Options::default(), &mut |_| Control::Continue).expect("a solution")
}

/// A cause as `--effect` names it.
pub fn cause(robot: &Robot, request: &str) -> Cause {
    Cause {
        instances: EffectRequest::parse(request)
            .expect("an effect")
            .bind(robot)
            .expect("an effect"),
    }
}

fn adequacy(adequate: bool, chi2: f64) -> Adequacy {
    let p_value = if adequate { 0.4 } else { 1e-9 };
    let group = |cable| GroupTest {
        quantity: Quantity::Length,
        cable,
        readings: 48,
        rms_over_sd: (chi2 / 100.0).sqrt(),
        p_value,
    };
    Adequacy {
        adequate,
        global: GlobalTest {
            chi2,
            degrees_of_freedom: 100.0,
            p_value,
        },
        groups: vec![group(None), group(Some(2))],
    }
}

fn discrepancy() -> Discrepancy {
    Discrepancy {
        quantity: Quantity::Length,
        cable: Some(2),
        variable: Variable::CableLength,
        rms_over_sd: 2.1,
        p_value: 1e-9,
        points: vec![(1, 1.5, -0.3), (2, f64::NAN, 1.2)],
    }
}

fn rival(cause: Cause, delta_chi2: f64) -> Rival {
    Rival {
        cause,
        delta_chi2,
        parameters: 1,
        holdout: 1.01,
    }
}

fn gain() -> Gain {
    Gain {
        before: 1.62,
        after: 1.01,
        interval: [0.4, 0.8],
        poses_held_out: 12,
        kinds: vec![KindGain {
            quantity: Quantity::Length,
            before: 1.9,
            after: 1.02,
        }],
        position: PositionChange {
            rms_m: 0.0023,
            interval_m: [0.0019, 0.0027],
            largest_m: 0.0051,
        },
    }
}

/// An error of the lengths of the third cable.
fn unmodelled() -> Subject {
    Subject::UnmodelledError(UnmodelledError {
        readings: ReadingId {
            quantity: Quantity::Length,
            cable: Some(2),
            component: None,
        },
        form: ErrorForm::Smooth(Variable::CableLength),
        rms: Some(0.0008),
    })
}

/// A finding of each verdict: a named winch scale, a pulley radius or winch offset, and an error without a cause.
pub fn finding(robot: &Robot, verdict: Verdict) -> Finding {
    let scale = cause(robot, "winch_scale:3");
    let radius = cause(robot, "pulley_radius:3");
    let (cause, other) = match verdict {
        Verdict::Named | Verdict::Unknown => (scale, radius),
        Verdict::Ambiguous => (radius, cause(robot, "winch_offset:3")),
    };
    let is_ambiguous = verdict == Verdict::Ambiguous;
    let ranking = match verdict {
        Verdict::Unknown => Vec::new(),
        _ => vec![rival(cause.clone(), 61.0), rival(other.clone(), 20.0)],
    };
    Finding {
        probability: if is_ambiguous { 0.6 } else { 0.998 },
        sentence: "Winch 3 pays out too much.".to_owned(),
        advice: "Measure the drum.".to_owned(),
        alternatives: if is_ambiguous {
            vec![Alternative {
                subject: Subject::Cause(other),
                probability: 0.4,
            }]
        } else {
            Vec::new()
        },
        parameters: match verdict {
            Verdict::Unknown => Vec::new(),
            _ => vec![FoundParameter {
                name: "scale",
                cable: None,
                value: 0.0031,
                unit: "1",
                sd: Some(0.0004),
            }],
        },
        evidence: Evidence {
            delta_chi2: 61.0,
            parameters: 1,
            p_value: 1e-13,
            questions: 300,
            ranking,
        },
        gain: gain(),
        separation: is_ambiguous.then(|| Separation {
            poses: vec![Pose::from_parts([0.25, -0.1, 0.0], [1.0, 0.0, 0.0, 0.0])],
            expected_delta_chi2: 25.0,
            advice: "Measure far from cable-3.".to_owned(),
        }),
        subject: match verdict {
            Verdict::Unknown => unmodelled(),
            _ => Subject::Cause(cause),
        },
    }
}

fn possible(robot: &Robot) -> PossibleCause {
    PossibleCause {
        cause: cause(robot, "drum_growth:2"),
        probability: 0.12,
    }
}

fn invisible(robot: &Robot) -> Vec<Invisible> {
    let one = |request: &str, parameter, smallest_visible| Invisible {
        cause: cause(robot, request),
        parameter,
        smallest_visible,
    };
    vec![
        one("pulley_axis_tilt:1", ("tilt_1", "rad"), Some(0.1)),
        one("pulley_axis_tilt:2", ("tilt_1", "rad"), Some(0.2)),
        one("pulley_axis_tilt:2", ("tilt_2", "rad"), None),
        one("cable_creep", ("c", "1"), None),
        one("pulley_friction", ("mu", "1"), Some(0.2)),
    ]
}

/// A diagnosis with these findings; without any the model explains the data.
pub fn diagnosed(dataset: &Dataset, verdicts: &[Verdict]) -> Diagnosed {
    let robot = &dataset.robot;
    let is_clean = verdicts.is_empty();
    let found = |v: &Verdict| finding(robot, *v);
    let structure = if is_clean {
        Vec::new()
    } else {
        vec![discrepancy()]
    };
    let noise = NoiseStatement {
        quantity: Quantity::Laser,
        cable: None,
        ratio: 2.1,
        interval: [1.8, 2.5],
        p_value: 1e-6,
    };
    let diagnosis = Diagnosis {
        drawing: None,
        slack: None,
        base: adequacy(is_clean, if is_clean { 100.0 } else { 256.0 }),
        extended: adequacy(true, 100.0),
        discrepancies: structure.clone(),
        remaining: structure,
        findings: verdicts.iter().map(found).collect(),
        possible: if is_clean {
            Vec::new()
        } else {
            vec![possible(robot)]
        },
        sets: Vec::new(),
        unseen: Vec::new(),
        noise: if is_clean { Vec::new() } else { vec![noise] },
        invisible: invisible(robot),
        readable: 40,
        tolerances: ToleranceFactor {
            factor: 0.6,
            are_stated: false,
        },
        held: 0,
        base_solution: solution(dataset, &[]),
        extended_solution: solution(dataset, if is_clean { &[] } else { &["winch_scale:3"] }),
        cancelled: false,
    };
    Diagnosed {
        mistakes: Vec::new(),
        dataset: Arc::new(dataset.clone()),
        measured: dataset.measurements.len(),
        diagnosis,
        alpha: 0.01,
        seconds: 0.1,
        limit_s: 60.0,
        ended_at_limit: false,
    }
}
