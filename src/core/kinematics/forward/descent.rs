//! Damped Gauss-Newton descent from one start.

use pulp::Simd;

use super::super::bank::{CableBank, Placement};
use super::normal::{NormalEquations, assemble};

/// Limit on the steps tried from one start.
const STEPS: usize = 60;
/// An error of the pose below this counts as none (m, and rad: platforms are smaller than metres).
const POSE_TOLERANCE: f64 = 1e-11;
/// Longest rotation in one step (rad); beyond it the linear model says nothing.
const LONGEST_TURN: f64 = 0.8;
/// Damping of the first step that is damped at all.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping at which no direction is left that reduces the residual.
const LAST_DAMPING: f64 = 1e10;

/// Position and unit quaternion (w first) of the platform.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) position: [f64; 3],
    pub(super) quaternion: [f64; 4],
}

/// Where a descent ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Descent {
    pub(super) state: State,
    /// Sum of squared residuals (m^2).
    pub(super) cost: f64,
    /// Whether no step improves it any more.
    pub(super) at_rest: bool,
    /// Whether an anchor is inside its pulley.
    pub(super) blocked: bool,
    pub(super) conditioning: f64,
    pub(super) iterations: usize,
}

/// What is solved, the same at every step.
#[derive(Clone, Copy)]
pub(super) struct Lengths<'a> {
    pub(super) bank: &'a CableBank,
    /// Measured lengths (m), padded with NaN to whole vectors.
    pub(super) measured: &'a [f64],
    pub(super) free: &'a [bool; 6],
}

impl Lengths<'_> {
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, state: &State) -> NormalEquations {
        let mut normal = assemble(simd, self.bank, self.measured, &state.placement());
        normal.lock(self.free);
        normal
    }
}

/// Descends from `state`.
#[inline(always)]
pub(super) fn descend<S: Simd>(simd: S, lengths: Lengths<'_>, state: State) -> Descent {
    let mut walk = Walk {
        state,
        normal: lengths.at(simd, &state),
        damping: 0.0,
        last_step: 0.0,
        at_rest: false,
    };
    let mut iterations = 0;
    while iterations < STEPS && walk.damping < LAST_DAMPING && !walk.at_rest {
        iterations += 1;
        let Some(step) = walk.normal.step(walk.damping) else {
            walk.damping = raised(walk.damping);
            continue;
        };
        let step = shortened(step);
        let trial = walk.state.moved(&step);
        let reached = lengths.at(simd, &trial);
        walk.judge(&step, trial, reached);
    }
    Descent {
        state: walk.state,
        cost: walk.normal.cost,
        at_rest: walk.at_rest,
        blocked: walk.normal.blocked > 0.0,
        conditioning: walk.normal.conditioning(),
        iterations,
    }
}

/// A descent under way.
struct Walk {
    state: State,
    normal: NormalEquations,
    damping: f64,
    /// Size of the last accepted step; 0 before the first.
    last_step: f64,
    at_rest: bool,
}

impl Walk {
    /// Accepts the trial or raises the damping, and notices when nothing is left to gain.
    #[inline(always)]
    fn judge(&mut self, step: &[f64; 6], trial: State, reached: NormalEquations) {
        let mut size = 0.0_f64;
        for value in step {
            size = size.max(value.abs());
        }
        let gain = self.normal.cost - reached.cost;
        // Residuals cannot be told apart below the rounding of the lengths.
        let noise = 1e-30 + 1e-14 * self.normal.cost;
        if gain.is_nan() || gain < -noise {
            self.at_rest = size < POSE_TOLERANCE;
            self.damping = raised(self.damping);
            return;
        }
        self.damping = relaxed(self.damping, gain, self.normal.promised_decrease(step));
        (self.state, self.normal) = (trial, reached);
        // Steps shrink at least by this ratio from now on, so that what is left is their sum.
        let ratio = if self.last_step > 0.0 {
            size / self.last_step
        } else {
            1.0
        };
        self.last_step = size;
        self.at_rest = size < POSE_TOLERANCE || (ratio < 0.3 && size * ratio < POSE_TOLERANCE);
    }
}

fn raised(damping: f64) -> f64 {
    (damping * 8.0).max(FIRST_DAMPING)
}

/// Damping after an accepted step: less where the linear model was right, none once it is small.
#[inline(always)]
fn relaxed(damping: f64, gain: f64, promised: f64) -> f64 {
    if damping == 0.0 || gain < 0.25 * promised {
        return damping;
    }
    let less = damping * if gain > 0.75 * promised { 0.1 } else { 0.5 };
    if less < FIRST_DAMPING { 0.0 } else { less }
}

/// The step, scaled down to the longest admissible turn.
#[inline(always)]
fn shortened(step: [f64; 6]) -> [f64; 6] {
    let turn = (step[3] * step[3] + step[4] * step[4] + step[5] * step[5]).sqrt();
    if turn <= LONGEST_TURN {
        return step;
    }
    step.map(|v| v * (LONGEST_TURN / turn))
}

impl State {
    /// After the twist `[d; phi]`; the rotation is that by `phi` up to third order.
    #[inline(always)]
    fn moved(&self, step: &[f64; 6]) -> Self {
        let [w, x, y, z] = self.quaternion;
        let (a, b, c) = (0.5 * step[3], 0.5 * step[4], 0.5 * step[5]);
        let raw = [
            w - a * x - b * y - c * z,
            x + a * w + b * z - c * y,
            y - a * z + b * w + c * x,
            z + a * y - b * x + c * w,
        ];
        let norm = (raw[0] * raw[0] + raw[1] * raw[1] + raw[2] * raw[2] + raw[3] * raw[3]).sqrt();
        Self {
            position: std::array::from_fn(|k| self.position[k] + step[k]),
            quaternion: raw.map(|v| v / norm),
        }
    }

    /// Position and rotation matrix.
    #[inline(always)]
    fn placement(&self) -> Placement<f64> {
        let [w, x, y, z] = self.quaternion;
        Placement {
            position: self.position,
            rotation: [
                [
                    1.0 - 2.0 * (y * y + z * z),
                    2.0 * (x * y - w * z),
                    2.0 * (x * z + w * y),
                ],
                [
                    2.0 * (x * y + w * z),
                    1.0 - 2.0 * (x * x + z * z),
                    2.0 * (y * z - w * x),
                ],
                [
                    2.0 * (x * z - w * y),
                    2.0 * (y * z + w * x),
                    1.0 - 2.0 * (x * x + y * y),
                ],
            ],
        }
    }
}
