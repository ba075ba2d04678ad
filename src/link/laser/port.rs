//! Byte streams of lasers: network connections and serial ports.

use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use serial2::{CharSize, FlowControl, Parity, SerialPort, StopBits};
use tautline_session::{LaserParity, LaserPort};

/// Longest wait for bytes, after which the thread checks whether it should end.
pub(super) const READ_WAIT: Duration = Duration::from_millis(50);
/// Longest wait for a connection, and for sending.
const LONGEST_WAIT: Duration = Duration::from_secs(2);

/// A byte stream; reading waits for at most [`READ_WAIT`].
pub(super) trait Port: Read + Write + Send {}

impl<P: Read + Write + Send> Port for P {}

/// Names of the serial ports of this computer; empty if the system does not list them.
#[must_use]
pub fn serial_ports() -> Vec<String> {
    let mut ports: Vec<String> = SerialPort::available_ports()
        .unwrap_or_default()
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    ports.sort();
    ports
}

/// The name of a port, for messages.
pub(super) fn name(port: &LaserPort) -> String {
    match port {
        LaserPort::Tcp { host, port } => format!("{host}:{port}"),
        LaserPort::Serial { device, .. } => device.clone(),
    }
}

/// Opens a port; the error states why it cannot be opened.
pub(super) fn open(port: &LaserPort) -> Result<Box<dyn Port>, String> {
    let opened = match port {
        LaserPort::Tcp { host, port } => open_tcp(host, *port),
        LaserPort::Serial {
            device,
            baud,
            parity,
            stop_bits,
        } => open_serial(device, (*baud, *parity, *stop_bits)),
    };
    opened.map_err(|error| format!("{} cannot be opened: {error}", name(port)))
}

fn open_tcp(host: &str, port: u16) -> std::io::Result<Box<dyn Port>> {
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let mut error = std::io::Error::other("the name has no address");
    for address in (host, port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, LONGEST_WAIT) {
            Ok(stream) => {
                stream.set_read_timeout(Some(READ_WAIT))?;
                stream.set_write_timeout(Some(LONGEST_WAIT))?;
                stream.set_nodelay(true)?;
                return Ok(Box::new(stream));
            }
            Err(refused) => error = refused,
        }
    }
    Err(error)
}

fn open_serial(device: &str, bits: (u32, LaserParity, u8)) -> std::io::Result<Box<dyn Port>> {
    let (baud, parity, stop_bits) = bits;
    let mut port = SerialPort::open(device, |mut settings: serial2::Settings| {
        settings.set_raw();
        settings.set_baud_rate(baud)?;
        settings.set_char_size(CharSize::Bits8);
        settings.set_flow_control(FlowControl::None);
        settings.set_stop_bits(match stop_bits {
            2 => StopBits::Two,
            _ => StopBits::One,
        });
        settings.set_parity(match parity {
            LaserParity::None => Parity::None,
            LaserParity::Odd => Parity::Odd,
            LaserParity::Even => Parity::Even,
        });
        Ok(settings)
    })?;
    port.set_read_timeout(READ_WAIT)?;
    port.set_write_timeout(LONGEST_WAIT)?;
    // Buffered input is outdated.
    port.discard_input_buffer()?;
    Ok(Box::new(port))
}
