//! Cells of a design: all combinations, or a random sample.

use rand::seq::index::sample;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::file::{Axis, Choice, Design, Method, StudyFile};

/// Random streams that belong to no calibration.
const DESIGN_STREAM: u64 = u64::MAX;
const CHECK_STREAM: u64 = u64::MAX - 1;
/// Maximum number of cells of a study.
const MOST_CELLS: usize = 200_000;

/// One combination of the design; `None` means as stated in the file of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Combination {
    /// Index among the robots of the design.
    pub robot: usize,
    /// Largest side of the frame (m).
    pub size_m: Option<f64>,
    /// Sensor of the catalogue, `none` or `own`.
    pub laser: String,
    /// Number of poses.
    pub poses: usize,
    /// Selection of the poses.
    pub choice: Choice,
    /// Standard deviation of the home position (m).
    pub home_sd_m: Option<f64>,
    /// Standard deviation of the inclinometer (rad); 0: none.
    pub inclinometer_sd_rad: Option<f64>,
    /// Standard deviation of a length reading (m).
    pub length_sd_m: Option<f64>,
    /// Standard deviation of a tension (N).
    pub tension_sd_n: Option<f64>,
    /// Method of identification.
    pub method: Method,
    /// Whether it is also simulated.
    pub is_simulated: bool,
}

/// Number of values of each axis, slowest-varying first.
fn counts(design: &Design) -> [usize; 10] {
    let of = |axis: &Axis| match axis {
        Axis::Values(values) => values.len().max(1),
        Axis::Range { .. } => 1,
    };
    [
        design.robots.len(),
        of(&design.size_m),
        design.choice.len(),
        design.methods.len(),
        of(&design.length_sd_m),
        of(&design.tension_sd_n),
        of(&design.inclinometer_sd_rad),
        of(&design.home_sd_m),
        design.lasers.len(),
        design.poses.len(),
    ]
}

/// The cells of a study, in order.
///
/// # Errors
/// If there are too many.
pub fn combinations(study: &StudyFile) -> Result<Vec<Combination>, StudyError> {
    let design = &study.design;
    let counts = counts(design);
    let all = counts
        .iter()
        .try_fold(1_usize, |product, count| product.checked_mul(*count));
    let all = all.filter(|all| *all <= MOST_CELLS || design.random_cells.is_some());
    let wanted = design
        .random_cells
        .or(all)
        .filter(|cells| *cells <= MOST_CELLS);
    let (Some(all), Some(wanted)) = (all, wanted) else {
        let message = format!(
            "/design: found more than {MOST_CELLS} cells, expected fewer, or a value for random_cells"
        );
        return Err(StudyError::Input(message));
    };
    let mut rng = stream(study.seed, DESIGN_STREAM);
    let has_ranges = [
        &design.size_m,
        &design.home_sd_m,
        &design.inclinometer_sd_rad,
        &design.length_sd_m,
        &design.tension_sd_n,
    ]
    .iter()
    .any(|axis| matches!(axis, Axis::Range { .. }));
    let places: Vec<usize> = match design.random_cells {
        None => (0..all).collect(),
        // With ranges a combination may recur, since its values differ.
        Some(_) if has_ranges => (0..wanted).map(|_| rng.random_range(0..all)).collect(),
        Some(_) => {
            let mut places = sample(&mut rng, all, wanted.min(all)).into_vec();
            places.sort_unstable();
            places
        }
    };
    let mut cells: Vec<Combination> = places
        .into_iter()
        .map(|place| combination(design, counts, place, &mut rng))
        .collect();
    choose_simulated(study, &mut cells);
    Ok(cells)
}

fn combination(
    design: &Design,
    counts: [usize; 10],
    mut place: usize,
    rng: &mut ChaCha8Rng,
) -> Combination {
    let mut index = [0; 10];
    for (index, count) in index.iter_mut().zip(counts).rev() {
        *index = place % count;
        place /= count;
    }
    let mut value = |axis: &Axis, index: usize| match axis {
        Axis::Values(values) => values.get(index).copied(),
        Axis::Range { from, to } => Some((rng.random_range(from.ln()..to.ln())).exp()),
    };
    Combination {
        robot: index[0],
        size_m: value(&design.size_m, index[1]),
        choice: design.choice[index[2]],
        method: design.methods[index[3]],
        length_sd_m: value(&design.length_sd_m, index[4]),
        tension_sd_n: value(&design.tension_sd_n, index[5]),
        inclinometer_sd_rad: value(&design.inclinometer_sd_rad, index[6]),
        home_sd_m: value(&design.home_sd_m, index[7]),
        laser: design.lasers[index[8]].clone(),
        poses: design.poses[index[9]],
        is_simulated: false,
    }
}

/// Marks the cells to simulate: all of them if there are faults, otherwise a random sample.
fn choose_simulated(study: &StudyFile, cells: &mut [Combination]) {
    let share = if study.faults.is_empty() {
        study.simulation.share
    } else {
        1.0
    };
    let mut rng = stream(study.seed, CHECK_STREAM);
    let count = (share * cells.len() as f64).ceil() as usize;
    for index in sample(&mut rng, cells.len(), count.min(cells.len())) {
        cells[index].is_simulated = true;
    }
}

/// An independent random stream of a study.
#[must_use]
pub fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}

#[cfg(test)]
mod tests {
    use tautline_session::parse_versioned_toml;

    use super::*;

    fn study(design: &str) -> StudyFile {
        let text = format!(
            "format = \"tautline-study\"\nversion = 1\nname = \"s\"\n[design]\nrobots = [\"mini\", \"hall\"]\n{design}"
        );
        parse_versioned_toml(text.as_bytes(), "s.toml")
            .expect("valid")
            .value
    }

    #[test]
    fn every_combination_is_there_once() {
        let study = study(
            "lasers = [\"class-1mm\", \"none\"]\nposes = [10, 20, 40]\nhome_sd_m = [1e-4, 1e-5]",
        );
        let cells = combinations(&study).expect("cells");
        assert_eq!(cells.len(), 24);
        assert_eq!(cells.iter().filter(|cell| cell.is_simulated).count(), 3);
        for (index, cell) in cells.iter().enumerate() {
            assert!(!cells[index + 1..].iter().any(|other| {
                (other.robot, &other.laser, other.poses, other.home_sd_m)
                    == (cell.robot, &cell.laser, cell.poses, cell.home_sd_m)
            }));
        }
        assert_eq!(
            cells,
            combinations(&study).expect("cells"),
            "no chance in it"
        );
    }

    #[test]
    fn random_designs_stay_in_their_ranges() {
        let study =
            study("poses = [10, 20]\nhome_sd_m = {from = 1e-5, to = 1e-3}\nrandom_cells = 50");
        let cells = combinations(&study).expect("cells");
        assert_eq!(cells.len(), 50);
        assert!(
            cells
                .iter()
                .all(|cell| (1e-5..1e-3).contains(&cell.home_sd_m.expect("drawn")))
        );
        assert_ne!(cells[0].home_sd_m, cells[1].home_sd_m);
    }

    #[test]
    fn too_many_cells_are_refused() {
        let many: Vec<String> = (1..=1000).map(|n| n.to_string()).collect();
        let list = many.join(", ");
        let study = study(&format!("poses = [{list}]\ntension_sd_n = [{list}]"));
        assert!(combinations(&study).is_err());
    }
}
