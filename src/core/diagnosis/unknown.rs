//! Structure without a name: smooth functions, waves and surfaces of the variables, on every reading.

use nalgebra::DMatrix;

use super::fit::Fit;
use super::moments::{Moments, PoseMoments};
use super::report::{Cause, Quantity};
use super::scores::{Block, Design, Directions, Scan, Scored};
use crate::effect::unknown::{FIRST, FUNCTIONS, Form, READING, SCALE};
use crate::effect::{BiasedReading, BoundEffect, Shape, UNKNOWN};
use crate::measurement::Variable;

/// Fewest poses at which a function is sought.
const FEWEST: usize = 12;
/// Sizes of the functions that are tried, in standard deviations of a constant seen at one pose.
const SIZES: [f64; 10] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 256.0, 1024.0];
/// Numbers of smooth functions that are tried.
const TERMS: [usize; 3] = [2, 3, FUNCTIONS];
/// Most waves over the range of a variable, and the steps per wave in which they are tried.
const MOST_WAVES: f64 = 16.0;
const STEPS_PER_WAVE: f64 = 2.5;
/// Variables along which waves are sought.
const ALONG: [Variable; 3] = [Variable::Revolutions, Variable::Time, Variable::Distance];
/// Pairs of variables over which surfaces are sought.
const OVER: [(Variable, Variable); 6] = [
    (Variable::Position(0), Variable::Position(1)),
    (Variable::Position(0), Variable::Position(2)),
    (Variable::Position(1), Variable::Position(2)),
    (Variable::Rotation(0), Variable::Rotation(1)),
    (Variable::Rotation(0), Variable::Rotation(2)),
    (Variable::Rotation(1), Variable::Rotation(2)),
];

/// What was found, and how many questions were asked.
pub(super) struct Search {
    pub scored: Vec<Scored>,
    pub questions: usize,
}

/// A constant on a reading: of a cable, or of the platform or all cables.
fn bound(reading: usize, cable: Option<usize>, cables: usize) -> BoundEffect {
    let mut values = vec![0.0; FIRST + FUNCTIONS];
    values[READING] = reading as f64;
    values[SCALE] = 1.0;
    // Any variable that every reading has: the first function is constant.
    let form = Form {
        shape: Shape::Smooth,
        variable: Variable::Position(0),
        range: [0.0, 1.0],
        other: Variable::Position(0),
        other_range: [0.0, 1.0],
        terms: 1,
    };
    form.write(&mut values);
    BoundEffect {
        effect: &UNKNOWN,
        cables: cable.map_or_else(|| (0..cables).collect(), |cable| vec![cable]),
        targeted: cable.is_some(),
        values,
    }
}

/// Structure of size zero on a kind of reading.
pub(super) fn structure_on(quantity: Quantity, cable: Option<usize>, cables: usize) -> BoundEffect {
    let reading = match quantity {
        Quantity::Length => Some(BiasedReading::Length),
        Quantity::Tension => Some(BiasedReading::Tension),
        Quantity::Swivel => Some(BiasedReading::Swivel),
        Quantity::Laser => Some(BiasedReading::Laser),
        Quantity::Inclination => Some(BiasedReading::Inclination(0)),
        Quantity::TrackerPosition | Quantity::TrackerOrientation => None,
    };
    let number = BiasedReading::ALL.iter().position(|r| Some(*r) == reading);
    bound(number.unwrap_or(BiasedReading::ALL.len()), cable, cables)
}

/// Every reading on which structure is sought.
fn readings(cables: usize) -> Vec<BoundEffect> {
    let mut all = Vec::new();
    for (number, reading) in BiasedReading::ALL.iter().enumerate() {
        all.push(bound(number, None, cables));
        if reading.is_of_cable() {
            all.extend((0..cables).map(|cable| bound(number, Some(cable), cables)));
        }
    }
    all
}

/// The best function of each kind for every reading.
pub(super) fn unknowns(fit: &Fit<'_>, scan: &Scan) -> Search {
    let bounds = readings(fit.problem.dataset.robot.cable_count());
    let design = Design::new(fit, &bounds, scan.linear.rows.len());
    let mut search = Search {
        scored: Vec::new(),
        questions: 0,
    };
    for (index, bound) in bounds.iter().enumerate() {
        let column = design.columns.column(design.column_of(index, FIRST));
        if column.norm_squared() == 0.0 {
            continue;
        }
        let moments = Moments::new(
            &design
                .columns
                .select_columns(&[design.column_of(index, FIRST)]),
            scan,
        );
        let reading = Reading::new(fit, bound, moments);
        search.questions += reading.ask(&mut search.scored);
    }
    search
}

/// One reading with what its error may depend on.
struct Reading<'b> {
    bound: &'b BoundEffect,
    moments: Moments,
    /// Variables at each pose.
    variables: Vec<[f64; Variable::COUNT]>,
    /// Information of a constant seen at one pose.
    constant: f64,
}

impl<'b> Reading<'b> {
    fn new(fit: &Fit<'_>, bound: &'b BoundEffect, moments: Moments) -> Self {
        let contexts = fit.problem.contexts.as_ref();
        let at = |pose: &PoseMoments| match (contexts, bound.cables.as_slice()) {
            (Some(known), [cable]) => known.cable(pose.row, *cable).variables,
            (Some(known), _) => known.platform(pose.row).variables,
            (None, _) => [f64::NAN; Variable::COUNT],
        };
        let variables: Vec<_> = moments.poses.iter().map(at).collect();
        let total: f64 = moments.poses.iter().map(PoseMoments::size).sum();
        Self {
            constant: total / variables.len().max(1) as f64,
            bound,
            moments,
            variables,
        }
    }

    /// Range of a variable, if it varies and is known at enough poses.
    fn range(&self, variable: Variable) -> Option<[f64; 2]> {
        let values = self.variables.iter().map(|v| v[variable.index()]);
        let known: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        let from = known.iter().copied().fold(f64::INFINITY, f64::min);
        let to = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let varies = to - from > 1e-9 * to.abs().max(from.abs());
        (known.len() >= FEWEST && varies).then_some([from, to])
    }

    /// Asks for every form; the number of questions.
    fn ask(&self, scored: &mut Vec<Scored>) -> usize {
        let mut questions = 0;
        for variable in Variable::ALL {
            let forms = TERMS.map(|terms| self.smooth(variable, terms));
            questions += self.best_of(forms.into_iter().flatten(), scored);
        }
        for variable in ALONG {
            questions += self.best_of(self.waves(variable).into_iter(), scored);
        }
        for (one, other) in OVER {
            questions += self.best_of(self.surface(one, other).into_iter(), scored);
        }
        questions
    }

    fn smooth(&self, variable: Variable, terms: usize) -> Option<Form> {
        Some(Form {
            shape: Shape::Smooth,
            variable,
            range: self.range(variable)?,
            other: variable,
            other_range: [0.0, 1.0],
            terms,
        })
    }

    fn waves(&self, variable: Variable) -> Vec<Form> {
        let Some(form) = self.smooth(variable, 3) else {
            return Vec::new();
        };
        let [from, to] = form.range;
        let count = (MOST_WAVES * STEPS_PER_WAVE) as usize;
        let period = |step: usize| (to - from) * STEPS_PER_WAVE / step as f64;
        // Less than one wave and a half is a smooth function.
        let steps = (1.5 * STEPS_PER_WAVE) as usize..=count;
        steps
            .map(|step| Form {
                shape: Shape::Wave,
                range: [from, from + period(step)],
                ..form
            })
            .collect()
    }

    fn surface(&self, variable: Variable, other: Variable) -> Option<Form> {
        Some(Form {
            shape: Shape::Surface,
            other,
            other_range: self.range(other)?,
            ..self.smooth(variable, FUNCTIONS)?
        })
    }

    /// Scores the best of several forms; how many there were.
    fn best_of(&self, forms: impl Iterator<Item = Form>, scored: &mut Vec<Scored>) -> usize {
        let mut best: Option<(Form, Block, f64)> = None;
        let mut count = 0;
        for form in forms {
            count += 1;
            let found = self.block(&form);
            let score = |(_, block, _): &(Form, Block, f64)| block.score();
            if found.as_ref().map(score) > best.as_ref().map(score) {
                best = found;
            }
        }
        scored.extend(best.map(|(form, block, scale)| {
            let places = 2.0 * (Variable::COUNT as f64).ln() + (count as f64).ln();
            block.scored(self.cause(&form, &block, scale), block.freedom, places)
        }));
        count
    }

    /// The score test of a form, and the size that its functions have.
    fn block(&self, form: &Form) -> Option<(Form, Block, f64)> {
        let mut weights = DMatrix::zeros(self.variables.len(), form.terms);
        for (j, variables) in self.variables.iter().enumerate() {
            for (k, value) in form.functions(variables)[..form.terms].iter().enumerate() {
                weights[(j, k)] = *value;
            }
        }
        let (score, information) = self.moments.weighted(&weights);
        let parameters = &self.bound.effect.parameters()[FIRST..FIRST + form.terms];
        let unit = self.constant.sqrt().recip();
        let prior: Vec<f64> = parameters.iter().map(|p| p.prior_sd * unit).collect();
        let directions = Directions::new(&score, &information, &prior)?;
        let size = directions.best_size(&SIZES);
        Some((*form, directions.block(size), size * unit))
    }

    fn cause(&self, form: &Form, block: &Block, scale: f64) -> Cause {
        let mut bound = self.bound.clone();
        form.write(&mut bound.values);
        bound.values[SCALE] = scale;
        for (value, estimate) in bound.values[FIRST..].iter_mut().zip(&block.estimate) {
            *value = estimate / scale;
        }
        Cause {
            instances: vec![bound],
        }
    }
}

/// Whether a cause is structure without a name.
pub(super) fn is_unknown(cause: &Cause) -> bool {
    cause.effect().id() == UNKNOWN.id()
}
