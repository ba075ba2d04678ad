//! Pose of a rigid body from the markers on it.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use tautline_core::geometry::{Pose, Vec3};

/// Minimum number of markers that define an orientation.
pub(crate) const FEWEST: usize = 3;
/// Alternations between fitting poses and points.
const ROUNDS: usize = 10;
/// Points are collinear if their extent across a line is below this fraction of that along it.
const ON_A_LINE: f64 = 1e-2;

/// Marker positions at one instant; `None` for those not seen.
pub(super) type MarkerPositions = Vec<Option<Vec3>>;

/// Markers on one rigid body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RigidBody {
    /// Positions of the markers in the body's frame (m), for those seen together with enough others.
    pub points_m: MarkerPositions,
}

impl RigidBody {
    /// The rigid body of these markers. The origin of its frame is their centroid, its axes are those of the instrument's frame
    /// at the first instant at which most of them were seen.
    ///
    /// Positions are means over all instants (generalised Procrustes analysis, DOI 10.1007/BF02291478).
    ///
    /// # Errors
    /// If no three of them were ever seen at once, or they are collinear.
    pub fn of(moments: &[MarkerPositions]) -> Result<Self, String> {
        let count = |seen: &MarkerPositions| seen.iter().flatten().count();
        let most = moments.iter().map(count).max().unwrap_or(0);
        let first = moments.iter().find(|seen| count(seen) == most);
        let Some(first) = first.filter(|_| most >= FEWEST) else {
            return Err(format!(
                "found at most {most} markers at once, expected {FEWEST} or more"
            ));
        };
        let mut body = Self {
            points_m: centred(first),
        };
        if !is_spread(&body.points_m.iter().flatten().copied().collect::<Vec<_>>()) {
            return Err("found collinear markers, expected three or more that are not".to_owned());
        }
        for _ in 0..ROUNDS {
            body = body.refined(moments);
        }
        Ok(body)
    }

    /// The pose at one instant, or `None` if fewer than three markers were seen.
    pub fn pose(&self, seen: &MarkerPositions) -> Option<Pose> {
        let (known, found) = self.pairs(seen);
        if known.len() < FEWEST || !is_spread(&known) {
            return None;
        }
        fit_pose(&known, &found)
    }

    /// Root mean square distance between the markers and their fitted positions (m).
    pub fn rms_m(&self, moments: &[MarkerPositions]) -> f64 {
        let mut squares = (0.0, 0_usize);
        for seen in moments {
            let Some(pose) = self.pose(seen) else {
                continue;
            };
            let (known, found) = self.pairs(seen);
            for (known, found) in known.iter().zip(&found) {
                squares.0 += (pose.transform(known) - found).norm_squared();
                squares.1 += 1;
            }
        }
        (squares.0 / squares.1.max(1) as f64).sqrt()
    }

    /// Positions in the body's frame and observed positions of the markers with both.
    fn pairs(&self, seen: &MarkerPositions) -> (Vec<Vec3>, Vec<Vec3>) {
        let both = self.points_m.iter().zip(seen);
        both.filter_map(|(known, found)| known.zip(*found)).unzip()
    }

    fn refined(&self, moments: &[MarkerPositions]) -> Self {
        let mut sums = vec![(Vec3::zeros(), 0_usize); self.points_m.len()];
        for seen in moments {
            let Some(pose) = self.pose(seen) else {
                continue;
            };
            let back = pose.orientation.inverse();
            for (sum, found) in sums.iter_mut().zip(seen) {
                if let Some(found) = found {
                    sum.0 += back * (found - pose.position);
                    sum.1 += 1;
                }
            }
        }
        let means = sums
            .iter()
            .map(|(sum, n)| (*n > 0).then(|| sum / *n as f64));
        Self {
            points_m: centred(&means.collect()),
        }
    }
}

fn centred(points: &MarkerPositions) -> MarkerPositions {
    let known = points.iter().flatten();
    let middle = known.clone().sum::<Vec3>() / known.count().max(1) as f64;
    points
        .iter()
        .map(|point| point.map(|p| p - middle))
        .collect()
}

/// Whether points are not collinear.
pub(super) fn is_spread(points: &[Vec3]) -> bool {
    let middle = points.iter().sum::<Vec3>() / points.len().max(1) as f64;
    let scatter = points.iter().fold(Matrix3::zeros(), |sum, point| {
        let arm = point - middle;
        sum + arm * arm.transpose()
    });
    let mut sizes: Vec<f64> = scatter.symmetric_eigenvalues().iter().copied().collect();
    sizes.sort_by(f64::total_cmp);
    sizes[1] > ON_A_LINE * ON_A_LINE * sizes[2]
}

/// The pose that takes points closest to others, `to = r + R from` by least squares (Umeyama 1991, DOI 10.1109/34.88573).
/// `None` if they are collinear or none.
pub(super) fn fit_pose(from: &[Vec3], to: &[Vec3]) -> Option<Pose> {
    let count = from.len() as f64;
    let [middle, target] = [from, to].map(|points| points.iter().sum::<Vec3>() / count);
    let pairs = from.iter().zip(to);
    let covariance = pairs.fold(Matrix3::zeros(), |sum, (a, b)| {
        sum + (b - target) * (a - middle).transpose()
    });
    let svd = covariance.try_svd(true, true, f64::EPSILON, 0)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    // A reflection is not a rotation: the direction of the smallest singular value is reversed.
    let mut sign = Matrix3::identity();
    sign[(2, 2)] = (u * v_t).determinant().signum();
    let rotation = Rotation3::from_matrix_unchecked(u * sign * v_t);
    let orientation = UnitQuaternion::from_rotation_matrix(&rotation);
    let is_known = orientation.coords.iter().all(|v| v.is_finite());
    is_known.then(|| Pose {
        position: target - orientation * middle,
        orientation,
    })
}
