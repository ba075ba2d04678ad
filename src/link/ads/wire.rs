//! Frames of AMS over TCP: one request at a time, with its response before a deadline.
//!
//! Received data are not trusted: a length is compared with its limit before memory is allocated and with the size of the
//! data before they are read, and the deadline applies to the whole exchange. After any violation the connection must be
//! dropped, so that a late response is never taken for that to a later request. No thread is
//! needed: unsolicited frames are read while waiting for the response, and dropped unless they belong to a subscription.

use std::collections::VecDeque;
use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use super::codes::AdsCode;
use crate::timed_socket::{SocketError, TimedSocket};

/// The AMS port of this computer.
const OWN_PORT: u16 = 58913;
/// Length of the TCP header (bytes): two for the kind of frame, then the length of the rest.
const OUTER: usize = 6;
/// Length of the AMS header (bytes).
const HEADER: usize = 32;
/// Upper limit of unsolicited frames of a router (bytes).
const LONGEST_UNASKED: usize = 1 << 12;
/// Largest notification (bytes).
const LONGEST_NOTIFICATION: usize = 1 << 16;
/// Largest number of queued notifications; the oldest in excess are dropped.
const MOST_NOTIFICATIONS: usize = 1024;
/// The Net ID of the local computer.
const LOCAL: [u8; 6] = [127, 0, 0, 1, 1, 1];
/// Flag of a response.
const ANSWER: u16 = 1;
/// Flag of an ADS command.
const COMMAND: u16 = 4;

/// ADS commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Command {
    Read = 2,
    Write = 3,
    ReadState = 4,
    Subscribe = 6,
    Unsubscribe = 7,
    /// Sent by a device without a request.
    Notification = 8,
    ReadWrite = 9,
}

/// AMS address: Net ID and port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AmsAddress {
    pub net_id: [u8; 6],
    pub port: u16,
}

impl AmsAddress {
    fn bytes(self) -> [u8; 8] {
        let [a, b, c, d, e, f] = self.net_id;
        let [low, high] = self.port.to_le_bytes();
        [a, b, c, d, e, f, low, high]
    }
}

/// An AMS connection.
pub(super) struct Wire {
    socket: TimedSocket,
    target: AmsAddress,
    source: AmsAddress,
    timeout: Duration,
    /// Number of the last request.
    number: u32,
    /// Queued notifications; `None` without subscriptions.
    notifications: Option<VecDeque<Vec<u8>>>,
}

/// A response without its headers, or the error that the router returned instead.
pub(super) type Reply = Result<Vec<u8>, AdsCode>;

impl Wire {
    /// Connects; `own` is the Net ID of this computer, derived from its IP address if absent.
    pub fn connect(
        place: SocketAddr,
        target: AmsAddress,
        own: Option<[u8; 6]>,
        timeout: Duration,
    ) -> Result<Self, SocketError> {
        let socket = TimedSocket::connect(place, timeout)?;
        let net_id = own.unwrap_or(match socket.own_address()? {
            IpAddr::V4(ip) => {
                let [a, b, c, d] = ip.octets();
                [a, b, c, d, 1, 1]
            }
            IpAddr::V6(_) => LOCAL,
        });
        let target = AmsAddress {
            net_id: if target.net_id == LOCAL {
                net_id
            } else {
                target.net_id
            },
            ..target
        };
        Ok(Self {
            socket,
            target,
            source: AmsAddress {
                net_id,
                port: OWN_PORT,
            },
            timeout,
            number: 0,
            notifications: None,
        })
    }

    /// Queues notifications from now on.
    pub fn keep_notifications(&mut self) {
        self.notifications.get_or_insert_default();
    }

    /// Takes the queued notifications, the oldest first, without waiting for more.
    pub fn take_notifications(&mut self) -> Result<VecDeque<Vec<u8>>, SocketError> {
        while self.notifications.is_some() && self.socket.has_received()? {
            // Only the rest of a frame whose first byte has arrived is waited for.
            let until = Instant::now() + self.timeout;
            let (kind, frame) = self.receive(LONGEST_UNASKED, until)?;
            if is_ads(kind)? && !self.keep(&Frame::parse(&frame)?) {
                return Err(SocketError::Invalid("an answer to no request".to_owned()));
            }
        }
        Ok(self
            .notifications
            .as_mut()
            .map(std::mem::take)
            .unwrap_or_default())
    }

    /// Queues a notification if there are subscriptions; returns whether the frame is one.
    fn keep(&mut self, frame: &Frame) -> bool {
        let is_notification =
            frame.command == Command::Notification as u16 && frame.flags & ANSWER == 0;
        if is_notification && let Some(kept) = &mut self.notifications {
            if kept.len() == MOST_NOTIFICATIONS {
                kept.pop_front();
            }
            kept.push_back(frame.data.to_vec());
        }
        is_notification
    }

    /// Sends a request and returns its response of at most `longest` bytes.
    pub fn exchange(
        &mut self,
        command: Command,
        data: &[u8],
        longest: usize,
    ) -> Result<Reply, SocketError> {
        let until = Instant::now() + self.timeout;
        self.number = self.number.wrapping_add(1);
        let frame = self.request(command, data)?;
        self.socket.send(&frame, until)?;
        let limit = (HEADER + longest).max(LONGEST_UNASKED);
        loop {
            let (kind, frame) = self.receive(limit, until)?;
            if !is_ads(kind)? {
                continue;
            }
            let frame = Frame::parse(&frame)?;
            if self.keep(&frame) {
                continue;
            }
            let is_answer = frame.command == command as u16 && frame.flags & ANSWER != 0;
            if !is_answer || frame.number != self.number {
                let text = "a frame that does not belong to the request";
                return Err(SocketError::Invalid(text.to_owned()));
            }
            return Ok(match frame.code {
                0 => Ok(frame.data.to_vec()),
                code => Err(AdsCode(code)),
            });
        }
    }

    fn request(&self, command: Command, data: &[u8]) -> Result<Vec<u8>, SocketError> {
        let sizes = u32::try_from(data.len()).ok();
        let sizes = sizes.and_then(|size| Some((size, size.checked_add(HEADER as u32)?)));
        let (size, whole) =
            sizes.ok_or_else(|| SocketError::Invalid("the request is too long".to_owned()))?;
        let mut frame = Vec::with_capacity(OUTER + HEADER + data.len());
        frame.extend_from_slice(&[0, 0]);
        frame.extend_from_slice(&whole.to_le_bytes());
        frame.extend_from_slice(&self.target.bytes());
        frame.extend_from_slice(&self.source.bytes());
        frame.extend_from_slice(&(command as u16).to_le_bytes());
        frame.extend_from_slice(&COMMAND.to_le_bytes());
        for word in [size, 0, self.number] {
            frame.extend_from_slice(&word.to_le_bytes());
        }
        frame.extend_from_slice(data);
        Ok(frame)
    }

    /// The next frame: its kind, and the data after the length.
    fn receive(&mut self, limit: usize, until: Instant) -> Result<(u16, Vec<u8>), SocketError> {
        let mut outer = [0; OUTER];
        self.socket.fill(&mut outer, until)?;
        let [low, high, length @ ..] = outer;
        let length = u32::from_le_bytes(length);
        let limit = match self.notifications {
            Some(_) => limit.max(HEADER + LONGEST_NOTIFICATION),
            None => limit,
        };
        let size = usize::try_from(length).ok().filter(|size| *size <= limit);
        let size = size.ok_or_else(|| {
            SocketError::Invalid(format!(
                "a frame of {length} bytes, expected at most {limit}"
            ))
        })?;
        let mut frame = vec![0; size];
        self.socket.fill(&mut frame, until)?;
        Ok((u16::from_le_bytes([low, high]), frame))
    }
}

/// Whether a frame contains ADS data; other frames of a router may arrive at any time.
fn is_ads(kind: u16) -> Result<bool, SocketError> {
    match kind {
        0 => Ok(true),
        1 | 0x1000..=0x1002 => Ok(false),
        _ => Err(SocketError::Invalid(format!(
            "a frame of the unknown kind {kind:#x}"
        ))),
    }
}

/// An AMS frame.
struct Frame<'a> {
    command: u16,
    flags: u16,
    /// Error of the router in place of a response; 0: none.
    code: u32,
    /// Number of the request that it responds to.
    number: u32,
    data: &'a [u8],
}

impl<'a> Frame<'a> {
    fn parse(frame: &'a [u8]) -> Result<Self, SocketError> {
        let short = || {
            SocketError::Invalid(format!(
                "a frame of {} bytes, shorter than its header",
                frame.len()
            ))
        };
        let (header, data) = frame.split_at_checked(HEADER).ok_or_else(short)?;
        let half = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        let word = |at: usize| {
            u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
        };
        let length = word(20);
        if usize::try_from(length) != Ok(data.len()) {
            return Err(SocketError::Invalid(format!(
                "a frame announces {length} bytes of data and has {}",
                data.len()
            )));
        }
        Ok(Self {
            command: half(16),
            flags: half(18),
            code: word(24),
            number: word(28),
            data,
        })
    }
}

/// Words of a request in transmission format.
pub(super) fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpListener;

    const TARGET: AmsAddress = AmsAddress {
        net_id: [1, 2, 3, 4, 5, 6],
        port: 851,
    };

    /// Result of a state request to a server that accepts it, answers with `says` and then falls silent.
    fn asked(says: Vec<u8>, closes: bool, timeout_ms: u64) -> Result<Reply, SocketError> {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let place = listener.local_addr().unwrap();
        let server = std::thread::spawn(move || {
            let (mut socket, _) = listener.accept().unwrap();
            let mut request = [0; OUTER + HEADER];
            socket.read_exact(&mut request).unwrap();
            socket.write_all(&says).unwrap();
            if !closes {
                // Until the other side has gone.
                let mut rest = Vec::new();
                let _ = socket.read_to_end(&mut rest);
            }
        });
        let wire = Wire::connect(place, TARGET, None, Duration::from_millis(timeout_ms));
        let told = wire.unwrap().exchange(Command::ReadState, &[], 8);
        server.join().unwrap();
        told
    }

    /// A frame from the outside: kind, command, flags, number, announced data and data.
    fn frame(
        kind: u16,
        (command, flags, number): (u16, u16, u32),
        length: usize,
        data: &[u8],
    ) -> Vec<u8> {
        let mut frame = kind.to_le_bytes().to_vec();
        frame.extend_from_slice(&(32 + data.len() as u32).to_le_bytes());
        frame.extend_from_slice(&[9; 16]);
        frame.extend_from_slice(&command.to_le_bytes());
        frame.extend_from_slice(&flags.to_le_bytes());
        frame.extend_from_slice(&(length as u32).to_le_bytes());
        frame.extend_from_slice(&[0; 4]);
        frame.extend_from_slice(&number.to_le_bytes());
        frame.extend_from_slice(data);
        frame
    }

    fn state(number: u32) -> Vec<u8> {
        frame(0, (4, 5, number), 8, &[0, 0, 0, 0, 5, 0, 0, 0])
    }

    fn refused(says: Vec<u8>) -> String {
        match asked(says, false, 20_000) {
            Err(SocketError::Invalid(what)) => what,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_answer_is_found_among_what_nobody_asked_for() {
        let mut says = frame(0x1001, (0, 0, 0), 0, &[]);
        says.extend(frame(0, (8, 4, 0), 0, &[]));
        says.extend(state(1));
        assert_eq!(
            asked(says, false, 20_000).unwrap(),
            Ok(vec![0, 0, 0, 0, 5, 0, 0, 0])
        );
    }

    #[test]
    fn lengths_that_cannot_be_are_refused_before_anything_is_allocated() {
        for length in [0, 23, 31] {
            let mut says = vec![0, 0];
            says.extend_from_slice(&u32::to_le_bytes(length));
            says.resize(OUTER + length as usize, 1);
            assert!(
                refused(says).contains("shorter than its header"),
                "{length}"
            );
        }
        for length in [u32::MAX, 1 << 31, 4097] {
            let mut says = vec![0, 0];
            says.extend_from_slice(&length.to_le_bytes());
            assert!(refused(says).contains("expected at most 4096"), "{length}");
        }
        let told = refused(frame(0, (4, 5, 1), 8, &[0; 4]));
        assert_eq!(told, "a frame announces 8 bytes of data and has 4");
    }

    #[test]
    fn frames_of_others_are_refused() {
        for says in [
            state(2),
            frame(0, (2, 5, 1), 0, &[]),
            frame(0, (4, 4, 1), 0, &[]),
        ] {
            assert!(refused(says).contains("does not belong to the request"));
        }
        assert!(refused(b"SSH-2.0-OpenSSH_9.2p1\r\n".to_vec()).contains("at most"));
        assert!(refused(frame(0x5353, (4, 5, 1), 8, &[0; 8])).contains("unknown kind 0x5353"));
    }

    #[test]
    fn time_is_taken_of_the_whole_exchange() {
        assert!(matches!(
            asked(Vec::new(), false, 200),
            Err(SocketError::Late)
        ));
        assert!(matches!(
            asked(vec![0, 0, 32], true, 20_000),
            Err(SocketError::Closed)
        ));
    }
}
