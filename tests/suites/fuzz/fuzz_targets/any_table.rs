#![no_main]

use libfuzzer_sys::fuzz_target;

/// Cells of every type, and none.
const CELLS: [&str; 12] = [
    "1", "-2.5", "3,7", "1e300", "nan", "", "true", "P1", "2026-11-26 10:00:00.5", "12:30:05", "\"a;b\"", "0x1F",
];
const SEPARATORS: [char; 4] = [',', ';', '\t', ' '];

// A table of any types: the first bytes are the separator and the number of columns, of which each has one type, or any.
fuzz_target!(|bytes: &[u8]| {
    let [separator, columns, cells @ ..] = bytes else { return };
    let separator = SEPARATORS[usize::from(separator % 4)];
    let columns = usize::from(columns % 12) + 1;
    let mut table = (0..columns).map(|k| format!("column {k}")).collect::<Vec<_>>().join(&separator.to_string());
    for row in cells.chunks(columns) {
        let row: Vec<&str> = row.iter().zip(cells).map(|(any, first)| match any % 4 {
            0 => CELLS[usize::from(any / 4) % CELLS.len()],
            _ => CELLS[usize::from(*first) % CELLS.len()],
        }).collect();
        table.push('\n');
        table.push_str(&row.join(&separator.to_string()));
    }
    tautline_fuzz::check_import(table.as_bytes());
});
