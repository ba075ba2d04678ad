//! One effect on several cables: found together it is stronger than on each alone, but it is reported on those cables
//! only that need it, and with one value where one does.

use super::fit::Fit;
use super::report::Cause;
use crate::effect::{BoundEffect, Scope, Search};
use crate::estimation::{EstimationError, Problem};

/// The fit with every family reduced to the cables that need it. `price` is what a parameter must gain.
pub(super) fn reduced<'a>(
    base: &Problem<'a>,
    fit: Fit<'a>,
    price: f64,
) -> Result<Fit<'a>, EstimationError> {
    let mut fit = fit;
    for index in 0..fit.causes.len() {
        while fit.causes[index].instances.len() > 1 {
            let Some(simpler) = without_weakest(base, &fit, index, price)? else {
                break;
            };
            fit = simpler;
        }
    }
    let causes = fit.causes.iter().flat_map(separated).collect::<Vec<_>>();
    Fit::new(base, &causes)
}

/// The fit without the instance that gains least, if it gains less than its parameters are worth.
fn without_weakest<'a>(
    base: &Problem<'a>,
    fit: &Fit<'a>,
    index: usize,
    price: f64,
) -> Result<Option<Fit<'a>>, EstimationError> {
    let mut best: Option<Fit<'a>> = None;
    for instance in 0..fit.causes[index].instances.len() {
        let mut causes = fit.causes.clone();
        causes[index].instances.remove(instance);
        let simpler = Fit::new(base, &causes)?;
        if best
            .as_ref()
            .is_none_or(|b| simpler.solution.chi2 < b.solution.chi2)
        {
            best = Some(simpler);
        }
    }
    let effect = fit.causes[index].effect();
    let parameters = effect.parameters().iter().filter(|p| !p.discrete).count();
    let allowed = fit.solution.chi2 + price * parameters as f64;
    Ok(best.filter(|simpler| simpler.solution.chi2 < allowed))
}

/// A family stays one finding while it concerns most cables; what is on few of them is told apart.
fn separated(cause: &Cause) -> Vec<Cause> {
    let few = cause.instances.len() <= 3;
    let each = |bound: &BoundEffect| Cause {
        instances: vec![bound.clone()],
    };
    if few {
        cause.instances.iter().map(each).collect()
    } else {
        vec![cause.clone()]
    }
}

/// The fit with findings of the same effect on several cables replaced by one with a common value, where that
/// costs less than the parameters it saves are worth.
pub(super) fn united<'a>(
    base: &Problem<'a>,
    fit: Fit<'a>,
    price: f64,
) -> Result<Fit<'a>, EstimationError> {
    let mut fit = fit;
    let mut index = 0;
    while index < fit.causes.len() {
        if let Some(causes) = with_common_value(&fit.causes, index, base) {
            let common = Fit::new(base, &causes)?;
            let saved = fit.parameters() - common.parameters();
            if common.solution.chi2 < fit.solution.chi2 + price * saved as f64 {
                fit = common;
            }
        }
        index += 1;
    }
    Ok(fit)
}

/// The causes with all of the same effect as the one at `index` replaced by one instance.
fn with_common_value(causes: &[Cause], index: usize, base: &Problem<'_>) -> Option<Vec<Cause>> {
    let effect = causes[index].effect();
    let same = |cause: &Cause| cause.effect().id() == effect.id();
    if effect.search() != Search::Direct || effect.scope() == Scope::Robot {
        return None;
    }
    let first = causes.iter().position(same)?;
    let members = || causes.iter().filter(|c| same(c)).flat_map(|c| &c.instances);
    let count = members().count();
    if first != index || count < 2 || members().any(|bound| !bound.targeted) {
        return None;
    }
    let mut cables: Vec<usize> = members().flat_map(|bound| bound.cables.clone()).collect();
    cables.sort_unstable();
    cables.dedup();
    let mean = |k: usize| members().map(|bound| bound.values[k]).sum::<f64>() / count as f64;
    let is_all = cables.len() == base.dataset.robot.cable_count();
    let common = BoundEffect {
        effect,
        // A scale of all winches has a name of its own.
        targeted: !(is_all && effect.scope() == Scope::CableOrAll),
        cables,
        values: (0..effect.parameters().len()).map(mean).collect(),
    };
    let mut replaced: Vec<Cause> = causes.iter().filter(|c| !same(c)).cloned().collect();
    replaced.insert(
        index.min(replaced.len()),
        Cause {
            instances: vec![common],
        },
    );
    Some(replaced)
}
