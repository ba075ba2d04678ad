//! A point on eight cables whose motion is a sum of sines, recorded twice, computed independently of the program.

use std::f64::consts::TAU;

use super::*;
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// True clock error of the second recorder.
#[derive(Clone, Copy)]
struct Truth {
    offset_s: f64,
    drift: f64,
}

/// Time of the robot at a time of the second recorder.
fn true_time(truth: Truth, own_s: f64) -> f64 {
    own_s + truth.offset_s + truth.drift * own_s
}

/// Both recordings: lengths of the cables at 100 Hz for 60 s, and the position of a reflector in another frame at 40 Hz.
fn recordings(truth: Truth, seed: u64) -> (Recording, Recording) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let sines: Vec<[[f64; 3]; 3]> = (0..3)
        .map(|_| {
            [0, 1, 2].map(|k| {
                let period = 5.0 + 6.0 * f64::from(k) + random.random_range(0.0..4.0);
                let phase = random.random_range(0.0..TAU);
                [0.12 + 0.05 * f64::from(k), period, phase]
            })
        })
        .collect();
    let position = |time: f64| -> [f64; 3] {
        let along = |axis: usize| {
            let parts = sines[axis].iter();
            parts
                .map(|[size, period, phase]| size * (TAU * time / period + phase).sin())
                .sum()
        };
        [along(0), along(1), along(2)]
    };
    let mut noise = |sd: f64| {
        let normal = Normal::new(0.0, sd).expect("a distribution");
        normal.sample(&mut random)
    };
    let mut cables = Recording {
        time_s: (0..6000).map(|k| 100.0 + 0.01 * f64::from(k)).collect(),
        channels: vec![Vec::new(); 8],
    };
    for time in cables.time_s.clone() {
        let p = position(time);
        for (k, channel) in cables.channels.iter_mut().enumerate() {
            let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let pulley = [1.5 * sign(0), 1.2 * sign(1), 1.3 * sign(2)];
            let squares = (0..3).map(|axis| (pulley[axis] - p[axis]).powi(2));
            channel.push(squares.sum::<f64>().sqrt() + noise(5e-5));
        }
    }
    let mut reflector = Recording {
        time_s: (0..1800).map(|k| 0.025 * f64::from(k)).collect(),
        channels: vec![Vec::new(); 3],
    };
    for own in reflector.time_s.clone() {
        let [x, y, z] = position(true_time(truth, own));
        let turned = [0.8 * x - 0.6 * y + 3.0, 0.6 * x + 0.8 * y - 1.0, z + 0.4];
        for (channel, value) in reflector.channels.iter_mut().zip(turned) {
            channel.push(1e3 * (value + noise(3e-4)));
        }
    }
    (cables, reflector)
}

#[test]
fn offset_and_drift_are_found_within_their_standard_deviations() {
    let mut within = [0, 0];
    let runs = 60;
    for seed in 0..runs {
        let truth = Truth {
            offset_s: 104.0 + 0.037 * seed as f64,
            drift: 5e-5,
        };
        let (cables, reflector) = recordings(truth, seed);
        let fit = align(&cables, &reflector).expect("one motion");
        let offset = true_time(truth, fit.middle_s) - fit.middle_s;
        assert!(
            (fit.offset_s - offset).abs() < 1e-3,
            "{seed}: {fit:?}, {offset}"
        );
        // Leaving out a part of the recording weakens the polynomial, so that these are rather too large.
        assert!(fit.offset_sd_s < 1.5e-3, "{seed}: {fit:?}");
        // 95 % of Student's t with 11 degrees of freedom.
        within[0] += u32::from((fit.offset_s - offset).abs() < 2.20 * fit.offset_sd_s);
        within[1] += u32::from((fit.drift - truth.drift).abs() < 2.20 * fit.drift_sd);
    }
    // 51 of 60 or more, of 95 %: by chance less often than once in 500.
    assert!(
        within.iter().all(|count| *count >= 51),
        "{within:?} of {runs}"
    );
}

#[test]
fn recordings_of_different_motions_are_not_aligned() {
    let truth = Truth {
        offset_s: 110.0,
        drift: 0.0,
    };
    let (cables, _) = recordings(truth, 1);
    let (_, other) = recordings(truth, 2);
    assert_eq!(align(&cables, &other), None);
}

#[test]
fn the_recipe_takes_the_clock_of_the_second_series() {
    use crate::recipe::Assignment;
    use tautline_channels::{Channel, Format, Series};
    let truth = Truth {
        offset_s: 103.25,
        drift: -4e-5,
    };
    let (cables, reflector) = recordings(truth, 11);
    let source = |name: &str, columns: &[String], recording: &Recording| Source {
        file: format!("{name}.csv"),
        format: Format::Table,
        series: vec![Series {
            name: name.into(),
            rows: recording.time_s.len(),
            time_s: Some(recording.time_s.clone().into()),
            channels: columns
                .iter()
                .zip(&recording.channels)
                .map(|(name, values)| Channel {
                    name: name.clone(),
                    unit: None,
                    values: values.clone().into(),
                })
                .collect(),
            texts: Vec::new(),
        }],
        notices: Vec::new(),
    };
    let lengths: Vec<String> = (1..=8).map(|k| format!("L{k}")).collect();
    let axes = ["x", "y", "z"].map(str::to_owned);
    let sources = [
        source("log", &lengths, &cables),
        source("take", &axes, &reflector),
    ];
    let mut recipe = Recipe {
        channels: vec![Assignment::new("L{i}", "length_{i}_m")],
        ..Recipe::default()
    };
    let robot = tautline_core::robot::presets::find("mini")
        .expect("a preset")
        .robot;
    let alone = align_clocks(&sources, &mut recipe, &robot).expect_err("one clock");
    assert!(
        alone.to_string().contains("found one clock only"),
        "{alone}"
    );
    let measured = axes.iter().map(|axis| Assignment {
        unit: Some("mm".into()),
        ..Assignment::new(axis.clone(), format!("meas_{axis}_m"))
    });
    recipe.channels.extend(measured);
    for _ in 0..2 {
        // A second alignment finds the same clock, not a remainder.
        let found = align_clocks(&sources, &mut recipe, &robot).expect("aligned");
        assert_eq!(found.len(), 1);
        assert!(
            found[0].sentence.contains("behind that of log"),
            "{}",
            found[0].sentence
        );
        assert_eq!(recipe.clocks.len(), 1);
        let times = crate::draft::clock_times(&sources, &recipe, &robot);
        let times = times[1].as_ref().expect("times");
        for (own, time) in reflector.time_s.iter().zip(times) {
            assert!((time - true_time(truth, *own)).abs() < 2e-3, "{time}");
        }
    }
}
