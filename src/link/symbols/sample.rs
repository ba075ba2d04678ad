//! Conversion of symbol values to readings and status of the controller.

use super::access::SymbolValues;
use super::layout::{Channel, ReadingSlots, StatusSlots};
use super::pose::pose_of;
use crate::controller::Sample;

/// Status of the controller when it was last read.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Status {
    pub moving: Option<bool>,
    pub fault: Option<String>,
    pub acknowledged: u32,
    /// Whether motion and writing are still permitted; true if there is no such symbol.
    pub released: bool,
    /// Number written last by the armed program; `None` if there is no such symbol.
    pub watchdog: Option<u32>,
}

fn values(raw: &SymbolValues, channel: &Channel) -> Vec<f64> {
    let slots = channel.slots.iter();
    slots
        .map(|slot| raw.number(*slot) * channel.scale + channel.offset)
        .collect()
}

fn value(raw: &SymbolValues, channel: &Option<Channel>) -> Option<f64> {
    values(raw, channel.as_ref()?).first().copied()
}

/// The readings; the time is 0 if the controller has none.
pub(super) fn sample_of(raw: &SymbolValues, slots: &ReadingSlots) -> Sample {
    let list = |channel: &Option<Channel>| channel.as_ref().map(|c| values(raw, c));
    let laser_valid = slots.laser_valid.is_none_or(|slot| raw.number(slot) == 1.0);
    Sample {
        time_s: value(raw, &slots.time).unwrap_or(0.0),
        revolutions: values(raw, &slots.revolutions),
        force_n: list(&slots.force).unwrap_or_default(),
        laser_m: value(raw, &slots.laser).filter(|metres| laser_valid && metres.is_finite()),
        temperature_c: value(raw, &slots.temperature).filter(|degrees| degrees.is_finite()),
        swivel_rad: list(&slots.swivel),
        inclination_rad: list(&slots.inclination).and_then(|angles| angles.try_into().ok()),
        started: slots.started.as_ref().map(|slot| raw.number(*slot)),
        commanded: slots.pose.as_ref().and_then(|pose| {
            let numbers: Vec<f64> = pose.slots.iter().map(|slot| raw.number(*slot)).collect();
            pose_of(&numbers, &pose.written)
        }),
    }
}

pub(super) fn status_of(raw: &SymbolValues, slots: &StatusSlots) -> Status {
    let fault = slots.fault.map(|slot| raw.number(slot));
    let fault = fault.filter(|code| *code != 0.0).map(|code| {
        let text = slots.fault_text.map(|slot| raw.text(slot));
        match text.filter(|text| !text.trim().is_empty()) {
            Some(text) => format!("{} (code {code})", text.trim()),
            None => format!("code {code}"),
        }
    });
    Status {
        moving: slots.moving.map(|slot| raw.number(slot) == 1.0),
        fault,
        // The cast wraps the value into a 32-bit counter.
        acknowledged: slots.acknowledged.map_or(0, |slot| raw.number(slot) as u32),
        released: slots.release.is_none_or(|slot| raw.number(slot) == 1.0),
        watchdog: slots.watchdog.map(|slot| raw.number(slot) as u32),
    }
}
