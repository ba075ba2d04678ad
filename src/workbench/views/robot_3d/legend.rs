//! Legends of the colours in the picture.

use egui::{Align2, Color32, Pos2, Rect, pos2, vec2};

use super::drawing::{
    ArrowColour, Band, CableColour, band_colour, conformity_colour, error_colour, is_drawn,
    length_colour, longest_m, significance_colour, tension_colour, tension_range,
};
use super::overlay::{Overlay, SMALL, WIDE};
use super::scene::{Reference, Significance};
use crate::theme::GRID;
use tautline_session::Stage;
use tautline_workflow::report::tolerance::Conformity;
use tautline_workflow::wording::units::significant;

/// Width of a colour scale (points), and in a small picture.
const WIDTH: f32 = 160.0;
const SMALL_WIDTH: f32 = 108.0;

impl Overlay<'_> {
    /// Draws the legends on top of each other in the lower right corner of `rect`; returns their rectangles.
    pub fn legends(&self) -> Vec<Rect> {
        let picture = self.picture;
        let scene = picture.scene;
        let mut at = self.rect.right_bottom() - vec2(4.0 * GRID, 5.0 * GRID);
        let mut drawn = Vec::new();
        let mut put = |legend: Option<Rect>, at: &mut Pos2| {
            if let Some(legend) = legend {
                at.y = legend.top() - 6.0 * GRID;
                drawn.push(legend);
            }
        };
        if picture.options.inspected.is_none() {
            put(self.residuals(at), &mut at);
        }
        if picture.options.colour == CableColour::Tension {
            let legend = match tension_range(scene) {
                Some([low, high]) => {
                    let marks = [low, (low + high) / 2.0, high].map(|t| format!("{t:.0}"));
                    let colour = |share: f32| tension_colour(share, self.palette);
                    self.ramp(at, "Tension (N)", &marks, colour)
                }
                None => self.text(at, Align2::RIGHT_BOTTOM, "No tensions known at this pose"),
            };
            put(Some(legend), &mut at);
        }
        put(self.bands(at), &mut at);
        put(self.displacements(at), &mut at);
        put(self.errors(at), &mut at);
        drawn
    }

    fn residuals(&self, at: Pos2) -> Option<Rect> {
        let picture = self.picture;
        let measured = &picture.scene.measured;
        let has_residuals = measured.iter().any(|pose| pose.residual.is_some());
        let of_poses = picture.options.poses && has_residuals;
        let of_cables = picture.options.colour == CableColour::Residual;
        let title = match (of_cables, of_poses) {
            (true, true) => "Cable and pose residuals (standard deviations)",
            (true, false) => "Cable residuals (standard deviations)",
            (false, true) => "Pose residuals (standard deviations)",
            (false, false) => return None,
        };
        let colour = |share: f32| self.palette.residual(f64::from(share) * 6.0 - 3.0);
        let marks = ["-3", "0", "+3"].map(str::to_owned);
        Some(self.ramp(at, title, &marks, colour))
    }

    fn displacements(&self, at: Pos2) -> Option<Rect> {
        let picture = self.picture;
        let options = picture.options;
        if picture.scene.reference == Reference::Nothing || !(options.arrows || options.ellipsoids)
        {
            return None;
        }
        match options.arrow_colour_of(picture.scene) {
            ArrowColour::Tolerance => Some(self.conformities(at)),
            ArrowColour::Length => {
                let longest_mm = longest_m(picture.scene)? * 1e3;
                let marks = [0.0, 0.5 * longest_mm, longest_mm].map(|mm| significant(mm, 2));
                let colour = |share: f32| length_colour(share, self.palette);
                Some(self.ramp(at, "Displacement (mm)", &marks, colour))
            }
            ArrowColour::Significance => Some(self.significances(at)),
        }
    }

    /// Legend of the bands around the nominal position of the inspected pulley.
    fn bands(&self, at: Pos2) -> Option<Rect> {
        let picture = self.picture;
        let (scene, options) = (picture.scene, picture.options);
        options.inspected?;
        let drawn = Band::ALL
            .into_iter()
            .filter(|one| is_drawn(*one, scene, options));
        let named = drawn.map(|one| {
            let words = match one {
                Band::Prior => "as drawn, 95 %".to_owned(),
                Band::Tolerance => {
                    let tolerance_mm = 1e3 * scene.tolerance_m.unwrap_or_default();
                    format!("tolerance of {} mm", significant(tolerance_mm, 3))
                }
            };
            (words, band_colour(one, self.palette))
        });
        let named: Vec<(String, Color32)> = named.collect();
        let lines: Vec<(&str, Color32)> = named.iter().map(|(w, c)| (w.as_str(), *c)).collect();
        let title = "Around the nominal place";
        (!lines.is_empty()).then(|| self.words(at, title, &lines))
    }

    /// Legend of the stages whose errors of position are drawn.
    fn errors(&self, at: Pos2) -> Option<Rect> {
        let picture = self.picture;
        let scene = picture.scene;
        let is_drawn = picture.options.errors && picture.options.inspected.is_none();
        let has = |stage: Stage| is_drawn && scene.errors.iter().any(|error| error.stage == stage);
        let stages = [(Stage::After, "after"), (Stage::Before, "before")].into_iter();
        let lines: Vec<(&str, Color32)> = stages
            .filter(|(stage, _)| has(*stage))
            .map(|(stage, words)| (words, error_colour(stage, self.palette)))
            .collect();
        let magnification = picture.options.exaggeration_of(scene);
        let title = format!("Position errors ({magnification:.0}×)");
        (!lines.is_empty()).then(|| self.words(at, &title, &lines))
    }

    /// Legend of the conformities that occur.
    fn conformities(&self, at: Pos2) -> Rect {
        let scene = self.picture.scene;
        let tolerance_m = scene.tolerance_m.unwrap_or(f64::INFINITY);
        let occurs = |one: Conformity| {
            let mut moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
            moved.any(|moved| moved.conformity(scene.decision_rule, tolerance_m) == one)
        };
        let all = [
            Conformity::Outside,
            Conformity::Undecided,
            Conformity::Within,
        ];
        let occurring = all.into_iter().filter(|one| occurs(*one));
        let lines: Vec<(&str, Color32)> = occurring
            .map(|one| (one.words(), conformity_colour(one, self.palette)))
            .collect();
        let title = format!("Tolerance of {} mm", significant(1e3 * tolerance_m, 3));
        self.words(at, &title, &lines)
    }

    /// Legend of the significances that occur.
    fn significances(&self, at: Pos2) -> Rect {
        let scene = self.picture.scene;
        let occurs = |one: &Significance| {
            let mut moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
            moved.any(|moved| moved.significance() == *one)
        };
        let all = Significance::KNOWN
            .into_iter()
            .chain([Significance::Unknown]);
        let lines: Vec<(&str, Color32)> = all
            .filter(occurs)
            .map(|one| {
                let words = match (scene.reference, one) {
                    (Reference::Other(_), Significance::Noise) => "unchanged",
                    (Reference::Other(_), Significance::Clear) => "moved",
                    _ => one.words(),
                };
                (words, significance_colour(one, self.palette))
            })
            .collect();
        self.words(at, "Displacements", &lines)
    }

    /// Lines of text in their colours below a title; returns their rectangle.
    fn words(&self, at: Pos2, title: &str, lines: &[(&str, Color32)]) -> Rect {
        let mut at = at + vec2(0.0, SMALL + 3.0);
        let mut drawn = Rect::from_min_max(at, at);
        for (words, colour) in lines {
            let right = at - vec2(26.0, 0.0);
            let words = self.text(right, Align2::RIGHT_BOTTOM, words);
            let middle = words.center().y;
            let line =
                Rect::from_min_max(pos2(at.x - 20.0, middle - 2.0), pos2(at.x, middle + 2.0));
            self.painter.rect_filled(line, 2.0, *colour);
            drawn = drawn.union(words).union(line);
            at.y = words.top() - 1.0;
        }
        let title = self.text(at, Align2::RIGHT_BOTTOM, title);
        drawn.union(title)
    }

    /// Colour scale with its lower right corner at `at`; returns the rectangle of the scale and its labels.
    fn ramp(
        &self,
        at: Pos2,
        title: &str,
        marks: &[String; 3],
        colour: impl Fn(f32) -> Color32,
    ) -> Rect {
        let painter = self.painter;
        const STEPS: usize = 40;
        // A small picture has its unit below the title, to leave room for the robot.
        let is_small = painter.clip_rect().width() < WIDE;
        let width = if is_small { SMALL_WIDTH } else { WIDTH };
        let left = at.x - width;
        for step in 0..STEPS {
            let share = |k: usize| k as f32 / STEPS as f32;
            let corners = [
                pos2(left + width * share(step), at.y - 6.0),
                pos2(left + width * share(step + 1), at.y),
            ];
            let middle = (share(step) + share(step + 1)) / 2.0;
            painter.rect_filled(Rect::from_points(&corners), 0.0, colour(middle));
        }
        let anchors = [Align2::LEFT_TOP, Align2::CENTER_TOP, Align2::RIGHT_TOP];
        for (k, (mark, anchor)) in marks.iter().zip(anchors).enumerate() {
            let x = left + width * 0.5 * k as f32;
            self.text(pos2(x, at.y + 1.0), anchor, mark);
        }
        let mut lines = vec![title];
        if let Some(place) = title.find(" (").filter(|_| is_small) {
            lines = vec![&title[..place], &title[place + 1..]];
        }
        let mut above = pos2(at.x, at.y - 9.0);
        let mut written = Rect::from_min_max(above, above);
        for line in lines.into_iter().rev() {
            let line = self.text(above, Align2::RIGHT_BOTTOM, line);
            above.y = line.top();
            written = written.union(line);
        }
        written.union(Rect::from_two_pos(
            pos2(left, at.y - 6.0),
            at + vec2(0.0, SMALL + 3.0),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::overlay::tests::in_picture;

    #[test]
    fn legends_leave_the_middle_of_a_small_picture_to_the_robot() {
        for size in [
            [400.0, 140.0],
            [460.0, 240.0],
            [640.0, 400.0],
            [1200.0, 800.0],
        ] {
            let legends = in_picture(size, |overlay| overlay.legends());
            assert_eq!(legends.len(), 2, "residuals and displacements");
            for legend in legends {
                assert!(legend.min.y > 0.0, "{size:?}: {legend:?}");
                let reach = (size[0] - legend.min.x) / size[0];
                assert!(reach < 0.4, "{size:?}: {legend:?}");
            }
        }
    }
}
