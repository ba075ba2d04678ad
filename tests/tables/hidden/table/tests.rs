use super::figures::Target;
use super::*;
use crate::tables::hidden::{Circumstances, Conditions, Drawn, ParameterError, Plan};
use crate::tables::simulated::setting;

fn said(text: &str) -> FindingRecord {
    FindingRecord {
        text: text.to_owned(),
        verdict: Verdict::Named,
        gain: 45.0,
        candidates: vec![],
    }
}

fn outcome(wanted: Wanted, hidden: Hidden, found: &[Found], answers: &[&str]) -> Outcome {
    let plan = Plan {
        robot: "mini",
        seed: 1,
        wanted,
        circumstances: Circumstances::AsStated,
    };
    let answers: Vec<String> = answers.iter().map(|a| (*a).to_owned()).collect();
    let wrong = found.iter().all(|f| *f != Found::Named);
    Outcome {
        plan,
        drawn: Drawn {
            hidden,
            conditions: Conditions::default(),
            noncentralities: vec![50.0; found.len()],
            visible: true,
            redraws: 1,
        },
        found: found.to_vec(),
        said: answers.iter().map(|text| said(text)).collect(),
        wrong_names: if wrong { answers } else { vec![] },
        possible: vec![],
        noise: vec![],
        without_holes: None,
        parameters: vec![ParameterError {
            effect: "winch_scale",
            parameter: "scale",
            standardised: 1.0,
        }],
        held_out_ratio: Some(1.01),
        seconds: 0.5,
    }
}

fn scale() -> Hidden {
    let scale = setting("winch_scale", &["cable-3"], "scale", 0.003);
    Hidden::Effects(vec![scale])
}

fn study() -> Study {
    let one = Wanted::One("winch_scale", Stratum::Typical);
    Study {
        outcomes: vec![
            outcome(one, scale(), &[Found::Named], &["winch_scale:3"]),
            outcome(one, scale(), &[Found::OtherNamed], &["pulley_radius:3"]),
            outcome(Wanted::Nothing, Hidden::Nothing, &[], &[]),
            outcome(Wanted::Nothing, Hidden::Nothing, &[], &["laser_bias"]),
            outcome(
                Wanted::Outside("obstacle"),
                Hidden::Outside(&OUTSIDE[8], 1e-3),
                &[],
                &["winch_offset:1"],
            ),
        ],
        not_applicable: 2,
        impossible: vec![],
    }
}

fn counted(figures: &Figures, what: &str) -> (usize, usize) {
    let mut all = figures.all.iter();
    let figure = all.find(|figure| figure.what.starts_with(what)).unwrap();
    (figure.share.part, figure.share.whole)
}

#[test]
fn outcomes_are_counted_correctly() {
    let figures = Figures::of(&study());
    let count = |what| counted(&figures, what);
    assert_eq!(count("typical size: named, or"), (1, 2));
    assert_eq!(count("typical size: another"), (1, 2));
    assert_eq!(count("clean data"), (1, 2));
    assert_eq!(count("outside the catalogue: unknown"), (0, 1));
    assert_eq!(count("outside the catalogue: named"), (1, 1));
    assert_eq!(count("just visible: named"), (0, 0));
    assert_eq!(count("parameters"), (5, 5));
}

#[test]
fn a_share_is_compared_with_its_requirement() {
    let figure = |part, target| Figure {
        what: String::new(),
        share: Share { part, whole: 10 },
        target: Some(target),
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    close(figure(10, Target::AtLeast(0.9)).p_value(), 1.0);
    close(figure(0, Target::AtLeast(0.9)).p_value(), 0.1_f64.powi(10));
    close(
        figure(1, Target::AtMost(0.01)).p_value(),
        1.0 - 0.99_f64.powi(10),
    );
}

#[test]
fn tables_show_successes_and_confusions() {
    let text = markdown(&study());
    assert!(text.contains("| winch_scale | 1/2 | - |"), "{text}");
    assert!(
        text.contains("| winch_scale | pulley_radius | 1 |"),
        "{text}"
    );
    assert!(text.contains("| nothing | laser_bias | 1 |"), "{text}");
    assert!(text.contains("| obstacle | winch_offset | 1 |"), "{text}");
    assert!(!text.contains("| laser_cyclic | winch"), "{text}");
    assert_eq!(failures(&study()).lines().count(), 3);
}
