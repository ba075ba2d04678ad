//! Recordings in motion, in words.

use tautline_core::measurement::{Measurements, Sampling};

use super::count;

/// Sentence on the samples of a recording that are used, with the reason; `None` for poses at rest.
#[must_use]
pub fn sampling_sentence(data: &Measurements) -> Option<String> {
    let sampling = &data.rates.as_ref()?.sampling;
    let used = format!(
        "A recording in motion: {} of {} are used, {} apart",
        data.len(),
        count(sampling.recorded, "sample"),
        milliseconds(sampling.interval_s)
    );
    let why = match correlated(sampling) {
        None => "; their noise is independent.".to_owned(),
        Some(kinds) => {
            format!(", so that their noise is independent: its correlation time is {kinds}.")
        }
    };
    Some(used + &why)
}

/// Number of the `measured` poses that an identification used, with the reason if not all: `1497 of 60001 poses: ...`.
#[must_use]
pub fn poses_used(used: &Measurements, measured: usize) -> String {
    let poses = count(measured, "pose");
    if used.len() >= measured {
        return poses;
    }
    let why = match &used.rates {
        Some(rates) => format!(
            "samples {} apart have independent noise",
            milliseconds(rates.sampling.interval_s)
        ),
        None => "the samples of each standstill are averaged".to_owned(),
    };
    format!("{} of {poses}: {why}", used.len())
}

/// Correlation time of the noise for each kind of reading; `None` if it is shorter than the sampling interval.
fn correlated(sampling: &Sampling) -> Option<String> {
    let long = sampling.correlation_s.iter();
    let kinds: Vec<String> = long
        .filter(|(_, time_s)| *time_s > 0.25 * sampling.step_s)
        .map(|(kind, time_s)| format!("{} in {}", milliseconds(*time_s), kind.name()))
        .collect();
    (!kinds.is_empty()).then(|| kinds.join(", "))
}

fn milliseconds(time_s: f64) -> String {
    format!("{:.0} ms", 1e3 * time_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::measurement::{Rates, ReadingKind};

    #[test]
    fn poses_that_are_not_used_have_a_reason() {
        let mut used = Measurements {
            labels: vec![0, 1, 2],
            ..Measurements::default()
        };
        assert_eq!(poses_used(&used, 3), "3 poses");
        assert_eq!(
            poses_used(&used, 60),
            "3 of 60 poses: the samples of each standstill are averaged"
        );
        used.rates = Some(Rates {
            sampling: Sampling {
                interval_s: 0.2,
                ..Sampling::default()
            },
            ..Rates::default()
        });
        assert_eq!(
            poses_used(&used, 60),
            "3 of 60 poses: samples 200 ms apart have independent noise"
        );
    }

    #[test]
    fn what_is_used_is_said() {
        let mut data = Measurements {
            labels: vec![0, 20],
            ..Measurements::default()
        };
        assert_eq!(sampling_sentence(&data), None);
        let mut sampling = Sampling {
            recorded: 6001,
            step_s: 0.01,
            interval_s: 0.2,
            correlation_s: vec![(ReadingKind::Length, 0.05), (ReadingKind::Laser, 0.001)],
        };
        let said = |sampling: &Sampling, data: &mut Measurements| {
            data.rates = Some(Rates {
                sampling: sampling.clone(),
                ..Rates::default()
            });
            sampling_sentence(data).unwrap()
        };
        assert_eq!(
            said(&sampling, &mut data),
            "A recording in motion: 2 of 6001 samples are used, 200 ms apart, so that their noise is independent: its correlation time is 50 ms in lengths."
        );
        sampling.correlation_s.clear();
        assert_eq!(
            said(&sampling, &mut data),
            "A recording in motion: 2 of 6001 samples are used, 200 ms apart; their noise is independent."
        );
    }
}
