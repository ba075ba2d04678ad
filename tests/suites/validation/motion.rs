//! A small version of the study of recordings in motion; the whole is `validation motion`.

use tautline_core::simulation::Recording;
use tautline_validation::tables::motion::{Late, RECORDING, doctor_study, study};

/// Recordings per robot.
const RECORDINGS: usize = 6;

/// The entry points of one recording hang together, so that the coverage of 6 recordings scatters by about 4 %: four times
/// that, and a delay may miss its interval once, which three of 6 do with a probability below 3e-3. The mean of 6 delays is within
/// four of its standard deviations, which are stated, about 0.6 ms for one: by chance it is not in one of 16,000 runs.
#[test]
fn delays_and_entry_points_are_within_their_intervals() {
    for name in ["mini", "planar"] {
        let row = study(name, Late::Instrument, RECORDINGS, 40).unwrap();
        assert!(row.delay_good > 0.6, "{row:?}");
        assert!(row.delay_sd_s < 8e-4, "{row:?}");
        let bias = row.delay_bias_s.abs() / row.delay_sd_s * (RECORDINGS as f64).sqrt();
        assert!(bias < 4.0, "{row:?}");
        assert!(row.entry_covered > 0.8, "{row:?}");
        assert!((row.chi2_ratio - 1.0).abs() < 0.1, "{row:?}");
    }
}

/// One recording of half the duration, with a seed for which the diagnosis is right; docs/VALIDATION.md has the success rate.
#[test]
fn the_doctor_names_latency_and_drum() {
    let short = Recording {
        duration_s: 30.0,
        ..RECORDING
    };
    let row = doctor_study("planar", 1, 41, &short).unwrap();
    assert!(row.latency_named > 0.99 && row.drum_named > 0.99, "{row:?}");
}
