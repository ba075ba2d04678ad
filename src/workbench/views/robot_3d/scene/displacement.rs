//! Displacements of pulleys from the drawing or another session, and positions as drawn.

use nalgebra::Matrix3;
use tautline_core::geometry::Vec3;

use super::{Reference, Scene, Wheel};
use tautline_session::DecisionRule;
use tautline_workflow::identification::{CLEAR, NOISE, chance_of_noise};
use tautline_workflow::report::tolerance::Conformity;

/// Significance of a displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Significance {
    /// The uncertainty is unknown, or the model does not explain the data.
    Unknown,
    /// Noise alone exceeds it more often than once in 20 times.
    Noise,
    /// Between [`Self::Noise`] and [`Self::Clear`].
    Unclear,
    /// Noise alone exceeds it less often than once in 1000 times.
    Clear,
}

impl Significance {
    /// All with a known uncertainty, in ascending order.
    pub const KNOWN: [Self; 3] = [Self::Noise, Self::Unclear, Self::Clear];

    /// Text for the operator.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Unknown => "uncertainty not valid",
            Self::Noise => "within the uncertainty",
            Self::Unclear => "unclear",
            Self::Clear => "beyond the uncertainty",
        }
    }
}

/// Displacement of a pulley by the identification, or between two sessions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement {
    /// Entry point of the drawing, or of the first session (m).
    pub from: Vec3,
    /// Identified minus nominal, or second minus first (m).
    pub by: Vec3,
    /// Covariance (m^2), if the data determine it; coordinates that were not estimated have no variance.
    pub covariance: Option<Matrix3<f64>>,
    /// Whether the model explains the data; otherwise the covariance is meaningless.
    pub is_explained: bool,
    /// Whether the pulley moved, if a comparison has decided that.
    pub moved: Option<bool>,
}

impl Displacement {
    /// Length plus three standard deviations of the least certain coordinate (m).
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        let variance = self.covariance.map_or(0.0, |c| c.diagonal().max());
        self.by.norm() + 3.0 * variance.max(0.0).sqrt()
    }

    /// Number of estimated coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        let covariance = self.covariance.unwrap_or_default();
        (0..3).filter(|k| covariance[(*k, *k)] > 0.0).count()
    }

    /// Conformity with a tolerance (m), as in the certificate.
    #[must_use]
    pub fn conformity(&self, rule: DecisionRule, tolerance_m: f64) -> Conformity {
        let covariance = self.covariance.filter(|_| self.is_explained);
        Conformity::of(rule, &self.by, covariance.as_ref(), tolerance_m)
    }

    #[must_use]
    pub fn significance(&self) -> Significance {
        let chance = self
            .covariance
            .filter(|_| self.is_explained)
            .and_then(|covariance| chance_of_noise(&self.by, &covariance));
        match (self.moved, chance) {
            (Some(true), _) => Significance::Clear,
            (Some(false), _) => Significance::Noise,
            (None, None) => Significance::Unknown,
            (None, Some(chance)) if chance > NOISE => Significance::Noise,
            (None, Some(chance)) if chance < CLEAR => Significance::Clear,
            (None, Some(_)) => Significance::Unclear,
        }
    }
}

/// Cable with its pulleys as drawn, with the displacement magnified.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedCable {
    /// Points from the winch's side over the pulley to the platform (m).
    pub path: Vec<Vec3>,
    pub wheel: Wheel,
    /// Second pulley, of the drawing or another session.
    pub other: Option<Wheel>,
}

impl Wheel {
    /// Wheel shifted by a vector.
    fn shifted(&self, by: &Vec3) -> Self {
        Self {
            entry: self.entry + by,
            centre: self.centre + by,
            ..*self
        }
    }
}

impl Scene {
    /// Cable with its pulleys as drawn, with displacements magnified by a factor. The end at the platform stays; the
    /// cable follows its pulley. An index beyond the cables has an empty path.
    #[must_use]
    pub fn placed(&self, index: usize, magnification: f64) -> PlacedCable {
        let Some(cable) = self.cables.get(index) else {
            return PlacedCable {
                path: Vec::new(),
                wheel: Wheel {
                    entry: Vec3::zeros(),
                    centre: Vec3::zeros(),
                    normal: Vec3::z(),
                    radius_m: 0.0,
                },
                other: None,
            };
        };
        let by = cable.moved.map_or_else(Vec3::zeros, |moved| moved.by);
        let more = by * (magnification - 1.0);
        if matches!(self.reference, Reference::Other(_)) {
            // The first session is drawn at its true position.
            return PlacedCable {
                path: cable.path.clone(),
                wheel: cable.wheel,
                other: cable.nominal.map(|wheel| wheel.shifted(&more)),
            };
        }
        let path = match (cable.path.last(), cable.free_m) {
            (Some(anchor), Some(free_m)) if free_m > 0.0 => {
                let follows = |p: &Vec3| p + more * ((p - anchor).norm() / free_m).min(1.0);
                cable.path.iter().map(follows).collect()
            }
            _ => cable.path.clone(),
        };
        PlacedCable {
            path,
            wheel: cable.wheel.shifted(&more),
            other: cable.nominal,
        }
    }

    /// Whether a pulley did not move in a comparison in which another one did.
    #[must_use]
    pub fn is_unmoved_beside_others(&self, cable: usize) -> bool {
        let moved = |index: usize| self.cables.get(index)?.moved?.moved;
        let is_unmoved = moved(cable) == Some(false);
        is_unmoved && (0..self.cables.len()).any(|index| moved(index) == Some(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn displacement(by: [f64; 3], sd: [f64; 3]) -> Displacement {
        Displacement {
            from: Vec3::zeros(),
            by: by.into(),
            covariance: Some(Matrix3::from_diagonal(&Vec3::from(sd.map(|s| s * s)))),
            is_explained: true,
            moved: None,
        }
    }

    #[test]
    fn significance_follows_the_chi_square_of_the_estimated_coordinates() {
        // Upper 5 % points of chi-square from tables: 3.841 for one and 7.815 for three degrees of freedom.
        for (by, sd, expected) in [
            ([1.9e-3, 0.0, 0.0], [1e-3, 0.0, 0.0], Significance::Noise),
            ([2.0e-3, 0.0, 0.0], [1e-3, 0.0, 0.0], Significance::Unclear),
            ([2.0e-3, 0.0, 0.0], [1e-3, 1e-3, 1e-3], Significance::Noise),
            ([2.0e-3, 2.1e-3, 0.0], [1e-3; 3], Significance::Unclear),
            ([4.1e-3, 0.0, 0.0], [1e-3; 3], Significance::Clear),
        ] {
            assert_eq!(displacement(by, sd).significance(), expected, "{by:?}");
        }
        let mut unknown = displacement([1e-3; 3], [0.0; 3]);
        assert_eq!(unknown.significance(), Significance::Unknown);
        unknown.covariance = None;
        assert_eq!(unknown.significance(), Significance::Unknown);
        unknown.moved = Some(true);
        assert_eq!(unknown.significance(), Significance::Clear);
    }

    #[test]
    fn a_tolerance_is_judged_by_the_least_certain_direction_and_only_where_the_model_holds() {
        for (by, sd, expected) in [
            ([1.0e-3, 0.0, 0.0], [1e-4, 1e-4, 4e-4], Conformity::Within),
            (
                [1.0e-3, 0.0, 0.0],
                [1e-4, 1e-4, 6e-4],
                Conformity::Undecided,
            ),
            ([3.0e-3, 0.0, 0.0], [1e-4, 1e-4, 4e-4], Conformity::Outside),
        ] {
            assert_eq!(
                displacement(by, sd).conformity(DecisionRule::default(), 2e-3),
                expected
            );
        }
        let mut wrong = displacement([1e-3, 0.0, 0.0], [1e-4; 3]);
        wrong.is_explained = false;
        assert_eq!(
            wrong.conformity(DecisionRule::default(), 2e-3),
            Conformity::Undecided
        );
    }
}
