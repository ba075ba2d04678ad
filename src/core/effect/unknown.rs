//! Structure that no effect of the catalogue explains: a function added to a reading, `scale sum_k c_k phi_k`.
//!
//! - smooth in one variable `v`: `phi_k = cos(k pi u)`, `u = (v - from)/(to - from)`; for the fraction of a drum revolution,
//!   which is periodic, sines and cosines of one and two waves; for the direction of travel the sign;
//! - a wave: `phi_1`, `phi_2` the sine and cosine of `2 pi u`;
//! - a surface over two variables: all terms up to the second order in `2 u - 1` of both.
//!
//! Always `phi_0 = 1`. It names no cause. As a nuisance it keeps the structure out of the geometry. `reading` is the
//! number of a [`BiasedReading`], `variable` and `other` of a [`Variable`], `shape` of a [`Shape`], `terms` how many of the
//! functions are used.

use super::words::{self, degrees, millimetres};
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, PlatformContext,
    PlatformPorts, Scope,
};
use crate::measurement::Variable;

/// Number of functions of one variable.
pub const FUNCTIONS: usize = 6;

const CONSTANT: [f64; FUNCTIONS] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// The reading to which a function is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BiasedReading {
    /// Cable paid out, or length.
    Length,
    /// Tension at the platform.
    Tension,
    /// Swivel angle.
    Swivel,
    /// Laser distance.
    Laser,
    /// Roll, pitch or yaw.
    Inclination(usize),
}

impl BiasedReading {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Length,
        Self::Tension,
        Self::Swivel,
        Self::Laser,
        Self::Inclination(0),
        Self::Inclination(1),
        Self::Inclination(2),
    ];

    /// Name for lists.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Tension => "tension",
            Self::Swivel => "swivel",
            Self::Laser => "laser",
            Self::Inclination(0) => "roll",
            Self::Inclination(1) => "pitch",
            Self::Inclination(_) => "yaw",
        }
    }

    /// Whether it is the reading of a cable.
    #[must_use]
    pub fn is_of_cable(self) -> bool {
        matches!(self, Self::Length | Self::Tension | Self::Swivel)
    }

    /// Formats a size in the unit customary for this reading.
    fn in_words(self, size: f64) -> String {
        match self {
            Self::Length | Self::Laser => millimetres(size),
            Self::Tension => format!("{} N", words::size(size)),
            Self::Swivel | Self::Inclination(_) => degrees(size),
        }
    }

    fn numbered(number: f64) -> Option<Self> {
        Self::ALL.get(number as usize).copied()
    }
}

/// Kind of function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Smooth in one variable.
    Smooth,
    /// Periodic in one variable; the period is `to - from`.
    Wave,
    /// Smooth in two variables.
    Surface,
}

/// The functions that are added to a reading, and the variables they depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Form {
    pub shape: Shape,
    pub variable: Variable,
    pub range: [f64; 2],
    /// Second variable of a surface, with its range.
    pub other: Variable,
    pub other_range: [f64; 2],
    /// Number of functions used.
    pub terms: usize,
}

impl Form {
    /// The form that the parameters of the effect state.
    fn of(values: &[f64]) -> Option<Self> {
        let variable = |k: usize| Variable::ALL.get(values[k] as usize).copied();
        Some(Self {
            shape: match values[SHAPE] as usize {
                0 => Shape::Smooth,
                1 => Shape::Wave,
                _ => Shape::Surface,
            },
            variable: variable(VARIABLE)?,
            range: [values[FROM], values[TO]],
            other: variable(OTHER)?,
            other_range: [values[OTHER_FROM], values[OTHER_TO]],
            terms: values[TERMS] as usize,
        })
    }

    /// Writes the form into the parameters of the effect.
    #[cfg(test)]
    pub fn write(&self, values: &mut [f64]) {
        values[SHAPE] = match self.shape {
            Shape::Smooth => 0.0,
            Shape::Wave => 1.0,
            Shape::Surface => 2.0,
        };
        values[VARIABLE] = self.variable.index() as f64;
        [values[FROM], values[TO]] = self.range;
        values[OTHER] = self.other.index() as f64;
        [values[OTHER_FROM], values[OTHER_TO]] = self.other_range;
        values[TERMS] = self.terms as f64;
    }

    /// The functions at the given values of the variables.
    pub fn functions(&self, variables: &[f64; Variable::COUNT]) -> [f64; FUNCTIONS] {
        let value = variables[self.variable.index()];
        let other = variables[self.other.index()];
        let is_known = value.is_finite() && (self.shape != Shape::Surface || other.is_finite());
        if !is_known {
            return [0.0; FUNCTIONS];
        }
        if self.terms == 1 {
            return CONSTANT;
        }
        let share = |v: f64, [from, to]: [f64; 2]| (v - from) / (to - from);
        let u = share(value, self.range);
        let mut all = match self.shape {
            Shape::Smooth => smooth(self.variable, value, u),
            Shape::Wave => {
                let (s, c) = (std::f64::consts::TAU * u).sin_cos();
                [1.0, s, c, 0.0, 0.0, 0.0]
            }
            Shape::Surface => {
                let (a, b) = (2.0 * u - 1.0, 2.0 * share(other, self.other_range) - 1.0);
                [1.0, a, b, a * a, a * b, b * b]
            }
        };
        all[self.terms.min(FUNCTIONS)..].fill(0.0);
        all
    }

    /// Names of the variables.
    fn variables(&self) -> String {
        match self.shape {
            Shape::Surface => format!("{} and the {}", self.variable.name(), self.other.name()),
            Shape::Smooth | Shape::Wave => self.variable.name().to_owned(),
        }
    }
}

fn smooth(variable: Variable, value: f64, u: f64) -> [f64; FUNCTIONS] {
    match variable {
        Variable::Direction => [1.0, value, 0.0, 0.0, 0.0, 0.0],
        Variable::DrumFraction => {
            let (s, c) = (std::f64::consts::TAU * value).sin_cos();
            [1.0, s, c, 2.0 * s * c, c * c - s * s, 0.0]
        }
        _ => {
            // Chebyshev recurrence for cos(k a).
            let mut all = CONSTANT;
            all[1] = (std::f64::consts::PI * u).cos();
            for k in 2..FUNCTIONS {
                all[k] = 2.0 * all[1] * all[k - 1] - all[k - 2];
            }
            all
        }
    }
}

/// Range of the function: its maximum less its minimum.
fn spread(found: &FoundEffect<'_>, form: &Form) -> f64 {
    const STEPS: u32 = 40;
    let at =
        |[from, to]: [f64; 2], step: u32| from + (to - from) * f64::from(step) / f64::from(STEPS);
    let range = match form.variable {
        Variable::Direction => [-1.0, 1.0],
        Variable::DrumFraction => [0.0, 1.0],
        _ => form.range,
    };
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for step in 0..=STEPS {
        for second in 0..=STEPS {
            let mut variables = [f64::NAN; Variable::COUNT];
            variables[form.other.index()] = at(form.other_range, second);
            variables[form.variable.index()] = at(range, step);
            let terms = form.functions(&variables);
            let terms = terms
                .iter()
                .enumerate()
                .map(|(k, f)| f * found.value(FIRST + k));
            let value = found.value(SCALE) * terms.sum::<f64>();
            (least, most) = (least.min(value), most.max(value));
        }
    }
    most - least
}

/// What to do about an error that no effect explains.
pub(crate) const ADVICE: &str =
    "Measure more poses between those where this error is large and small.";

/// Indices of the parameters.
pub(crate) const READING: usize = 0;
const SHAPE: usize = 1;
const VARIABLE: usize = 2;
const FROM: usize = 3;
const TO: usize = 4;
const OTHER: usize = 5;
const OTHER_FROM: usize = 6;
const OTHER_TO: usize = 7;
const TERMS: usize = 8;
pub(crate) const SCALE: usize = 9;
pub(crate) const FIRST: usize = 10;

fn sum(parameters: &[Dual], variables: &[f64; Variable::COUNT]) -> Dual {
    let values: [f64; FIRST] = std::array::from_fn(|k| parameters[k].value);
    let mut sum = Dual::constant(0.0);
    let Some(form) = Form::of(&values) else {
        return sum;
    };
    for (c, value) in parameters[FIRST..].iter().zip(form.functions(variables)) {
        sum += *c * (value * values[SCALE]);
    }
    sum
}

/// The effect `unknown`, see the module documentation.
pub static EFFECT: Effect = Effect {
    id: "unknown",
    title: "Unknown structure",
    scope: Scope::Reading,
    parameters: &[
        EffectParameter::given("reading", "1", [0.0, 6.0]),
        EffectParameter::given("shape", "1", [0.0, 2.0]),
        EffectParameter::given("variable", "1", [0.0, 15.0]),
        EffectParameter::given("from", "1", [0.0, 1.0]),
        EffectParameter::given("to", "1", [0.0, 1.0]),
        EffectParameter::given("other", "1", [0.0, 15.0]),
        EffectParameter::given("other_from", "1", [0.0, 1.0]),
        EffectParameter::given("other_to", "1", [0.0, 1.0]),
        EffectParameter::given("terms", "1", [1.0, 6.0]),
        EffectParameter::given("scale", "1", [0.0, 1.0]),
        EffectParameter::new("c0", "1", 1.0, [0.1, 1.0]),
        EffectParameter::new("c1", "1", 1.0, [0.1, 1.0]),
        EffectParameter::new("c2", "1", 1.0, [0.1, 1.0]),
        EffectParameter::new("c3", "1", 0.7, [0.1, 1.0]),
        EffectParameter::new("c4", "1", 0.5, [0.1, 1.0]),
        EffectParameter::new("c5", "1", 0.4, [0.1, 1.0]),
    ],
    cause,
    workshop,
    source: "Smooth functions with a prior on their size",
    change_cable,
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let reading = BiasedReading::numbered(found.value(READING));
    let values: [f64; FIRST] = std::array::from_fn(|k| found.value(k));
    let (Some(reading), Some(form)) = (reading, Form::of(&values)) else {
        return "The readings contain an unexplained error.".to_owned();
    };
    let what = match reading {
        BiasedReading::Length => format!("The length reading of {}", found.name(Part::Cable)),
        BiasedReading::Tension => format!("The force reading of {}", found.name(Part::Cable)),
        BiasedReading::Swivel => format!("The swivel reading of {}", found.name(Part::Pulley)),
        BiasedReading::Laser => "The laser reading".to_owned(),
        BiasedReading::Inclination(0) => "The roll reading".to_owned(),
        BiasedReading::Inclination(1) => "The pitch reading".to_owned(),
        BiasedReading::Inclination(_) => "The heading reading".to_owned(),
    };
    let how = match form.shape {
        Shape::Wave => "swings",
        Shape::Smooth | Shape::Surface => "changes",
    };
    let size = reading.in_words(spread(found, &form));
    let variables = form.variables();
    format!(
        "{what} has an error that {how} with the {variables} by up to {size}; no known cause explains it."
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    ADVICE.to_owned()
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    let bias = sum(parameters, &at.variables);
    match BiasedReading::numbered(parameters[READING].value) {
        // Encoders are zeroed at home and lengths count from there, so the error is zero there.
        _ if at.is_home => {}
        Some(BiasedReading::Length) => ports.paid += bias,
        Some(BiasedReading::Tension) => ports.tension += bias,
        Some(BiasedReading::Swivel) => ports.swivel_offset += bias,
        _ => {}
    }
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    let bias = sum(parameters, &at.variables);
    match BiasedReading::numbered(parameters[READING].value) {
        Some(BiasedReading::Laser) => ports.laser_bias += bias,
        Some(BiasedReading::Inclination(k)) => ports.inclination_offset[k] += bias,
        _ => {}
    }
}
