//! The hidden-effect test: effects are hidden in simulated data, and the model doctor is asked what is wrong.
//!
//! A [`Plan`] says what to hide where; [`draw`] makes a [`Case`] of it with random targets, signs and sizes;
//! [`run`] simulates the case, asks the doctor and judges the answer; [`Study`] does so for many and
//! [`markdown`] makes tables of the outcomes.
//!
//! How well an effect can be seen is decided without the doctor, by its noncentrality: the chi-square that it
//! leaves in a fit of the model without it to noise-free data.

mod draw;
mod interval;
mod judge;
mod measure;
mod outside;
mod plans;
mod robots;
mod run;
mod table;
mod template;
mod visibility;

pub use draw::{Drawn, draw};
pub use interval::{binomial_tail, clopper_pearson};
pub use judge::{Claim, Found, judge, wrong_names};
pub use measure::{ParameterError, held_out_ratio, parameter_errors, rivals_fit};
pub use outside::{OUTSIDE, Outside, Scene};
pub use plans::{Restriction, clean, outside, pairs, single};
pub use robots::{TestRobot, robot, robots};
pub use run::{Outcome, Study, draw_all, run, run_all};
pub use table::{Figure, Figures, Target, coverage, describe, drawn_markdown, failures, markdown};
pub use template::Template;
pub use visibility::{JUST_VISIBLE, VISIBLE, noncentrality};

use tautline_core::effect::EffectSetting;

/// Poses per data set, without the home pose.
pub const POSES: usize = 41;

/// How large a hidden effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stratum {
    /// Log-uniform from just visible, or the smallest typical size, to the largest typical size.
    Typical,
    /// Such that its noncentrality is that of an effect which can just be seen.
    JustVisible,
}

/// What is to be hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// Nothing.
    Nothing,
    /// One effect of the catalogue.
    One(&'static str, Stratum),
    /// Two effects of the catalogue, drawn at random.
    Two,
    /// An effect that the catalogue does not have.
    Outside(&'static str),
}

/// One data set to be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Name of the robot.
    pub robot: &'static str,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What is to be hidden.
    pub wanted: Wanted,
}

/// What is hidden in a data set.
#[derive(Debug, Clone, PartialEq)]
pub enum Hidden {
    /// Nothing.
    Nothing,
    /// Effects of the catalogue.
    Effects(Vec<EffectSetting>),
    /// An effect outside the catalogue and its size, in units of its own.
    Outside(&'static Outside, f64),
}

/// One data set with what is hidden in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the robot.
    pub robot: &'static str,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What is hidden.
    pub hidden: Hidden,
}
