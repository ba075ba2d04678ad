//! A comparison in words.

use tautline_core::comparison::{Comparison, EffectDifference, Test};
use tautline_core::effect::find;

use crate::wording::units::quantity;
use crate::wording::{count, list, odds};

/// Probability of a fit below which its differences are not trusted.
const BAD_FIT: f64 = 0.01;

/// Whether the difference is significant at the level of the comparison.
pub fn differs(compared: &Comparison, test: Option<Test>) -> bool {
    test.is_some_and(|test| test.p_corrected < compared.level)
}

/// The differences in a sentence or two.
pub fn verdict(compared: &Comparison) -> String {
    let moved: Vec<String> = (compared.pulleys.iter())
        .filter(|pulley| pulley.moved)
        .map(|pulley| pulley.cable.clone())
        .collect();
    let others = others(compared);
    let have = if moved.len() == 1 { "has" } else { "have" };
    let pulleys = format!("{} {have} moved", count(moved.len(), "pulley"));
    match (moved.is_empty(), others.is_empty()) {
        (true, true) => "No pulley has moved: all values agree within the noise.".to_owned(),
        (true, false) => format!(
            "No pulley has moved, but the following differs: {}.",
            list(&others)
        ),
        (false, true) => format!(
            "{pulleys}: {}. The rest agrees within the noise.",
            list(&moved)
        ),
        (false, false) => format!(
            "{pulleys}: {}. Also different: {}.",
            list(&moved),
            list(&others)
        ),
    }
}

/// Differences other than those of pulleys.
fn others(compared: &Comparison) -> Vec<String> {
    let plane = compared.plane.as_ref().and_then(|plane| plane.test);
    let plane = differs(compared, plane).then(|| "the laser's target plane".to_owned());
    let effects = compared.effects.iter();
    let mut others: Vec<String> = effects
        .filter(|effect| differs(compared, effect.size.test))
        .map(effect_name)
        .collect();
    // An effect with several parameters counts once.
    others.dedup();
    others.splice(0..0, plane);
    others
}

/// An effect with its cables: `winch scale of cable-3`.
pub fn effect_name(effect: &EffectDifference) -> String {
    let title = find(&effect.effect).map_or(effect.effect.as_str(), |found| found.title());
    match effect.targets.as_slice() {
        [] => title.to_owned(),
        targets => format!("{title} ({})", list(targets)),
    }
}

/// A sentence for each of the two runs, with the given names, that its model does not explain.
pub fn unexplained(compared: &Comparison, names: [&str; 2]) -> Vec<String> {
    let fits = compared.fits.iter().zip(names);
    fits.filter(|(fit, _)| fit.p_value.is_some_and(|p| p < BAD_FIT))
        .map(|(_, name)| {
            format!(
                "The model does not explain {name}: differences may come from unmodelled effects."
            )
        })
        .collect()
}

/// The motion that was taken out of the differences of the pulleys, if there is one.
pub fn common_motion(compared: &Comparison) -> Option<String> {
    let motion = compared.motion.as_ref()?;
    Some(format!(
        "The motion common to all pulleys has been taken out: a shift of {} and a rotation of {}.",
        quantity(motion.shift_m.norm(), "m"),
        quantity(motion.rotation_rad.norm(), "rad")
    ))
}

/// Probability of such a difference by noise alone, in words.
pub fn by_chance(test: Test) -> String {
    odds(test.p_corrected)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};
    use tautline_core::comparison::{Displacement, FitQuality, PulleyDifference, ScalarDifference};

    use super::*;

    fn test(p_value: f64) -> Option<Test> {
        Some(Test {
            chi2: 1.0,
            degrees_of_freedom: 1,
            p_value,
            p_corrected: p_value,
        })
    }

    /// Four pulleys, those of the given numbers moved.
    fn compared(moved: &[usize]) -> Comparison {
        let raw = Displacement {
            vector_m: Vector3::zeros(),
            covariance: Matrix3::identity(),
        };
        let pulley = |k: usize| PulleyDifference {
            cable: format!("cable-{k}"),
            raw,
            relative: Some(raw),
            test: test(if moved.contains(&k) { 1e-6 } else { 0.5 }),
            moved: moved.contains(&k),
        };
        let fit = |p_value| FitQuality {
            chi2: 1.0,
            degrees_of_freedom: 1.0,
            p_value: Some(p_value),
        };
        Comparison {
            level: 0.05,
            pulleys: (1..=4).map(pulley).collect(),
            motion: None,
            plane: None,
            home: None,
            effects: Vec::new(),
            global: None,
            fits: [fit(0.5), fit(0.001)],
        }
    }

    #[test]
    fn what_has_moved_comes_first_then_what_else_differs() {
        let verdict_of = |moved: &[usize]| verdict(&compared(moved));
        assert_eq!(
            verdict_of(&[]),
            "No pulley has moved: all values agree within the noise."
        );
        assert_eq!(
            verdict_of(&[1, 2, 4]),
            "3 pulleys have moved: cable-1, cable-2 and cable-4. The rest agrees within the noise."
        );
        let mut other = compared(&[3]);
        other.effects.push(EffectDifference {
            effect: "winch_scale".to_owned(),
            targets: vec!["cable-2".to_owned()],
            parameter: "scale".to_owned(),
            unit: "1".to_owned(),
            size: ScalarDifference {
                first: Some(0.0),
                second: None,
                difference: 0.02,
                sd: 0.001,
                test: test(1e-9),
            },
        });
        let title = find("winch_scale").map(|effect| effect.title());
        let title = title.expect("an effect of the catalogue");
        assert_eq!(
            verdict(&other),
            format!("1 pulley has moved: cable-3. Also different: {title} (cable-2).")
        );
    }

    #[test]
    fn a_session_that_is_not_explained_is_named() {
        let told = unexplained(&compared(&[]), ["A", "B"]);
        assert_eq!(
            told,
            ["The model does not explain B: differences may come from unmodelled effects."]
        );
    }
}
