//! Structure that no effect of the catalogue explains: a smooth function of one variable added to a reading,
//! `scale sum_k c_k phi_k(u)`, `u = (v - from)/(to - from)`, with `phi_0 = 1`, `phi_k = cos(k pi u)`; for the fraction
//! of a drum revolution, which is periodic, sines and cosines of one and two waves; for the direction of
//! travel, which is a sign, the sign alone.
//!
//! It names no cause. As a nuisance it keeps the structure out of the geometry. `reading` is the number of a
//! [`BiasedReading`], `variable` that of a [`Variable`].

use super::words::{self, degrees, millimetres};
use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part,
    PlatformCircumstances, PlatformPorts, Scope,
};
use crate::measurement::Variable;

/// Functions of one variable.
pub const FUNCTIONS: usize = 6;

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

    /// Whether it is the reading of a cable.
    #[must_use]
    pub fn is_of_cable(self) -> bool {
        matches!(self, Self::Length | Self::Tension | Self::Swivel)
    }

    /// The size of a value in words that a reader uses for this reading.
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

/// The functions of one variable at a value of it, between `from` and `to`.
#[must_use]
pub fn functions(variable: Variable, value: f64, [from, to]: [f64; 2]) -> [f64; FUNCTIONS] {
    if !value.is_finite() {
        return [0.0; FUNCTIONS];
    }
    match variable {
        Variable::Direction => [1.0, value, 0.0, 0.0, 0.0, 0.0],
        Variable::DrumFraction => {
            let (s, c) = (std::f64::consts::TAU * value).sin_cos();
            [1.0, s, c, 2.0 * s * c, c * c - s * s, 0.0]
        }
        _ => {
            let angle = std::f64::consts::PI * (value - from) / (to - from);
            std::array::from_fn(|k| (k as f64 * angle).cos())
        }
    }
}

/// Largest less smallest value of the function.
fn spread(found: &Found<'_>, variable: Variable) -> f64 {
    let [from, to] = match variable {
        Variable::Direction => [-1.0, 1.0],
        Variable::DrumFraction => [0.0, 1.0],
        _ => [found.value(FROM), found.value(TO)],
    };
    let at = |step: u32| {
        let value = from + (to - from) * f64::from(step) / 100.0;
        let terms = functions(variable, value, [from, to]);
        let terms = terms
            .iter()
            .enumerate()
            .map(|(k, f)| f * found.value(FIRST + k));
        found.value(SCALE) * terms.sum::<f64>()
    };
    let values: Vec<f64> = (0..=100).map(at).collect();
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// See the module documentation.
#[derive(Debug)]
pub struct Unknown;

/// Indices of the parameters.
pub(crate) const READING: usize = 0;
pub(crate) const VARIABLE: usize = 1;
pub(crate) const FROM: usize = 2;
pub(crate) const TO: usize = 3;
pub(crate) const SCALE: usize = 4;
pub(crate) const FIRST: usize = 5;

fn sum(parameters: &[Dual], variables: &[f64; Variable::COUNT]) -> Dual {
    let number = |k: usize| parameters[k].value;
    let Some(variable) = Variable::ALL.get(number(VARIABLE) as usize).copied() else {
        return Dual::constant(0.0);
    };
    let range = [number(FROM), number(TO)];
    let values = functions(variable, variables[variable.index()], range);
    let mut sum = Dual::constant(0.0);
    for (c, value) in parameters[FIRST..].iter().zip(values) {
        sum += *c * (value * number(SCALE));
    }
    sum
}

impl Effect for Unknown {
    fn id(&self) -> &'static str {
        "unknown"
    }
    fn title(&self) -> &'static str {
        "Unknown structure"
    }
    fn scope(&self) -> Scope {
        Scope::Reading
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::given("reading", "1", [0.0, 6.0]),
                EffectParameter::given("variable", "1", [0.0, 15.0]),
                EffectParameter::given("from", "1", [0.0, 1.0]),
                EffectParameter::given("to", "1", [0.0, 1.0]),
                EffectParameter::given("scale", "1", [0.0, 1.0]),
                EffectParameter::new("c0", "1", 1.0, [0.1, 1.0]),
                EffectParameter::new("c1", "1", 1.0, [0.1, 1.0]),
                EffectParameter::new("c2", "1", 1.0, [0.1, 1.0]),
                EffectParameter::new("c3", "1", 0.7, [0.1, 1.0]),
                EffectParameter::new("c4", "1", 0.5, [0.1, 1.0]),
                EffectParameter::new("c5", "1", 0.4, [0.1, 1.0]),
            ]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        let reading = BiasedReading::numbered(found.value(READING));
        let variable = Variable::ALL.get(found.value(VARIABLE) as usize);
        let (Some(reading), Some(variable)) = (reading, variable) else {
            return "Something is not explained.".to_owned();
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
        let size = reading.in_words(spread(found, *variable));
        let variable = variable.name();
        format!(
            "{what} has an error that changes with the {variable} by up to {size}; no known cause explains it."
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Look at the plot of this error; measure poses between those where it is large and small."
            .to_owned()
    }
    fn source(&self) -> &'static str {
        "Smooth functions with a prior on their size"
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        let bias = sum(parameters, &at.variables);
        match BiasedReading::numbered(parameters[READING].value) {
            // At home, where encoders are zeroed and lengths count from, there is none.
            _ if at.is_home => {}
            Some(BiasedReading::Length) => ports.paid += bias,
            Some(BiasedReading::Tension) => ports.tension += bias,
            Some(BiasedReading::Swivel) => ports.swivel_offset += bias,
            _ => {}
        }
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        let bias = sum(parameters, &at.variables);
        match BiasedReading::numbered(parameters[READING].value) {
            Some(BiasedReading::Laser) => ports.laser_bias += bias,
            Some(BiasedReading::Inclination(k)) => ports.inclination_offset[k] += bias,
            _ => {}
        }
    }
}
