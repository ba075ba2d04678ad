//! Several rows per standstill, which share part of their errors.

use rand_chacha::ChaCha8Rng;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

use super::normal;

/// Number of rows per standstill.
pub const REPEATS: usize = 4;
/// Seconds between the rows of a standstill.
const SECONDS: f64 = 2.0;

/// Repeats every row except home [`REPEATS`] times, each in a group of its own.
pub fn repeated(data: &Measurements) -> Measurements {
    let home = data.home_row();
    let times = |row: usize| if Some(row) == home { 1 } else { REPEATS };
    let rows: Vec<usize> = (0..data.len())
        .flat_map(|row| std::iter::repeat_n(row, times(row)))
        .collect();
    let mut all = data.select(&rows);
    let first = data.labels.first().copied().unwrap_or_default();
    all.labels = (first..).take(rows.len()).collect();
    all.groups = rows.iter().map(|row| format!("standstill-{row}")).collect();
    for at in 1..rows.len() {
        if rows[at] == rows[at - 1] && !all.time_s.is_empty() {
            all.time_s[at] = all.time_s[at - 1] + SECONDS;
        }
    }
    all
}

/// Adds to every channel an error of `size` described standard deviations that all rows of a standstill share.
pub fn add_shared_errors(robot: &Robot, data: &mut Measurements, size: f64, rng: &mut ChaCha8Rng) {
    let home = robot.home.and(data.home_row());
    for row in (0..data.len()).filter(|row| Some(*row) != home) {
        let is_first = row == 0 || data.groups[row] != data.groups[row - 1];
        let last = data
            .groups
            .iter()
            .rposition(|group| *group == data.groups[row]);
        let (Some(last), true) = (last, is_first) else {
            continue;
        };
        let mut add = |grid: &mut Grid, index: usize, sd: f64| {
            let error = normal(rng, size * sd);
            if !grid.is_empty() {
                (row..=last).for_each(|k| grid.set(k, index, grid.get(k, index) + error));
            }
        };
        for (index, cable) in robot.cables.iter().enumerate() {
            let winch = &cable.winch;
            let sd = winch.length_sd_m / winch.cable_per_revolution_m();
            add(&mut data.revolutions, index, sd);
            add(&mut data.length_m, index, winch.length_sd_m);
            if let Some(sensor) = cable.force_sensor {
                let sd = sensor.tension_gain.abs() * sensor.tension_sd_n;
                add(&mut data.force_n, index, sd);
            }
            let sd = cable.pulley.swivel_sd_rad.unwrap_or(0.0);
            add(&mut data.swivel_rad, index, sd);
        }
        if let (Some(laser), false) = (&robot.laser, data.laser_m.is_empty()) {
            let error = normal(rng, size * laser.sd_m);
            data.laser_m[row..=last]
                .iter_mut()
                .for_each(|d| *d += error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robot;
    use rand::SeedableRng;

    #[test]
    fn rows_of_a_standstill_differ_from_the_exact_ones_by_the_same() {
        let mini = robot("mini").unwrap().preset.robot;
        let mut grid = Grid::new(8);
        (0..3).for_each(|_| grid.push_row(&[1.0; 8]));
        let data = Measurements {
            labels: vec![0, 1, 2],
            time_s: vec![0.0, 30.0, 60.0],
            revolutions: grid,
            laser_m: vec![0.5; 3],
            ..Measurements::default()
        };
        let mut all = repeated(&data);
        assert_eq!(all.labels, (0..9).collect::<Vec<i64>>());
        assert_eq!(
            all.groups[1..5],
            [
                "standstill-1",
                "standstill-1",
                "standstill-1",
                "standstill-1"
            ]
        );
        assert!(
            all.time_s.windows(2).all(|t| t[0] < t[1]),
            "{:?}",
            all.time_s
        );
        add_shared_errors(&mini, &mut all, 1.5, &mut ChaCha8Rng::seed_from_u64(1));
        let reading = |row| all.revolutions.get(row, 3);
        assert_eq!(reading(0).to_bits(), 1.0_f64.to_bits());
        assert!((reading(1) - reading(4)).abs() < 1e-15 && (reading(4) - reading(5)).abs() > 1e-9);
        assert!((all.laser_m[1] - all.laser_m[3]).abs() < 1e-15);
    }
}
