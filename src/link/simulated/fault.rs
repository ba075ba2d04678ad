//! What can go wrong with a simulated robot on request.

use crate::controller::Sample;

/// One thing that is wrong. Cables are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The laser has no return.
    LaserLost,
    /// An encoder shows what it showed when this began.
    StuckEncoder {
        /// Cable.
        cable: usize,
        /// What it shows.
        revolutions: f64,
    },
    /// An encoder's reading is not a number.
    NotANumber {
        /// Cable.
        cable: usize,
    },
    /// An encoder's reading is off by so much.
    Jump {
        /// Cable.
        cable: usize,
        /// By how much.
        revolutions: f64,
    },
    /// An encoder counts backwards.
    Reversed {
        /// Cable.
        cable: usize,
    },
    /// Two encoders are connected to each other's channel.
    Exchanged {
        /// The two cables.
        cables: [usize; 2],
    },
    /// A winch never stands still.
    Restless {
        /// Cable.
        cable: usize,
        /// How fast it turns.
        revolutions_per_s: f64,
    },
    /// A force sensor shows another tension.
    Tension {
        /// Cable.
        cable: usize,
        /// Raw reading (N).
        reading_n: f64,
    },
    /// The force sensors of two cables are connected to each other's channel.
    ForcesExchanged {
        /// The two cables.
        cables: [usize; 2],
    },
    /// A force sensor shows a multiple, a negative one where its sign is reversed.
    ForceFactor {
        /// Cable.
        cable: usize,
        /// Factor.
        factor: f64,
    },
    /// An encoder counts a multiple.
    EncoderFactor {
        /// Cable.
        cable: usize,
        /// Factor.
        factor: f64,
    },
    /// The laser shows this and nothing else.
    LaserStuck {
        /// What it shows (m).
        distance_m: f64,
    },
    /// The laser shows a multiple and something more.
    LaserOff {
        /// Factor.
        factor: f64,
        /// What is added (m).
        by_m: f64,
    },
    /// The time of the readings stands still.
    ClockStands {
        /// What it shows (s).
        time_s: f64,
    },
    /// There is no connection.
    ConnectionLost,
    /// A drive has stopped.
    Drive(String),
    /// After so many values the next cannot be written, once.
    WriteFails {
        /// Values that are written before.
        after: usize,
    },
    /// After so many values the connection breaks.
    WriteDisconnects {
        /// Values that are written before.
        after: usize,
    },
    /// A value arrives changed.
    WriteDiffers {
        /// Which.
        name: String,
        /// By how much.
        by: f64,
        /// How often.
        times: usize,
    },
}

impl Fault {
    /// Changes what is read.
    pub(super) fn change(&self, sample: &mut Sample) {
        let revolutions = &mut sample.revolutions;
        match self {
            Self::LaserLost => sample.laser_m = None,
            Self::StuckEncoder {
                cable,
                revolutions: value,
            } => set(revolutions, *cable, |_| *value),
            Self::NotANumber { cable } => set(revolutions, *cable, |_| f64::NAN),
            Self::Jump {
                cable,
                revolutions: by,
            } => set(revolutions, *cable, |value| value + by),
            Self::Reversed { cable } => set(revolutions, *cable, |value| -value),
            Self::Exchanged { cables: [a, b] } => {
                if *a < revolutions.len() && *b < revolutions.len() {
                    revolutions.swap(*a, *b);
                }
            }
            Self::Restless {
                cable,
                revolutions_per_s,
            } => {
                let turned = revolutions_per_s * sample.time_s;
                set(revolutions, *cable, |value| value + turned);
            }
            Self::Tension { cable, reading_n } => {
                set(&mut sample.force_n, *cable, |_| *reading_n);
            }
            Self::ForcesExchanged { cables: [a, b] } => {
                if *a < sample.force_n.len() && *b < sample.force_n.len() {
                    sample.force_n.swap(*a, *b);
                }
            }
            Self::ForceFactor { cable, factor } => {
                set(&mut sample.force_n, *cable, |value| value * factor);
            }
            Self::EncoderFactor { cable, factor } => {
                set(revolutions, *cable, |value| value * factor);
            }
            Self::LaserStuck { distance_m } => sample.laser_m = Some(*distance_m),
            Self::LaserOff { factor, by_m } => {
                sample.laser_m = sample.laser_m.map(|value| value * factor + by_m);
            }
            Self::ClockStands { time_s } => sample.time_s = *time_s,
            Self::ConnectionLost
            | Self::Drive(_)
            | Self::WriteFails { .. }
            | Self::WriteDisconnects { .. }
            | Self::WriteDiffers { .. } => {}
        }
    }
}

fn set(values: &mut [f64], index: usize, change: impl Fn(f64) -> f64) {
    if let Some(value) = values.get_mut(index) {
        *value = change(*value);
    }
}
