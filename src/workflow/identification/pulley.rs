//! Inspection of one pulley: nominal and identified position, its uncertainty, and the correlations behind
//! the uncertainty.

use nalgebra::{DMatrix, DVector, Matrix3};
use tautline_core::estimation::{ParameterId, Solution};
use tautline_core::geometry::Vec3;
use tautline_core::robot::Robot;
use tautline_core::statistics::chi_square_survival;

use super::{Identification, entry_point_sd};
use crate::wording::odds;
use crate::wording::units::{decimals, fixed, signed};

/// Probability above which a displacement counts as noise.
pub const NOISE: f64 = 0.05;
/// Probability below which a displacement is clearly more than noise.
pub const CLEAR: f64 = 0.001;
/// Number of correlations listed.
const LISTED: usize = 3;
/// Axes of the base frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Covariance of a cable's identified entry point, 3 x 3 (m^2, base frame): 0 for coordinates that were not estimated;
/// `None` if none was, or the data do not determine them.
#[must_use]
pub fn entry_point_covariance(solution: &Solution, cable: usize) -> Option<Matrix3<f64>> {
    let whole = solution.covariance.as_ref()?;
    let columns = entry_point_columns(solution, cable);
    columns.iter().any(Option::is_some).then(|| {
        Matrix3::from_fn(|i, k| match (columns[i], columns[k]) {
            (Some(i), Some(k)) => whole[(i, k)],
            _ => 0.0,
        })
    })
}

/// Joint covariance of the entry points of these cables (m^2), x, y and z of each in turn, with zeros for coordinates that were not
/// estimated; `None` if the data do not determine all values.
#[must_use]
pub fn entry_points_covariance(solution: &Solution, cables: usize) -> Option<DMatrix<f64>> {
    let whole = solution.covariance.as_ref()?;
    let columns = (0..cables).flat_map(|cable| entry_point_columns(solution, cable));
    let columns: Vec<Option<usize>> = columns.collect();
    Some(DMatrix::from_fn(columns.len(), columns.len(), |i, k| {
        columns[i].zip(columns[k]).map_or(0.0, |at| whole[at])
    }))
}

/// Columns of the covariance that belong to x, y, z of a cable's entry point.
fn entry_point_columns(solution: &Solution, cable: usize) -> [Option<usize>; 3] {
    [0, 1, 2].map(|axis| {
        let id = ParameterId::EntryPoint { cable, axis };
        solution.parameters.iter().position(|p| p.id == id)
    })
}

/// Probability that noise alone causes a displacement at least as improbable as `by` (m), given its `covariance` (m^2):
/// `d^T P^-1 d` is chi-square with as many degrees of freedom as there are estimated coordinates, which are those with a
/// variance. `None` if there are none, or if the covariance is not positive.
#[must_use]
pub fn chance_of_noise(by: &Vec3, covariance: &Matrix3<f64>) -> Option<f64> {
    let known: Vec<usize> = (0..3).filter(|k| covariance[(*k, *k)] > 0.0).collect();
    if known.is_empty() {
        return None;
    }
    let own = covariance.select_rows(&known).select_columns(&known);
    let by = DVector::from_iterator(known.len(), known.iter().map(|k| by[*k]));
    let solved = own.cholesky()?.solve(&by);
    chi_square_survival(by.dot(&solved), known.len() as f64)
}

/// A coordinate of a pulley's entry point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulleyCoordinate {
    /// Identified less nominal (m).
    pub change_m: f64,
    /// Standard deviation of the change (m): 0 if the coordinate was given, `None` if the data do not determine it.
    pub sd_m: Option<f64>,
    /// Prior standard deviation of the nominal value (m), if the description states one.
    pub prior_sd_m: Option<f64>,
}

/// Correlation of the errors of a coordinate of the pulley with those of another pulley.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoordinateCorrelation {
    /// Axis of this pulley: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// The other pulley, by the index of its cable, and its axis.
    pub other: (usize, usize),
    /// Correlation coefficient, -1 to 1.
    pub value: f64,
}

/// Summary of a pulley.
#[derive(Debug, Clone, PartialEq)]
pub struct PulleyInspection {
    /// Index of its cable.
    pub cable: usize,
    /// Name of its cable.
    pub name: String,
    /// Radius of the pulley (m); 0 for an eyelet.
    pub radius_m: f64,
    /// Nominal entry point (m, base frame).
    pub nominal_m: Vec3,
    /// Result of the identification, if there is one.
    pub identified: Option<IdentifiedPulley>,
    /// Prior standard deviations of the nominal coordinates (m), if the description states them.
    pub prior_sd_m: [Option<f64>; 3],
}

/// Identified position of a pulley.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifiedPulley {
    /// Identified entry point (m, base frame).
    pub entry_m: Vec3,
    /// Covariance of the entry point, see [`entry_point_covariance`].
    pub covariance: Option<Matrix3<f64>>,
    /// Coordinates x, y, z.
    pub coordinates: [PulleyCoordinate; 3],
    /// The strongest correlations with coordinates of other pulleys, the strongest first.
    pub correlations: Vec<CoordinateCorrelation>,
}

impl PulleyInspection {
    /// The pulley of a cable of `robot`, which provides the nominal coordinates; `None` without such a cable.
    #[must_use]
    pub fn of(robot: &Robot, fit: Option<&Identification>, cable: usize) -> Option<Self> {
        let drawn = robot.cables.get(cable)?;
        let nominal_m = Vec3::from(drawn.pulley.entry_point_m);
        let prior_sd_m = drawn.pulley.entry_point_sd_m.each();
        let identified = fit.and_then(|fit| {
            let entry_m = Vec3::from(*fit.solution.globals.entry_points.get(cable)?);
            let solution = &fit.solution;
            let columns = entry_point_columns(solution, cable);
            let coordinates = [0, 1, 2].map(|axis| PulleyCoordinate {
                change_m: entry_m[axis] - nominal_m[axis],
                sd_m: entry_point_sd(solution, cable, axis),
                prior_sd_m: prior_sd_m[axis],
            });
            Some(IdentifiedPulley {
                entry_m,
                covariance: entry_point_covariance(solution, cable),
                coordinates,
                correlations: correlations(solution, cable, columns),
            })
        });
        Some(Self {
            cable,
            name: drawn.name.clone(),
            radius_m: drawn.pulley.radius_m,
            nominal_m,
            identified,
            prior_sd_m,
        })
    }

    /// Identified less nominal (m), if it was identified.
    #[must_use]
    pub fn displacement_m(&self) -> Option<Vec3> {
        Some(self.identified.as_ref()?.entry_m - self.nominal_m)
    }

    /// The displacement of the pulley, judged by its uncertainty, as a sentence. If the model does not explain the data
    /// (`is_explained` is false), the uncertainty is not valid and the displacement is not judged.
    #[must_use]
    pub fn sentence(&self, is_explained: bool) -> String {
        let (Some(found), Some(by)) = (&self.identified, self.displacement_m()) else {
            return "Nothing is identified yet: the pulley is shown where the drawing has it."
                .to_owned();
        };
        let Some(covariance) = &found.covariance else {
            let given = found.coordinates.iter().all(|c| c.sd_m == Some(0.0));
            return match given {
                true => "The position of this pulley was given, not identified.".to_owned(),
                false => "The data do not determine the position of this pulley.".to_owned(),
            };
        };
        let length = by.norm();
        let along = by.try_normalize(0.0).unwrap_or_else(Vec3::x);
        let sd = along.dot(&(covariance * along)).max(0.0).sqrt();
        let size = size(length, sd);
        if !is_explained {
            return format!(
                "{size} mm from the drawing. The model does not explain the data: the uncertainty is larger than shown, and the displacement may come from unmodelled effects."
            );
        }
        let Some(chance) = chance_of_noise(&by, covariance) else {
            return format!("{size} mm from the drawing.");
        };
        let often = odds(chance);
        let judged = match chance {
            p if p > NOISE => format!("within its uncertainty: noise alone would cause it {often}"),
            p if p < CLEAR => {
                format!("more than its uncertainty: noise alone would cause it {often}")
            }
            _ => format!("unclear whether it is more than noise, which would cause it {often}"),
        };
        format!("{size} mm from the drawing, {judged}.")
    }
}

/// A length with its standard deviation (m) in millimetres: `0.83 ± 0.05`.
fn size(length_m: f64, sd_m: f64) -> String {
    let (length, sd) = (1e3 * length_m, 1e3 * sd_m);
    if !(sd.is_finite() && sd > 0.0) {
        return fixed(length, 2);
    }
    let decimals = decimals(sd).min(4);
    format!("{} ± {}", fixed(length, decimals), fixed(sd, decimals))
}

fn correlations(
    solution: &Solution,
    cable: usize,
    columns: [Option<usize>; 3],
) -> Vec<CoordinateCorrelation> {
    let Some(covariance) = &solution.covariance else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for (axis, own) in columns.into_iter().enumerate() {
        let Some(own) = own else {
            continue;
        };
        for (column, parameter) in solution.parameters.iter().enumerate() {
            let ParameterId::EntryPoint { cable: of, axis: k } = parameter.id else {
                continue;
            };
            let sds = (covariance[(own, own)] * covariance[(column, column)]).sqrt();
            if of != cable && sds > 0.0 {
                found.push(CoordinateCorrelation {
                    axis,
                    other: (of, k),
                    value: covariance[(own, column)] / sds,
                });
            }
        }
    }
    found.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    found.truncate(LISTED);
    found
}

impl CoordinateCorrelation {
    /// The coordinates and the coefficient: `x with z of cable-4: +0.83`.
    #[must_use]
    pub fn name(&self, robot: &Robot) -> String {
        let (cable, axis) = self.other;
        let name = robot.cables.get(cable).map_or("", |cable| &cable.name);
        let (own, other) = (AXES[self.axis], AXES[axis]);
        format!("{own} with {other} of {name}: {}", signed(self.value, 2))
    }

    /// The meaning of the correlation in words.
    #[must_use]
    pub fn words(&self) -> &'static str {
        let together = self.value > 0.0;
        match (self.value.abs(), together) {
            (r, true) if r > 0.95 => "hardly separable: only their difference is well known",
            (r, false) if r > 0.95 => "hardly separable: only their sum is well known",
            (r, true) if r > 0.7 => "strong: they err in the same direction",
            (r, false) if r > 0.7 => "strong: they err in opposite directions",
            (r, true) if r > 0.4 => "moderate: they tend to err in the same direction",
            (r, false) if r > 0.4 => "moderate: they tend to err in opposite directions",
            _ => "weak: nearly independent",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::samples::identified;

    #[test]
    fn an_inspection_has_the_numbers_of_the_solution() {
        let fit = identified();
        let robot = &fit.dataset.robot;
        for cable in 0..robot.cable_count() {
            let seen = PulleyInspection::of(robot, Some(&fit), cable).expect("a cable");
            let found = seen.identified.as_ref().expect("identified");
            assert_eq!(
                <[f64; 3]>::from(found.entry_m),
                fit.solution.globals.entry_points[cable]
            );
            let covariance = found.covariance.expect("it is determined");
            for (axis, coordinate) in found.coordinates.iter().enumerate() {
                let sd = coordinate.sd_m.expect("determined or given");
                assert!((sd * sd - covariance[(axis, axis)]).abs() < 1e-18);
                let change = found.entry_m[axis] - robot.cables[cable].pulley.entry_point_m[axis];
                assert!((coordinate.change_m - change).abs() < 1e-15);
            }
            let whole = fit.solution.correlations().expect("determined");
            let own: Vec<usize> = (0..whole.nrows())
                .filter(|k| is_of(&fit, *k, Some(cable)))
                .collect();
            let others: Vec<usize> = (0..whole.nrows())
                .filter(|k| is_of(&fit, *k, None) && !own.contains(k))
                .collect();
            let all = own
                .iter()
                .flat_map(|i| others.iter().map(|k| whole[(*i, *k)].abs()));
            let largest = all.fold(0.0, f64::max);
            let first = found.correlations.first().expect("a correlation");
            assert!((first.value.abs() - largest).abs() < 1e-9, "{first:?}");
            assert!(
                found
                    .correlations
                    .is_sorted_by(|a, b| a.value.abs() >= b.value.abs())
            );
        }
        assert!(PulleyInspection::of(robot, Some(&fit), 99).is_none());
    }

    /// Whether a parameter is a coordinate of a pulley, of the cable `of` if one is given.
    fn is_of(fit: &Identification, index: usize, of: Option<usize>) -> bool {
        matches!(
            fit.solution.parameters[index].id,
            ParameterId::EntryPoint { cable, .. } if of.is_none_or(|of| of == cable)
        )
    }

    #[test]
    fn noise_alone_exceeds_the_bound_as_often_as_it_should() {
        // Upper 5 % points of chi-square from tables: 3.841, 5.991 and 7.815 for one, two and three degrees of freedom.
        for (sd, quantile) in [
            ([1e-3, 0.0, 0.0], 3.841_f64),
            ([1e-3, 0.0, 2e-3], 5.991),
            ([1e-3, 3e-3, 2e-3], 7.815),
        ] {
            let covariance = Matrix3::from_diagonal(&Vec3::from(sd).map(|s| s * s));
            let by = Vec3::x() * (1e-3 * quantile.sqrt());
            let chance = chance_of_noise(&by, &covariance).expect("determined");
            assert!((chance - 0.05).abs() < 1e-4, "{sd:?}: {chance}");
        }
        assert!(chance_of_noise(&Vec3::x(), &Matrix3::zeros()).is_none());
    }

    #[test]
    fn a_sentence_says_how_far_and_whether_that_is_noise() {
        let fit = identified();
        let robot = &fit.dataset.robot;
        let nothing = PulleyInspection::of(robot, None, 0).expect("a cable");
        assert!(
            nothing
                .sentence(true)
                .starts_with("Nothing is identified yet")
        );
        let mut seen = PulleyInspection::of(robot, Some(&fit), 0).expect("a cable");
        let mut say = |by_mm: f64| {
            let nominal = seen.nominal_m;
            let found = seen.identified.as_mut().expect("identified");
            found.covariance = Some(Matrix3::identity() * 1e-8);
            found.entry_m = nominal + Vec3::y() * (1e-3 * by_mm);
            [true, false].map(|is_explained| seen.sentence(is_explained))
        };
        assert_eq!(
            say(0.1)[0],
            "0.10 ± 0.10 mm from the drawing, within its uncertainty: noise alone would cause it 80 times in 100."
        );
        assert!(say(0.3)[0].contains("unclear whether it is more than noise"));
        assert_eq!(
            say(5.0)[0],
            "5.00 ± 0.10 mm from the drawing, more than its uncertainty: noise alone would cause it less than once in a million times."
        );
        let unexplained = &say(5.0)[1];
        assert!(unexplained.starts_with("5.00 ± 0.10 mm from the drawing. The model does not"));
    }
}
