//! Exchanged channels.

use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{Cause, Verdict};
use tautline_core::effect::Search;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

use super::judge::Claim;

/// The channels that are exchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Channels {
    /// Encoders or length readings.
    Lengths,
    /// Force sensors.
    Forces,
    /// Both, as if the cables themselves were mistaken for each other.
    Both,
}

impl Channels {
    /// All three kinds of exchange.
    pub const ALL: [Self; 3] = [Self::Lengths, Self::Forces, Self::Both];

    /// Short description for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lengths => "encoders",
            Self::Forces => "force sensors",
            Self::Both => "encoders and force sensors",
        }
    }

    /// Whether a robot has these channels.
    #[must_use]
    pub fn exist_on(self, robot: &Robot) -> bool {
        self == Self::Lengths || robot.has_force_sensors() && robot.platform.mass_kg.is_some()
    }

    /// Exchanges the channels of two cables. Doing so twice restores the data.
    pub fn exchange(self, cables: [usize; 2], data: &mut Measurements) {
        if self != Self::Forces {
            exchange(cables, &mut data.revolutions);
            exchange(cables, &mut data.length_m);
        }
        if self != Self::Lengths {
            exchange(cables, &mut data.force_n);
        }
    }
}

fn exchange([one, other]: [usize; 2], grid: &mut Grid) {
    for row in 0..grid.rows() {
        let (a, b) = (grid.get(row, one), grid.get(row, other));
        grid.set(row, one, b);
        grid.set(row, other, a);
    }
}

/// Whether a cause is an exchange of channels.
pub fn is_exchange(cause: &Cause) -> bool {
    cause.effect().search() == Search::Exchange
}

/// Whether the readings return to their cables when all named exchanges are undone.
pub fn is_undone(
    (channels, cables): (Channels, [usize; 2]),
    claims: &[Claim],
    robot: &Robot,
) -> bool {
    // One row of distinct numbers identifies the channels: 1, 2, 3 and so on.
    let numbered = || Grid::of_row((1..=robot.cable_count()).map(|n| n as f64).collect());
    let in_order = Measurements {
        labels: vec![1],
        revolutions: numbered(),
        length_m: numbered(),
        force_n: numbered(),
        ..Measurements::default()
    };
    let mut data = in_order.clone();
    channels.exchange(cables, &mut data);
    let named = claims
        .iter()
        .filter(|claim| claim.verdict == Verdict::Named);
    for cause in named.filter_map(|claim| claim.candidates.first()?.cause()) {
        for bound in cause.instances.iter().filter(|_| is_exchange(cause)) {
            bound.exchange_channels(&mut data);
        }
    }
    data == in_order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robot;
    use tautline_core::diagnosis::Subject;
    use tautline_core::effect::{BoundEffect, EffectSetting};

    #[test]
    fn an_exchange_is_undone_by_its_name_alone() {
        let mini = robot("mini").unwrap().preset.robot;
        let claim = |cables: [&str; 2]| {
            let setting = EffectSetting {
                effect: "cable_swap".to_owned(),
                targets: cables.map(str::to_owned).to_vec(),
                parameters: [].into(),
            };
            Claim {
                verdict: Verdict::Named,
                candidates: vec![Subject::Cause(Cause {
                    instances: vec![BoundEffect::from_setting(&setting, &mini).unwrap()],
                })],
                probabilities: vec![1.0],
                finding: 0,
            }
        };
        let undone = |channels, cables| is_undone((channels, [1, 4]), &[claim(cables)], &mini);
        assert!(undone(Channels::Lengths, ["cable-5", "cable-2"]));
        assert!(!undone(Channels::Lengths, ["cable-5", "cable-3"]));
        assert!(!undone(Channels::Both, ["cable-2", "cable-5"]));
        assert!(!is_undone((Channels::Forces, [1, 4]), &[], &mini));
    }
}
