//! Correct answers of the server.

use std::sync::mpsc::Sender;
use std::time::{Duration, Instant, SystemTime};

use super::super::host::Written;
use super::memory;
use super::{Request, State, frame, is_command, word};

const SYMBOL_VERSION: u32 = 0xF008;
pub(super) const SYMBOL_INFO: u32 = 0xF009;
pub(super) const SYMBOL_HANDLE: u32 = 0xF003;
const VALUE_BY_HANDLE: u32 = 0xF005;
pub(super) const RELEASE_HANDLE: u32 = 0xF006;
const READ_TOGETHER: u32 = 0xF083;
pub(super) const WRITE_TOGETHER: u32 = 0xF081;
pub(super) const SUBSCRIBE: u16 = 6;
pub(super) const UNSUBSCRIBE: u16 = 7;
const NOTIFICATION: u16 = 8;
/// Mode of a subscription: values are sent in every cycle.
const EVERY_CYCLE: u32 = 3;
const UNKNOWN: u32 = 0x701;
const WRONG_OFFSET: u32 = 0x703;
const NO_SYMBOL: u32 = 0x710;
const WRONG_HANDLE: u32 = 0x714;
/// Handle of the first symbol.
const FIRST_HANDLE: u32 = 0x1000;

/// The content of an answer; at most `limit` values are written.
pub(super) fn answer(
    state: &mut State,
    request: &Request,
    limit: usize,
    tell: &Sender<Written>,
) -> Vec<u8> {
    let data = &request.data;
    let done = match request.command {
        2 => (|| {
            let (group, offset, size) = (word(data, 0)?, word(data, 4)?, word(data, 8)?);
            Some(read(state, group, offset, size as usize).map(with_length))
        })(),
        3 => (|| {
            let (group, offset, size) = (word(data, 0)?, word(data, 4)?, word(data, 8)?);
            if group == RELEASE_HANDLE {
                return Some(Ok(Vec::new()));
            }
            let bytes = data.get(12..12 + size as usize)?;
            let written = match limit {
                0 => Ok(()),
                _ => write(state, group, offset, bytes, tell),
            };
            Some(written.map(|()| Vec::new()))
        })(),
        4 => Some(Ok([state.state.to_le_bytes(), [0, 0]].concat())),
        SUBSCRIBE => subscribe(state, request),
        UNSUBSCRIBE => word(data, 0).map(|handle| {
            let known = state.subscriptions.remove(&handle);
            known.map(|_| Vec::new()).ok_or(WRONG_HANDLE)
        }),
        9 => (|| {
            let (group, offset, size) = (word(data, 0)?, word(data, 4)?, word(data, 12)?);
            let sent = data.get(16..16 + size as usize)?;
            read_write(state, (group, offset), sent, limit, tell)
        })(),
        _ => None,
    };
    match done {
        Some(Ok(content)) => [&[0; 4][..], &content].concat(),
        Some(Err(code)) => code.to_le_bytes().to_vec(),
        None => UNKNOWN.to_le_bytes().to_vec(),
    }
}

/// Subscription of a client to values that are sent in every cycle.
#[derive(Debug)]
pub(super) struct Subscription {
    group: u32,
    offset: u32,
    size: usize,
    cycle: Duration,
    next: Instant,
    /// Number of the connection that it belongs to.
    pub connection: u64,
    addresses: [u8; 16],
}

fn subscribe(state: &mut State, request: &Request) -> Option<Result<Vec<u8>, u32>> {
    let data = &request.data;
    let (group, offset, size) = (word(data, 0)?, word(data, 4)?, word(data, 8)? as usize);
    let (mode, units) = (word(data, 12)?, word(data, 20)?);
    if mode != EVERY_CYCLE || data.len() != 40 {
        return None;
    }
    if let Err(code) = read(state, group, offset, size) {
        return Some(Err(code));
    }
    state.last_subscription += 1;
    let subscription = Subscription {
        group,
        offset,
        size,
        cycle: Duration::from_nanos(100 * u64::from(units)),
        next: Instant::now(),
        connection: request.connection,
        addresses: request.addresses,
    };
    let handle = state.last_subscription;
    state.subscriptions.insert(handle, subscription);
    Some(Ok(handle.to_le_bytes().to_vec()))
}

/// The notification that is due on a connection, with all that have the same cycle.
pub(super) fn notification(state: &mut State, connection: u64) -> Option<Vec<u8>> {
    let now = Instant::now();
    let mut due = Vec::new();
    let mut addresses = [0; 16];
    for (handle, subscription) in &mut state.subscriptions {
        if subscription.connection == connection && subscription.next <= now {
            // Cycles that were missed are not made up for.
            while subscription.next <= now {
                subscription.next += subscription.cycle.max(Duration::from_millis(1));
            }
            addresses = subscription.addresses;
            due.push((
                *handle,
                subscription.group,
                subscription.offset,
                subscription.size,
            ));
        }
    }
    if due.is_empty() {
        return None;
    }
    let mut samples = Vec::new();
    for (handle, group, offset, size) in &due {
        let bytes = read(state, *group, *offset, *size).ok()?;
        samples.extend(handle.to_le_bytes());
        samples.extend((bytes.len() as u32).to_le_bytes());
        samples.extend(bytes);
    }
    state.notified += due.len();
    let since = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .ok()?;
    let stamp = ((since.as_nanos() / 100) as u64).to_le_bytes();
    let count = (due.len() as u32).to_le_bytes();
    let rest = [&1_u32.to_le_bytes()[..], &stamp, &count, &samples].concat();
    let told = Request {
        command: NOTIFICATION,
        number: [0; 4],
        addresses,
        data: Vec::new(),
        connection,
    };
    let mut notification = frame(&told, 0, &with_length(rest));
    // Not an answer.
    notification[6 + 18] = 4;
    Some(notification)
}

fn with_length(bytes: Vec<u8>) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], &bytes].concat()
}

fn read_write(
    state: &mut State,
    (group, offset): (u32, u32),
    sent: &[u8],
    limit: usize,
    tell: &Sender<Written>,
) -> Option<Result<Vec<u8>, u32>> {
    let name = || {
        String::from_utf8_lossy(sent)
            .trim_end_matches('\0')
            .to_owned()
    };
    let count = offset as usize;
    Some(match group {
        SYMBOL_INFO => {
            let found = state.memory.description(&name());
            found.map(with_length).ok_or(NO_SYMBOL)
        }
        SYMBOL_HANDLE => {
            let known = state.memory.description(&name());
            known.ok_or(NO_SYMBOL).map(|_| {
                state.handles.push(name());
                let handle = FIRST_HANDLE + state.handles.len() as u32 - 1;
                with_length(handle.to_le_bytes().to_vec())
            })
        }
        READ_TOGETHER => {
            let (mut heads, mut values) = (Vec::new(), Vec::new());
            for part in 0..count {
                let at = 12 * part;
                let size = word(sent, at + 8)? as usize;
                let (code, bytes) = match read(state, word(sent, at)?, word(sent, at + 4)?, size) {
                    Ok(bytes) => (0, bytes),
                    Err(code) => (code, Vec::new()),
                };
                heads.extend_from_slice(&code.to_le_bytes());
                heads.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
                values.extend(bytes);
            }
            Ok(with_length([heads, values].concat()))
        }
        WRITE_TOGETHER => {
            let (mut at, mut codes) = (12 * count, Vec::new());
            for part in 0..count {
                let head = 12 * part;
                let size = word(sent, head + 8)? as usize;
                let bytes = sent.get(at..at + size)?;
                at += size;
                if part < limit {
                    let written =
                        write(state, word(sent, head)?, word(sent, head + 4)?, bytes, tell);
                    codes.extend_from_slice(&written.err().unwrap_or(0).to_le_bytes());
                }
            }
            Ok(with_length(codes))
        }
        _ => return None,
    })
}

fn handle(state: &mut State, handle: u32) -> Option<(u32, u32)> {
    let index = handle.checked_sub(FIRST_HANDLE)? as usize;
    let name = state.handles.get(index)?.clone();
    Some((memory::GROUP, state.memory.variable(&name).offset))
}

fn read(state: &mut State, group: u32, offset: u32, size: usize) -> Result<Vec<u8>, u32> {
    if group == SYMBOL_VERSION {
        return Ok(vec![state.memory.version]);
    }
    let (group, offset) = match group {
        VALUE_BY_HANDLE => handle(state, offset).ok_or(WRONG_OFFSET)?,
        group => (group, offset),
    };
    let bytes = state.memory.read(group, offset, size).ok_or(WRONG_OFFSET)?;
    let name = state.memory.name_at(group, offset);
    Ok(misread(state, name.as_deref(), bytes))
}

/// Bytes read from a symbol, with the wrong readings that are planned for it.
fn misread(state: &mut State, name: Option<&str>, mut bytes: Vec<u8>) -> Vec<u8> {
    const SIZE: usize = size_of::<f64>();
    state.wrong_readings.retain_mut(|wrong| {
        if Some(wrong.symbol.as_str()) != name {
            return true;
        }
        wrong.number = wrong.number.saturating_sub(1);
        let place = bytes.get_mut(SIZE * wrong.element..SIZE * (wrong.element + 1));
        if let Some(place) = place.filter(|_| wrong.number == 0) {
            place.copy_from_slice(&wrong.value.to_le_bytes());
        }
        wrong.number > 0
    });
    bytes
}

fn write(
    state: &mut State,
    group: u32,
    offset: u32,
    bytes: &[u8],
    tell: &Sender<Written>,
) -> Result<(), u32> {
    let (group, offset) = match group {
        VALUE_BY_HANDLE => handle(state, offset).ok_or(WRONG_OFFSET)?,
        group => (group, offset),
    };
    let State {
        memory,
        values,
        before_value,
        ..
    } = state;
    let is_parameter = memory
        .name_at(group, offset)
        .is_some_and(|name| !is_command(&name));
    if let Some(does) = before_value.as_mut().filter(|_| is_parameter) {
        does(*values, memory);
    }
    let written = memory.write(group, offset, bytes).ok_or(WRONG_OFFSET)?;
    *values += u64::from(is_parameter);
    let _ = tell.send((written.name.clone(), written.numbers()));
    Ok(())
}
