//! What is hidden: the effects outside the catalogue, and forms of our own in the grammar of `formulas` and outside it.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_core::estimation::Problem;
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_workflow::formulas::{Formula, Reading, formulas};

use super::file::{File, of_outside};
use crate::tables::hidden::{Hidden, OUTSIDE, Outside, Scene, Setup};
use crate::tables::simulated::solved;

/// Where a form comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// It is one of the effects outside the catalogue.
    Outside,
    /// A form of our own outside the grammar.
    Own,
    /// A form of our own in the grammar.
    Grammar,
}

/// Something that is hidden in readings.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// Identifier.
    pub id: &'static str,
    /// How it is hidden.
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Outside(&'static Outside),
    Own(&'static Own),
    Grammar(Reading, &'static str),
}

/// A form outside the grammar with one parameter.
#[derive(Debug)]
struct Own {
    id: &'static str,
    scope: &'static str,
    target: &'static str,
    /// The factor of the size.
    factor: &'static str,
    unit: &'static str,
    typical: [f64; 2],
}

const fn own(
    id: &'static str,
    (scope, target): (&'static str, &'static str),
    factor: &'static str,
    (unit, typical): (&'static str, [f64; 2]),
) -> Own {
    Own {
        id,
        scope,
        target,
        factor,
        unit,
        typical,
    }
}

const PAID: (&str, &str) = ("cable", "paid");
const TENSION: (&str, &str) = ("cable", "tension");
const LASER: (&str, &str) = ("robot", "laser_bias");

/// Forms outside the grammar: of other cables, of saturating, one-sided and wavy shapes, and products of three.
static OWN: [Own; 10] = [
    own(
        "length_crosstalk",
        PAID,
        "paid_of(next)",
        ("1", [1e-3, 1e-2]),
    ),
    own(
        "oval_drum",
        PAID,
        "sin(4 * pi * drum_revolutions)",
        ("m", [1e-4, 1e-3]),
    ),
    own(
        "settling",
        PAID,
        "(1 - exp(-time / 900 [s]))",
        ("m", [1e-4, 1e-2]),
    ),
    own(
        "one_sided",
        PAID,
        "max(position_x - 0.1 [m], 0 [m])",
        ("1", [1e-3, 3e-2]),
    ),
    own(
        "triple",
        PAID,
        "position_x * position_y * position_z",
        ("1/m^2", [1e-3, 1e-1]),
    ),
    own("wavy_groove", PAID, "sin(6 * wrap)", ("m", [1e-4, 1e-2])),
    own(
        "growing_step",
        PAID,
        "sign(position_x - 0.1 [m]) * time",
        ("m/s", [1e-7, 1e-5]),
    ),
    own(
        "cubic_sensor",
        TENSION,
        "(tension - mean_tension) ^ 3",
        ("1/N^2", [1e-5, 1e-3]),
    ),
    own(
        "growing_crosstalk",
        TENSION,
        "(tension_of(next) - mean_tension_of(next)) * time",
        ("1/s", [1e-5, 1e-3]),
    ),
    own(
        "ribbed_target",
        LASER,
        "sin(20 [1/m] * position_x)",
        ("m", [1e-4, 1e-2]),
    ),
];

/// Forms in the grammar, in its own words.
const GRAMMAR: [(&str, Reading, &str); 10] = [
    ("in_grammar_1", Reading::Length, "position_z * wrap"),
    ("in_grammar_2", Reading::Length, "position_x * position_y"),
    ("in_grammar_3", Reading::Length, "time * paid"),
    ("in_grammar_4", Reading::Length, "abs(position_x)"),
    (
        "in_grammar_5",
        Reading::Length,
        "a wave of 3 per motor revolution",
    ),
    ("in_grammar_6", Reading::Tension, "tension * tension"),
    ("in_grammar_7", Reading::Tension, "position_x * time"),
    ("in_grammar_8", Reading::Tension, "abs(position_y)"),
    ("in_grammar_9", Reading::Laser, "position_x * position_x"),
    ("in_grammar_10", Reading::Laser, "position_x * time"),
];

/// All forms.
pub fn forms() -> impl Iterator<Item = Form> {
    let outside = OUTSIDE.iter().map(|effect| Form {
        id: effect.id,
        kind: Kind::Outside(effect),
    });
    let own = OWN.iter().map(|own| Form {
        id: own.id,
        kind: Kind::Own(own),
    });
    let grammar = GRAMMAR.iter().map(|(id, reading, expression)| Form {
        id,
        kind: Kind::Grammar(*reading, expression),
    });
    outside.chain(own).chain(grammar)
}

/// The ten forms of our own outside the grammar as files.
pub fn ten_files() -> Vec<String> {
    OWN.iter().map(Own::text).collect()
}

impl Own {
    fn text(&self) -> String {
        let Self {
            id, target, factor, ..
        } = self;
        File::new(self.scope, target, format!("{target} + size * {factor}"))
            .with("size", self.unit, self.typical)
            .text(id)
    }
}

/// A form on a robot.
pub struct OnRobot {
    how: How,
    /// Size at which a search for a size starts.
    pub unit: f64,
    /// Form of the grammar that is the same, up to what the tolerances of the parts take up.
    pub in_grammar: Option<Formula>,
    /// The file that describes it, or why none can.
    pub file: Result<String, &'static str>,
    /// Cable that it acts on; `None` if on the robot.
    pub cable: Option<String>,
}

enum How {
    Outside(&'static Outside),
    Text(Hypothesis),
}

impl Form {
    /// Where it comes from.
    pub fn origin(&self) -> Origin {
        match self.kind {
            Kind::Outside(_) => Origin::Outside,
            Kind::Own(_) => Origin::Own,
            Kind::Grammar(..) => Origin::Grammar,
        }
    }

    /// Form of the grammar that is the same on a robot. A quadratic term of a force sensor is one because its gain and bias
    /// deviate within tolerances.
    pub fn in_grammar(&self, robot: &Robot) -> Option<(Reading, &'static str)> {
        let is_planar = robot.platform.free.len() < 6;
        match (self.kind, self.id) {
            (Kind::Grammar(reading, expression), _) => Some((reading, expression)),
            (_, "force_square") => Some((Reading::Tension, "tension * tension")),
            (_, "curved_target") if is_planar => Some((Reading::Laser, "position_x * position_x")),
            (_, "laser_incidence") if is_planar => {
                Some((Reading::Laser, "rotation_z * rotation_z"))
            }
            _ => None,
        }
    }

    /// The form on a robot; `None` if the robot has nothing that it changes.
    ///
    /// # Errors
    /// If the robot cannot be simulated.
    pub fn on(&self, setup: &Setup) -> Result<Option<OnRobot>> {
        let exact = setup.exact(&[])?;
        let scene = Scene::new(&exact.truth, setup.seed);
        let in_grammar = match self.in_grammar(&exact.truth) {
            Some(of) => formula(&exact.dataset, of)?,
            None => None,
        };
        let (how, unit, file) = match self.kind {
            Kind::Outside(effect) if !(effect.applies)(&exact.truth) => return Ok(None),
            Kind::Outside(effect) => {
                let file = of_outside(self.id, &scene, &exact.dataset.measurements);
                let file = file.map(|file| file.text(&format!("suspected_{}", self.id)));
                (How::Outside(effect), effect.unit, file)
            }
            Kind::Own(own) => of_text(own.text())?,
            Kind::Grammar(..) => match &in_grammar {
                Some(formula) => of_text(formula.text.clone())?,
                None => return Ok(None),
            },
        };
        let cable = |text: &String| -> Result<Option<String>> {
            let is_of_cable = text.contains("scope = \"cable\"");
            Ok(is_of_cable.then(|| exact.truth.cables[scene.cable].name.clone()))
        };
        let known = in_grammar.as_ref().map(|formula| &formula.text);
        let cable = match file.as_ref().ok().or(known) {
            Some(text) => cable(text)?,
            None => None,
        };
        Ok(Some(OnRobot {
            how,
            unit,
            in_grammar,
            file,
            cable,
        }))
    }
}

/// A form that is hidden by its own file.
fn of_text(text: String) -> Result<(How, f64, Result<String, &'static str>)> {
    let hypothesis = Hypothesis::parse(&text)?;
    let [low, high] = hypothesis.effect().parameters()[0].typical_sizes();
    Ok((How::Text(hypothesis), (low * high).sqrt(), Ok(text)))
}

/// A formula of the grammar on a robot, if it has it.
fn formula(exact: &Dataset, (reading, expression): (Reading, &str)) -> Result<Option<Formula>> {
    let solution = solved(&Problem::new(exact)?)?;
    let mut all = formulas(reading, exact, &solution).into_iter();
    Ok(all.find(|one| one.expression == expression))
}

impl OnRobot {
    /// The setup in which it can be hidden.
    ///
    /// # Errors
    /// If the robot does not take the file.
    pub fn prepare(&self, setup: &mut Setup) -> Result<()> {
        if let How::Text(hypothesis) = &self.how {
            setup.robot.preset.robot.add_hypothesis(hypothesis)?;
        }
        Ok(())
    }

    /// What is hidden at a size.
    pub fn hidden(&self, size: f64, phase: f64) -> Hidden {
        match &self.how {
            How::Outside(effect) => Hidden::Outside(effect, size),
            How::Text(hypothesis) => {
                let parameters = hypothesis.effect().parameters();
                // Two parameters are those of a sine and a cosine.
                let value = |k: usize| match parameters.len() {
                    1 => size,
                    _ => size * [phase.cos(), phase.sin()][k.min(1)],
                };
                let values = parameters.iter().enumerate();
                let values = values.map(|(k, p)| (p.name.to_owned(), value(k)));
                Hidden::Effects(vec![self.setting(hypothesis.id(), values.collect())])
            }
        }
    }

    /// An effect on its cable.
    pub fn setting(&self, effect: &str, parameters: BTreeMap<String, f64>) -> EffectSetting {
        EffectSetting {
            effect: effect.to_owned(),
            targets: self.cable.iter().cloned().collect(),
            parameters,
        }
    }

    /// Its own hypothesis.
    ///
    /// # Errors
    /// If the file is none.
    pub fn hypothesis(&self) -> Result<Option<Hypothesis>> {
        let text = self.file.as_ref().ok();
        text.map(|text| Hypothesis::parse(text).context("a file"))
            .transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_sixteen_and_ten_and_ten_and_all_files_are_hypotheses() {
        let of = |origin| forms().filter(|form| form.origin() == origin).count();
        assert_eq!(
            [Origin::Outside, Origin::Own, Origin::Grammar].map(of),
            [16, 10, 10]
        );
        for text in ten_files() {
            Hypothesis::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        }
    }
}
