//! A connection: requests and responses, in as few frames as possible.
//!
//! After a [`RequestError::Lost`] the client must be dropped, so that a late response is never taken for that to a later
//! request.

use super::address::AdsAddress;
use super::codes::{AdsCode, RUN, state_name};
use super::notifications::{self, NotifiedValues, Rows};
use super::options::AdsOptions;
use super::symbols::{Symbol, SymbolAddress};
use super::wire::{AmsAddress, Command, Wire, words};
use crate::error::LinkError;
use crate::timed_socket::{SocketError, addresses_of, timeout_of};

/// Largest number of parts per request; controllers allow 500.
const PARTS: usize = 256;
/// Largest response (bytes).
const BYTES: usize = 1 << 16;
/// Largest description of a symbol (bytes).
const ENTRY: usize = 8192;
/// Length of the error code at the start of every response (bytes).
const CODE: usize = 4;
/// Length of a state response (bytes): error code, state of the device, state of its hardware.
const STATE: usize = 8;

/// Index groups, which select the kind of request.
mod group {
    /// Description of a symbol by its name.
    pub const SYMBOL: u32 = 0xF009;
    /// Several reads, with an error for each.
    pub const READ_TOGETHER: u32 = 0xF083;
    /// Several writes, with an error for each.
    pub const WRITE_TOGETHER: u32 = 0xF081;
}

/// Errors of a request.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RequestError {
    /// The connection can no longer be used.
    Lost(LinkError),
    /// The controller rejected the request.
    Refused(AdsCode),
}

type Answer<T> = Result<T, RequestError>;
/// An error comes with the index of the value that was not written.
type WriteAnswer = Result<(), (RequestError, usize)>;

/// A connection to a controller.
pub(super) struct AdsClient {
    wire: Wire,
    timeout_s: f64,
    /// The present request, for the message if it is not answered.
    request: String,
    /// Whether the controller accepts sum commands, i.e. several parts in one request.
    sums: bool,
    /// Handles of the subscriptions.
    handles: Vec<u32>,
    /// Collector of notifications; `None` without subscriptions.
    rows: Option<Rows>,
}

impl AdsClient {
    /// Connects to an ADS server and requests the state of the program.
    pub fn open(address: &AdsAddress, options: &AdsOptions) -> Result<Self, LinkError> {
        let timeout = timeout_of(options.timeout_s)?;
        let target = AmsAddress {
            net_id: address.net_id,
            port: address.ams_port,
        };
        let mut last =
            LinkError::Disconnected(format!("the host {:?} has no address", address.host));
        for place in addresses_of(&address.host, address.port)? {
            let opened =
                Wire::connect(place, target, options.own_net_id, timeout).and_then(|mut wire| {
                    // An ADS error is also proof of an ADS server.
                    wire.exchange(Command::ReadState, &[], STATE).map(|_| wire)
                });
            match opened {
                Ok(wire) => {
                    return Ok(Self {
                        wire,
                        timeout_s: options.timeout_s,
                        request: String::new(),
                        sums: true,
                        handles: Vec::new(),
                        rows: None,
                    });
                }
                Err(SocketError::Invalid(_)) => {
                    last = LinkError::Disconnected(format!(
                        "the server at {place} does not speak ADS"
                    ));
                }
                Err(SocketError::Io(error)) => {
                    last = LinkError::Disconnected(format!("{place} cannot be reached ({error})"));
                }
                Err(broken) => last = lost(broken, ("for its state", options.timeout_s)),
            }
        }
        Err(last)
    }

    fn lost(&self, broken: SocketError) -> RequestError {
        RequestError::Lost(lost(broken, (&self.request, self.timeout_s)))
    }

    /// Sends a request and returns its response after the error code, at most `longest` bytes.
    fn ask(&mut self, command: Command, data: &[u8], longest: usize) -> Answer<Vec<u8>> {
        let reply = self.wire.exchange(command, data, CODE + longest);
        let reply = reply.map_err(|broken| self.lost(broken))?;
        let mut content = reply.map_err(RequestError::Refused)?;
        if content.len() < CODE {
            return Err(broken("an answer without its error code"));
        }
        let rest = content.split_off(CODE);
        match word(&content) {
            0 => Ok(rest),
            code => Err(RequestError::Refused(AdsCode(code))),
        }
    }

    /// The data of a response with a length field, at most `longest` bytes.
    fn ask_for_data(
        &mut self,
        command: Command,
        request: &[u8],
        longest: usize,
    ) -> Answer<Vec<u8>> {
        let mut content = self.ask(command, request, 4 + longest)?;
        if content.len() < 4 {
            return Err(broken("an answer without its length"));
        }
        let data = content.split_off(4);
        let length = word(&content);
        if usize::try_from(length) != Ok(data.len()) {
            let arrived = data.len();
            return Err(broken(&format!(
                "an answer announces {length} bytes and has {arrived}"
            )));
        }
        Ok(data)
    }

    fn read_write(
        &mut self,
        (group, offset): (u32, u32),
        longest: usize,
        sent: &[u8],
    ) -> Answer<Vec<u8>> {
        let (longest_word, sent_word) = (size_word(longest), size_word(sent.len()));
        let mut request = words(&[group, offset, longest_word, sent_word]);
        request.extend_from_slice(sent);
        self.ask_for_data(Command::ReadWrite, &request, longest)
    }

    /// Whether the ADS device runs, and the name of its state; a running program is in the state "Run".
    pub fn state(&mut self) -> Answer<(bool, String)> {
        "for its state".clone_into(&mut self.request);
        let state = self.ask(Command::ReadState, &[], STATE - CODE)?;
        let Ok([low, high, _, _]) = <[u8; 4]>::try_from(state) else {
            return Err(broken("a state that is incomplete"));
        };
        let number = u16::from_le_bytes([low, high]);
        Ok((number == RUN, state_name(number)))
    }

    /// Looks up a symbol.
    pub fn symbol(&mut self, name: &str) -> Answer<Symbol> {
        self.request = format!("for the symbol {name}");
        let mut asked = name.as_bytes().to_vec();
        asked.push(0);
        let entry = self.read_write((group::SYMBOL, 0), ENTRY, &asked)?;
        Symbol::parse(name, &entry)
            .ok_or_else(|| broken("the description of a symbol is incomplete"))
    }

    /// Reads symbols; returns the bytes of each, or the code of its rejection.
    pub fn read(&mut self, places: &[SymbolAddress]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let mut all = Vec::with_capacity(places.len());
        for part in batches(places, |place| place.size) {
            self.request = format!("to read {} of {} symbols", part.len(), places.len());
            let answers = match self.sums {
                true => self.read_together(part),
                false => self.read_singly(part),
            };
            all.extend(match answers {
                Err(RequestError::Refused(code)) if self.sums && code.is_unknown_request() => {
                    self.sums = false;
                    self.read_singly(part)?
                }
                answers => answers?,
            });
        }
        Ok(all)
    }

    fn read_together(&mut self, places: &[SymbolAddress]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let heads: Vec<u8> = (places.iter().flat_map(|p| p.head().concat())).collect();
        let sizes: usize = places.iter().map(|place| place.size).sum();
        let longest = 8 * places.len() + sizes;
        let request = (group::READ_TOGETHER, size_word(places.len()));
        let answer = self.read_write(request, longest, &heads)?;
        split(&answer, places)
            .ok_or_else(|| broken("the length of an answer differs from that of its parts"))
    }

    fn read_singly(&mut self, places: &[SymbolAddress]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let mut read = |place: &SymbolAddress| match self.ask_for_data(
            Command::Read,
            &place.head().concat(),
            place.size,
        ) {
            Ok(bytes) if bytes.len() == place.size => Ok(Ok(bytes)),
            Ok(_) => Err(broken("an answer is shorter than requested")),
            Err(RequestError::Refused(code)) => Ok(Err(code)),
            Err(lost) => Err(lost),
        };
        places.iter().map(&mut read).collect()
    }

    /// Subscribes to symbols, sent every `every_s` seconds; all of them or, after a rejection, none. Returns the
    /// handle of each.
    pub fn subscribe(&mut self, places: &[SymbolAddress], every_s: f64) -> Answer<Vec<u32>> {
        self.unsubscribe()?;
        self.request = format!("to send {} symbols in every cycle", places.len());
        self.wire.keep_notifications();
        self.rows = Some(Rows::new(every_s));
        for place in places {
            let request = [place.head().concat(), notifications::cycle(every_s)].concat();
            match self.ask(Command::Subscribe, &request, 4) {
                Ok(handle) if handle.len() == 4 => self.handles.push(word(&handle)),
                Ok(_) => return Err(broken("the handle of a subscription is incomplete")),
                Err(refused) => {
                    self.unsubscribe()?;
                    return Err(refused);
                }
            }
        }
        Ok(self.handles.clone())
    }

    /// Ends all subscriptions. It does not matter if the controller no longer knows one of them.
    pub fn unsubscribe(&mut self) -> Answer<()> {
        "to end a subscription".clone_into(&mut self.request);
        self.rows = None;
        for handle in std::mem::take(&mut self.handles) {
            match self.ask(Command::Unsubscribe, &handle.to_le_bytes(), 0) {
                Ok(_) | Err(RequestError::Refused(_)) => {}
                Err(lost) => return Err(lost),
            }
        }
        Ok(())
    }

    /// The received values of all subscribed symbols, by cycle, the oldest first.
    pub fn notified(&mut self) -> Answer<Vec<NotifiedValues>> {
        let frames = self.wire.take_notifications();
        "for the rest of a notification".clone_into(&mut self.request);
        let frames = frames.map_err(|broken| self.lost(broken))?;
        let Some(rows) = &mut self.rows else {
            return Ok(Vec::new());
        };
        let count = self.handles.len();
        let rows = frames.iter().flat_map(|frame| rows.take(frame, count));
        Ok(rows.collect())
    }

    /// Writes symbols in order and stops after the batch of the first rejected one, whose index is returned.
    pub fn write(&mut self, values: &[(SymbolAddress, Vec<u8>)]) -> WriteAnswer {
        let mut done = 0;
        for part in batches(values, |(place, _)| place.size) {
            self.request = format!("to write {} of {} values", part.len(), values.len());
            let written = match self.sums {
                true => self.write_together(part),
                false => self.write_singly(part),
            };
            match written {
                Err((RequestError::Refused(code), _))
                    if self.sums && code.is_unknown_request() && !self.knows_sums() =>
                {
                    self.sums = false;
                    self.write_singly(part)
                }
                written => written,
            }
            .map_err(|(error, index)| (error, done + index))?;
            done += part.len();
        }
        Ok(())
    }

    /// Whether the controller accepts sum commands, tested by reading the version of the symbols.
    fn knows_sums(&mut self) -> bool {
        self.read_together(&[SymbolAddress::VERSION]).is_ok()
    }

    fn write_together(&mut self, values: &[(SymbolAddress, Vec<u8>)]) -> WriteAnswer {
        let heads = values.iter().flat_map(|(place, _)| place.head().concat());
        let bytes = values.iter().flat_map(|(_, bytes)| bytes.iter().copied());
        let request: Vec<u8> = heads.chain(bytes).collect();
        let longest = CODE * values.len();
        let asked = (group::WRITE_TOGETHER, size_word(values.len()));
        let answer = self.read_write(asked, longest, &request);
        let answer = answer.map_err(|error| (error, 0))?;
        if answer.len() != longest {
            return Err((
                broken("the length of an answer differs from that of its parts"),
                0,
            ));
        }
        let codes = answer.chunks_exact(4).map(word);
        match codes.enumerate().find(|(_, code)| *code != 0) {
            Some((index, code)) => Err((RequestError::Refused(AdsCode(code)), index)),
            None => Ok(()),
        }
    }

    fn write_singly(&mut self, values: &[(SymbolAddress, Vec<u8>)]) -> WriteAnswer {
        for (index, (place, bytes)) in values.iter().enumerate() {
            let request = [place.head().concat(), bytes.clone()].concat();
            let asked = self.ask(Command::Write, &request, 0);
            asked.map_err(|error| (error, index))?;
        }
        Ok(())
    }
}

fn broken(what: &str) -> RequestError {
    RequestError::Lost(LinkError::Disconnected(format!(
        "its answer is invalid: {what}"
    )))
}

/// Converts a broken connection to an error for the operator.
fn lost(broken: SocketError, request: (&str, f64)) -> LinkError {
    broken.into_error(request, " (does it have an ADS route to this computer?)")
}

fn size_word(size: usize) -> u32 {
    u32::try_from(size).unwrap_or(u32::MAX)
}

fn word(bytes: &[u8]) -> u32 {
    bytes.try_into().map_or(u32::MAX, u32::from_le_bytes)
}

/// Splits a list into batches that fit into one request each.
fn batches<T>(list: &[T], size: impl Fn(&T) -> usize) -> Vec<&[T]> {
    let mut parts = Vec::new();
    let mut rest = list;
    while !rest.is_empty() {
        let mut bytes = 0;
        let fits = rest.iter().take(PARTS).take_while(|part| {
            bytes += size(part);
            bytes <= BYTES
        });
        let count = fits.count().max(1);
        let (part, left) = rest.split_at(count);
        parts.push(part);
        rest = left;
    }
    parts
}

/// The parts of a response: an error code and a length for each, then the bytes. Controllers either pad or omit the bytes
/// of a rejected part.
fn split(answer: &[u8], places: &[SymbolAddress]) -> Option<Vec<Result<Vec<u8>, AdsCode>>> {
    let (heads, mut rest) = answer.split_at_checked(8 * places.len())?;
    let heads: Vec<(u32, usize)> = heads
        .chunks_exact(8)
        .map(|head| Some((word(&head[..4]), usize::try_from(word(&head[4..])).ok()?)))
        .collect::<Option<_>>()?;
    let filled = rest.len() == places.iter().map(|place| place.size).sum::<usize>();
    let mut parts = Vec::with_capacity(places.len());
    for (place, (error, length)) in places.iter().zip(heads) {
        let taken = if filled { place.size } else { length };
        let (bytes, left) = rest.split_at_checked(taken)?;
        rest = left;
        parts.push(match error {
            0 if length == place.size => Ok(bytes.to_vec()),
            0 => return None,
            code => Err(AdsCode(code)),
        });
    }
    rest.is_empty().then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> [SymbolAddress; 3] {
        [4, 2, 1].map(|size| SymbolAddress {
            group: 1,
            offset: 2,
            size,
        })
    }

    fn answer(heads: &[(u32, u32)], bytes: &[u8]) -> Vec<u8> {
        let heads = heads
            .iter()
            .flat_map(|(a, b)| [a.to_le_bytes(), b.to_le_bytes()].concat());
        heads.chain(bytes.iter().copied()).collect()
    }

    #[test]
    fn answers_are_split_whether_refused_parts_are_filled_up_or_not() {
        let heads = [(0, 4), (0x710, 0), (0, 1)];
        let expected = Some(vec![Ok(vec![1, 2, 3, 4]), Err(AdsCode(0x710)), Ok(vec![9])]);
        let filled = answer(&heads, &[1, 2, 3, 4, 0, 0, 9]);
        assert_eq!(split(&filled, &places()), expected);
        let left_out = answer(&heads, &[1, 2, 3, 4, 9]);
        assert_eq!(split(&left_out, &places()), expected);
    }

    #[test]
    fn answers_that_do_not_add_up_are_refused() {
        let whole = answer(&[(0, 4), (0, 2), (0, 1)], &[0; 7]);
        assert!(split(&whole, &places()).is_some());
        for length in 0..whole.len() {
            assert_eq!(split(&whole[..length], &places()), None);
        }
        let lying = answer(&[(0, 4), (0, u32::MAX), (0, 1)], &[0; 7]);
        assert_eq!(split(&lying, &places()), None);
        assert_eq!(split(&[whole, vec![0]].concat(), &places()), None);
    }

    #[test]
    fn long_lists_go_out_in_parts() {
        let sizes = vec![1; 600];
        let lengths: Vec<usize> = batches(&sizes, |s| *s).iter().map(|p| p.len()).collect();
        assert_eq!(lengths, [256, 256, 88]);
        let sizes = [BYTES, 1, BYTES + 1, 3];
        let lengths: Vec<usize> = batches(&sizes, |s| *s).iter().map(|p| p.len()).collect();
        assert_eq!(lengths, [1, 1, 1, 1]);
        assert!(batches(&[0_usize; 0], |s| *s).is_empty());
    }
}
