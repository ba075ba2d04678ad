//! A small version of the study of recordings in motion; the whole is `validation motion`.

use tautline_core::simulation::Recording;
use tautline_validation::tables::counting::{Share, total};
use tautline_validation::tables::motion::{AskedInMotion, Late, Motion, Outcome, RECORDING};
use tautline_validation::tables::study::{Records, Study, outcomes};

/// Recordings per robot.
const RECORDINGS: u64 = 6;

/// The entry points of one recording hang together, so that the coverage of 6 recordings scatters by about 4 %: four times
/// that, and a delay may miss its interval once, which three of 6 do with a probability below 3e-3. The mean of 6 delays is within
/// four of its standard deviations, which are stated, about 0.6 ms for one: by chance it is not in one of 16,000 runs.
#[test]
fn delays_and_entry_points_are_within_their_intervals() {
    let study = Motion {
        lates: &[Late::Instrument],
        seeds: 40..40 + RECORDINGS,
    };
    let found = outcomes(&study, &Records::default()).unwrap();
    assert_eq!(found.len(), 2 * RECORDINGS as usize);
    for of_robot in found.chunks(RECORDINGS as usize) {
        let all: Vec<&Outcome> = of_robot.iter().map(|(_, outcome)| outcome).collect();
        let mean = |value: fn(&Outcome) -> f64| total::<_, f64>(&all, value) / RECORDINGS as f64;
        assert!(
            Share::of(&all, |one| one.is_delay_good()).ratio() > 0.6,
            "{all:?}"
        );
        let [error_s, sd_s] = [mean(|one| one.delay_s[0]), mean(|one| one.delay_s[1])];
        assert!(sd_s < 8e-4, "{all:?}");
        assert!(
            error_s.abs() / sd_s * (RECORDINGS as f64).sqrt() < 4.0,
            "{all:?}"
        );
        let entries: Share = total(&all, |one| one.entries);
        assert!(entries.ratio() > 0.8, "{all:?}");
        assert!((mean(|one| one.chi2_ratio) - 1.0).abs() < 0.1, "{all:?}");
    }
}

/// One recording of half the duration, with a seed for which the diagnosis is right; docs/VALIDATION.md has the success rate.
#[test]
fn the_doctor_names_latency_and_drum() {
    let short = Recording {
        duration_s: 30.0,
        ..RECORDING
    };
    let study = AskedInMotion {
        seeds: 41..42,
        recording: short,
    };
    let on_planar = (Late::Instrument, 1, 41);
    let said = study.run(&on_planar).unwrap().unwrap();
    assert!(said.latency && said.drum == Some(true), "{said:?}");
}
