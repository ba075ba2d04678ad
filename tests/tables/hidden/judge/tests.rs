use tautline_core::diagnosis::{ErrorForm, Quantity, ReadingId, UnmodelledError};

use super::*;
use crate::tables::hidden::robots::robot;

fn mini() -> Robot {
    robot("mini").unwrap().preset.robot
}

fn setting(effect: &str, targets: &[&str], values: &[(&str, f64)]) -> EffectSetting {
    EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|t| (*t).to_owned()).collect(),
        parameters: values.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
    }
}

fn cause(settings: &[EffectSetting]) -> Cause {
    let bound = settings
        .iter()
        .map(|s| BoundEffect::from_setting(s, &mini()));
    Cause {
        instances: bound.collect::<Result<_, _>>().unwrap(),
    }
}

fn claim(verdict: Verdict, candidates: &[EffectSetting]) -> Claim {
    let each = candidates
        .iter()
        .map(|s| Subject::Cause(cause(std::slice::from_ref(s))));
    Claim {
        verdict,
        candidates: each.collect(),
        probabilities: vec![1.0; candidates.len()],
        finding: 0,
    }
}

fn scale(cable: &str) -> EffectSetting {
    setting("winch_scale", &[cable], &[("scale", 0.003)])
}

fn found(truths: &[EffectSetting], claims: &[Claim]) -> Vec<Found> {
    let judged = judge(truths, claims, &mini());
    judged.into_iter().map(|(found, _)| found).collect()
}

#[test]
fn effect_and_target_must_both_be_right() {
    let truths = [scale("cable-3")];
    let named = |s: EffectSetting| found(&truths, &[claim(Verdict::Named, &[s])]);
    assert_eq!(named(scale("cable-3")), [Found::Named]);
    assert_eq!(named(scale("cable-4")), [Found::OtherNamed]);
    let radius = setting("pulley_radius", &["cable-3"], &[("change", 0.1)]);
    assert_eq!(named(radius), [Found::OtherNamed]);
    assert_eq!(found(&truths, &[]), [Found::Missed]);
    let mut unknown = claim(Verdict::Unknown, &[]);
    unknown
        .candidates
        .push(Subject::UnmodelledError(UnmodelledError {
            readings: ReadingId {
                quantity: Quantity::Length,
                cable: Some(2),
                component: None,
            },
            form: ErrorForm::Scatter,
            rms: None,
        }));
    assert_eq!(found(&truths, &[unknown]), [Found::Unknown]);
}

#[test]
fn lists_may_have_three_causes() {
    let truths = [scale("cable-3")];
    let list = |cables: &[&str]| {
        let candidates: Vec<_> = cables.iter().map(|c| scale(c)).collect();
        found(&truths, &[claim(Verdict::Ambiguous, &candidates)])
    };
    assert_eq!(list(&["cable-1", "cable-2", "cable-3"]), [Found::Listed]);
    let long = ["cable-1", "cable-2", "cable-3", "cable-4"];
    assert_eq!(list(&long), [Found::ListedLong]);
    assert_eq!(list(&["cable-1"]), [Found::OtherListed]);
}

#[test]
fn a_common_scale_equals_the_same_scale_of_every_winch() {
    let truths = [setting("winch_scale_common", &[], &[("scale", 0.003)])];
    let all = |last: f64| {
        let each: Vec<_> = (1..=8)
            .map(|k| {
                let value = if k == 8 { last } else { 0.003 };
                setting("winch_scale", &[&format!("cable-{k}")], &[("scale", value)])
            })
            .collect();
        cause(&each)
    };
    assert_eq!(matched(&truths, &all(0.0031), &mini()), [0]);
    assert!(matched(&truths, &all(-0.003), &mini()).is_empty());
    let on_all = [setting("winch_scale", &[], &[("scale", 0.003)])];
    assert_eq!(matched(&on_all, &cause(&truths), &mini()), [0]);
}

#[test]
fn one_finding_may_stand_for_two_cables_but_not_blame_a_third() {
    let truths = [scale("cable-3"), scale("cable-5")];
    let both = cause(&[scale("cable-3"), scale("cable-5")]);
    assert_eq!(matched(&truths, &both, &mini()), [0, 1]);
    let three = cause(&[scale("cable-3"), scale("cable-5"), scale("cable-6")]);
    assert!(matched(&truths, &three, &mini()).is_empty());
}

#[test]
fn steps_may_be_a_pose_off_and_outliers_may_not() {
    let slip = |pose: f64| {
        setting(
            "cable_slip",
            &["cable-2"],
            &[("step", 0.01), ("pose", pose)],
        )
    };
    let outlier = |pose: f64| setting("laser_outliers", &[], &[("error", 0.05), ("pose", pose)]);
    let named = |truth: EffectSetting, said: EffectSetting| {
        found(&[truth], &[claim(Verdict::Named, &[said])])[0]
    };
    assert_eq!(named(slip(20.0), slip(21.0)), Found::Named);
    assert_eq!(named(slip(20.0), slip(22.0)), Found::OtherNamed);
    assert_eq!(named(outlier(20.0), outlier(20.0)), Found::Named);
    assert_eq!(named(outlier(20.0), outlier(21.0)), Found::OtherNamed);
}

#[test]
fn additional_wrong_names_are_counted() {
    let truths = [scale("cable-3")];
    let claims = [
        claim(Verdict::Named, &[scale("cable-3")]),
        claim(Verdict::Named, &[scale("cable-4")]),
        claim(Verdict::Ambiguous, &[scale("cable-1"), scale("cable-2")]),
    ];
    assert_eq!(found(&truths, &claims), [Found::Named]);
    assert_eq!(wrong_names(&truths, &claims, &mini()), ["winch_scale:4"]);
}

#[test]
fn a_correct_name_does_not_count_for_another_effect() {
    let truths = [scale("cable-3"), scale("cable-5")];
    let claims = [claim(Verdict::Named, &[scale("cable-3")])];
    assert_eq!(found(&truths, &claims), [Found::Named, Found::Missed]);
}
