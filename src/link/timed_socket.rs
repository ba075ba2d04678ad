//! A socket with a deadline for every exchange, independent of the data that arrive.
//!
//! The deadline applies to the whole exchange, not to its parts: a server that sends one byte every half second is also late.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use crate::error::LinkError;

/// Reasons why a connection can no longer be used.
#[derive(Debug)]
pub(crate) enum SocketError {
    /// The connection could not be made, or the operating system reports a failure.
    Io(std::io::Error),
    /// The response did not arrive in time.
    Late,
    /// The other side closed it.
    Closed,
    /// The other side ended it and stated why.
    Ended(String),
    /// The received data violate the protocol; states how.
    Invalid(String),
}

impl SocketError {
    /// Converts to an error for the operator about a request; `closed` suggests why the other side may have closed it.
    pub fn into_error(self, (request, timeout_s): (&str, f64), closed: &str) -> LinkError {
        match self {
            Self::Late => LinkError::Timeout {
                request: request.to_owned(),
                seconds: timeout_s,
            },
            Self::Closed => LinkError::Disconnected(format!("it closed the connection{closed}")),
            Self::Ended(why) => LinkError::Disconnected(format!("it ended the connection: {why}")),
            Self::Io(error) => LinkError::Disconnected(format!("it failed ({error})")),
            Self::Invalid(what) => {
                LinkError::Disconnected(format!("its answer is invalid: {what}"))
            }
        }
    }
}

/// The timeout of a connection.
pub(crate) fn timeout_of(timeout_s: f64) -> Result<Duration, LinkError> {
    Duration::try_from_secs_f64(timeout_s)
        .ok()
        .filter(|timeout| !timeout.is_zero())
        .ok_or_else(|| LinkError::Setup("the timeout is not a positive time".to_owned()))
}

/// The addresses of a host.
pub(crate) fn addresses_of(host: &str, port: u16) -> Result<Vec<SocketAddr>, LinkError> {
    let found = (host, port).to_socket_addrs().map_err(|error| {
        LinkError::Disconnected(format!("the host {host:?} cannot be found ({error})"))
    })?;
    let found: Vec<SocketAddr> = found.collect();
    match found.is_empty() {
        true => Err(LinkError::Disconnected(format!(
            "the host {host:?} has no address"
        ))),
        false => Ok(found),
    }
}

/// A socket.
pub(crate) struct TimedSocket(TcpStream);

impl TimedSocket {
    /// Connects within a time.
    pub fn connect(place: SocketAddr, timeout: Duration) -> Result<Self, SocketError> {
        let socket =
            TcpStream::connect_timeout(&place, timeout).map_err(|error| match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => SocketError::Late,
                _ => SocketError::Io(error),
            })?;
        socket.set_nodelay(true).map_err(SocketError::Io)?;
        Ok(Self(socket))
    }

    /// The address of this computer on the connection.
    pub fn own_address(&self) -> Result<IpAddr, SocketError> {
        Ok(self.0.local_addr().map_err(SocketError::Io)?.ip())
    }

    /// Whether data have arrived that were not read yet.
    pub fn has_received(&self) -> Result<bool, SocketError> {
        self.0.set_nonblocking(true).map_err(SocketError::Io)?;
        let peeked = self.0.peek(&mut [0]);
        self.0.set_nonblocking(false).map_err(SocketError::Io)?;
        match peeked {
            Ok(0) => Err(SocketError::Closed),
            Ok(_) => Ok(true),
            Err(error) => passing(error).map(|()| false),
        }
    }

    /// Fills the buffer.
    pub fn fill(&mut self, buffer: &mut [u8], until: Instant) -> Result<(), SocketError> {
        let mut done = 0;
        while done < buffer.len() {
            let left = remaining(until)?;
            self.0
                .set_read_timeout(Some(left))
                .map_err(SocketError::Io)?;
            match self.0.read(&mut buffer[done..]) {
                Ok(0) => return Err(SocketError::Closed),
                Ok(count) => done += count,
                Err(error) => passing(error)?,
            }
        }
        Ok(())
    }

    /// Sends all bytes.
    pub fn send(&mut self, bytes: &[u8], until: Instant) -> Result<(), SocketError> {
        let mut done = 0;
        while done < bytes.len() {
            let left = remaining(until)?;
            self.0
                .set_write_timeout(Some(left))
                .map_err(SocketError::Io)?;
            match self.0.write(&bytes[done..]) {
                Ok(0) => return Err(SocketError::Closed),
                Ok(count) => done += count,
                Err(error) => passing(error)?,
            }
        }
        Ok(())
    }
}

/// Time remaining.
fn remaining(until: Instant) -> Result<Duration, SocketError> {
    let left = until.saturating_duration_since(Instant::now());
    match left.is_zero() {
        true => Err(SocketError::Late),
        false => Ok(left),
    }
}

/// Ignores errors after which a socket can be tried again, until the deadline.
fn passing(error: std::io::Error) -> Result<(), SocketError> {
    match error.kind() {
        ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut => Ok(()),
        ErrorKind::UnexpectedEof
        | ErrorKind::ConnectionReset
        | ErrorKind::ConnectionAborted
        | ErrorKind::BrokenPipe => Err(SocketError::Closed),
        _ => Err(SocketError::Io(error)),
    }
}
