//! One connection: requests and answers, in as few frames as possible.
//!
//! The answers are parsed here and not by the library, because that trusts the lengths in them. After a
//! [`RequestError::Lost`] the client has to be dropped: a late answer must never be taken for that of a later request.

use std::net::{SocketAddr, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

use ads::client::{Command, Device, Source};
use ads::{AmsAddr, AmsNetId, Client, Timeouts, index};

use super::address::AdsAddress;
use super::options::AdsOptions;
use super::probe::{OWN_PORT, probe};
use super::symbols::{Place, Symbol};
use crate::clock::Clock;
use crate::error::LinkError;

/// Most parts of one request; controllers allow 500.
const PARTS: usize = 256;
/// Most bytes that one answer may carry.
const BYTES: usize = 1 << 16;
/// Longest description of a symbol (bytes).
const ENTRY: usize = 8192;
/// The ADS state in which the program runs.
const RUN: u16 = 5;

/// An error code of the controller: one part was refused, the connection is still good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AdsCode(pub u32);

impl AdsCode {
    /// What it means, in words.
    pub fn explain(self) -> String {
        let known = ads::errors::ADS_ERRORS
            .iter()
            .find(|(code, _)| *code == self.0);
        let meaning = known.map_or("unknown error", |(_, text)| text);
        format!("{meaning} (ADS error {:#x})", self.0)
    }

    /// Whether the controller does not know such a request.
    fn is_unknown_request(self) -> bool {
        matches!(self.0, 0x8 | 0xB | 0x701 | 0x702)
    }
}

/// Why a request failed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RequestError {
    /// The connection cannot be used any more.
    Lost(LinkError),
    /// The controller refused.
    Refused(AdsCode),
}

type Answer<T> = Result<T, RequestError>;

/// A connection to a controller.
pub(super) struct AdsClient {
    client: Client,
    target: AmsAddr,
    timeout_s: f64,
    clock: Arc<dyn Clock>,
    /// Whether the controller takes several parts in one request.
    sums: bool,
}

impl AdsClient {
    pub fn open(
        address: &AdsAddress,
        options: &AdsOptions,
        clock: Arc<dyn Clock>,
    ) -> Result<Self, LinkError> {
        let timeout = Duration::try_from_secs_f64(options.timeout_s)
            .ok()
            .filter(|timeout| !timeout.is_zero())
            .ok_or_else(|| LinkError::Setup("the timeout is not a positive time".to_owned()))?;
        let source = match options.own_net_id {
            None => Source::Auto,
            Some(id) => Source::Addr(AmsAddr::new(AmsNetId(id), OWN_PORT)),
        };
        let target = AmsAddr::new(AmsNetId(address.net_id), address.ams_port);
        let mut last =
            LinkError::Disconnected(format!("the host {:?} has no address", address.host));
        for place in places_of(address)? {
            let opened = probe(place, target, options.own_net_id, timeout).and_then(|()| {
                Client::new(place, Timeouts::new(timeout), source)
                    .map_err(|error| LinkError::Disconnected(unreachable(place, &error)))
            });
            match opened {
                Ok(client) => {
                    return Ok(Self {
                        client,
                        target,
                        timeout_s: options.timeout_s,
                        clock,
                        sums: true,
                    });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Sends a request and says what a failure means.
    fn ask<T>(&self, request: impl FnOnce(Device<'_>) -> ads::Result<T>) -> Answer<T> {
        let asked_s = self.clock.now_s();
        request(self.client.device(self.target)).map_err(|error| match error {
            ads::Error::Ads(_, _, code) => RequestError::Refused(AdsCode(code)),
            ads::Error::Io(_, error) => {
                // The library reports a timeout also when the other side has closed the connection.
                let waited_s = self.clock.now_s() - asked_s;
                let late = error.kind() == std::io::ErrorKind::TimedOut
                    || error.kind() == std::io::ErrorKind::WouldBlock;
                RequestError::Lost(if late && waited_s >= 0.9 * self.timeout_s {
                    LinkError::Timeout(self.timeout_s)
                } else {
                    let text =
                        "it closed the connection (does it have an ADS route to this computer?)";
                    LinkError::Disconnected(text.to_owned())
                })
            }
            ads::Error::Reply(_, what, _) => broken(what),
            ads::Error::Overflow(_) => broken("a request is too long"),
        })
    }

    /// The state of the ADS device, and its name; the program runs in state "Run".
    pub fn state(&self) -> Answer<(bool, String)> {
        let mut state = [0; 4];
        self.ask(|device| {
            let client = device.client;
            client.communicate(Command::ReadState, self.target, &[], &mut [&mut state])
        })?;
        let number = u16::from_le_bytes([state[0], state[1]]);
        let name = ads::AdsState::try_from(number)
            .map_or_else(|_| format!("number {number}"), |state| format!("{state:?}"));
        Ok((number == RUN, name))
    }

    /// Looks a symbol up.
    pub fn symbol(&self, name: &str) -> Answer<Symbol> {
        let mut entry = vec![0; ENTRY];
        let mut asked = name.as_bytes().to_vec();
        asked.push(0);
        let length = self
            .ask(|device| device.write_read(index::GET_SYMINFO_BYNAME_EX, 0, &asked, &mut entry))?;
        let entry = entry.get(..length).unwrap_or_default();
        Symbol::parse(name, entry)
            .ok_or_else(|| broken("the description of a symbol is incomplete"))
    }

    /// Reads places: the bytes of each, or why it was refused.
    pub fn read(&mut self, places: &[Place]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let mut all = Vec::with_capacity(places.len());
        for part in batches(places, |place| place.size) {
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

    fn read_together(&self, places: &[Place]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let heads: Vec<u8> = (places.iter().flat_map(|p| p.head().concat())).collect();
        let sizes: usize = places.iter().map(|place| place.size).sum();
        let mut answer = vec![0; 8 * places.len() + sizes];
        let count = u32::try_from(places.len()).unwrap_or(u32::MAX);
        let length =
            self.ask(|device| device.write_read(index::SUMUP_READ_EX, count, &heads, &mut answer))?;
        let answer = answer.get(..length).unwrap_or_default();
        split(answer, places).ok_or_else(|| broken("an answer has another length than its parts"))
    }

    fn read_singly(&self, places: &[Place]) -> Answer<Vec<Result<Vec<u8>, AdsCode>>> {
        let read = |place: &Place| {
            let mut bytes = vec![0; place.size];
            let asked = self.ask(|device| device.read(place.group, place.offset, &mut bytes));
            match asked {
                Ok(length) if length == place.size => Ok(Ok(bytes)),
                Ok(_) => Err(broken("an answer is shorter than what was asked for")),
                Err(RequestError::Refused(code)) => Ok(Err(code)),
                Err(lost) => Err(lost),
            }
        };
        places.iter().map(read).collect()
    }

    /// Writes places in their order and stops after the batch of the first that is refused, whose index is returned.
    pub fn write(&mut self, values: &[(Place, Vec<u8>)]) -> Result<(), (RequestError, usize)> {
        let mut done = 0;
        for part in batches(values, |(place, _)| place.size) {
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

    /// Whether the controller takes several parts in one request, asked by reading.
    fn knows_sums(&self) -> bool {
        self.read_together(&[Place::VERSION]).is_ok()
    }

    fn write_together(&self, values: &[(Place, Vec<u8>)]) -> Result<(), (RequestError, usize)> {
        let heads = values.iter().flat_map(|(place, _)| place.head().concat());
        let bytes = values.iter().flat_map(|(_, bytes)| bytes.iter().copied());
        let request: Vec<u8> = heads.chain(bytes).collect();
        let mut answer = vec![0; 4 * values.len()];
        let count = u32::try_from(values.len()).unwrap_or(u32::MAX);
        let asked =
            self.ask(|device| device.write_read(index::SUMUP_WRITE, count, &request, &mut answer));
        let length = asked.map_err(|error| (error, 0))?;
        if length != answer.len() {
            return Err((broken("an answer has another length than its parts"), 0));
        }
        let codes = answer.chunks_exact(4).map(word);
        match codes.enumerate().find(|(_, code)| *code != 0) {
            Some((index, code)) => Err((RequestError::Refused(AdsCode(code)), index)),
            None => Ok(()),
        }
    }

    fn write_singly(&self, values: &[(Place, Vec<u8>)]) -> Result<(), (RequestError, usize)> {
        for (index, (place, bytes)) in values.iter().enumerate() {
            self.ask(|device| device.write(place.group, place.offset, bytes))
                .map_err(|error| (error, index))?;
        }
        Ok(())
    }
}

fn broken(what: &str) -> RequestError {
    RequestError::Lost(LinkError::Disconnected(format!(
        "its answer is invalid: {what}"
    )))
}

fn places_of(address: &AdsAddress) -> Result<Vec<SocketAddr>, LinkError> {
    let found = (address.host.as_str(), address.port).to_socket_addrs();
    let found = found.map_err(|error| {
        LinkError::Disconnected(format!(
            "the host {:?} cannot be found ({error})",
            address.host
        ))
    })?;
    Ok(found.collect())
}

fn unreachable(place: SocketAddr, error: &ads::Error) -> String {
    match error {
        ads::Error::Io(_, error) => format!("{place} cannot be reached ({error})"),
        error => format!("{place} cannot be reached ({error})"),
    }
}

fn word(bytes: &[u8]) -> u32 {
    bytes.try_into().map_or(u32::MAX, u32::from_le_bytes)
}

/// Parts of a list that fit into one request.
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

/// The parts of an answer: an error and a length for each, then the bytes. Controllers either pad or leave out the bytes
/// of a refused part.
fn split(answer: &[u8], places: &[Place]) -> Option<Vec<Result<Vec<u8>, AdsCode>>> {
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

    fn places() -> [Place; 3] {
        [4, 2, 1].map(|size| Place {
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

    #[test]
    fn codes_are_told_with_their_meaning() {
        assert_eq!(
            AdsCode(0x710).explain(),
            "Symbol not found (ADS error 0x710)"
        );
        assert_eq!(
            AdsCode(0x9999).explain(),
            "unknown error (ADS error 0x9999)"
        );
    }
}
