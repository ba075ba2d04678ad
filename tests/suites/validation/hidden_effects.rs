//! A fixed selection of the hidden-effect test; the whole is `validation hidden all`.
//!
//! The selection is small, so that its shares scatter. A figure fails if a count as bad would have a
//! probability below [`LEVEL`] were the share exactly the required one. Seeds are fixed: a change of the
//! program that meets the requirements fails one of the figures with a probability of at most their number times
//! `LEVEL`, 9e-3; with margins, far less.

use tautline_validation::tables::hidden::{
    Figure, Figures, Plan, Restriction, Study, clean, failures, markdown, outside, pairs, run_all,
    single,
};
use tautline_validation::tables::study::Records;

/// Probability of a false failure of one figure whose share is exactly the required one.
const LEVEL: f64 = 1e-3;

/// Every `step`-th plan.
fn some(plans: Vec<Plan>, step: usize) -> Vec<Plan> {
    plans.into_iter().step_by(step).collect()
}

fn run(plans: &[Plan]) -> Study {
    run_all(plans, &Records::default())
}

/// Fails where a figure is worse than required, beyond what chance explains.
fn check(study: &Study) {
    println!("{}\n{}", markdown(study), failures(study));
    let figures = Figures::of(study).all;
    let bad: Vec<&Figure> = figures.iter().filter(|f| f.p_value() < LEVEL).collect();
    assert!(bad.is_empty(), "{bad:#?}");
    assert!(study.impossible.is_empty(), "{:?}", study.impossible);
}

#[test]
fn hidden_effects_are_named() {
    // 17 is prime to the numbers of robots and effects: all of them take part.
    check(&run(&some(single(3, &Restriction::default()), 17)));
}

#[test]
fn two_hidden_effects_are_both_named() {
    check(&run(&pairs(1, &Restriction::default())));
}

#[test]
fn nothing_is_found_in_clean_data() {
    check(&run(&clean(36, &Restriction::default())));
}

#[test]
fn effects_outside_the_catalogue_are_not_forced_into_it() {
    check(&run(&some(outside(1, &Restriction::default()), 7)));
}
