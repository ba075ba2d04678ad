//! Bands around the nominal position of a pulley: 95 % region of the drawing, and tolerance.

use nalgebra::Matrix3;
use tautline_core::geometry::Vec3;

use super::options::{ArrowColour, Options};
use super::{Drawing, region};
use crate::theme::Palette;
use crate::views::robot_3d::parts::{SolidPart, paint};
use crate::views::robot_3d::scene::{CableView, Reference, Scene};

/// Opacity of bands.
const OPACITY: f32 = 0.1;

/// Region around the nominal position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Band {
    /// 95 % region of the pulley from the drawing alone.
    Prior,
    /// Tolerance of the displacement.
    Tolerance,
}

impl Band {
    /// All bands, usually the larger one first.
    pub const ALL: [Self; 2] = [Self::Prior, Self::Tolerance];
}

/// Transformation from the unit sphere to a band of a cable's pulley; `None` if it is not drawn. The inspected pulley
/// has all known bands, the others only their tolerance while displacements are coloured by it.
#[must_use]
pub fn band(band: Band, scene: &Scene, index: usize, options: &Options) -> Option<Matrix3<f64>> {
    let cable = scene.cables.get(index)?;
    let is_inspected = options.inspected == Some(index);
    let is_asked = match options.inspected {
        Some(inspected) => inspected == index,
        None => options.arrow_colour_of(scene) == ArrowColour::Tolerance,
    };
    // Neither is known for the pulleys of another session.
    if scene.reference != Reference::Drawing || !is_asked || cable.moved.is_none() {
        return None;
    }
    match band {
        Band::Prior if is_inspected && options.ellipsoids => prior(cable),
        Band::Prior => None,
        Band::Tolerance => {
            let radius_m = scene.tolerance_m? * options.exaggeration_of(scene);
            Some(Matrix3::identity() * radius_m)
        }
    }
}

/// 95 % region of the drawing; `None` if a coordinate has no tolerance.
fn prior(cable: &CableView) -> Option<Matrix3<f64>> {
    let [Some(x), Some(y), Some(z)] = cable.prior_sd_m else {
        return None;
    };
    let variances = Vec3::new(x, y, z).map(|sd| sd * sd);
    region(&Matrix3::from_diagonal(&variances), 1.0)
}

/// Whether a band is drawn at any pulley.
#[must_use]
pub fn is_drawn(one: Band, scene: &Scene, options: &Options) -> bool {
    (0..scene.cables.len()).any(|index| band(one, scene, index, options).is_some())
}

#[must_use]
pub fn band_colour(band: Band, palette: &Palette) -> egui::Color32 {
    match band {
        Band::Prior => palette.ghost,
        Band::Tolerance => palette.good,
    }
}

impl Drawing {
    /// Draws the bands of a cable's pulley.
    pub(super) fn bands(
        &mut self,
        scene: &Scene,
        index: usize,
        options: &Options,
        palette: &Palette,
    ) {
        let Some(moved) = scene.cables.get(index).and_then(|cable| cable.moved) else {
            return;
        };
        for one in Band::ALL {
            if let Some(shape) = band(one, scene, index, options) {
                let colour = paint(band_colour(one, palette), OPACITY);
                self.glass
                    .push(SolidPart::ellipsoid(&moved.from, &shape, colour));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;

    use super::*;
    use crate::views::robot_3d::scene::{Displacement, SceneInputs};

    fn scene() -> Scene {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        scene.reference = Reference::Drawing;
        scene.tolerance_m = Some(2e-3);
        for cable in &mut scene.cables {
            cable.moved = Some(Displacement {
                from: cable.wheel.entry,
                by: Vec3::new(1e-3, 0.0, 0.0),
                covariance: None,
                is_explained: true,
                moved: None,
            });
        }
        scene
    }

    #[test]
    fn the_inspected_pulley_has_the_bands_of_drawing_and_tolerance_true_to_scale() {
        let scene = scene();
        let options = Options {
            inspected: Some(2),
            ..Options::default()
        };
        // MINI's drawing has 8 mm; the 95 % point of chi-square with three degrees of freedom is 7.815.
        let prior = band(Band::Prior, &scene, 2, &options).expect("the drawing's");
        assert!((prior[(0, 0)] - 8e-3 * 7.815_f64.sqrt()).abs() < 1e-12);
        let tolerance = band(Band::Tolerance, &scene, 2, &options).expect("the tolerance");
        assert_eq!(tolerance, Matrix3::identity() * 2e-3);
        for one in Band::ALL {
            assert_eq!(band(one, &scene, 3, &options), None, "of others nothing");
        }
    }

    #[test]
    fn all_tolerances_are_magnified_like_the_displacements_that_they_judge() {
        let mut scene = scene();
        let mut options = Options {
            exaggeration: Some(10.0),
            ..Options::default()
        };
        assert!(!is_drawn(Band::Tolerance, &scene, &options));
        options.arrow_colour = ArrowColour::Tolerance;
        let tolerance = band(Band::Tolerance, &scene, 5, &options).expect("the tolerance");
        assert!((tolerance[(1, 1)] - 20e-3).abs() < 1e-15);
        assert!(!is_drawn(Band::Prior, &scene, &options));
        scene.tolerance_m = None;
        assert!(!is_drawn(Band::Tolerance, &scene, &options));
    }
}
