//! Physical effects that extend the nominal model.
//!
//! Each effect is one file: what it changes in the prediction (through [`CablePorts`] and
//! [`PlatformPorts`]), its parameters with unit, prior and typical size. The same code hides an effect
//! in simulated data and adds it to a model.

mod binding;
mod cable_stiffness;
mod catalogue;
mod drum_eccentricity;
mod drum_growth;
mod dual;
mod laser_bias;
mod laser_scale;
mod ports;
mod pulley_radius;
mod setting;
mod winch_offset;
mod winch_scale;
mod winch_scale_common;

pub use binding::{BoundEffect, EffectError, EffectRequest};
pub use catalogue::{CATALOGUE, find};
pub use dual::Dual;
pub use ports::{CablePort, CablePorts, PlatformPort, PlatformPorts};
pub use setting::EffectSetting;

/// What an effect can be attached to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// One cable; without a target each cable gets its own.
    Cable,
    /// One cable, or all cables with common parameters; without a target all.
    CableOrAll,
    /// All cables, the platform, the frame or an instrument together; takes no target.
    Robot,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name in files.
    pub name: &'static str,
    /// SI unit; "1" for a ratio.
    pub unit: &'static str,
    /// Standard deviation of the prior, which is centred at no effect.
    pub prior_sd: f64,
    /// Typical size in the field, smallest and largest.
    pub typical: [f64; 2],
}

/// Circumstances of one cable at one pose.
#[derive(Debug, Clone, Copy)]
pub struct CableCircumstances {
    /// Whether this is the home pose, at which the encoders were zeroed.
    pub is_home: bool,
    /// Motor revolutions since home; 0 where lengths are read directly.
    pub revolutions: f64,
    /// Drum revolutions per motor revolution.
    pub drum_per_motor: f64,
}

/// A physical effect of the catalogue.
pub trait Effect: Sync {
    /// Stable identifier in files and commands.
    fn id(&self) -> &'static str;
    /// Plain title.
    fn title(&self) -> &'static str;
    /// What it can be attached to.
    fn scope(&self) -> Scope;
    /// Its parameters, in the order in which `change_cable` and `change_platform` get them.
    fn parameters(&self) -> &'static [EffectParameter];
    /// Changes the ports of a cable it is attached to.
    fn change_cable(
        &self,
        _parameters: &[Dual],
        _at: &CableCircumstances,
        _ports: &mut CablePorts,
    ) {
    }
    /// Changes the ports of the platform.
    fn change_platform(&self, _parameters: &[Dual], _ports: &mut PlatformPorts) {}
}
