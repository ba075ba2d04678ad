//! The physical quantities through which effects act on the prediction.
//!
//! An effect never touches the solver: it changes some of these quantities, as a function of its
//! parameters and of the context of a pose. The prediction and its derivatives with respect to
//! the ports are written only once.
//!
//! `T` is [`Dual`] where effects change the ports, and a number or a SIMD packet where they are used.

use super::Dual;
use crate::robot::{Cable, Robot};

/// Ports and their identifiers, from groups of scalars and vectors: a struct with their values, and an enum of them.
macro_rules! ports {
    (
        $(#[$about:meta])* $ports:ident; $(#[$about_port:meta])* $port:ident;
        $(
            scalars { $($(#[$meaning:meta])* $scalar:ident: $of_scalar:ident,)* }
            vectors { $($(#[$meaning_of_vector:meta])* $vector:ident: $of_vector:ident,)* }
        )*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy)]
        pub struct $ports<T = Dual> {
            $(
                $($(#[$meaning])* pub $scalar: T,)*
                $($(#[$meaning_of_vector])* pub $vector: [T; 3],)*
            )*
        }

        $(#[$about_port])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $port {
            $($($of_scalar,)* $($of_vector(usize),)*)*
        }

        impl $port {
            /// All of them.
            pub const ALL: &[Self] = &[$(
                $(Self::$of_scalar,)*
                $(Self::$of_vector(0), Self::$of_vector(1), Self::$of_vector(2),)*
            )*];
        }

        impl<T: Copy> $ports<T> {
            /// Value of a port.
            pub fn get(&self, port: $port) -> T {
                match port {
                    $($($port::$of_scalar => self.$scalar,)* $($port::$of_vector(axis) => self.$vector[axis],)*)*
                }
            }

            /// A port, to be changed.
            pub fn get_mut(&mut self, port: $port) -> &mut T {
                match port {
                    $(
                        $($port::$of_scalar => &mut self.$scalar,)*
                        $($port::$of_vector(axis) => &mut self.$vector[axis],)*
                    )*
                }
            }

            /// All values, in the order of `ALL`.
            pub fn values(&self) -> [T; $port::ALL.len()] {
                [$(
                    $(self.$scalar,)*
                    $(self.$vector[0], self.$vector[1], self.$vector[2],)*
                )*]
            }

            /// Ports whose values a function gives.
            #[inline(always)]
            pub fn from_fn(mut value: impl FnMut($port) -> T) -> Self {
                Self {
                    $(
                        $($scalar: value($port::$of_scalar),)*
                        $($vector: [value($port::$of_vector(0)), value($port::$of_vector(1)), value($port::$of_vector(2))],)*
                    )*
                }
            }
        }
    };
}

ports! {
    /// Quantities that the prediction of one cable's readings depends on, at one pose.
    CablePorts;
    /// Identifies a scalar of [`CablePorts`]; vectors by component.
    CablePort;
    scalars {
        /// Unstrained cable paid out since home, according to the reading (m); for absolute readings the length.
        paid: Paid,
        /// Tension at the platform (N).
        tension: Tension,
        /// Extra strain of the cable.
        strain: Strain,
        /// Reciprocal axial stiffness (1/N).
        compliance: Compliance,
        /// Weight per metre (N/m).
        weight: Weight,
        /// Pulley radius (m).
        radius: Radius,
    }
    vectors {
        /// Added to the entry point, base frame (m).
        entry_shift: EntryShift,
        /// Swivel axis, base frame.
        axis: Axis,
        /// Platform anchor, platform frame (m).
        anchor: Anchor,
    }
    scalars {
        /// Added to the predicted swivel angle (rad).
        swivel_offset: SwivelOffset,
    }
    vectors {}
}

ports! {
    /// Quantities that the prediction of the platform's readings depends on, at one pose.
    PlatformPorts;
    /// Identifies a scalar of [`PlatformPorts`]; vectors by component.
    PlatformPort;
    scalars {
        /// Mass (kg).
        mass: Mass,
    }
    vectors {
        /// Centre of mass, platform frame (m).
        center_of_mass: CenterOfMass,
    }
    scalars {
        /// Gain of the laser, reading per true distance.
        laser_gain: LaserGain,
        /// Added to the laser reading (m).
        laser_bias: LaserBias,
    }
    vectors {
        /// Beam direction, platform frame.
        laser_direction: LaserDirection,
        /// Normal of the target plane, base frame.
        target_normal: TargetNormal,
        /// Added to roll, pitch and yaw (rad).
        inclination_offset: InclinationOffset,
    }
    scalars {
        /// Delay of the external instrument (s).
        tracker_delay: TrackerDelay,
    }
    vectors {
        /// Point of the platform that it measures, platform frame (m).
        tracker_point: TrackerPoint,
        /// Added to its position reading, base frame (m).
        tracker_shift: TrackerShift,
        /// Added to twice the vector part of the quaternion by which the orientation differs from the reading (base frame).
        tracker_turn: TrackerTurn,
    }
}

/// The reading of a distance between poses: `gain` times the distance plus `shift` (m).
#[derive(Debug, Clone, Copy)]
pub struct DistancePorts {
    pub gain: Dual,
    pub shift: Dual,
}

impl DistancePorts {
    /// The true distance.
    pub const NOMINAL: Self = Self {
        gain: Dual::constant(1.0),
        shift: Dual::constant(0.0),
    };
}

impl CablePort {
    /// Whether a winch or a force sensor reads the port.
    pub fn is_reading(self) -> bool {
        matches!(self, Self::Paid | Self::Tension)
    }
}

fn constants(values: [f64; 3]) -> [Dual; 3] {
    values.map(Dual::constant)
}

impl CablePorts {
    /// Ports of a cable before any effect, for the length paid out (m) and the tension (N) according to the
    /// readings.
    pub fn nominal(cable: &Cable, paid: f64, tension: f64) -> Self {
        Self {
            paid: Dual::constant(paid),
            tension: Dual::constant(tension),
            strain: Dual::constant(0.0),
            compliance: Dual::constant(cable.cable.axial_stiffness_n.map_or(0.0, f64::recip)),
            weight: Dual::constant(cable.cable.weight_n_per_m),
            radius: Dual::constant(cable.pulley.radius_m),
            entry_shift: constants([0.0; 3]),
            axis: constants(cable.pulley.swivel_axis),
            anchor: constants(cable.platform_anchor_m),
            swivel_offset: Dual::constant(0.0),
        }
    }

    /// Replaces entry point, swivel axis, pulley radius and anchor of a cable by the values of these ports.
    pub(crate) fn change_geometry(&self, cable: &mut Cable) {
        let values = |port: [Dual; 3]| port.map(|dual| dual.value);
        let shift = values(self.entry_shift);
        for k in 0..3 {
            cable.pulley.entry_point_m[k] += shift[k];
        }
        cable.pulley.swivel_axis = values(self.axis);
        cable.pulley.radius_m = self.radius.value;
        cable.platform_anchor_m = values(self.anchor);
    }
}

impl PlatformPorts {
    /// The ports of the platform before any effect.
    pub fn nominal(robot: &Robot) -> Self {
        let laser = robot.laser;
        Self {
            mass: Dual::constant(robot.platform.mass_kg.unwrap_or(0.0)),
            center_of_mass: constants(robot.platform.center_of_mass_m),
            laser_gain: Dual::constant(1.0),
            laser_bias: Dual::constant(0.0),
            laser_direction: constants(laser.map_or([0.0, 0.0, -1.0], |l| l.direction)),
            target_normal: constants(laser.map_or([0.0, 0.0, 1.0], |l| l.target_plane.normal)),
            inclination_offset: constants([0.0; 3]),
            tracker_delay: Dual::constant(0.0),
            tracker_point: constants([0.0; 3]),
            tracker_shift: constants([0.0; 3]),
            tracker_turn: constants([0.0; 3]),
        }
    }
}
