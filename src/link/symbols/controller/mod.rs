//! A symbol-based controller that implements [`Controller`].

mod checks;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_session::SymbolMapping;

use super::access::{Failure, SymbolAccess, SymbolServer, connect};
use super::layout::{CommandSlots, Layout, Slot};
use super::pose::numbers_of;
use super::sample::{Status, sample_of, status_of};
use crate::clock::Clock;
use crate::controller::{Activity, Controller, ControllerState, LinkProtection, Sample};
use crate::error::LinkError;
use crate::parameters::{ParameterInfo, check_finite};

/// Number of parameters written in one request; the release is read again before each request.
const BLOCK: usize = 16;
/// Interval between checks whether the program runs (s).
const STATE_EVERY_S: f64 = 1.0;

const HOME: f64 = 1.0;
const MOVE: f64 = 2.0;
const STOP: f64 = 3.0;

/// A command without acknowledgement so far.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pending {
    number: u32,
    since_s: f64,
}

/// A controller whose readings, commands and parameters are symbols.
pub struct SymbolController {
    server: Box<dyn SymbolServer>,
    name: String,
    layout: Layout,
    /// Index of each parameter by its name.
    known: HashMap<String, usize>,
    /// Timeout for the acknowledgement of a command (s).
    acknowledge_s: f64,
    clock: Arc<dyn Clock>,
    program: Option<Box<dyn SymbolAccess>>,
    armed: bool,
    status: Status,
    number: u32,
    /// The last commanded target; `None` after homing or a stop.
    last_commanded: Option<Pose>,
    pending: Option<Pending>,
    /// A fault detected by Tautline, shown until it is armed again.
    own_fault: Option<String>,
    /// First and last number that this program wrote to the watchdog. The first is random, so that no two programs write the
    /// same.
    counted: [u32; 2],
    state_asked_s: f64,
}

impl SymbolController {
    /// Creates a controller that is not connected. The clock detects missing acknowledgements.
    pub(crate) fn new(
        server: Box<dyn SymbolServer>,
        (mapping, robot): (&SymbolMapping, &Robot),
        acknowledge_s: f64,
        clock: Arc<dyn Clock>,
    ) -> Result<Self, LinkError> {
        let layout = Layout::of(mapping, robot)?;
        let names = layout.parameters.iter().enumerate();
        let known = names.map(|(k, p)| (p.name.clone(), k)).collect();
        Ok(Self {
            name: format!("{} at {}", robot.name, server.place()),
            server,
            layout,
            known,
            acknowledge_s,
            clock,
            program: None,
            armed: false,
            status: Status::default(),
            number: 0,
            last_commanded: None,
            pending: None,
            own_fault: None,
            counted: [RandomState::new().build_hasher().finish() as u32; 2],
            state_asked_s: f64::NEG_INFINITY,
        })
    }

    /// Performs an operation on the program; drops a lost connection, which also disarms.
    fn with<T>(
        &mut self,
        action: impl FnOnce(&mut dyn SymbolAccess, &Layout) -> Result<T, Failure>,
    ) -> Result<T, LinkError> {
        let Some(program) = &mut self.program else {
            let text = "it is not connected";
            return Err(LinkError::Disconnected(text.to_owned()));
        };
        action(program.as_mut(), &self.layout).map_err(|failure| match failure {
            Failure::Refused(error) => error,
            Failure::Lost(error) => {
                self.forget();
                error
            }
        })
    }

    fn forget(&mut self) {
        self.program = None;
        self.armed = false;
        self.pending = None;
        self.last_commanded = None;
        self.status = Status::default();
    }

    /// Reads the readings and the status.
    fn poll(&mut self) -> Result<Sample, LinkError> {
        let now_s = self.clock.now_s();
        if now_s - self.state_asked_s >= STATE_EVERY_S {
            self.state_asked_s = now_s;
            if let Some(text) = self.with(|program, _| program.problem())? {
                self.own_fault = Some(text.clone());
                return Err(LinkError::Refused(text));
            }
        }
        let (sample, status) = self.with(|program, layout| {
            let raw = program.read(&mut (0..layout.sampled))?;
            Ok((
                sample_of(&raw, &layout.readings),
                status_of(&raw, &layout.status),
            ))
        })?;
        self.take(status);
        self.check_last_commanded(sample.commanded.as_ref());
        Ok(Sample {
            time_s: if self.layout.readings.time.is_some() {
                sample.time_s
            } else {
                self.clock.now_s()
            },
            ..sample
        })
    }

    fn fault(&self) -> Option<&String> {
        self.status.fault.as_ref().or(self.own_fault.as_ref())
    }

    fn check_fault(&self) -> Result<(), LinkError> {
        let fault = self.fault().cloned().map(LinkError::Fault);
        fault.map_or(Ok(()), Err)
    }

    fn moves(&self) -> bool {
        self.pending.is_some() || self.status.moving == Some(true)
    }

    fn check_armed(&self) -> Result<(), LinkError> {
        if self.program.is_none() {
            let text = "it is not connected";
            return Err(LinkError::Disconnected(text.to_owned()));
        }
        self.check_fault()?;
        match self.armed {
            true => Ok(()),
            false => Err(LinkError::NotArmed),
        }
    }

    /// Sends a command: target and kind first, the number in a separate request.
    fn send(&mut self, kind: f64, target: Option<&Pose>) -> Result<(), LinkError> {
        let number = self.number.wrapping_add(1);
        self.with(|program, layout| {
            let command = command_of(layout)?;
            let slots = command.target.slots.iter().copied();
            let numbers = target.map(|pose| numbers_of(pose, &command.target.written));
            let mut values: Vec<(Slot, f64)> = slots.zip(numbers.into_iter().flatten()).collect();
            values.push((command.kind, kind));
            program.check_unchanged()?;
            program.write(&values)?;
            program.write(&[(command.number, f64::from(number))])
        })?;
        self.number = number;
        self.last_commanded = target.copied();
        self.pending = Some(Pending {
            number,
            since_s: self.clock.now_s(),
        });
        Ok(())
    }

    /// The number of the last command, which the controller must have acknowledged.
    fn last_number(&mut self) -> Result<u32, LinkError> {
        self.with(|program, layout| {
            let Some(command) = &layout.command else {
                return Ok(0);
            };
            let (number, taken) = (command.number, command.acknowledged);
            let raw = program.read(&mut [number.symbol, taken.symbol].into_iter())?;
            let (number, taken) = (raw.number(number), raw.number(taken));
            if number != taken {
                return Err(Failure::Refused(LinkError::Refused(format!(
                    "command {number} is pending, the last one acknowledged is {taken}: does its program handle commands?"
                ))));
            }
            Ok(number as u32)
        })
    }

    /// The elements of named parameters with their scales.
    fn places(&self, names: &[String]) -> Result<Vec<(Slot, f64)>, LinkError> {
        let place = |name: &String| {
            let parameter = self
                .known
                .get(name)
                .and_then(|k| self.layout.parameters.get(*k));
            let unknown = || LinkError::UnknownParameter(name.clone());
            parameter.map(|p| (p.slot, p.scale)).ok_or_else(unknown)
        };
        names.iter().map(place).collect()
    }

    /// Sets the release; together with a number of the watchdog, so that nobody sees one without the other.
    fn release(&mut self, on: bool) -> Result<(), LinkError> {
        let count = self.next_count().filter(|_| on);
        self.with(|program, layout| match layout.status.release {
            Some(slot) => {
                program.check_unchanged()?;
                let release = [(slot, f64::from(u8::from(on)))].into_iter();
                program.write(&release.chain(count).collect::<Vec<_>>())
            }
            None => Ok(()),
        })
    }

    /// The next number of the watchdog.
    fn next_count(&mut self) -> Option<(Slot, f64)> {
        self.counted[1] = self.counted[1].wrapping_add(1);
        let slot = self.layout.status.watchdog?;
        Some((slot, f64::from(self.counted[1])))
    }

    fn count_sample(&mut self) -> Result<(), LinkError> {
        match self.next_count() {
            Some(next) => self.with(|program, _| program.write(&[next])),
            None => Ok(()),
        }
    }
}

fn command_of(layout: &Layout) -> Result<&CommandSlots, Failure> {
    let text = "the mapping has no symbols for commands, so it can only be read";
    let missing = || Failure::Refused(LinkError::Refused(text.to_owned()));
    layout.command.as_ref().ok_or_else(missing)
}

impl Controller for SymbolController {
    fn identity(&self) -> String {
        self.name.clone()
    }

    fn protection(&self) -> Option<LinkProtection> {
        self.program.as_ref().map(|program| program.protection())
    }

    fn connect(&mut self) -> Result<(), LinkError> {
        if self.program.is_some() {
            return Ok(());
        }
        self.forget();
        self.own_fault = None;
        let program = connect(self.server.as_ref(), &self.layout.wanted)?;
        self.program = Some(program);
        self.state_asked_s = self.clock.now_s();
        self.poll().map(drop).inspect_err(|_| self.forget())
    }

    fn disconnect(&mut self) {
        self.disarm();
        if let Some(program) = &mut self.program {
            program.close();
        }
        self.forget();
    }

    fn state(&self) -> ControllerState {
        let activity = match self.fault() {
            _ if self.program.is_none() => Activity::Disconnected,
            Some(text) => Activity::Fault(text.clone()),
            None if self.moves() => Activity::Moving,
            None if self.status.moving.is_none() => Activity::Connected,
            None => Activity::Still,
        };
        ControllerState {
            activity,
            armed: self.armed,
        }
    }

    fn arm(&mut self) -> Result<(), LinkError> {
        self.state_asked_s = f64::NEG_INFINITY;
        self.own_fault = None;
        self.poll()?;
        self.check_fault()?;
        self.number = self.last_number()?;
        self.pending = None;
        self.last_commanded = None;
        self.check_free()?;
        let before = self.status.watchdog;
        self.release(true)?;
        if let Err(error) = self.confirm_release(before) {
            // A release left behind would obey whoever commands the controller next; that of another program is its own.
            if !matches!(error, LinkError::Occupied(_)) {
                let _ = self.release(false);
            }
            return Err(error);
        }
        self.armed = true;
        Ok(())
    }

    fn confirm_alone(&mut self) -> Result<(), LinkError> {
        let status = self.with(|program, layout| {
            let raw = program.read(&mut layout.status.symbols())?;
            Ok(status_of(&raw, &layout.status))
        })?;
        self.take(status);
        self.foreign_count()
            .map_or(Ok(()), |text| Err(LinkError::Occupied(text)))
    }

    fn disarm(&mut self) {
        if !self.armed {
            return;
        }
        // A failure here ends the connection or is a fault of the controller; it is disarmed on this side in any case.
        if self.layout.command.is_some() && self.moves() {
            let _ = self.send(STOP, None);
        }
        let _ = self.release(false);
        self.armed = false;
    }

    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.poll()?;
        self.check_release();
        if self.armed {
            self.count_sample()?;
        }
        Ok(sample)
    }

    fn subscribe(&mut self, every_s: f64) -> Result<(), LinkError> {
        if self.layout.readings.time.is_none() {
            let text = "no symbol contains its time, so the readings it sends cannot be ordered";
            return Err(LinkError::Refused(text.to_owned()));
        }
        self.with(|program, layout| program.subscribe(&mut (0..layout.shown), every_s))
    }

    fn sent(&mut self) -> Result<Vec<Sample>, LinkError> {
        self.with(|program, layout| {
            let sent = program.sent()?;
            let samples = sent.iter().map(|raw| sample_of(raw, &layout.readings));
            Ok(samples.collect())
        })
    }

    fn home(&mut self) -> Result<(), LinkError> {
        self.check_armed()?;
        self.send(HOME, None)
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        self.send(MOVE, Some(pose))
    }

    /// Stops the platform. If the controller is not armed, nothing is written: it moves at the command of another program.
    fn stop(&mut self) -> Result<(), LinkError> {
        if self.armed {
            return self.send(STOP, None);
        }
        if self.program.is_none() {
            let text = "it is not connected";
            return Err(LinkError::Disconnected(text.to_owned()));
        }
        if self.moves() {
            let text =
                "it is not armed here and moves at the command of another program: stop it there";
            return Err(LinkError::Refused(text.to_owned()));
        }
        Ok(())
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        let names: Vec<String> = self
            .layout
            .parameters
            .iter()
            .map(|p| p.name.clone())
            .collect();
        let values = self.read(&names)?;
        let parameters = self.layout.parameters.iter().zip(values);
        Ok(parameters
            .map(|(parameter, value)| ParameterInfo {
                name: parameter.name.clone(),
                unit: parameter.unit,
                value,
            })
            .collect())
    }

    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        let places = self.places(names)?;
        self.with(|program, _| {
            let raw = program.read(&mut places.iter().map(|(slot, _)| slot.symbol))?;
            let values = places.iter().map(|(slot, scale)| raw.number(*slot) * scale);
            Ok(values.collect())
        })
    }

    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        self.check_armed()?;
        check_finite(values)?;
        let names: Vec<String> = values.iter().map(|(name, _)| name.clone()).collect();
        let places = self.places(&names)?;
        let raw = places.iter().zip(values);
        let raw: Vec<(Slot, f64)> = raw
            .map(|((slot, scale), (_, value))| (*slot, value / scale))
            .collect();
        for block in raw.chunks(BLOCK) {
            self.check_writable()?;
            // The controller revokes the release of a program that does not count.
            let counted = block.iter().copied().chain(self.next_count());
            let counted: Vec<(Slot, f64)> = counted.collect();
            self.with(|program, _| program.write(&counted))?;
        }
        Ok(())
    }
}

impl Drop for SymbolController {
    fn drop(&mut self) {
        self.disconnect();
    }
}
