//! Noise larger than described produces chance patterns, none of which may be named.

use super::{diagnosed, found, run_with};
use crate::diagnosis::{Quantity, Verdict};

/// A correct program names a cause in each of the 12 datasets with a probability of about 0.01, so that one is allowed.
#[test]
fn excess_noise_is_not_named_as_a_cause() {
    let mut named = 0;
    let mut stated = 0;
    for name in ["mini", "hall", "planar", "suspended"] {
        for seed in 1..4 {
            let mut run = run_with(name, 41, seed, &[]);
            if let Some(laser) = &mut run.dataset.robot.laser {
                laser.sd_m /= 2.1;
            }
            let diagnosis = diagnosed(&run.dataset);
            let sure = |f: &crate::diagnosis::Finding| f.verdict() == Verdict::Named;
            named += usize::from(diagnosis.findings.iter().any(sure));
            let covers = |s: &crate::diagnosis::NoiseStatement| {
                s.quantity == Quantity::Laser && s.interval[0] < 2.1 && s.interval[1] > 2.1
            };
            stated += usize::from(diagnosis.noise.iter().any(covers));
        }
    }
    assert!(named <= 1, "{named}");
    // Each statement covers the truth with probability 0.95, and statements are made almost surely.
    assert!(stated >= 8, "{stated}");
}

/// A cause is still found if the noise is larger than described.
#[test]
fn a_cause_is_found_in_excess_noise() {
    let setting = super::setting("winch_scale", &["cable-2"], &[("scale", 0.008)]);
    let mut run = run_with("mini", 41, 1, std::slice::from_ref(&setting));
    for cable in &mut run.dataset.robot.cables {
        cable.winch.length_sd_m /= 2.0;
    }
    let diagnosis = diagnosed(&run.dataset);
    assert_eq!(found(&diagnosis)[0], ("winch_scale", vec![1]));
    assert_eq!(diagnosis.findings[0].verdict(), Verdict::Named);
    // Further findings may only be the noise itself.
    let rest = &diagnosis.findings[1..];
    assert!(rest.iter().all(|f| f.verdict() == Verdict::Unknown));
    assert_eq!(diagnosis.noise[0].quantity, Quantity::Length);
}
