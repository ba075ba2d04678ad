//! Faults of the server.

use std::net::TcpStream;
use std::thread::sleep;
use std::time::Duration;

use super::{Request, frame, send};

/// Fault of an answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Action {
    /// The connection ends before the request is treated.
    DropBefore,
    /// The connection ends after the request is treated.
    DropAfter,
    /// The connection ends after this number of values was written, and nobody can connect before [`Unruly::up`].
    DownAfterValues(usize),
    /// The last bytes are missing; the answer's own length still counts them.
    Short(usize),
    /// The last bytes are missing and its own length is right: shorter than what was asked for.
    Less(usize),
    /// Zeros follow what its own length counts.
    Padded(usize),
    /// One byte every half second.
    Dripping,
    /// Frames of a router instead of an answer, until the client has disconnected.
    Notes,
    /// A frame of this announced length, and its first bytes.
    Length(u32),
    /// Empty notifications and such with lengths that cannot be, then the answer.
    Notifications,
    /// An AMS error in the header.
    Code(u32),
    /// Nothing for this time (ms), then the answer.
    Late(u64),
}

/// Answers a request wrongly; `None` where the connection ends.
pub(super) fn misbehave(
    socket: &mut TcpStream,
    request: &Request,
    content: &[u8],
    action: Action,
) -> Option<()> {
    let plain = frame(request, 0, content);
    match action {
        Action::DropBefore | Action::DropAfter | Action::DownAfterValues(_) => None,
        Action::Short(missing) => {
            let arrives = content.len().saturating_sub(missing);
            send(socket, &frame(request, 0, &content[..arrives]))
        }
        Action::Less(missing) => {
            let arrives = content.len().saturating_sub(missing).max(8);
            let mut less = content[..arrives].to_vec();
            less[4..8].copy_from_slice(&((arrives - 8) as u32).to_le_bytes());
            send(socket, &frame(request, 0, &less))
        }
        Action::Padded(zeros) => {
            let mut padded = content.to_vec();
            padded.resize(content.len() + zeros, 0);
            send(socket, &frame(request, 0, &padded))
        }
        Action::Dripping => {
            for byte in plain {
                send(socket, &[byte])?;
                sleep(Duration::from_millis(500));
            }
            Some(())
        }
        Action::Notes => {
            let mut note = vec![0x01, 0x10];
            note.extend_from_slice(&4_u32.to_le_bytes());
            note.extend_from_slice(&[1, 0, 0, 0]);
            loop {
                send(socket, &note)?;
                sleep(Duration::from_millis(20));
            }
        }
        Action::Length(length) => {
            let mut broken = plain;
            broken[2..6].copy_from_slice(&length.to_le_bytes());
            send(socket, &broken)
        }
        Action::Notifications => {
            let note = |data: &[u8]| {
                let told = Request {
                    command: 8,
                    number: [0; 4],
                    addresses: request.addresses,
                    data: Vec::new(),
                    connection: request.connection,
                };
                let mut note = frame(&told, 0, data);
                // Not an answer.
                note[6 + 18] = 4;
                note
            };
            let huge = [0xff; 16];
            for data in [&[][..], &[0; 4], &[0; 8], &huge] {
                send(socket, &note(data))?;
            }
            send(socket, &plain)
        }
        Action::Code(code) => send(socket, &frame(request, code, &[])),
        Action::Late(pause_ms) => {
            sleep(Duration::from_millis(pause_ms));
            send(socket, &plain)
        }
    }
}
