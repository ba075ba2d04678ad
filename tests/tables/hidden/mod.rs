//! The hidden-effect study: effects are hidden in simulated data and must be found by the diagnosis.
//!
//! A [`Plan`] determines what to hide in which robot and under which [`Circumstances`] it is measured. [`draw`] turns
//! it into a case with random targets, signs and sizes; [`run`] simulates and diagnoses it, and compares the
//! findings with the truth; [`Study`] collects the outcomes of many plans, and [`markdown`] makes tables of them.
//!
//! The visibility of an effect is determined independently of the diagnosis by its noncentrality: the chi-square of a
//! model without the effect for noise-free data.

mod calibration;
mod changes;
mod conditions;
mod draw;
mod exchange;
mod hanging;
mod judge;
mod measure;
mod names;
mod outside;
mod plans;
pub mod robots;
mod run;
mod setup;
mod several;
mod table;
mod template;
mod visibility;

pub use calibration::{Calibration, Statement, calibration};
pub use changes::{Change, changes};
pub use conditions::{Circumstances, Conditions, NoiseFactors, add_noise};
pub use draw::{Drawn, draw};
pub(crate) use draw::{NEGLIGIBLE, OUTSIDE_SIZES};
pub use exchange::Channels;
pub use judge::{Claim, Found, judge, wrong_names};
pub use measure::{ParameterError, held_out_ratio, parameter_errors, rivals_fit};
pub use outside::{OUTSIDE, Outside, Scene};
pub use plans::{
    Restriction, STUDIES, TABLE_SEED, clean, named, outside, pairs, single, table_plans,
};
pub use robots::{TestRobot, robot, robots};
pub use run::{Candidate, FindingRecord, Outcome, Study, WithoutHoles, run, run_all};
pub use setup::Setup;
pub use table::{
    Figure, Figures, Target, coverage, describe, diagram, failures, markdown, summary,
};
pub use template::Template;
pub(crate) use template::log_uniform;
pub use visibility::{JUST_VISIBLE, VISIBLE, noncentrality};
pub(crate) use visibility::{on_each_target, single_effects, size_for};

use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;

use names::Name;

/// Default number of poses per dataset, without the home pose.
pub const POSES: usize = 41;

/// Range of the size of a hidden effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stratum {
    /// Log-uniform from the smallest typical size, or the visible one if that is larger, to the largest typical size.
    Typical,
    /// A size whose noncentrality is near the threshold of visibility.
    JustVisible,
}

/// What a plan hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Wanted {
    /// Nothing.
    Nothing,
    /// One effect of the catalogue.
    One(#[serde(with = "names")] Name, Stratum),
    /// One visible effect drawn from the catalogue.
    Any,
    /// The same, but one that no other single effect could explain.
    Separated,
    /// Two effects drawn from the catalogue.
    Two,
    /// Three to five effects drawn from the catalogue.
    Several,
    /// A random number of effects, 0.8 on average, visible or not.
    ByChance,
    /// A common offset of all cables of 50 to 200 mm.
    CommonOffset,
    /// A different scale for every winch, and a different gain and bias for every force sensor.
    Families,
    /// Two exchanged channels.
    Exchanged(Channels),
    /// An effect outside the catalogue.
    Outside(#[serde(with = "names")] Name),
}

/// Specification of one dataset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Plan {
    /// Name of the robot.
    #[serde(with = "names")]
    pub robot: Name,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What is hidden.
    pub wanted: Wanted,
    /// How the measurements deviate from the description.
    pub circumstances: Circumstances,
}

/// The hidden content of a dataset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Hidden {
    /// Nothing.
    Nothing,
    /// Effects of the catalogue.
    Effects(Vec<EffectSetting>),
    /// An effect outside the catalogue, and its size in units of its own.
    Outside(#[serde(with = "outside::by_id")] &'static Outside, f64),
    /// Exchanged channels of two cables, given by index.
    Exchanged(Channels, [usize; 2]),
}

impl Hidden {
    /// The hidden effects of the catalogue.
    #[must_use]
    pub fn effects(&self) -> &[EffectSetting] {
        match self {
            Self::Effects(settings) => settings,
            Self::Nothing | Self::Outside(..) | Self::Exchanged(..) => &[],
        }
    }
}
