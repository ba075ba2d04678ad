//! The physical quantities through which effects act on the prediction.
//!
//! An effect never touches the solver: it changes some of these quantities, as a function of its
//! parameters and of the circumstances of a pose. The prediction and its derivatives with respect to
//! the ports are written once.

use super::Dual;
use crate::robot::{Cable, Robot};

/// What the prediction of one cable's readings depends on, at one pose.
#[derive(Debug, Clone, Copy)]
pub struct CablePorts {
    /// Unstrained cable paid out since home, as the reading tells (m); for absolute readings the length.
    pub paid: Dual,
    /// Tension at the platform (N).
    pub tension: Dual,
    /// Extra strain of the cable.
    pub strain: Dual,
    /// Reciprocal axial stiffness (1/N).
    pub compliance: Dual,
    /// Weight per metre (N/m).
    pub weight: Dual,
    /// Pulley radius (m).
    pub radius: Dual,
    /// Added to the entry point, base frame (m).
    pub entry_shift: [Dual; 3],
    /// Swivel axis, base frame.
    pub axis: [Dual; 3],
    /// Platform anchor, platform frame (m).
    pub anchor: [Dual; 3],
    /// Added to the predicted swivel angle (rad).
    pub swivel_offset: Dual,
}

/// What the prediction of the platform's readings depends on, at one pose.
#[derive(Debug, Clone, Copy)]
pub struct PlatformPorts {
    /// Mass (kg).
    pub mass: Dual,
    /// Centre of mass, platform frame (m).
    pub center_of_mass: [Dual; 3],
    /// Laser reading per true distance.
    pub laser_gain: Dual,
    /// Added to the laser reading (m).
    pub laser_bias: Dual,
    /// Beam direction, platform frame.
    pub laser_direction: [Dual; 3],
    /// Normal of the target plane, base frame.
    pub target_normal: [Dual; 3],
    /// Added to roll, pitch and yaw (rad).
    pub inclination_offset: [Dual; 3],
}

/// One scalar of [`CablePorts`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CablePort {
    /// Cable paid out.
    Paid,
    /// Tension.
    Tension,
    /// Extra strain.
    Strain,
    /// Reciprocal stiffness.
    Compliance,
    /// Weight per metre.
    Weight,
    /// Pulley radius.
    Radius,
    /// Component of the entry point's shift.
    EntryShift(usize),
    /// Component of the swivel axis.
    Axis(usize),
    /// Component of the platform anchor.
    Anchor(usize),
    /// Swivel reading offset.
    SwivelOffset,
}

/// One scalar of [`PlatformPorts`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlatformPort {
    /// Mass.
    Mass,
    /// Component of the centre of mass.
    CenterOfMass(usize),
    /// Laser gain.
    LaserGain,
    /// Laser bias.
    LaserBias,
    /// Component of the beam direction.
    LaserDirection(usize),
    /// Component of the target normal.
    TargetNormal(usize),
    /// Component of the inclination offset.
    InclinationOffset(usize),
}

impl CablePort {
    /// Number of scalars.
    pub const COUNT: usize = 16;

    /// All of them, in the order of [`CablePorts::scalars`].
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
    pub const COUNT: usize = 15;

    /// All of them, in the order of [`PlatformPorts::scalars`].
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
    ];
}

fn constants(values: [f64; 3]) -> [Dual; 3] {
    values.map(Dual::constant)
}

impl CablePorts {
    /// The ports of a cable before any effect, for the cable paid out (m) and the tension (N) that its
    /// readings tell.
    #[must_use]
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

    /// Gives a cable the entry point, swivel axis, pulley radius and anchor of these ports.
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

    /// The scalars in the order of [`CablePort::ALL`].
    #[must_use]
    pub fn scalars(&self) -> [Dual; CablePort::COUNT] {
        let ([ex, ey, ez], [zx, zy, zz], [bx, by, bz]) = (self.entry_shift, self.axis, self.anchor);
        [
            self.paid,
            self.tension,
            self.strain,
            self.compliance,
            self.weight,
            self.radius,
            ex,
            ey,
            ez,
            zx,
            zy,
            zz,
            bx,
            by,
            bz,
            self.swivel_offset,
        ]
    }
}

impl PlatformPorts {
    /// The ports of the platform before any effect.
    #[must_use]
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
        }
    }

    /// The scalars in the order of [`PlatformPort::ALL`].
    #[must_use]
    pub fn scalars(&self) -> [Dual; PlatformPort::COUNT] {
        let [cx, cy, cz] = self.center_of_mass;
        let [qx, qy, qz] = self.laser_direction;
        let [nx, ny, nz] = self.target_normal;
        let [roll, pitch, yaw] = self.inclination_offset;
        [
            self.mass,
            cx,
            cy,
            cz,
            self.laser_gain,
            self.laser_bias,
            qx,
            qy,
            qz,
            nx,
            ny,
            nz,
            roll,
            pitch,
            yaw,
        ]
    }
}
