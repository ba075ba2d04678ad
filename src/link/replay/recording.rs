//! The recorded rows and their lookup.

use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Grid, Measurements};

use crate::controller::Sample;
use crate::error::LinkError;

/// Distance (m) and rotation (rad) up to which a commanded pose matches a recorded one.
const SAME_M: f64 = 1e-4;
const SAME_RAD: f64 = 1e-4;

/// Measurements, and how often each row was returned.
pub(super) struct Recording {
    measurements: Measurements,
    /// Rows by label.
    order: Vec<usize>,
    visits: Vec<usize>,
}

impl Recording {
    /// Checks that a dataset can be played back.
    pub fn new(dataset: Dataset) -> Result<Self, LinkError> {
        let refuse = |text: &str| Err(LinkError::Setup(text.to_owned()));
        let measurements = dataset.measurements;
        if measurements.is_empty() {
            return refuse("the recording has no poses");
        }
        if measurements.revolutions.is_empty() {
            return refuse("the recording has no motor revolutions (rev_1 and so on)");
        }
        if !measurements.commanded.iter().any(Option::is_some) {
            return refuse(
                "the recording does not say which poses were commanded (x_m to qz of poses.csv)",
            );
        }
        let mut order: Vec<usize> = (0..measurements.len()).collect();
        order.sort_by_key(|row| measurements.labels[*row]);
        Ok(Self {
            visits: vec![0; order.len()],
            order,
            measurements,
        })
    }

    /// The row with the smallest label.
    pub fn first(&self) -> usize {
        self.order[0]
    }

    /// The row of the home pose.
    pub fn home(&self) -> Option<usize> {
        self.measurements.home_row()
    }

    /// Time at which a row was measured (s).
    pub fn time_s(&self, row: usize) -> Option<f64> {
        known(self.measurements.time_s.get(row))
    }

    pub fn commanded(&self, row: usize) -> Option<Pose> {
        self.measurements.commanded.get(row).copied().flatten()
    }

    pub fn visit(&mut self, row: usize) {
        self.visits[row] += 1;
    }

    /// The row measured at a pose; among several, the one returned least often, then the one with the smallest label.
    pub fn nearest(&self, pose: &Pose) -> Result<usize, LinkError> {
        let off = |row: usize| {
            let twist = self.commanded(row)?.difference(pose);
            let (way, turn) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
            Some((row, way.norm(), turn.norm()))
        };
        let known: Vec<_> = self.order.iter().filter_map(|row| off(*row)).collect();
        let same = known
            .iter()
            .filter(|(_, way, turn)| *way <= SAME_M && *turn <= SAME_RAD);
        if let Some((row, ..)) = same.min_by_key(|(row, ..)| self.visits[*row]) {
            return Ok(*row);
        }
        let nearest = known.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let [x, y, z] = (pose.position * 1e3).into();
        let rest = nearest.map_or(String::new(), |(row, way, turn)| {
            format!(
                ", the nearest is pose {} at a distance of {:.1} mm and {:.2} degrees",
                self.measurements.labels[*row],
                way * 1e3,
                turn.to_degrees()
            )
        });
        Err(LinkError::Refused(format!(
            "no pose was recorded at ({x:.1}, {y:.1}, {z:.1}) mm with this orientation{rest}"
        )))
    }

    /// Readings on the way between two rows, or at the second one.
    pub fn between(&self, from: usize, to: usize, part: f64) -> Sample {
        let at = self.at(to);
        if part >= 1.0 || from == to {
            return at;
        }
        let before = self.at(from);
        let mix = |a: f64, b: f64| a + part * (b - a);
        let mix_all = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| mix(*a, *b)).collect();
        Sample {
            revolutions: mix_all(&before.revolutions, &at.revolutions),
            force_n: mix_all(&before.force_n, &at.force_n),
            laser_m: before.laser_m.zip(at.laser_m).map(|(a, b)| mix(a, b)),
            ..at
        }
    }

    fn at(&self, row: usize) -> Sample {
        let m = &self.measurements;
        let of_grid = |grid: &Grid| match grid.is_empty() {
            true => Vec::new(),
            false => grid.row(row).to_vec(),
        };
        let swivel_rad = of_grid(&m.swivel_rad);
        Sample {
            time_s: 0.0,
            revolutions: of_grid(&m.revolutions),
            force_n: of_grid(&m.force_n),
            laser_m: known(m.laser_m.get(row)),
            temperature_c: known(m.temperature_c.get(row)),
            swivel_rad: (!swivel_rad.is_empty()).then_some(swivel_rad),
            inclination_rad: m.inclination_rad.get(row).copied(),
            commanded: None,
            started: None,
        }
    }
}

/// A reading, unless it is missing.
fn known(value: Option<&f64>) -> Option<f64> {
    value.copied().filter(|value| value.is_finite())
}
