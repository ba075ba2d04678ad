//! Checks that a server speaks ADS at all.
//!
//! The library trusts every answer: what another kind of server sends, such as a login banner, would make it allocate
//! hundreds of megabytes or fail in its own thread. So one request is sent by hand first, on a connection of its own.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::time::Duration;

use ads::{AmsAddr, AmsNetId};

use crate::error::LinkError;

/// The AMS port of this computer.
pub(super) const OWN_PORT: u16 = 58913;
/// Bytes of the AMS header.
const HEADER: usize = 32;
/// More than any answer to the question has.
const LONGEST: usize = 1024;
const READ_STATE: u8 = 4;

/// Asks for the state of the program.
pub(super) fn probe(
    place: SocketAddr,
    target: AmsAddr,
    net_id: Option<[u8; 6]>,
    timeout: Duration,
) -> Result<(), LinkError> {
    let answer = ask(place, target, net_id, timeout);
    match answer {
        Ok(true) => Ok(()),
        Ok(false) => Err(LinkError::Disconnected(format!(
            "the server at {place} does not speak ADS"
        ))),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            Err(LinkError::Timeout(timeout.as_secs_f64()))
        }
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe
            ) =>
        {
            let text = "it closed the connection (does it have an ADS route to this computer?)";
            Err(LinkError::Disconnected(text.to_owned()))
        }
        Err(error) => Err(LinkError::Disconnected(format!(
            "{place} cannot be reached ({error})"
        ))),
    }
}

fn ask(
    place: SocketAddr,
    target: AmsAddr,
    net_id: Option<[u8; 6]>,
    timeout: Duration,
) -> std::io::Result<bool> {
    let mut socket = TcpStream::connect_timeout(&place, timeout)?;
    socket.set_read_timeout(Some(timeout))?;
    socket.set_write_timeout(Some(timeout))?;
    let source = net_id.unwrap_or(match socket.local_addr()?.ip() {
        IpAddr::V4(ip) => {
            let [a, b, c, d] = ip.octets();
            [a, b, c, d, 1, 1]
        }
        IpAddr::V6(_) => [127, 0, 0, 1, 1, 1],
    });
    socket.write_all(&question(target, source))?;
    loop {
        let mut start = [0; 6];
        socket.read_exact(&mut start)?;
        let [low, high, rest @ ..] = start;
        let length = usize::try_from(u32::from_le_bytes(rest)).unwrap_or(usize::MAX);
        if length > LONGEST {
            return Ok(false);
        }
        let mut frame = vec![0; length];
        socket.read_exact(&mut frame)?;
        match u16::from_le_bytes([low, high]) {
            0 => return Ok(is_answer(&frame)),
            // Messages of a router, which may arrive at any time.
            1 | 0x1000..=0x1002 => {}
            _ => return Ok(false),
        }
    }
}

/// The frame that asks for the state: no data.
fn question(target: AmsAddr, source: [u8; 6]) -> Vec<u8> {
    let AmsNetId(wanted) = target_net_id(target, source);
    let mut frame = vec![0, 0, HEADER as u8, 0, 0, 0];
    frame.extend_from_slice(&wanted);
    frame.extend_from_slice(&target.port().to_le_bytes());
    frame.extend_from_slice(&source);
    frame.extend_from_slice(&OWN_PORT.to_le_bytes());
    // Command, flags of a request; no data, no error; number 1.
    frame.extend_from_slice(&[READ_STATE, 0, 4, 0]);
    frame.extend_from_slice(&[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    frame
}

/// As the library does it: the local Net ID stands for that of this computer.
fn target_net_id(target: AmsAddr, source: [u8; 6]) -> AmsNetId {
    if target.netid() == AmsNetId::local() {
        AmsNetId(source)
    } else {
        target.netid()
    }
}

/// Whether a frame answers the question, be it with an error.
fn is_answer(frame: &[u8]) -> bool {
    let length = frame.get(20..24).map(|bytes| {
        bytes
            .iter()
            .rev()
            .fold(0_usize, |sum, byte| sum << 8 | usize::from(*byte))
    });
    frame.get(16) == Some(&READ_STATE)
        && frame.get(18).is_some_and(|flags| flags & 1 == 1)
        && frame.get(28..32) == Some(&[1, 0, 0, 0])
        && length == frame.len().checked_sub(HEADER)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    /// What is found where a server says this and then holds its tongue.
    fn found(says: &'static [u8], closes: bool) -> String {
        // Only who says nothing is waited for.
        let timeout_ms = if says.is_empty() { 300 } else { 20_000 };
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let place = listener.local_addr().unwrap();
        let server = std::thread::spawn(move || {
            let (mut socket, _) = listener.accept().unwrap();
            socket.write_all(says).unwrap();
            if !closes {
                // Until the other side has gone.
                let mut rest = Vec::new();
                let _ = socket.read_to_end(&mut rest);
            }
        });
        let target = AmsAddr::new(AmsNetId::new(1, 2, 3, 4, 5, 6), 851);
        let told = probe(place, target, None, Duration::from_millis(timeout_ms));
        server.join().unwrap();
        told.unwrap_err().to_string()
    }

    #[test]
    fn other_servers_are_recognised() {
        let banner = found(b"SSH-2.0-OpenSSH_9.2p1\r\n", false);
        assert!(banner.contains("does not speak ADS"), "{banner}");
        let empty = found(&[0; 6], false);
        assert!(empty.contains("does not speak ADS"), "{empty}");
        let short = found(&[0, 0, 3, 0, 0, 0, 1, 2, 3], false);
        assert!(short.contains("does not speak ADS"), "{short}");
        let silent = found(&[], false);
        assert!(silent.contains("did not answer within 0.3 s"), "{silent}");
    }

    #[test]
    fn whoever_hangs_up_may_lack_a_route() {
        let told = found(&[0, 0, 32], true);
        assert!(told.contains("an ADS route to this computer"), "{told}");
    }

    #[test]
    fn answers_are_told_from_other_frames() {
        let mut frame = question(AmsAddr::new(AmsNetId::local(), 851), [9; 6]).split_off(6);
        assert_eq!(frame[..6], [9; 6]);
        assert!(!is_answer(&frame), "a request");
        frame[18] |= 1;
        assert!(is_answer(&frame));
        frame.push(0);
        assert!(!is_answer(&frame));
        for length in 0..HEADER {
            assert!(!is_answer(&frame[..length]));
        }
    }
}
