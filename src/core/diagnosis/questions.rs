//! The questions: which effect on which target could explain the data.

use super::report::Cause;
use crate::effect::{BoundEffect, CATALOGUE, Effect, EffectParameter, Scope, Search};
use crate::robot::Robot;

/// One effect with its target, not yet with values.
#[derive(Debug, Clone)]
pub(super) struct Question {
    /// Effect and target at the start values.
    pub cause: Cause,
}

impl Question {
    pub fn search(&self) -> Search {
        self.cause.effect().search()
    }

    /// The probes whose derivatives are the question's columns: bound effects, and which of their
    /// parameters. An event is probed at the pose NaN, which stands for all, and a wave whose period is
    /// searched as an endless one at its crest, which is a constant.
    pub fn probes(&self) -> Vec<(BoundEffect, usize)> {
        let mut probes = Vec::new();
        for bound in &self.cause.instances {
            let mut at = bound.clone();
            match self.search() {
                Search::Wave { phase, period } => {
                    let amplitude = amplitude_of(phase, period);
                    if let Some(period) = period {
                        at.values[period] = f64::INFINITY;
                        at.values[phase] = std::f64::consts::FRAC_PI_2;
                        probes.push((at, amplitude));
                        continue;
                    }
                    for angle in [0.0, std::f64::consts::FRAC_PI_2] {
                        at.values[phase] = angle;
                        probes.push((at.clone(), amplitude));
                    }
                }
                Search::FromPose(pose) | Search::AtPose(pose) => {
                    at.values[pose] = f64::NAN;
                    probes.extend(estimable(at.effect).map(|k| (at.clone(), k)));
                }
                Search::Direct | Search::Exchange => {
                    for (value, parameter) in at.values.iter_mut().zip(at.effect.parameters()) {
                        *value = parameter.neutral + probe_offset(parameter);
                    }
                    probes.extend(estimable(at.effect).map(|k| (at.clone(), k)));
                }
            }
        }
        probes
    }

    /// The cause with a linear estimate, one number per column; `place` is the label of an event's pose, or the
    /// period of a wave.
    pub fn estimated(&self, estimate: &[f64], place: f64) -> Cause {
        let mut cause = self.cause.clone();
        let mut numbers = estimate.iter();
        for bound in &mut cause.instances {
            match bound.effect.search() {
                Search::Wave { phase, period } => {
                    let (a, b) = (numbers.next(), numbers.next());
                    let (a, b) = (a.copied().unwrap_or(0.0), b.copied().unwrap_or(0.0));
                    bound.values[amplitude_of(phase, period)] = a.hypot(b);
                    bound.values[phase] = b.atan2(a);
                    if let Some(period) = period {
                        bound.values[period] = place;
                    }
                }
                Search::FromPose(pose) | Search::AtPose(pose) => {
                    for k in estimable(bound.effect) {
                        bound.values[k] = numbers.next().copied().unwrap_or(0.0);
                    }
                    bound.values[pose] = place;
                }
                Search::Direct | Search::Exchange => {
                    for k in estimable(bound.effect) {
                        let step = numbers.next().copied().unwrap_or(0.0);
                        let parameter = &bound.effect.parameters()[k];
                        bound.values[k] = parameter.neutral + distance(parameter, step);
                    }
                }
            }
        }
        cause
    }
}

/// Where a parameter is probed, from its neutral value: not far, since all probes act together, but not there where
/// nothing depends on it at first order.
fn probe_offset(parameter: &EffectParameter) -> f64 {
    0.1 * (parameter.start - parameter.neutral)
}

/// Distance from the neutral value that a linear step from the probe means: what does not depend on a parameter at
/// first order depends on its square.
fn distance(parameter: &EffectParameter, step: f64) -> f64 {
    let probe = probe_offset(parameter);
    if probe == 0.0 {
        return step;
    }
    let square = (probe * probe + 2.0 * probe * step).max(0.0);
    square.sqrt().max(parameter.start - parameter.neutral)
}

/// The prior standard deviation of a linear step from the probe.
pub(super) fn prior_of(parameter: &EffectParameter) -> f64 {
    let probe = probe_offset(parameter);
    if probe == 0.0 {
        parameter.prior_sd
    } else {
        parameter.prior_sd.powi(2) / (2.0 * probe)
    }
}

/// The parameter of a wave that is neither phase nor period.
fn amplitude_of(phase: usize, period: Option<usize>) -> usize {
    (0..3)
        .find(|k| *k != phase && Some(*k) != period)
        .unwrap_or_default()
}

fn estimable(effect: &'static Effect) -> impl Iterator<Item = usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, p)| !p.discrete).map(|(k, _)| k)
}

/// All questions of one effect.
pub(super) fn questions_of(effect: &'static Effect, robot: &Robot) -> Vec<Question> {
    let all: Vec<usize> = (0..robot.cable_count()).collect();
    let bound = |cables: Vec<usize>, targeted: bool| BoundEffect {
        effect,
        cables,
        targeted,
        values: effect.parameters().iter().map(|p| p.start).collect(),
    };
    let mut causes: Vec<Vec<BoundEffect>> = Vec::new();
    let each = || all.iter().map(|cable| bound(vec![*cable], true));
    match effect.scope() {
        Scope::Robot => causes.push(vec![bound(all.clone(), false)]),
        Scope::Pair | Scope::Reading => {}
        Scope::Cable | Scope::CableOrAll => {
            causes.extend(each().map(|bound| vec![bound]));
            if effect.scope() == Scope::CableOrAll {
                causes.push(vec![bound(all.clone(), false)]);
            } else if effect.search() == Search::Direct && all.len() > 1 {
                // Nothing makes these errors alike: every cable with a value of its own.
                causes.push(each().collect());
            }
        }
    }
    causes
        .into_iter()
        .map(|instances| Question {
            cause: Cause { instances },
        })
        .collect()
}

/// Periods at which a wave in a quantity that spans `range` is tried: from the shortest to the longest typical
/// one, so close that none between is missed.
pub(super) fn periods(typical: [f64; 2], range: f64) -> Vec<f64> {
    const PER_RANGE: f64 = 2.5;
    let (longest, shortest) = (typical[1].recip(), typical[0].recip());
    let step = (PER_RANGE * range.max(1e-9)).recip();
    let count = ((shortest - longest) / step).ceil().clamp(1.0, 600.0);
    (0..=count as usize)
        .map(|k| (longest + (shortest - longest) * k as f64 / count).recip())
        .collect()
}

/// The effects that are asked, and the periods for those that need them.
pub(super) fn asked() -> impl Iterator<Item = &'static Effect> {
    let exchange = |effect: &&Effect| effect.search() != Search::Exchange;
    CATALOGUE.iter().copied().filter(exchange)
}
