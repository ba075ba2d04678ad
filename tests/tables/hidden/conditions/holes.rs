//! Empties cells of a dataset.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

use crate::tables::hidden::template::log_uniform;

/// Range of the share of cells that are empty in the scattered pattern.
const SCATTERED: [f64; 2] = [0.01, 0.3];

/// A column of the file: index of its grid and of the cable; grid 4 is the laser.
type Column = (usize, usize);

/// The grid of a column; `None` for the laser.
fn grid(data: &mut Measurements, of: usize) -> Option<&mut Grid> {
    let all = [
        &mut data.revolutions,
        &mut data.length_m,
        &mut data.force_n,
        &mut data.swivel_rad,
    ];
    all.into_iter().nth(of)
}

fn clear(data: &mut Measurements, (of, cable): Column, row: usize) {
    match grid(data, of) {
        Some(grid) => grid.set(row, cable, f64::NAN),
        None => data.laser_m[row] = f64::NAN,
    }
}

/// Empties cells in a random pattern: one cell, ten cells, scattered cells, one channel from some pose on, or all
/// channels of one kind at some poses. The encoder values at home are set rather than read, so they stay.
pub fn empty_cells(robot: &Robot, data: &mut Measurements, rng: &mut ChaCha8Rng) {
    let cables = robot.cable_count();
    let mut columns: Vec<Column> = Vec::new();
    for of in 0..4 {
        if grid(data, of).is_some_and(|grid| !grid.is_empty()) {
            columns.extend((0..cables).map(|cable| (of, cable)));
        }
    }
    if !data.laser_m.is_empty() {
        columns.push((4, 0));
    }
    let home = robot.home.and(data.home_row());
    let rows: Vec<usize> = (0..data.len()).filter(|row| Some(*row) != home).collect();
    let mut any = |from: usize| rng.random_range(0..from);
    let pattern = any(5);
    let column = columns[any(columns.len())];
    match pattern {
        0 => clear(data, column, rows[any(rows.len())]),
        1 => (0..10).for_each(|_| clear(data, columns[any(columns.len())], rows[any(rows.len())])),
        2 => {
            let from = any(rows.len());
            rows[from..]
                .iter()
                .for_each(|row| clear(data, column, *row));
        }
        3 => {
            for _ in 0..=any(rows.len() / 4) {
                let row = rows[any(rows.len())];
                let kind = columns.iter().filter(|(of, _)| *of == column.0);
                kind.for_each(|column| clear(data, *column, row));
            }
        }
        _ => {
            let share = log_uniform(SCATTERED, rng);
            for row in &rows {
                for column in &columns {
                    if rng.random_bool(share) {
                        clear(data, *column, *row);
                    }
                }
            }
        }
    }
}
