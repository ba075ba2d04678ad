//! The evidence of sets against dense algebra, and the search against enumeration of all sets.

use nalgebra::{DMatrix, DVector};

use super::super::candidates::Acts;
use super::super::evidence::{Member, System};
use super::super::gram::Gram;
use super::super::linear_fit::LinearFit;
use super::super::search::Search;
use super::{Fit, based, run_with, setting};
use crate::measurement::Dataset;

/// Data with two causes, noise that is not as described.
fn dataset() -> Dataset {
    let scale = setting("winch_scale", &["cable-3"], &[("scale", 0.004)]);
    let slip = setting(
        "cable_slip",
        &["cable-1"],
        &[("step", 0.003), ("pose", 6.0)],
    );
    run_with("planar", 12, 31, &[scale, slip]).dataset
}

/// Logarithm of the density of the conditions under a dense covariance, what is always estimated having a flat prior.
fn dense_log_evidence(at: &LinearFit<'_, '_>, variance: &[f64], columns: &DMatrix<f64>) -> f64 {
    let linear = &at.linear;
    let count = linear.conditions.count;
    let mut whitening = DMatrix::identity(count, count);
    let noise = linear.conditions.noise(variance);
    noise.whiten(&mut whitening);
    let inverse = whitening.tr_mul(&whitening);
    let covariance = inverse.try_inverse().unwrap() + columns * columns.transpose();
    let weight = covariance.clone().try_inverse().unwrap();
    let fixed = &linear.fixed;
    let normal = fixed.tr_mul(&weight) * fixed;
    let pull = fixed.tr_mul(&weight) * &linear.residual;
    let square = linear.residual.dot(&(&weight * &linear.residual))
        - pull.dot(&(normal.clone().try_inverse().unwrap() * &pull));
    let log_determinant = |m: DMatrix<f64>| -> f64 { m.symmetric_eigenvalues().map(f64::ln).sum() };
    -0.5 * (log_determinant(covariance) + log_determinant(normal) + square)
}

#[test]
fn evidence_is_that_of_the_dense_covariance() {
    let dataset = dataset();
    let problem = based(&dataset);
    let fit = Fit::new(&problem, &[]).unwrap();
    let at = LinearFit::new(&fit, 0.8, true);
    let described = at.linear.described();
    let mut louder = at.linear.louder(1.0);
    for (k, variance) in louder.variance.iter_mut().enumerate() {
        *variance = 0.5 + 0.3 * k as f64;
    }
    let candidates = &at.catalogue.candidates;
    let find = |id: &str, acts: fn(Acts) -> bool| {
        let is = |c: &super::super::candidates::Candidate| {
            c.effect().id() == id && acts(c.columns[0].acts)
        };
        candidates.iter().position(is).unwrap()
    };
    let members: Vec<Member> = vec![
        (find("force_gain", |_| true), 1),
        (find("cable_slip", |acts| acts == Acts::From(5)), 0),
        (find("encoder_outlier", |acts| acts == Acts::At(3)), 1),
        (find("laser_cyclic", |_| true), 0),
    ];
    for hyper in [&described, &louder] {
        let mut gram = at.gram(hyper);
        for count in 0..=members.len() {
            let set = &members[..count];
            let odds = |m: &Member| candidates[m.0].log_odds + candidates[m.0].scales[m.1].1;
            let prior: f64 = set.iter().map(odds).sum();
            let of_none = gram.base.log_evidence;
            let closed = of_none + System::new(&mut gram, set).log_posterior - prior;
            let dense = dense_log_evidence(&at, &hyper.variance, &at.columns(set));
            assert!(
                (closed - dense).abs() < 1e-5 * dense.abs(),
                "{closed} {dense}"
            );
            // The gain of the next is the difference of both.
            let (Some(next), system) = (members.get(count), System::extensible(&mut gram, set))
            else {
                continue;
            };
            let (gain, scale) = system.gain(&gram, next.0, f64::NEG_INFINITY).unwrap();
            let mut more = set.to_vec();
            more.push((next.0, scale));
            let with = System::new(&mut gram, &more).log_posterior;
            assert!((with - system.log_posterior - gain).abs() < 1e-7 * with.abs());
        }
    }
}

/// All sets of up to three of the candidates, at the scales that the search chose.
fn enumerated(gram: &mut Gram<'_>) -> Vec<(Vec<usize>, f64)> {
    let all = gram.candidates;
    let mut found = Vec::new();
    let mut open: Vec<Vec<usize>> = vec![Vec::new()];
    while let Some(set) = open.pop() {
        let mut members: Vec<Member> = set.iter().map(|k| (*k, 0)).collect();
        // Scales one after the other until none changes.
        for _ in 0..4 {
            for place in 0..members.len() {
                let mut others = members.clone();
                others.remove(place);
                let system = System::extensible(gram, &others);
                let best = system
                    .gain(gram, members[place].0, f64::NEG_INFINITY)
                    .unwrap();
                members[place].1 = best.1;
            }
        }
        found.push((set.clone(), System::new(gram, &members).log_posterior));
        if set.len() < 3 {
            for next in set.last().map_or(0, |last| last + 1)..all.len() {
                if set.iter().all(|k| !all[*k].excludes(&all[next])) {
                    let mut more = set.clone();
                    more.push(next);
                    open.push(more);
                }
            }
        }
    }
    found
}

/// The probability of every cause, found by the search and by enumeration of all sets of a robot with few candidates.
#[test]
fn the_search_finds_what_enumeration_finds() {
    let mut dataset = dataset();
    dataset.measurements.laser_m.clear();
    let problem = based(&dataset);
    let fit = Fit::new(&problem, &[]).unwrap();
    let mut at = LinearFit::new(&fit, 0.8, true);
    let few = ["winch_scale", "winch_offset", "force_gain", "pulley_radius"];
    at.catalogue.candidates.retain(|c| {
        let slip = c.effect().id() == "cable_slip" && c.cause.cables() == [0];
        few.contains(&c.effect().id()) || slip
    });
    let hyper = at.linear.described();
    let mut gram = at.gram(&hyper);
    let exact = enumerated(&mut gram);
    let count = gram.candidates.len();
    let mut search = Search::new(&mut gram, 3);
    search.visit(&[]);
    search.run(200, &mut || true);
    let visited: Vec<(Vec<usize>, f64)> = search
        .visited
        .iter()
        .map(|(set, v)| (set.clone(), v.log_posterior))
        .collect();
    let probabilities = |sets: &[(Vec<usize>, f64)]| -> DVector<f64> {
        let top = sets.iter().map(|s| s.1).fold(f64::NEG_INFINITY, f64::max);
        let mut sums = DVector::zeros(count);
        let mut total = 0.0;
        for (set, value) in sets {
            let weight = (value - top).exp();
            total += weight;
            set.iter().for_each(|k| sums[*k] += weight);
        }
        sums / total
    };
    let (exact, found) = (probabilities(&exact), probabilities(&visited));
    let off = (&exact - &found).amax();
    assert!(off < 0.05, "{off}");
    assert!(exact.max() > 0.9);
}
