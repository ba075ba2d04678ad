//! Terms that motion adds to the equations of a packet of poses: inertia, and the delay of an external instrument.

use super::columns::{ColumnStore, StoredColumn};
use super::equations::Equations;
use super::inputs::Selection;
use super::layout::Layout;
use crate::effect::{PlatformContext, PlatformPort};
use crate::estimation::problem::Problem;
use crate::geometry::PosePacket;
use crate::real::{Packet, Real, add_scaled, cross, dot, scaled};

/// Motion of the platform at all poses.
#[derive(Clone)]
pub(super) struct MotionColumns {
    pub velocity: Vec<StoredColumn>,
    pub acceleration: Vec<StoredColumn>,
    /// Acceleration of the centre of mass, then `I alpha + w x I w` (m/s^2, N m).
    pub inertia: Vec<StoredColumn>,
}

impl MotionColumns {
    /// Packs the motion at the selected rows; `None` where poses are at rest.
    pub fn pack<T: Packet>(
        store: &mut ColumnStore<T>,
        problem: &Problem<'_>,
        selection: &Selection,
    ) -> Option<Self> {
        problem.dataset.measurements.rates.as_ref()?;
        let contexts = selection.contexts.as_ref()?;
        let mut six = |of: &dyn Fn(&PlatformContext, usize) -> f64| -> Vec<StoredColumn> {
            let column = |k: usize| {
                let values = selection.rows.iter();
                store.varying(values.map(|row| of(contexts.platform(*row), k)), 0.0)
            };
            (0..6).map(column).collect()
        };
        Some(Self {
            velocity: six(&|at, k| at.twists[0][k]),
            acceleration: six(&|at, k| at.twists[1][k]),
            inertia: six(&|at, k| at.inertia[k]),
        })
    }
}

/// Pose at the time when an external instrument saw it: the present pose moved by `-delay v + delay^2 a/2`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lag<T> {
    pub step: [T; 6],
    by_delay: [T; 6],
}

impl<T: Real> Lag<T> {
    #[inline(always)]
    pub fn new(velocity: [T; 6], acceleration: [T; 6], delay: T) -> Self {
        let mut lag = Self {
            step: velocity,
            by_delay: velocity,
        };
        let half = delay * delay.lift(0.5);
        for k in 0..6 {
            lag.step[k] = (acceleration[k] * half - velocity[k]) * delay;
            lag.by_delay[k] = acceleration[k] * delay - velocity[k];
        }
        lag
    }

    /// Completes the rows of the instrument at the pose it saw: adds their derivatives by the delay, and refers those of the
    /// orientation to the rotation of the present pose.
    #[inline(always)]
    pub fn complete(
        &self,
        links: &[(PlatformPort, usize, T)],
        layout: &Layout,
        equations: &mut Equations<T>,
    ) {
        let [x, y, z, turn_x, turn_y, turn_z] = self.by_delay;
        let zero = turn_x.lift(0.0);
        let one = turn_x.lift(1.0);
        let still = PosePacket::new([zero; 3], [one, zero, zero, zero]);
        let turned = still.moved(self.step).rotation;
        let turn = [self.step[3], self.step[4], self.step[5]];
        // A change of the step rotates the pose seen as its Rodrigues parameters (half the step) do.
        let half = turn_x.lift(0.5);
        let by_turn = [turn_x, turn_y, turn_z];
        let by_turn = add_scaled(by_turn, half, cross(turn, by_turn));
        let shrink = one / (dot(turn, turn) * half).mul_add(half, one);
        let by_turn = scaled(by_turn, shrink);
        let blocks = [layout.tracker_position, layout.tracker_orientation];
        for row in blocks
            .into_iter()
            .flatten()
            .flat_map(|first| first..first + 3)
        {
            let [p, q, r, a, b, c] = equations.by_pose[row];
            let change = dot([p, q, r], [x, y, z]) + dot([a, b, c], by_turn);
            link(row, change, links, layout, equations);
            for k in 0..3 {
                equations.by_pose[row][3 + k] =
                    dot([a, b, c], [turned[0][k], turned[1][k], turned[2][k]]);
            }
        }
    }
}

/// Adds the derivative of a row with respect to the delay.
#[inline(always)]
fn link<T: Real>(
    row: usize,
    change: T,
    links: &[(PlatformPort, usize, T)],
    layout: &Layout,
    equations: &mut Equations<T>,
) {
    for (port, parameter, by_parameter) in links {
        if *port == PlatformPort::TrackerDelay {
            let entry = &mut equations.effects_of(layout, row)[*parameter];
            *entry = change.mul_add(*by_parameter, *entry);
        }
    }
}
