//! Path of the selected pulley over several dates.

use egui::Color32;

use super::options::Options;
use super::{Drawing, faded};
use crate::model::Selection;
use crate::theme::Palette;
use crate::views::robot_3d::scene::Scene;

/// Width of the path (points of the screen).
const WIDTH: f32 = 2.6;
/// Diameter of a date, of the shown date, and width of its ring (points of the screen).
const DATE: f32 = 6.0;
const SHOWN: f32 = 14.0;
const RING: f32 = 2.5;

/// Cable whose pulley's path is drawn.
fn cable_with_path(scene: &Scene, options: &Options, selection: Selection) -> Option<usize> {
    let cable = selection.cable.filter(|_| options.arrows)?;
    let known = scene.paths.as_ref()?.by.get(cable)?;
    (options.inspected.is_none() && known.len() > 1).then_some(cable)
}

/// Colours of the path until the shown date, and after it.
fn path_colours(palette: &Palette) -> [Color32; 2] {
    [palette.accent, faded(palette.accent, palette)]
}

impl Drawing {
    /// Draws the path of the selected pulley: a point for each date, with a ring around the shown one.
    pub(super) fn path(
        &mut self,
        scene: &Scene,
        options: &Options,
        selection: Selection,
        palette: &Palette,
    ) {
        let Some(cable) = cable_with_path(scene, options, selection) else {
            return;
        };
        let date = scene.paths.as_ref().map_or(0, |paths| paths.date);
        let places = scene.path_of(cable, options.exaggeration_of(scene));
        let [before, after] = path_colours(palette);
        let colour = |index: usize| if index <= date { before } else { after };
        for (index, ends) in (1..).zip(places.windows(2)) {
            self.lines.push([ends[0], ends[1]], colour(index), WIDTH);
        }
        for (index, place) in places.iter().enumerate() {
            self.points.push(place, colour(index), [DATE, 0.0, 0.0]);
        }
        if let Some(place) = places.get(date) {
            self.points.push(place, palette.text, [SHOWN, RING, 0.0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::Theme;
    use tautline_core::geometry::Vec3;
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;

    use super::*;
    use crate::theme;
    use crate::views::robot_3d::scene::{Displacement, PulleyPaths, SceneInputs, SideNames};

    const CABLE: usize = 2;

    /// MINI, whose third pulley moves along x at the second date and along z at the third; the second date is shown.
    fn scene(date: usize) -> Scene {
        let robot = presets::find("mini").expect("a preset").robot;
        let names = SideNames {
            first: "first",
            second: "second",
        };
        let mut by = vec![vec![Vec3::zeros(); 3]; 8];
        by[CABLE] = vec![
            Vec3::zeros(),
            Vec3::new(2e-3, 0.0, 0.0),
            Vec3::new(2e-3, 0.0, 5e-3),
        ];
        let displacements = by.iter().map(|by| Displacement {
            from: Vec3::zeros(),
            by: by[date],
            covariance: None,
            is_explained: true,
            moved: Some(by[date].norm() > 0.0),
        });
        let displacements: Vec<Displacement> = displacements.collect();
        let nothing = Measurements::default();
        let mut scene = SceneInputs::new(&robot, &nothing).scene();
        scene = scene.beside(names, displacements);
        scene.paths = Some(PulleyPaths { by, date });
        scene
    }

    fn drawing(scene: &Scene, selection: Selection) -> Drawing {
        Drawing::new(scene, &Options::default(), selection, Theme::Dark)
    }

    #[test]
    fn the_selected_pulley_has_a_path_through_its_places_magnified_with_the_date_marked() {
        let scene = scene(1);
        let without = drawing(&scene, Selection::default());
        let with = drawing(&scene, Selection::cable(CABLE));
        let magnification = Options::default().exaggeration_of(&scene);
        assert!(magnification > 1.0);
        let entry = scene.cables[CABLE].wheel.entry;
        let places = [[0.0, 0.0], [2e-3, 0.0], [2e-3, 5e-3]]
            .map(|[x, z]| entry + magnification * Vec3::new(x, 0.0, z))
            .map(|place| [place.x as f32, place.y as f32, place.z as f32]);
        // Two segments instead of the shaft of the arrow.
        assert_eq!(with.lines.from.len(), without.lines.from.len() + 1);
        let ways = with.lines.from.iter().zip(&with.lines.to);
        let ways: Vec<_> = ways.map(|(from, to)| [*from, *to]).collect();
        for way in places.windows(2) {
            assert!(ways.contains(&[way[0], way[1]]), "{way:?}");
        }
        let ring = with
            .points
            .looks
            .iter()
            .position(|look| *look == [SHOWN, RING, 0.0]);
        assert_eq!(with.points.centres[ring.expect("a mark")], places[1]);
        let [before, after] = path_colours(theme::palette(Theme::Dark));
        assert_ne!(before, after);
    }

    #[test]
    fn the_scale_stays_from_date_to_date_and_a_pulley_that_is_not_selected_has_no_path() {
        let scales = [0, 1, 2].map(|date| Options::default().exaggeration_of(&scene(date)));
        assert_eq!(scales[0], scales[1]);
        assert_eq!(scales[1], scales[2]);
        let scene = scene(1);
        let options = Options::default();
        assert_eq!(
            cable_with_path(&scene, &options, Selection::default()),
            None
        );
        let inspected = Options {
            inspected: Some(CABLE),
            ..Options::default()
        };
        let selection = Selection::cable(CABLE);
        assert_eq!(cable_with_path(&scene, &inspected, selection), None);
    }
}
