//! Sentences on faults besides causes of the catalogue: mistakes in the readings, a wrong drawing, a slack cable.

use tautline_core::diagnosis::{DrawingPattern, SlackCable, WrongDrawing};

use super::Diagnosed;
use crate::wording::units::{mm, significant, with_sd};
use crate::wording::{list, sentence};

/// Odds above which no other possibility is mentioned: those of a named cause.
const CERTAIN_ODDS: f64 = 19.0;
/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Diagnosed {
    /// Faults besides causes of the catalogue: for each kind a heading, and sentences, the last of which is advice.
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
        let slack = self.diagnosis.slack.as_ref();
        found.extend(slack.map(|slack| ("Slack cable", self.slack_lines(slack))));
        let drawing = self.diagnosis.drawing.as_ref();
        found.extend(drawing.map(|drawing| ("Drawing", self.drawing_lines(drawing))));
        found
    }

    fn slack_lines(&self, slack: &SlackCable) -> Vec<String> {
        let cable = &self.robot().cables[slack.cable].name;
        let labels: Vec<String> = slack.poses.iter().map(i64::to_string).collect();
        let poses = if labels.len() == 1 { "pose" } else { "poses" };
        let when = format!("{poses} {}", list(&labels));
        let excess = match slack.excess_m {
            Some([least, most]) => {
                let [least, most] = [least, most].map(|by_m| significant(1e3 * by_m, 2));
                format!("its readings there are {least} to {most} mm too long")
            }
            None => "its force sensor reads nothing there".to_owned(),
        };
        let (yes, no) = (slack.log_odds.exp(), (-slack.log_odds).exp());
        if !slack.is_left_out {
            let (odds, way) = if yes < 1.0 {
                (no, "against")
            } else {
                (yes, "for")
            };
            return vec![
                format!(
                    "{} may instead be slack at {when}: {excess}. The odds are {} to 1 {way} it.",
                    sentence(cable),
                    significant(odds, 2)
                ),
                "Watch the cable at these poses.".to_owned(),
            ];
        }
        let mut lines = vec![format!(
            "{} is slack at {when}: {excess}. These readings are left out, and no part is broken by it.",
            sentence(cable)
        )];
        if yes < CERTAIN_ODDS {
            lines.push(format!(
                "Another cause is possible, at odds of {} to 1 against it: watch the cable at these poses.",
                significant(yes, 2)
            ));
        }
        lines.push(format!("Raise the lower limit of tension, or plan poses at which {cable} stays taut, and check that its winch follows."));
        lines
    }

    /// Title of a wrong drawing: `Wrong drawing (turned about z)`.
    pub(super) fn drawing_title(&self, pattern: DrawingPattern) -> String {
        let how = match pattern {
            DrawingPattern::Extent(axis) => format!("extent along {}", AXES[axis]),
            DrawingPattern::Turn(axis) => format!("turned about {}", AXES[axis]),
            DrawingPattern::Pulley(cable) => {
                format!("pulley of {}", self.robot().cables[cable].name)
            }
        };
        format!("Wrong drawing ({how})")
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
        let mut lines = vec![match drawing.is_named() {
            true => format!("The drawing is wrong: {what}."),
            false => {
                let way = if drawing.log_odds < 0.0 {
                    "against"
                } else {
                    "for"
                };
                let odds = significant(drawing.log_odds.abs().exp(), 2);
                format!("The drawing may be wrong, at odds of {odds} to 1 {way} it: {what}.")
            }
        }];
        if matches!(drawing.pattern, DrawingPattern::Pulley(_)) && !self.robot().platform.turns() {
            lines.push("On a platform that does not turn, its attachment point may be off by as much the other way instead.".to_owned());
        }
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
        let enter = match drawing.is_named() {
            true => "Enter the identified places",
            false => "Measure them, and enter the identified places if they are right",
        };
        lines.push(match drawing.worth_m {
            Some(worth_m) => format!(
                "{enter}: with those of robot.json the platform is {} mm off at these poses.",
                significant(1e3 * worth_m, 2)
            ),
            None => format!("{enter}."),
        });
        lines
    }
}
