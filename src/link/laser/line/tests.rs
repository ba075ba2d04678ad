//! Tests with devices that misbehave, over the network and over pairs of serial ports. Waits end with what is waited for.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};

use tautline_session::LaserSettings;

use super::*;
use crate::clock::ManualClock;

fn laser(text: &str) -> (LineLaser, ManualClock) {
    let settings = text.parse();
    let Ok(LaserSettings::Line(line)) = settings else {
        panic!("{settings:?}");
    };
    let clock = ManualClock::default();
    (LineLaser::new(line, Arc::new(clock.clone())), clock)
}

/// A laser connected to a reader_thread, and the device's end.
fn over_tcp(query: &str) -> (LineLaser, ManualClock, TcpStream, TcpListener) {
    let reader_thread = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = reader_thread.local_addr().unwrap();
    let (mut laser, clock) = laser(&format!("tcp:{address}{query}"));
    laser.connect().unwrap();
    let (device, _) = reader_thread.accept().unwrap();
    (laser, clock, device, reader_thread)
}

/// Waits until `get` returns a value; panics after a time that is long enough for a busy machine.
fn until<T>(mut get: impl FnMut() -> Option<T>) -> T {
    for _ in 0..6000 {
        if let Some(found) = get() {
            return found;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("it never happened");
}

fn shows(laser: &LineLaser, distance_m: f64) {
    until(|| {
        let shown = laser.distance_m()?;
        ((shown - distance_m).abs() < 1e-12).then_some(())
    });
}

fn troubled(laser: &LineLaser, words: &str) {
    until(|| laser.problem().filter(|text| text.contains(words)));
    assert_eq!(laser.distance_m(), None);
}

#[test]
fn lines_over_the_network_are_distances() {
    let (mut laser, clock, mut device, _reader_thread) = over_tcp("?no_return=E255");
    assert!(
        laser
            .problem()
            .is_some_and(|text| text.contains("sends nothing"))
    );
    // The beginning of the first line may have been missed.
    device.write_all(b"12.5\r\n512.5\r\n").unwrap();
    shows(&laser, 0.5125);
    assert_eq!(laser.problem(), None);
    device.write_all(b"E255\r\n").unwrap();
    troubled(&laser, "no return");
    device.write_all(b"0.25e3\n").unwrap();
    shows(&laser, 0.25);
    clock.advance(0.9);
    shows(&laser, 0.25);
    clock.advance(0.2);
    assert_eq!(laser.distance_m(), None);
    device.write_all(b"300\n").unwrap();
    shows(&laser, 0.3);
    laser.discard_reading();
    assert_eq!(laser.latest(), None);
    laser.disconnect();
    assert!(
        laser
            .problem()
            .is_some_and(|text| text.contains("not connected"))
    );
}

#[test]
fn garbage_is_never_a_distance() {
    let (laser, _, mut device, _reader_thread) = over_tcp("");
    let long = [b'7'; 5000];
    let rubbish: [(&[u8], &str); 5] = [
        (b"\xff\xfe1\x00\n", "not plain text"),
        (b"E17\n", "\"E17\""),
        (b"12,5\n", "\"12,5\""),
        (b"5 m\n", "unit is mm"),
        (&long, ""),
    ];
    for (bytes, words) in rubbish {
        device.write_all(b"\n100\n").unwrap();
        shows(&laser, 0.1);
        device.write_all(bytes).unwrap();
        if !words.is_empty() {
            troubled(&laser, words);
        }
    }
    device.write_all(b"\n").unwrap();
    troubled(&laser, "more than 256");
    // An incomplete line has no effect until its end arrives.
    device.write_all(b"10").unwrap();
    device.write_all(b"24.0").unwrap();
    device.write_all(b"\n").unwrap();
    shows(&laser, 1.024);
}

#[test]
fn a_lost_connection_is_made_anew() {
    let (laser, _, mut device, reader_thread) = over_tcp("");
    device.write_all(b"\n100\n20").unwrap();
    shows(&laser, 0.1);
    drop(device);
    troubled(&laser, "closed the connection");
    let (mut device, _) = reader_thread.accept().unwrap();
    // The rest of the previous line does not become part of the next one.
    device.write_all(b"0\n300\n").unwrap();
    shows(&laser, 0.3);
    drop((device, reader_thread));
    troubled(&laser, "cannot be opened");
}

#[test]
fn readings_are_asked_for_with_a_command() {
    let (laser, _, mut device, _reader_thread) = over_tcp("?command=D%0D&unit=m");
    let mut asked = [0; 2];
    // It answers what it was asked, with an echo.
    for answer in ["D\r0.1\r\n", "D\r0.2\r\n", "D\r0.3\r\n"] {
        device.read_exact(&mut asked).unwrap();
        assert_eq!(&asked, b"D\r");
        device.write_all(answer.as_bytes()).unwrap();
    }
    shows(&laser, 0.3);
    // It asks again.
    device.read_exact(&mut asked).unwrap();
}

#[test]
fn where_nothing_is_there_is_no_connection() {
    let reader_thread = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = reader_thread.local_addr().unwrap();
    drop(reader_thread);
    for text in [
        format!("tcp:{address}"),
        "serial:/dev/no-such-port".to_owned(),
    ] {
        let (mut laser, _) = laser(&text);
        let told = laser.connect().unwrap_err().to_string();
        assert!(told.contains("cannot be opened"), "{told}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn lines_over_a_serial_port_are_distances() {
    use std::os::fd::AsRawFd;

    let (device, end) = serial2::SerialPort::pair().unwrap();
    let path = format!("/proc/self/fd/{}", end.as_raw_fd());
    let path = std::fs::read_link(path).unwrap();
    let (mut laser, _) = laser(&format!("serial:{}:19200", path.display()));
    laser.connect().unwrap();
    drop(end);
    device.write_all(b"5\r\n512.5\r\n").unwrap();
    shows(&laser, 0.5125);
    device.write_all(b"\x80\x81\r\n").unwrap();
    troubled(&laser, "baud");
    device.write_all(b"600\r\n").unwrap();
    shows(&laser, 0.6);
    // The port is pulled out.
    drop(device);
    troubled(&laser, &path.display().to_string());
}
