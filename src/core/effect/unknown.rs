//! Structure that no effect of the catalogue explains: a smooth function of one variable added to a reading,
//! `scale sum_k c_k phi_k(u)`, `u = (v - from)/(to - from)`, with `phi_0 = 1`, `phi_k = cos(k pi u)`; for the fraction
//! of a drum revolution, which is periodic, sines and cosines of one and two waves; for the direction of
//! travel, which is a sign, the sign alone.
//!
//! It names no cause. As a nuisance it keeps the structure out of the geometry. `reading` is the number of a
//! [`BiasedReading`], `variable` that of a [`Variable`].

use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, PlatformCircumstances,
    PlatformPorts, Scope,
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
