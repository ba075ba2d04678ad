//! What is wrong besides causes of the catalogue, in words: the readings, and the drawing.

use tautline_core::diagnosis::{DrawingPattern, WrongDrawing};

use super::Diagnosed;
use crate::wording::sentence;
use crate::wording::units::{mm, significant, with_sd};

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Diagnosed {
    /// What is wrong besides causes of the catalogue: for each kind a heading, and sentences.
    #[must_use]
    pub fn gross(&self) -> Vec<(&'static str, Vec<String>)> {
        let mut found = Vec::new();
        let mistakes = self.mistakes.iter();
        let mut mistakes: Vec<String> = mistakes
            .map(|one| format!("{}.", sentence(&one.sentence)))
            .collect();
        if !mistakes.is_empty() {
            mistakes.push("Correct the recording, or import it with `tautline import FOLDER --apply-suggestions -o NEW_FOLDER`.".to_owned());
            found.push(("Mistakes in the readings, undone here", mistakes));
        }
        let drawing = self.diagnosis.drawing.as_ref();
        found.extend(drawing.map(|drawing| ("Drawing", self.drawing_lines(drawing))));
        found
    }

    fn drawing_lines(&self, drawing: &WrongDrawing) -> Vec<String> {
        let WrongDrawing {
            size,
            sd,
            stated_sd,
            ..
        } = *drawing;
        let [in_mm, in_degrees] = ["m", "rad"].map(|unit| with_sd(size.abs(), sd, unit));
        let [stated_mm, stated_degrees] =
            [1e3 * stated_sd, stated_sd.to_degrees()].map(|sd| significant(sd, 2));
        let what = match drawing.pattern {
            DrawingPattern::Extent(axis) => {
                let how = if size < 0.0 {
                    "closer together"
                } else {
                    "farther apart"
                };
                format!(
                    "along {} the pulleys are {in_mm} {how} than robot.json states, which it knows to {stated_mm} mm",
                    AXES[axis]
                )
            }
            DrawingPattern::Turn(axis) => format!(
                "the pulleys are turned by {in_degrees} about {}{} against robot.json, which knows it to {stated_degrees}°",
                if size < 0.0 { "-" } else { "+" },
                AXES[axis]
            ),
            DrawingPattern::Pulley(cable) => format!(
                "the pulley of {} is {in_mm} from where robot.json states it, which it knows to {stated_mm} mm",
                self.robot().cables[cable].name
            ),
        };
        let mut lines = vec![format!("The drawing is wrong: {what}.")];
        let cables = self.robot().cables.iter().zip(&drawing.displacements_m);
        let places = cables.map(|(cable, by)| {
            let by = AXES.iter().zip(by).filter(|(_, by)| by.abs() > 0.0);
            let by: Vec<String> = by
                .map(|(axis, by)| format!("{axis} {} mm", mm(*by, 1)))
                .collect();
            format!("{} {}", cable.name, by.join(", "))
        });
        lines.push(format!(
            "The pulleys are displaced by: {}.",
            places.collect::<Vec<_>>().join("; ")
        ));
        if let Some(worth_m) = drawing.worth_m {
            lines.push(format!(
                "Enter the identified places: with those of robot.json the platform is {} mm off at these poses.",
                significant(1e3 * worth_m, 2)
            ));
        }
        lines
    }
}
