//! The physical quantities through which effects act on the prediction.
//!
//! An effect never touches the solver: it changes some of these quantities, as a function of its
//! parameters and of the context of a pose. The prediction and its derivatives with respect to
//! the ports are written only once.
//!
//! `T` is [`Dual`] where effects change the ports, and a number or a SIMD packet where they are used.

use super::Dual;
use crate::robot::{Cable, Robot};

/// Quantities that the prediction of one cable's readings depends on, at one pose.
#[derive(Debug, Clone, Copy)]
pub struct CablePorts<T = Dual> {
    /// Unstrained cable paid out since home, according to the reading (m); for absolute readings the length.
    pub paid: T,
    /// Tension at the platform (N).
    pub tension: T,
    /// Extra strain of the cable.
    pub strain: T,
    /// Reciprocal axial stiffness (1/N).
    pub compliance: T,
    /// Weight per metre (N/m).
    pub weight: T,
    /// Pulley radius (m).
    pub radius: T,
    /// Added to the entry point, base frame (m).
    pub entry_shift: [T; 3],
    /// Swivel axis, base frame.
    pub axis: [T; 3],
    /// Platform anchor, platform frame (m).
    pub anchor: [T; 3],
    /// Added to the predicted swivel angle (rad).
    pub swivel_offset: T,
}

/// Quantities that the prediction of the platform's readings depends on, at one pose.
#[derive(Debug, Clone, Copy)]
pub struct PlatformPorts<T = Dual> {
    /// Mass (kg).
    pub mass: T,
    /// Centre of mass, platform frame (m).
    pub center_of_mass: [T; 3],
    /// Gain of the laser, reading per true distance.
    pub laser_gain: T,
    /// Added to the laser reading (m).
    pub laser_bias: T,
    /// Beam direction, platform frame.
    pub laser_direction: [T; 3],
    /// Normal of the target plane, base frame.
    pub target_normal: [T; 3],
    /// Added to roll, pitch and yaw (rad).
    pub inclination_offset: [T; 3],
    /// Delay of the external instrument (s).
    pub tracker_delay: T,
    /// Point of the platform that it measures, platform frame (m).
    pub tracker_point: [T; 3],
    /// Added to its position reading, base frame (m).
    pub tracker_shift: [T; 3],
    /// Added to twice the vector part of the quaternion by which the orientation differs from the reading (base frame).
    pub tracker_turn: [T; 3],
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

/// Identifies a scalar of [`CablePorts`]; vectors by component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CablePort {
    Paid,
    Tension,
    Strain,
    Compliance,
    Weight,
    Radius,
    EntryShift(usize),
    Axis(usize),
    Anchor(usize),
    SwivelOffset,
}

/// Identifies a scalar of [`PlatformPorts`]; vectors by component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlatformPort {
    Mass,
    CenterOfMass(usize),
    LaserGain,
    LaserBias,
    LaserDirection(usize),
    TargetNormal(usize),
    InclinationOffset(usize),
    TrackerDelay,
    TrackerPoint(usize),
    TrackerShift(usize),
    TrackerTurn(usize),
}

impl CablePort {
    /// Whether a winch or a force sensor reads the port.
    pub fn is_reading(self) -> bool {
        matches!(self, Self::Paid | Self::Tension)
    }

    /// Number of scalars.
    pub const COUNT: usize = 16;

    /// All cable ports.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Paid,
        Self::Tension,
        Self::Strain,
        Self::Compliance,
        Self::Weight,
        Self::Radius,
        Self::EntryShift(0),
        Self::EntryShift(1),
        Self::EntryShift(2),
        Self::Axis(0),
        Self::Axis(1),
        Self::Axis(2),
        Self::Anchor(0),
        Self::Anchor(1),
        Self::Anchor(2),
        Self::SwivelOffset,
    ];
}

impl PlatformPort {
    /// Number of scalars.
    pub const COUNT: usize = 25;

    /// All platform ports.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Mass,
        Self::CenterOfMass(0),
        Self::CenterOfMass(1),
        Self::CenterOfMass(2),
        Self::LaserGain,
        Self::LaserBias,
        Self::LaserDirection(0),
        Self::LaserDirection(1),
        Self::LaserDirection(2),
        Self::TargetNormal(0),
        Self::TargetNormal(1),
        Self::TargetNormal(2),
        Self::InclinationOffset(0),
        Self::InclinationOffset(1),
        Self::InclinationOffset(2),
        Self::TrackerDelay,
        Self::TrackerPoint(0),
        Self::TrackerPoint(1),
        Self::TrackerPoint(2),
        Self::TrackerShift(0),
        Self::TrackerShift(1),
        Self::TrackerShift(2),
        Self::TrackerTurn(0),
        Self::TrackerTurn(1),
        Self::TrackerTurn(2),
    ];
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

impl<T: Copy> CablePorts<T> {
    /// Value of a port.
    pub fn get(&self, port: CablePort) -> T {
        match port {
            CablePort::Paid => self.paid,
            CablePort::Tension => self.tension,
            CablePort::Strain => self.strain,
            CablePort::Compliance => self.compliance,
            CablePort::Weight => self.weight,
            CablePort::Radius => self.radius,
            CablePort::EntryShift(axis) => self.entry_shift[axis],
            CablePort::Axis(axis) => self.axis[axis],
            CablePort::Anchor(axis) => self.anchor[axis],
            CablePort::SwivelOffset => self.swivel_offset,
        }
    }

    /// A port, to be changed.
    pub fn get_mut(&mut self, port: CablePort) -> &mut T {
        match port {
            CablePort::Paid => &mut self.paid,
            CablePort::Tension => &mut self.tension,
            CablePort::Strain => &mut self.strain,
            CablePort::Compliance => &mut self.compliance,
            CablePort::Weight => &mut self.weight,
            CablePort::Radius => &mut self.radius,
            CablePort::EntryShift(axis) => &mut self.entry_shift[axis],
            CablePort::Axis(axis) => &mut self.axis[axis],
            CablePort::Anchor(axis) => &mut self.anchor[axis],
            CablePort::SwivelOffset => &mut self.swivel_offset,
        }
    }

    /// All values, in the order of [`CablePort::ALL`].
    pub fn values(&self) -> [T; CablePort::COUNT] {
        let [shift, axis, anchor] = [self.entry_shift, self.axis, self.anchor];
        [
            self.paid,
            self.tension,
            self.strain,
            self.compliance,
            self.weight,
            self.radius,
            shift[0],
            shift[1],
            shift[2],
            axis[0],
            axis[1],
            axis[2],
            anchor[0],
            anchor[1],
            anchor[2],
            self.swivel_offset,
        ]
    }

    /// Ports whose values a function gives.
    pub fn from_fn(mut value: impl FnMut(CablePort) -> T) -> Self {
        Self {
            paid: value(CablePort::Paid),
            tension: value(CablePort::Tension),
            strain: value(CablePort::Strain),
            compliance: value(CablePort::Compliance),
            weight: value(CablePort::Weight),
            radius: value(CablePort::Radius),
            entry_shift: [0, 1, 2].map(|axis| value(CablePort::EntryShift(axis))),
            axis: [0, 1, 2].map(|axis| value(CablePort::Axis(axis))),
            anchor: [0, 1, 2].map(|axis| value(CablePort::Anchor(axis))),
            swivel_offset: value(CablePort::SwivelOffset),
        }
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

impl<T: Copy> PlatformPorts<T> {
    /// Value of a port.
    pub fn get(&self, port: PlatformPort) -> T {
        match port {
            PlatformPort::Mass => self.mass,
            PlatformPort::CenterOfMass(axis) => self.center_of_mass[axis],
            PlatformPort::LaserGain => self.laser_gain,
            PlatformPort::LaserBias => self.laser_bias,
            PlatformPort::LaserDirection(axis) => self.laser_direction[axis],
            PlatformPort::TargetNormal(axis) => self.target_normal[axis],
            PlatformPort::InclinationOffset(angle) => self.inclination_offset[angle],
            PlatformPort::TrackerDelay => self.tracker_delay,
            PlatformPort::TrackerPoint(axis) => self.tracker_point[axis],
            PlatformPort::TrackerShift(axis) => self.tracker_shift[axis],
            PlatformPort::TrackerTurn(axis) => self.tracker_turn[axis],
        }
    }

    /// A port, to be changed.
    pub fn get_mut(&mut self, port: PlatformPort) -> &mut T {
        match port {
            PlatformPort::Mass => &mut self.mass,
            PlatformPort::CenterOfMass(axis) => &mut self.center_of_mass[axis],
            PlatformPort::LaserGain => &mut self.laser_gain,
            PlatformPort::LaserBias => &mut self.laser_bias,
            PlatformPort::LaserDirection(axis) => &mut self.laser_direction[axis],
            PlatformPort::TargetNormal(axis) => &mut self.target_normal[axis],
            PlatformPort::InclinationOffset(angle) => &mut self.inclination_offset[angle],
            PlatformPort::TrackerDelay => &mut self.tracker_delay,
            PlatformPort::TrackerPoint(axis) => &mut self.tracker_point[axis],
            PlatformPort::TrackerShift(axis) => &mut self.tracker_shift[axis],
            PlatformPort::TrackerTurn(axis) => &mut self.tracker_turn[axis],
        }
    }

    /// All values, in the order of [`PlatformPort::ALL`].
    pub fn values(&self) -> [T; PlatformPort::COUNT] {
        let [center, beam, normal] = [
            self.center_of_mass,
            self.laser_direction,
            self.target_normal,
        ];
        let [point, shift, turn] = [self.tracker_point, self.tracker_shift, self.tracker_turn];
        let incline = self.inclination_offset;
        [
            self.mass,
            center[0],
            center[1],
            center[2],
            self.laser_gain,
            self.laser_bias,
            beam[0],
            beam[1],
            beam[2],
            normal[0],
            normal[1],
            normal[2],
            incline[0],
            incline[1],
            incline[2],
            self.tracker_delay,
            point[0],
            point[1],
            point[2],
            shift[0],
            shift[1],
            shift[2],
            turn[0],
            turn[1],
            turn[2],
        ]
    }

    /// Ports whose values a function gives.
    pub fn from_fn(mut value: impl FnMut(PlatformPort) -> T) -> Self {
        Self {
            mass: value(PlatformPort::Mass),
            center_of_mass: [0, 1, 2].map(|axis| value(PlatformPort::CenterOfMass(axis))),
            laser_gain: value(PlatformPort::LaserGain),
            laser_bias: value(PlatformPort::LaserBias),
            laser_direction: [0, 1, 2].map(|axis| value(PlatformPort::LaserDirection(axis))),
            target_normal: [0, 1, 2].map(|axis| value(PlatformPort::TargetNormal(axis))),
            inclination_offset: [0, 1, 2].map(|k| value(PlatformPort::InclinationOffset(k))),
            tracker_delay: value(PlatformPort::TrackerDelay),
            tracker_point: [0, 1, 2].map(|axis| value(PlatformPort::TrackerPoint(axis))),
            tracker_shift: [0, 1, 2].map(|axis| value(PlatformPort::TrackerShift(axis))),
            tracker_turn: [0, 1, 2].map(|axis| value(PlatformPort::TrackerTurn(axis))),
        }
    }
}
