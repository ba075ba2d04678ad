//! Ports of a cable or of the platform at one row under the effects that act on them, with the slopes by the effects'
//! parameters.
//!
//! An effect changes each port by itself, as a function of that port alone, so the slope by a parameter is the slope that its
//! own effect gives to the port, times the derivatives of the later effects by the port. Directions are the exception: a tilt
//! mixes their components, so slopes of directions pass through the later effects one by one.

use crate::effect::{CablePort, CablePorts, Dual, PlatformPort, PlatformPorts};

/// A set of ports that effects change.
pub(super) trait Ports: Copy {
    /// Identifies one port.
    type Port: Copy + PartialEq + 'static;
    /// All of them.
    const ALL: &'static [Self::Port];
    /// Value and slope of a port.
    fn port(&self, port: Self::Port) -> Dual;
    /// Values and slopes of all ports, in the order of [`Self::ALL`].
    fn duals(&self) -> impl AsRef<[Dual]>;
    /// Ports whose values and slopes a function gives.
    fn of(value: impl FnMut(Self::Port) -> Dual) -> Self;
    /// Whether a port is a component of a direction.
    fn is_direction(port: Self::Port) -> bool;

    /// The same values with another slope of every port.
    fn with_slope(&self, slope: f64) -> Self {
        Self::of(|port| Dual {
            value: self.port(port).value,
            slope,
        })
    }
}

impl Ports for CablePorts {
    type Port = CablePort;
    const ALL: &'static [CablePort] = CablePort::ALL;

    fn port(&self, port: CablePort) -> Dual {
        self.get(port)
    }

    fn duals(&self) -> impl AsRef<[Dual]> {
        self.values()
    }

    fn of(value: impl FnMut(CablePort) -> Dual) -> Self {
        Self::from_fn(value)
    }

    fn is_direction(port: CablePort) -> bool {
        matches!(port, CablePort::Axis(_))
    }
}

impl Ports for PlatformPorts {
    type Port = PlatformPort;
    const ALL: &'static [PlatformPort] = PlatformPort::ALL;

    fn port(&self, port: PlatformPort) -> Dual {
        self.get(port)
    }

    fn duals(&self) -> impl AsRef<[Dual]> {
        self.values()
    }

    fn of(value: impl FnMut(PlatformPort) -> Dual) -> Self {
        Self::from_fn(value)
    }

    fn is_direction(port: PlatformPort) -> bool {
        matches!(
            port,
            PlatformPort::LaserDirection(_) | PlatformPort::TargetNormal(_)
        )
    }
}

/// An estimated parameter with the values of its effect, of which it is the variable of differentiation.
pub(super) struct Variable {
    /// Index of the effect among those that act.
    pub effect: usize,
    /// Values of the effect's parameters.
    pub values: Vec<Dual>,
}

/// Ports at one row after all effects, and the state that their slopes need.
pub(super) struct EffectsOnPorts<P: Ports> {
    /// Ports before each effect, then after all of them.
    before: Vec<P>,
    /// After each effect, the factors that later effects apply to the ports.
    later: Vec<P>,
}

impl<P: Ports> EffectsOnPorts<P> {
    /// Room for a number of effects.
    pub fn with_capacity(effects: usize) -> Self {
        Self {
            before: Vec::with_capacity(effects + 1),
            later: Vec::with_capacity(effects),
        }
    }

    /// Applies the effects, each by its index, to `nominal` ports; returns the ports after them.
    pub fn apply(&mut self, nominal: P, effects: usize, change: impl Fn(usize, &mut P)) -> P {
        self.before.clear();
        self.later.clear();
        self.before.push(nominal.with_slope(0.0));
        for effect in 0..effects {
            let mut ports = self.before[effect].with_slope(1.0);
            change(effect, &mut ports);
            self.later.push(ports);
            self.before.push(ports.with_slope(0.0));
        }
        let mut factors = nominal.with_slope(1.0);
        for of_effect in self.later.iter_mut().rev() {
            let own = *of_effect;
            *of_effect = factors;
            factors = P::of(|port| Dual {
                value: 0.0,
                slope: factors.port(port).slope * own.port(port).slope,
            });
        }
        self.before[effects]
    }

    /// Calls `visit` with every port that depends on a parameter, and its slope; `change` applies an effect, given by its
    /// index, with the values of its parameters where they are not the constant ones.
    pub fn slopes(
        &self,
        variable: &Variable,
        change: impl Fn(usize, Option<&[Dual]>, &mut P),
        mut visit: impl FnMut(P::Port, f64),
    ) {
        let own = variable.effect;
        let last = self.later.len();
        let mut ports = self.before[own];
        change(own, Some(&variable.values), &mut ports);
        let mut mixes = false;
        if own + 1 < last {
            let duals = ports.duals();
            let mut ports = P::ALL.iter().zip(duals.as_ref());
            mixes = ports.any(|(port, dual)| dual.slope != 0.0 && P::is_direction(*port));
        }
        if mixes {
            for effect in own + 1..last {
                change(effect, None, &mut ports);
            }
        }
        for (port, dual) in P::ALL.iter().copied().zip(ports.duals().as_ref()) {
            let slope = dual.slope;
            // A missing reading has no derivative.
            if slope == 0.0 || self.before[last].port(port).value.is_nan() {
                continue;
            }
            let factor = if mixes {
                1.0
            } else {
                self.later[own].port(port).slope
            };
            visit(port, factor * slope);
        }
    }
}
