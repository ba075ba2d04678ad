//! Human-readable form of a comparison.

use tautline_core::comparison::{Comparison, ScalarDifference};

use crate::output::say;
use crate::table::{self, mm};
use tautline_workflow::comparison::{ComparisonDocument, PulleyDocument, unexplained, verdict};
use tautline_workflow::wording::units::{quantity, significant, with_sd};

/// Prints the differences.
pub fn print(comparison: &Comparison, compared: &ComparisonDocument) {
    let mut rows = table::numbers(&[
        "Pulley",
        "dx mm",
        "dy mm",
        "dz mm",
        "length mm",
        "sd mm",
        "verdict",
        "p corrected",
    ]);
    for pulley in &compared.pulleys {
        table::push(&mut rows, &cells(pulley));
    }
    say!("{rows}");
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

fn cells(pulley: &PulleyDocument) -> [String; 8] {
    let shown = pulley.relative.unwrap_or(pulley.raw);
    let [x, y, z] = shown.vector_m.map(|value| mm(value, 2));
    let verdict = match (&pulley.test, pulley.moved) {
        (None, _) => "undetermined",
        (Some(_), true) => "moved",
        (Some(_), false) => "noise",
    };
    [
        pulley.cable.clone(),
        x,
        y,
        z,
        mm(shown.length_m, 2),
        mm(shown.length_sd_m, 2),
        verdict.to_owned(),
        pulley
            .test
            .map_or(String::new(), |test| probability(test.p_corrected)),
    ]
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
