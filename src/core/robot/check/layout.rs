//! Checks of pulleys and anchors together, and of the size of the frame they span.

use super::super::{Cable, Robot};
use super::{Checked, FieldError};
use crate::geometry::{Pose, Vec3};
use crate::kinematics::check_path_at;

/// A larger frame is that of a telescope, or one of half a metre that is described in millimetres ...
const LARGEST_FRAME_M: f64 = 500.0;
/// ... by entry points alone, so that its drums are smaller than this fraction of it, or by all its lengths, so that its platform is
/// larger than that one. The cabin of FAST has a hundredth of its frame of 600 m, drums a three-hundredth.
const LARGE_FRAME_SHARES: [f64; 2] = [0.001, 0.03];
/// Pulleys closer than this fraction of the frame coincide (Jin et al. 2018 print two within
/// 1.3 % of MINI's frame) ...
const SAME_PLACE_SHARE: f64 = 0.02;
/// ... but on large frames, two pulleys on one post can be a few decimetres apart.
const SAME_PLACE_AT_MOST_M: f64 = 0.1;
impl Robot {
    /// Size of the frame (m): the largest distance between two pulleys, or with one cable the distance from
    /// the pulley to the home position. `None` if neither is known.
    #[must_use]
    pub fn frame_size_m(&self) -> Option<f64> {
        let mut points: Vec<Vec3> = self.cables.iter().map(entry_point).collect();
        if let ([_], Some(home)) = (points.as_slice(), &self.home) {
            points.push(home.position_m.into());
        }
        let size = points
            .iter()
            .enumerate()
            .flat_map(|(i, a)| points[..i].iter().map(move |b| (a - b).norm()))
            .fold(0.0, f64::max);
        (size > 0.0).then_some(size)
    }

    /// Diagonal of the bounding box of the entry points (m).
    pub(crate) fn frame_diagonal_m(&self) -> f64 {
        let extent = |axis: usize| {
            let points = self.cables.iter().map(|c| c.pulley.entry_point_m[axis]);
            let (low, high) = points.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
            high - low
        };
        extent(0).hypot(extent(1)).hypot(extent(2))
    }

    pub(super) fn check_layout(&self) -> Checked {
        if let Some(size_m) = self.frame_size_m() {
            self.check_units(size_m)?;
            self.check_pulleys_apart(size_m)?;
        } else if self.cables.len() > 1 {
            let message = "found all pulleys in one place, expected different entry points";
            return fail("/cables/1/pulley/entry_point_m".into(), message.into());
        }
        self.home
            .map_or(Ok(()), |home| self.check_reach(&home.pose()))
    }

    fn check_units(&self, size_m: f64) -> Checked {
        if size_m > LARGEST_FRAME_M && !self.has_parts_of_a_large_frame(size_m) {
            let message = format!(
                "found pulleys {size_m:.1} m apart, expected at most {LARGEST_FRAME_M} m: \
                 the entry points look like millimetres"
            );
            return fail("/cables/0/pulley/entry_point_m".into(), message);
        }
        for (i, cable) in self.cables.iter().enumerate() {
            let arm_m = Vec3::from(cable.platform_anchor_m).norm();
            if arm_m > 3.0 * size_m {
                let message = format!(
                    "found an anchor {arm_m:.3} m from the platform's origin in a frame of \
                     {size_m:.3} m, expected a platform that fits into the frame"
                );
                return fail(format!("/cables/{i}/platform_anchor_m"), message);
            }
        }
        match &self.home {
            Some(home) if Vec3::from(home.position_m).norm() > 10.0 * self.reach_m(size_m) => {
                let message = format!(
                    "found a place far outside the frame of {size_m:.3} m: \
                     it looks like millimetres"
                );
                fail("/home/position_m".into(), message)
            }
            _ => Ok(()),
        }
    }

    fn has_parts_of_a_large_frame(&self, size_m: f64) -> bool {
        let [smallest_drum, largest_platform] = LARGE_FRAME_SHARES.map(|share| share * size_m);
        self.cables.iter().all(|cable| {
            cable.winch.drum_diameter_m > smallest_drum
                && Vec3::from(cable.platform_anchor_m).norm() < largest_platform
        })
    }

    /// Distance from the origin within which all parts of the robot are expected (m).
    fn reach_m(&self, size_m: f64) -> f64 {
        let farthest = self.cables.iter().map(|c| entry_point(c).norm());
        farthest.fold(size_m, f64::max)
    }

    fn check_pulleys_apart(&self, size_m: f64) -> Checked {
        let limit_m = (SAME_PLACE_SHARE * size_m).min(SAME_PLACE_AT_MOST_M);
        for (i, cable) in self.cables.iter().enumerate() {
            for other in &self.cables[..i] {
                let distance_m = (entry_point(cable) - entry_point(other)).norm();
                let is_possible =
                    self.are_parallel(cable, other) || leave_one_eyelet(cable, other, limit_m);
                if distance_m < limit_m && !is_possible {
                    let message = format!(
                        "found {:.1} mm from the pulley of {:?}, expected pulleys at least \
                         {:.1} mm apart: two pulleys in one place",
                        distance_m * 1e3,
                        other.name,
                        limit_m * 1e3
                    );
                    return fail(format!("/cables/{i}/pulley/entry_point_m"), message);
                }
            }
        }
        Ok(())
    }

    /// Whether two cables run side by side: their anchors differ as their pulleys do.
    fn are_parallel(&self, cable: &Cable, other: &Cable) -> bool {
        let home = self.home.map_or_else(Pose::identity, |home| home.pose());
        let arm = Vec3::from(cable.platform_anchor_m) - Vec3::from(other.platform_anchor_m);
        let offset = entry_point(cable) - entry_point(other);
        (offset - home.orientation * arm).norm() < 0.5 * offset.norm()
    }

    /// Checks that every cable has a path to its anchor with the platform at `pose`.
    ///
    /// # Errors
    /// Names the first cable that has none.
    pub fn check_reach(&self, pose: &Pose) -> Result<(), FieldError> {
        for (i, cable) in self.cables.iter().enumerate() {
            if let Err(error) = check_path_at(cable, pose) {
                let message =
                    format!("found that {error}, expected the anchor clear of the pulley");
                return fail(format!("/cables/{i}/platform_anchor_m"), message);
            }
        }
        Ok(())
    }
}

/// Whether two cables to different anchors may leave one point: through one eyelet, as those of a RoboCrane do; pulleys would
/// need room.
fn leave_one_eyelet(cable: &Cable, other: &Cable, limit_m: f64) -> bool {
    let arm = Vec3::from(cable.platform_anchor_m) - Vec3::from(other.platform_anchor_m);
    cable.pulley.radius_m == 0.0 && other.pulley.radius_m == 0.0 && arm.norm() >= limit_m
}

fn entry_point(cable: &Cable) -> Vec3 {
    cable.pulley.entry_point_m.into()
}

fn fail(pointer: String, message: String) -> Checked {
    Err(FieldError { pointer, message })
}
