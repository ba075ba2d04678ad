#![no_main]

use std::sync::LazyLock;

use tautline_files::ReadError;
use libfuzzer_sys::fuzz_target;
use tautline_core::robot::Robot;
use tautline_session::{Loaded, read_check, read_elongation, read_force, read_home, read_winch, write_check, write_elongation, write_force, write_home, write_winch};

static ROBOT: LazyLock<Robot> = LazyLock::new(tautline_fuzz::robot);

/// Reads, writes what was read, and reads that again.
fn round_trip<T: PartialEq + std::fmt::Debug>(
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<Loaded<Vec<T>>, ReadError>,
    write: impl Fn(&mut Vec<u8>, &[T]) -> std::io::Result<()>,
) {
    let rows = match read(bytes) {
        Ok(loaded) => loaded.value,
        Err(error) => return tautline_fuzz::check_error(&error, "x.csv"),
    };
    let mut written = Vec::new();
    write(&mut written, &rows).expect("what was read can be written");
    assert_eq!(read(&written).expect("and read again").value, rows);
}

fuzz_target!(|bytes: &[u8]| {
    // The first byte chooses the table.
    let Some((which, text)) = bytes.split_first() else {
        return;
    };
    match which % 5 {
        0 => round_trip(
            text,
            |b| read_winch(b, "x.csv", &ROBOT),
            |out, rows| write_winch(out, rows, &ROBOT),
        ),
        1 => round_trip(
            text,
            |b| read_force(b, "x.csv", &ROBOT),
            |out, rows| write_force(out, rows, &ROBOT),
        ),
        2 => round_trip(
            text,
            |b| read_home(b, "x.csv"),
            |out, rows| write_home(out, rows),
        ),
        3 => round_trip(
            text,
            |b| read_elongation(b, "x.csv"),
            |out, rows| write_elongation(out, rows),
        ),
        _ => round_trip(
            text,
            |b| read_check(b, "x.csv"),
            |out, rows| write_check(out, rows),
        ),
    }
});
