//! Physical effects that extend the nominal model.
//!
//! Each effect is one file with one static [`Effect`]: its contribution to the prediction (through `CablePorts` and
//! `PlatformPorts`), its parameters with unit, prior and typical size, and the sentences that a technician reads when
//! it is found (`FoundEffect`). The same code hides an effect in simulated data and adds it to a model. Users state further
//! effects as text: a [`Hypothesis`].

mod binding;
mod bound;
mod cable_creep;
mod cable_sag;
mod cable_slip;
mod cable_stiffening;
mod cable_stiffness;
mod cable_swap;
mod cable_thermal;
mod catalogue;
mod channels;
mod context;
mod direction;
mod drum_eccentricity;
mod drum_growth;
mod dual;
mod encoder_drift;
mod encoder_latency;
mod encoder_outlier;
mod force_bias;
mod force_gain;
mod force_latency;
mod found;
mod frame_compliance;
mod frame_shift;
mod frame_thermal;
mod heading_offset;
mod hypothesis;
mod inclinometer_tilt;
mod laser_beam_tilt;
mod laser_bias;
mod laser_cyclic;
mod laser_drift;
mod laser_latency;
mod laser_outliers;
mod laser_scale;
mod motion;
mod part_deviation;
mod payload_com;
mod payload_mass;
mod platform_anchor;
mod ports;
mod pulley_axis_tilt;
mod pulley_drag;
mod pulley_friction;
mod pulley_radius;
mod setting;
mod slack_cable;
mod swivel_offset;
mod tape_outlier;
mod tape_scale;
mod target_tilt;
mod text_physics;
mod tolerance;
mod tracker_axes;
mod tracker_clock;
mod tracker_frame;
mod tracker_latency;
mod tracker_moved;
mod tracker_outlier;
mod tracker_scale;
mod tracker_target;
mod tracker_tilt;
mod typical_size;
mod winch_backlash;
mod winch_offset;
mod winch_scale;
mod winch_scale_common;
pub(crate) mod words;

pub use binding::EffectRequest;
pub use bound::{BoundEffect, EffectError};
pub use catalogue::{CATALOGUE, IN_MOTION, OF_DISTANCES, OF_EXTERNAL_POSES, every_effect, find};
pub use channels::measurements_as_modelled;
pub(crate) use context::{
    BetterKnown, CableContext, PlatformContext, PoseContexts, RowContexts, sign, travel,
};
pub(crate) use dual::Dual;
pub(crate) use found::FoundEffect;
#[cfg(test)]
pub(crate) use hypothesis::CROSSTALK;
pub use hypothesis::{
    FORMULA_QUANTITIES, FORMULA_TARGETS, FormulaQuantity, FormulaTarget, Hypothesis,
    HypothesisError, HypothesisNotAdded, MAX_HYPOTHESES, MAX_HYPOTHESIS_BYTES, NotAsText,
    formula_functions, line_and_column,
};
pub(crate) use motion::inertia;
pub use part_deviation::{PartDeviation, part_deviations};
pub(crate) use ports::{CablePort, CablePorts, DistancePorts, PlatformPort, PlatformPorts};
pub use setting::EffectSetting;
pub(crate) use slack_cable::is_slack;
pub(crate) use text_physics::TextPhysics;
pub use tolerance::{MachineClass, TypicalTolerance};
pub(crate) use typical_size::amplitude_of;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measurement::{Measurements, Variable};
use crate::robot::Robot;

/// Possible targets of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// One cable; without a target, each cable gets an instance of its own.
    Cable,
    /// One cable, or all cables with common parameters; without a target, all.
    CableOrAll,
    /// Two cables, both of which must be named.
    Pair,
    /// The whole robot: all cables, the platform, the frame or an instrument. Takes no target.
    Robot,
}

/// Order in which effects act where several do: by stage, regardless of their order in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Acts on the raw reading.
    Sensor,
    /// Multiplies by a factor.
    Ratio,
    /// Adds a term, or acts on a quantity that no other effect touches.
    Addition,
}

/// Size of the frame (m) up to which the stated lengths are usual.
const FRAME_OF_USUAL_LENGTHS: f64 = 10.0;

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name in files.
    pub name: &'static str,
    /// SI unit; "1" for a ratio.
    pub unit: &'static str,
    /// Standard deviation of the prior, which is centred at `neutral`, in a frame of usual size.
    pub prior_sd: f64,
    /// Range of sizes typical in practice, in a frame of usual size.
    pub typical: [f64; 2],
    /// Value without effect; arbitrary where another parameter decides whether there is one.
    pub neutral: f64,
    /// Value at which the estimation starts: not the neutral one where the derivatives vanish there.
    pub start: f64,
    /// Smallest and largest possible value.
    pub bounds: [f64; 2],
    /// Whether the parameter is given and never estimated, as the label of a pose.
    pub discrete: bool,
    /// Whether a discrete parameter may be omitted and is then neutral.
    pub optional: bool,
    /// Deviation of sound parts; `None` for a parameter that is neutral in every sound part.
    pub tolerance: Option<TypicalTolerance>,
}

impl EffectParameter {
    /// A parameter that can be estimated; its neutral and start value is 0.
    #[must_use]
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        prior_sd: f64,
        typical: [f64; 2],
    ) -> Self {
        Self {
            name,
            unit,
            prior_sd,
            typical,
            neutral: 0.0,
            start: 0.0,
            bounds: [f64::NEG_INFINITY, f64::INFINITY],
            discrete: false,
            optional: false,
            tolerance: None,
        }
    }

    /// A parameter that must be given and is not estimated.
    #[must_use]
    pub const fn given(name: &'static str, unit: &'static str, typical: [f64; 2]) -> Self {
        Self {
            discrete: true,
            ..Self::new(name, unit, 1.0, typical)
        }
    }

    /// A parameter that is not estimated and has a default if it is not given.
    #[must_use]
    pub const fn choice(name: &'static str, typical: [f64; 2], default: f64) -> Self {
        Self {
            optional: true,
            ..Self::given(name, "1", typical).around(default)
        }
    }

    /// Smallest and largest typical magnitude.
    #[must_use]
    pub fn typical_sizes(&self) -> [f64; 2] {
        let [a, b] = self.typical.map(f64::abs);
        [a.min(b), a.max(b)]
    }

    /// Standard deviation of the prior on a robot, see [`Self::prior_sd`].
    pub(crate) fn prior_sd_in(&self, robot: &Robot) -> f64 {
        self.growth_in(robot) * self.prior_sd
    }

    /// Largest typical magnitude on a robot.
    pub(crate) fn largest_in(&self, robot: &Robot) -> f64 {
        let [_, largest] = self.typical_sizes();
        self.growth_in(robot) * largest
    }

    /// Factor of what is usual on a robot: lengths grow in proportion to a large frame.
    fn growth_in(&self, robot: &Robot) -> f64 {
        match self.unit {
            "m" => (robot.frame_size_m().unwrap_or(0.0) / FRAME_OF_USUAL_LENGTHS).max(1.0),
            _ => 1.0,
        }
    }

    /// Sets another neutral value, which becomes the start value as well.
    #[must_use]
    pub const fn around(self, neutral: f64) -> Self {
        Self {
            neutral,
            start: neutral,
            ..self
        }
    }

    /// Restricts the values to the range from `low` to `high`.
    #[must_use]
    pub const fn within(self, low: f64, high: f64) -> Self {
        Self {
            bounds: [low, high],
            ..self
        }
    }

    /// States the deviation of sound parts, as standard deviations for small and for large machines.
    #[must_use]
    pub const fn with_tolerance(self, [small, large]: [f64; 2], source: &'static str) -> Self {
        Self {
            tolerance: Some(TypicalTolerance {
                small,
                large,
                source,
                is_one_sided: self.bounds[0] == self.neutral,
            }),
            ..self
        }
    }

    /// Lets the parameter of a broken part have a sign that the tolerance of a sound one excludes.
    #[must_use]
    pub const fn of_either_sign_if_broken(mut self) -> Self {
        self.bounds = [f64::NEG_INFINITY, f64::INFINITY];
        self
    }

    /// Sets another start value.
    #[must_use]
    pub const fn starting_at(self, start: f64) -> Self {
        Self { start, ..self }
    }
}

/// The physics of an effect of the catalogue as text.
#[derive(Debug, Clone, Copy)]
pub(crate) enum AsText {
    /// Formulas of the quantities that it changes.
    Formulas(&'static [(&'static str, &'static str)]),
    /// Reason why formulas cannot express the effect.
    Impossible(&'static str),
}

/// Method by which a diagnosis searches for an effect. Numbers are indices of its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// By its derivative at the start values.
    Direct,
    /// As a wave of any phase, and over a range of periods if the period is a parameter.
    Wave {
        /// The phase.
        phase: usize,
        /// The period.
        period: Option<usize>,
    },
    /// From each pose onwards: the parameter is the label of the first pose.
    FromPose(usize),
    /// At each single pose: the parameter is its label.
    AtPose(usize),
    /// At each single distance between poses: the parameter is its row.
    AtDistance(usize),
    /// By exchanging the channels of every pair of cables.
    Exchange,
}

/// Delays of the readings, by device (s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Delays {
    /// Revolutions and lengths.
    pub length: f64,
    /// Forces.
    pub force: f64,
    /// Laser distance.
    pub laser: f64,
    /// External pose.
    pub tracker: f64,
}

/// Texts for an effect that all cables have at once, each with its own values, if the cause is then another than for one cable.
#[derive(Debug, Clone, Copy)]
pub struct OnEachCable {
    /// Plain title.
    pub title: &'static str,
    /// Sentence on the fault; fields as in `FoundEffect::say`.
    pub cause: &'static str,
    /// Advice for the workshop.
    pub workshop: &'static str,
}

/// A physical effect, of the catalogue or of the user: its identity and parameters, its contribution to the prediction, and its texts for a
/// technician.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    /// Stable identifier in files and commands.
    pub(crate) id: &'static str,
    /// Plain title.
    pub(crate) title: &'static str,
    /// Possible targets.
    pub(crate) scope: Scope,
    /// Parameters, in the order in which `change_cable` and `change_platform` get them.
    pub(crate) parameters: &'static [EffectParameter],
    /// Sentence on the fault with its estimated size, for a technician.
    pub(crate) cause: fn(&FoundEffect<'_>) -> String,
    /// Advice for the workshop, in one or two sentences.
    pub(crate) workshop: fn(&FoundEffect<'_>) -> String,
    /// Other texts for the case that all cables have the effect at once.
    pub(crate) on_each_cable: Option<OnEachCable>,
    /// An independent check in the workshop that confirms the effect or rules it out, in one sentence, if there is one.
    pub(crate) check: Option<&'static str>,
    /// Source of the model.
    pub(crate) source: &'static str,
    /// Stage at which the effect acts.
    pub(crate) stage: Stage,
    /// Method by which a diagnosis searches for the effect.
    pub(crate) search: Search,
    /// The variable over which readings show the effect best, if there is one.
    pub(crate) variable: Option<Variable>,
    /// Whether the effect is damage: something is loose, broke or moved. Damage is repaired before the robot is used, and does
    /// not happen again in the same way. Other effects are permanent, so that they become part of the model.
    pub(crate) is_damage: bool,
    /// Whether sag must be modelled even if the description says that cables weigh nothing.
    pub(crate) needs_sag: bool,
    /// Changes the ports of a cable that the effect is attached to.
    pub(crate) change_cable: fn(&[Dual], &CableContext, &mut CablePorts),
    /// Changes the ports of the platform; called for those of [`Scope::Robot`].
    pub(crate) change_platform: fn(&[Dual], &PlatformContext, &mut PlatformPorts),
    /// Changes the ports of the distance between poses in a row, counted from 1.
    pub(crate) change_distance: fn(&[Dual], usize, &mut DistancePorts),
    /// Adds the delays of readings at a time (s) since the start of a recording; for simulations only, as the prediction
    /// applies them in `change_cable` and `change_platform`.
    pub(crate) delays: fn(&[f64], f64, &mut Delays),
    /// Exchanges channels of measured data between cables; applying it twice changes nothing.
    pub(crate) exchange_channels: fn(&[usize], &[f64], &mut Measurements),
    /// The same physics as text, or why formulas cannot express it.
    pub(crate) as_text: AsText,
    /// The text of a user that takes the place of `change_cable` and `change_platform`.
    pub(crate) text_physics: Option<&'static dyn TextPhysics>,
}

impl Effect {
    /// An effect that changes nothing: the defaults of most fields.
    pub(crate) const NEUTRAL: Self = Self {
        id: "",
        title: "",
        scope: Scope::Robot,
        parameters: &[],
        cause: |_| String::new(),
        workshop: |_| String::new(),
        on_each_cable: None,
        check: None,
        source: "",
        stage: Stage::Addition,
        search: Search::Direct,
        variable: None,
        is_damage: false,
        needs_sag: false,
        change_cable: |_, _, _| {},
        change_platform: |_, _, _| {},
        change_distance: |_, _, _| {},
        delays: |_, _, _| {},
        exchange_channels: |_, _, _| {},
        as_text: AsText::Impossible(""),
        text_physics: None,
    };

    /// Stable identifier in files and commands.
    #[must_use]
    pub fn id(&self) -> &'static str {
        self.id
    }

    /// Plain title.
    #[must_use]
    pub fn title(&self) -> &'static str {
        self.title
    }

    /// Other texts where all cables have it at once, if there are any.
    #[must_use]
    pub fn on_each_cable(&self) -> Option<OnEachCable> {
        self.on_each_cable
    }

    /// Possible targets.
    #[must_use]
    pub fn scope(&self) -> Scope {
        self.scope
    }

    /// Its parameters.
    #[must_use]
    pub fn parameters(&self) -> &'static [EffectParameter] {
        self.parameters
    }

    /// An independent check in the workshop that confirms or rules it out, if there is one.
    #[must_use]
    pub fn check(&self) -> Option<&'static str> {
        self.check
    }

    /// Source of the model.
    #[must_use]
    pub fn source(&self) -> &'static str {
        self.source
    }

    /// Method by which a diagnosis searches for the effect.
    #[must_use]
    pub fn search(&self) -> Search {
        self.search
    }

    /// The variable over which readings show the effect best, if there is one.
    #[must_use]
    pub fn variable(&self) -> Option<Variable> {
        self.variable
    }

    /// Whether the effect is damage, to be repaired rather than modelled: something is loose, broke or moved.
    #[must_use]
    pub fn is_damage(&self) -> bool {
        self.is_damage
    }

    /// Whether the effect is a single wrong reading.
    #[must_use]
    pub fn is_wrong_reading(&self) -> bool {
        matches!(self.search, Search::AtPose(_) | Search::AtDistance(_))
    }

    /// Index of the parameter that is the label of a pose.
    #[must_use]
    pub fn pose_parameter(&self) -> Option<usize> {
        match self.search {
            Search::FromPose(index) | Search::AtPose(index) => Some(index),
            Search::Direct | Search::Wave { .. } | Search::AtDistance(_) | Search::Exchange => None,
        }
    }

    /// Whether only recordings in motion reveal the effect.
    #[must_use]
    pub fn is_in_motion(&self) -> bool {
        match self.text_physics {
            Some(physics) => physics.needs_motion(),
            None => IN_MOTION.iter().any(|effect| effect.id == self.id),
        }
    }

    /// Whether the effect is a hypothesis of the user.
    #[must_use]
    pub fn is_hypothesis(&self) -> bool {
        self.text_physics.is_some()
    }

    /// Whether any parameter of the effect can be estimated.
    #[must_use]
    pub fn is_estimable(&self) -> bool {
        self.parameters.iter().any(|p| !p.discrete)
    }

    /// Whether the parameter with this index measures the size of the effect: it is neither given nor the phase of a wave.
    #[must_use]
    pub fn is_size(&self, parameter: usize) -> bool {
        let is_phase = matches!(self.search, Search::Wave { phase, .. } if phase == parameter);
        !self.parameters[parameter].discrete && !is_phase
    }

    /// Whether every part deviates from its description by a little of this effect, so that a tolerance can be stated: the
    /// effect is permanent, and readings depend on its size at first order.
    #[must_use]
    pub fn has_tolerance(&self) -> bool {
        let is_smooth = |p: &EffectParameter| p.discrete || p.start == p.neutral;
        let lasts = match self.search {
            Search::Direct | Search::Wave { period: None, .. } => true,
            Search::Wave { .. }
            | Search::FromPose(_)
            | Search::AtPose(_)
            | Search::AtDistance(_)
            | Search::Exchange => false,
        };
        lasts && self.is_estimable() && self.parameters.iter().all(is_smooth)
    }

    /// Neutral values of its parameters.
    #[must_use]
    pub fn neutral_values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.neutral).collect()
    }
}

#[cfg(test)]
pub(crate) mod tests;
