//! A hypothesis alone in measured readings: the target where it fits best, and the part of the residuals that it explains.

use std::sync::Arc;

use tautline_core::diagnosis::single_causes;
use tautline_core::effect::{BoundEffect, EffectSetting, Hypothesis};
use tautline_core::estimation::{Control, Progress};
use tautline_session::Session;

use super::image::{
    Abscissa, Image, LEAST_SEEN, MOST_IMAGES, Residual, named, order, residuals, strengths,
};
use super::replace_hypothesis;
use crate::diagnosis::dataset_to_diagnose;
use crate::identification::{Identification, IdentificationRequest, effect_sizes, identify};
use crate::plot::figure::{Ink, Marker, Series};
use crate::wording::list;

/// Largest number of targets on which the hypothesis is fitted: further ones would not be better.
const MOST_PLACEMENTS: usize = 4;

/// Result of fitting a hypothesis alone to the residuals of a session.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Targets on which it was fitted, the most probable first.
    pub placements: Vec<Placement>,
}

/// A hypothesis on one target.
#[derive(Debug, Clone)]
pub struct Placement {
    /// The target: `cable-3`, or `the robot`.
    pub target: String,
    /// The effect with its identified values.
    pub setting: EffectSetting,
    /// Its identified size with standard deviations.
    pub size: String,
    /// Chi-square of the readings without and with the hypothesis.
    pub chi2: [f64; 2],
    /// Residuals without the hypothesis, and its contribution to them, for the readings where that is largest.
    pub images: Vec<Image>,
}

impl Placement {
    /// Share of the residuals that the hypothesis explains, in one sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let [before, after] = self.chi2;
        let share = 100.0 * (before - after).max(0.0) / before.max(f64::MIN_POSITIVE);
        format!(
            "It explains {share:.0} % of the residuals: their sum of squares falls from {before:.0} to {after:.0}."
        )
    }
}

/// Fits a hypothesis to the readings of a session, on each of its targets and at the pose or with the period that suit them best.
/// `before` is the identification of the session without it, if there is one. `None` if it was stopped.
///
/// # Errors
/// One sentence, if nothing can be identified with it, or no reading depends on it.
pub fn try_hypothesis(
    session: &Session,
    before: Option<Arc<Identification>>,
    hypothesis: &Hypothesis,
    goes_on: &dyn Fn() -> Control,
) -> Result<Option<Trial>, String> {
    let mut session = session.clone();
    // Without this, the present instance of the effect would already explain the residuals.
    let effects = &mut session.settings.identification.effects;
    let count = effects.len();
    effects.retain(|one| one.effect != hypothesis.id());
    let is_before = effects.len() == count;
    replace_hypothesis(&mut session.robot, hypothesis).map_err(|error| format!("{error}."))?;
    let before = match before.filter(|_| is_before) {
        Some(fit) => fit,
        None => match identified(&session, None, goes_on)? {
            Some(fit) => Arc::new(fit),
            None => return Ok(None),
        },
    };
    let effect = hypothesis.effect();
    let dataset = dataset_to_diagnose(&session, &before);
    let found = single_causes(&dataset, effect).map_err(|error| format!("{error}."))?;
    if found.is_empty() {
        return Err(
            match effect.is_in_motion() && dataset.measurements.rates.is_none() {
                true => "It shows only in a recording in motion, and these poses are at rest."
                    .to_owned(),
                false => "No reading of these poses depends on it.".to_owned(),
            },
        );
    }
    let mut placements = Vec::new();
    let mut failure = None;
    for single in found.iter().take(MOST_PLACEMENTS) {
        let Some(bound) = single.cause.instances.first() else {
            continue;
        };
        match fitted(&session, &before, bound, goes_on) {
            Ok(Some(placement)) => placements.push(placement),
            Ok(None) => return Ok(None),
            Err(why) => failure = failure.or(Some(why)),
        }
    }
    match (placements.is_empty(), failure) {
        (true, Some(why)) => Err(why),
        _ => Ok(Some(Trial { placements })),
    }
}

/// The identification of a session, with another effect that starts at given values.
fn identified(
    session: &Session,
    with: Option<&EffectSetting>,
    goes_on: &dyn Fn() -> Control,
) -> Result<Option<Identification>, String> {
    let mut session = session.clone();
    session
        .settings
        .identification
        .effects
        .extend(with.cloned());
    let request =
        IdentificationRequest::of_session(&session).map_err(|error| format!("{error}."))?;
    let fit = identify(&request, &mut |_: &Progress| goes_on());
    let fit = fit.map_err(|error| format!("{error}."))?;
    Ok((goes_on() == Control::Continue).then_some(fit))
}

fn fitted(
    session: &Session,
    before: &Identification,
    bound: &BoundEffect,
    goes_on: &dyn Fn() -> Control,
) -> Result<Option<Placement>, String> {
    let start = bound.setting(&session.robot);
    let Some(fit) = identified(session, Some(&start), goes_on)? else {
        return Ok(None);
    };
    if !fit.solution.converged() {
        return Err("The identification does not converge with it.".to_owned());
    }
    let robot = &fit.dataset.robot;
    let settings = fit.free_effects().iter().map(|own| own.setting(robot));
    let is_own = |own: &EffectSetting| own.effect == start.effect && own.targets == start.targets;
    let own = settings.rev().find(is_own);
    let setting = own.unwrap_or(start);
    let target = match setting.targets.as_slice() {
        [] => "the robot".to_owned(),
        targets => list(targets),
    };
    Ok(Some(Placement {
        target,
        size: effect_sizes(&fit, std::slice::from_ref(&setting)).concat(),
        chi2: [before.solution.chi2, fit.solution.chi2],
        images: images(before, &fit, bound),
        setting,
    }))
}

/// The readings of which the effect explains most: their residuals without the effect, and the explained part.
fn images(before: &Identification, after: &Identification, bound: &BoundEffect) -> Vec<Image> {
    let left = residuals(after);
    let is_same = |(one, other): &(Residual, &Residual)| {
        (one.quantity, one.cable, one.row) == (other.quantity, other.cable, other.row)
    };
    let pairs = residuals(before).into_iter().zip(&left);
    let pairs: Vec<(Residual, &Residual)> = pairs.filter(is_same).collect();
    let explained = |(one, other): &(Residual, &Residual)| Residual {
        value: one.value - other.value,
        ..*one
    };
    let parts: Vec<Residual> = pairs.iter().map(explained).collect();
    let groups = strengths(&parts, |one| (order(one.quantity), one.cable));
    let shown = groups.iter().enumerate().take(MOST_IMAGES);
    let shown = shown.filter(|(place, (.., largest))| *place == 0 || *largest >= LEAST_SEEN);
    let keys = shown.map(|(_, (key, ..))| *key);
    let image = |key: (usize, Option<usize>)| {
        let is_own = |one: &Residual| (order(one.quantity), one.cable) == key;
        let quantity = parts.iter().find(|one| is_own(one))?.quantity;
        let cable = key.1;
        let abscissa = Abscissa::of(before, bound.effect, &[(quantity, cable)]);
        let points = |all: &[Residual]| {
            let own = all.iter().filter(|one| is_own(one));
            own.filter_map(|one| abscissa.point(one)).collect()
        };
        let all: Vec<Residual> = pairs.iter().map(|(one, _)| *one).collect();
        let name = cable.map(|index| before.dataset.robot.cables[index].name.as_str());
        let residuals = match (cable, name) {
            (Some(index), Some(name)) => Series::of_cable(index, name, points(&all)),
            _ => Series::new(quantity.name(), Ink::Accent, Marker::Circle, points(&all)),
        };
        let pattern = Series::new(
            "explained by the hypothesis",
            Ink::Text,
            Marker::Circle,
            points(&parts),
        );
        Some(Image {
            name: named(quantity, name),
            figure: abscissa.figure(vec![residuals, pattern.as_rings()]),
        })
    };
    keys.filter_map(image).collect()
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
    use tautline_session::Timestamp;

    use super::*;

    const CROSSTALK: &str = r#"
id = "encoder_crosstalk"
title = "Crosstalk between neighbouring encoders"
scope = "cable"
cause = "The encoder of {cable} picks up {share} of the revolutions of its neighbour."
workshop = "Separate the two encoder cables."
[parameters.share]
unit = "1"
typical = [0.001, 0.01]
[change]
paid = "paid + share * paid_of(next)"
"#;

    fn session() -> (Session, Hypothesis) {
        let hypothesis = Hypothesis::parse(CROSSTALK).expect("a hypothesis");
        let robot = presets::find("mini").expect("a preset").robot;
        let mut truth = robot.clone();
        truth.add_hypothesis(&hypothesis).expect("known");
        truth.effects.push(EffectSetting {
            effect: "encoder_crosstalk".into(),
            targets: vec!["cable-3".into()],
            parameters: [("share".to_owned(), 0.01)].into(),
        });
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            ..SimulationOptions::new(40, 4)
        };
        let run = simulate(&truth, &options).expect("a run");
        let mut session = Session::new("bad", robot, Timestamp::from_unix_seconds(0));
        session.measurements = run.dataset.measurements;
        (session, hypothesis)
    }

    #[test]
    fn it_is_fitted_where_it_explains_most() {
        let (session, hypothesis) = session();
        let goes_on = || Control::Continue;
        let trial = try_hypothesis(&session, None, &hypothesis, &goes_on).expect("a trial");
        let trial = trial.expect("not stopped");
        let best = &trial.placements[0];
        assert_eq!(best.target, "cable-3");
        let share = best.setting.parameters["share"];
        // Three standard deviations of 0.11 %: a false failure in 370 seeds.
        assert!((share - 0.01).abs() < 3.3e-3, "{share}");
        assert!(
            best.size.contains('±') && best.size.ends_with('%'),
            "{}",
            best.size
        );
        let [before, after] = best.chi2;
        assert!(after < before - 20.0, "{before} {after}");
        let other = &trial.placements[1];
        assert!(other.chi2[1] > after, "{other:?}");
        let image = &best.images[0];
        assert_eq!(image.figure.series.len(), 2);
        // Revolutions are counted from the home pose, so that it has no reading of a length.
        assert_eq!(image.figure.series[0].points().len(), 40);
        assert!(session.robot.hypotheses.is_empty());
    }

    #[test]
    fn what_no_reading_shows_is_said_and_a_trial_can_be_stopped() {
        let (session, hypothesis) = session();
        let stop = || Control::Cancel;
        let stopped = try_hypothesis(&session, None, &hypothesis, &stop).expect("no failure");
        assert!(stopped.is_none());
        let swift = CROSSTALK
            .replace("paid_of(next)", "paid_rate")
            .replace("\"1\"", "\"s\"");
        let swift = Hypothesis::parse(&swift).expect("a hypothesis");
        let goes_on = || Control::Continue;
        let why = try_hypothesis(&session, None, &swift, &goes_on).expect_err("at rest");
        assert!(why.contains("recording in motion"), "{why}");
    }
}
