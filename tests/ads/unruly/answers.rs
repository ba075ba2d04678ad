//! What the server answers while it behaves.

use std::sync::mpsc::Sender;

use super::super::host::Written;
use super::memory;
use super::{Request, State, word};

const SYMBOL_VERSION: u32 = 0xF008;
pub(super) const SYMBOL_INFO: u32 = 0xF009;
pub(super) const SYMBOL_HANDLE: u32 = 0xF003;
const VALUE_BY_HANDLE: u32 = 0xF005;
pub(super) const RELEASE_HANDLE: u32 = 0xF006;
const READ_TOGETHER: u32 = 0xF083;
pub(super) const WRITE_TOGETHER: u32 = 0xF081;
const UNKNOWN: u32 = 0x701;
const WRONG_OFFSET: u32 = 0x703;
const NO_SYMBOL: u32 = 0x710;
/// Handles of symbols count from here.
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
    state.memory.read(group, offset, size).ok_or(WRONG_OFFSET)
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
    if let Some(does) = before_value {
        does(*values, memory);
    }
    let written = memory.write(group, offset, bytes).ok_or(WRONG_OFFSET)?;
    *values += 1;
    let _ = tell.send((written.name.clone(), written.numbers()));
    Ok(())
}
