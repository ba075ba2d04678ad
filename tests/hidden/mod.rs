//! The hidden-effect test: effects are hidden in simulated data, and the model doctor is asked what is wrong.
//!
//! A [`Plan`] says what to hide where, and under which [`Circumstances`] it is measured; [`draw`] makes a [`Case`] of it
//! with random targets, signs and sizes; [`run`] simulates the case, asks the doctor and judges the answer; [`Study`] does
//! so for many and [`markdown`] makes tables of the outcomes.
//!
//! How well an effect can be seen is decided without the doctor, by its noncentrality: the chi-square that it
//! leaves in a fit of the model without it to noise-free data.

mod conditions;
mod draw;
mod exchange;
mod hanging;
mod interval;
mod judge;
mod measure;
mod names;
mod outside;
mod plans;
mod records;
mod robots;
mod run;
mod setup;
mod several;
mod table;
mod template;
mod visibility;

pub use conditions::{Circumstances, Conditions, NoiseFactors};
pub use draw::{Drawn, draw};
pub use exchange::Channels;
pub use interval::{binomial_tail, clopper_pearson};
pub use judge::{Claim, Found, judge, wrong_names};
pub use measure::{ParameterError, held_out_ratio, parameter_errors, rivals_fit};
pub use outside::{OUTSIDE, Outside, Scene};
pub use plans::{
    Restriction, STUDIES, TABLE_SEED, clean, named, outside, pairs, single, table_plans,
};
pub use records::Records;
pub use robots::{TestRobot, robot, robots};
pub use run::{Candidate, Outcome, Said, Study, Sure, WithoutHoles, draw_all, run, run_all};
pub use setup::Setup;
pub use table::{
    Figure, Figures, Target, coverage, describe, diagram, drawn_markdown, failures, markdown,
    summary,
};
pub use template::Template;
pub use visibility::{JUST_VISIBLE, VISIBLE, noncentrality};

use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;

use names::Name;

/// Poses per data set, without the home pose, where a robot has no number of its own.
pub const POSES: usize = 41;

/// How large a hidden effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stratum {
    /// Log-uniform from just visible, or the smallest typical size, to the largest typical size.
    Typical,
    /// Such that its noncentrality is that of an effect which can just be seen.
    JustVisible,
}

/// What is to be hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Wanted {
    /// Nothing.
    Nothing,
    /// One effect of the catalogue.
    One(#[serde(with = "names")] Name, Stratum),
    /// One effect of the catalogue, drawn at random among those that can be seen.
    Any,
    /// The same, if no other single effect could explain it.
    Separated,
    /// Two effects of the catalogue, drawn at random.
    Two,
    /// Three to five effects of the catalogue, drawn at random.
    Several,
    /// As many effects as chance has it, visible or not: 0.8 on average.
    ByChance,
    /// One offset of 50 to 200 mm that all cables have in common.
    CommonOffset,
    /// Every winch with a scale of its own, every force sensor with a gain and a bias of its own.
    Families,
    /// Two channels the wrong way round.
    Exchanged(Channels),
    /// An effect that the catalogue does not have.
    Outside(#[serde(with = "names")] Name),
}

/// One data set to be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Plan {
    /// Name of the robot.
    #[serde(with = "names")]
    pub robot: Name,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What is to be hidden.
    pub wanted: Wanted,
    /// How it is measured.
    pub circumstances: Circumstances,
}

/// What is hidden in a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Hidden {
    /// Nothing.
    Nothing,
    /// Effects of the catalogue.
    Effects(Vec<EffectSetting>),
    /// An effect outside the catalogue and its size, in units of its own.
    Outside(#[serde(with = "outside::by_id")] &'static Outside, f64),
    /// Channels of two cables, by index, the wrong way round.
    Exchanged(Channels, [usize; 2]),
}

impl Hidden {
    /// The effects of the catalogue.
    #[must_use]
    pub fn effects(&self) -> &[EffectSetting] {
        match self {
            Self::Effects(settings) => settings,
            Self::Nothing | Self::Outside(..) | Self::Exchanged(..) => &[],
        }
    }
}

/// One data set with what is hidden in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Name of the robot.
    #[serde(with = "names")]
    pub robot: Name,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What is hidden.
    pub hidden: Hidden,
    /// How it is measured.
    pub conditions: Conditions,
}
