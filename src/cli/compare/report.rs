//! Human-readable form of a comparison.

use tautline_core::comparison::{Comparison, ScalarDifference};

use crate::output::say;
use crate::table::{self, mm};
use tautline_workflow::comparison::{ComparisonDocument, PulleyDocument, unexplained, verdict};
use tautline_workflow::wording::units::{quantity, significant, with_sd};

/// Prints the differences.
pub fn print(comparison: &Comparison, compared: &ComparisonDocument) {
    let shown = |pulley: &PulleyDocument| pulley.relative.unwrap_or(pulley.raw);
    let along = |pulley: &PulleyDocument, axis: usize| mm(shown(pulley).vector_m[axis], 2);
    table::rows(&compared.pulleys).print(&[
        ("Pulley", &|one| one.cable.clone()),
        ("dx mm", &|one| along(one, 0)),
        ("dy mm", &|one| along(one, 1)),
        ("dz mm", &|one| along(one, 2)),
        ("length mm", &|one| mm(shown(one).length_m, 2)),
        ("sd mm", &|one| mm(shown(one).length_sd_m, 2)),
        ("verdict", &|one| match (&one.test, one.moved) {
            (None, _) => "undetermined".to_owned(),
            (Some(_), true) => "moved".to_owned(),
            (Some(_), false) => "noise".to_owned(),
        }),
        ("p corrected", &|one| {
            one.test
                .map_or(String::new(), |test| probability(test.p_corrected))
        }),
    ]);
    if let Some(motion) = &compared.common_motion {
        let shift = [0, 1, 2].map(|k| with_sd(motion.shift_m[k], motion.shift_sd_m[k], "m"));
        let turn =
            [0, 1, 2].map(|k| with_sd(motion.rotation_rad[k], motion.rotation_sd_rad[k], "rad"));
        say!("common shift, removed: {}", shift.join(", "));
        say!("common rotation, removed: {}", turn.join(", "));
    }
    if let Some(plane) = &compared.target_plane {
        say!("target plane: {}", scalar(plane, "m", compared.level));
    }
    for effect in &compared.effects {
        let on = effect.targets.join(", ");
        let size = scalar(&effect.size, &effect.unit, compared.level);
        say!("{} {} {on}: {size}", effect.effect, effect.parameter);
    }
    for sentence in unexplained(comparison, ["the first run", "the second run"]) {
        say!("{sentence}");
    }
    say!("{}", verdict(comparison));
}

/// Formats a probability.
fn probability(p: f64) -> String {
    if p < 1e-4 {
        "< 0.0001".to_owned()
    } else {
        significant(p, 2)
    }
}

fn scalar(of: &ScalarDifference, unit: &str, level: f64) -> String {
    let size = |value: Option<f64>| value.map_or("not estimated".to_owned(), |v| quantity(v, unit));
    let verdict = match of.test {
        Some(test) if test.p_corrected < level => "different",
        _ => "noise",
    };
    format!(
        "{} and {}, difference {}: {verdict}",
        size(of.first),
        size(of.second),
        with_sd(of.difference, of.sd, unit)
    )
}
