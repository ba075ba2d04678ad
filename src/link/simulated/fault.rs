//! Faults of a simulated robot, set on request.

use crate::controller::Sample;

/// A fault. Cables are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The laser has no return.
    LaserLost,
    /// An encoder is stuck at its reading when the fault began.
    StuckEncoder {
        /// Cable.
        cable: usize,
        /// Reading.
        revolutions: f64,
    },
    /// An encoder's reading is not a number.
    NotANumber {
        /// Cable.
        cable: usize,
    },
    /// An encoder's reading has an offset.
    Jump {
        /// Cable.
        cable: usize,
        /// Offset.
        revolutions: f64,
    },
    /// An encoder counts backwards.
    Reversed {
        /// Cable.
        cable: usize,
    },
    /// The encoders of two cables are swapped.
    Exchanged {
        /// The two cables.
        cables: [usize; 2],
    },
    /// A winch never stands still.
    Restless {
        /// Cable.
        cable: usize,
        /// Speed.
        revolutions_per_s: f64,
    },
    /// A force sensor has a fixed reading.
    Tension {
        /// Cable.
        cable: usize,
        /// Raw reading (N).
        reading_n: f64,
    },
    /// The force sensors of two cables are swapped.
    ForcesExchanged {
        /// The two cables.
        cables: [usize; 2],
    },
    /// A force sensor reads a multiple, negative if its sign is reversed.
    ForceFactor {
        /// Cable.
        cable: usize,
        /// Factor.
        factor: f64,
    },
    /// An encoder reads a multiple.
    EncoderFactor {
        /// Cable.
        cable: usize,
        /// Factor.
        factor: f64,
    },
    /// The laser is stuck.
    LaserStuck {
        /// Reading (m).
        distance_m: f64,
    },
    /// The laser reads a multiple plus an offset.
    LaserOff {
        /// Factor.
        factor: f64,
        /// Offset (m).
        by_m: f64,
    },
    /// The time of the readings does not advance.
    ClockStands {
        /// Time (s).
        time_s: f64,
    },
    /// There is no connection.
    ConnectionLost,
    /// A drive has stopped.
    Drive(String),
    /// Writing fails once after a number of values.
    WriteFails {
        /// Number of values written before.
        after: usize,
    },
    /// The connection breaks after a number of values.
    WriteDisconnects {
        /// Number of values written before.
        after: usize,
    },
    /// Another program arms after a number of values were written.
    AnotherArms {
        /// Number of values written before.
        after: usize,
    },
    /// A written value is changed.
    WriteDiffers {
        /// Name of the parameter.
        name: String,
        /// Change.
        by: f64,
        /// Number of times.
        times: usize,
    },
}

impl Fault {
    /// Applies the fault to a sample.
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
            | Self::AnotherArms { .. }
            | Self::WriteDiffers { .. } => {}
        }
    }
}

fn set(values: &mut [f64], index: usize, change: impl Fn(f64) -> f64) {
    if let Some(value) = values.get_mut(index) {
        *value = change(*value);
    }
}
