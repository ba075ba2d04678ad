//! The method of identification.

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::Method;
use tautline_session::Session;

use crate::identification::Identification;
use crate::report::document::Section;
use crate::wording::{count, list};

/// Source of the method.
const SOURCE: &str = "X. Jin, J. Jung, S. Y. Ko, E. Choi, J.-O. Park, C.-S. Kim: Geometric parameter calibration for a cable-driven parallel robot based on a single one-dimensional laser distance sensor measurement and experimental modeling. Sensors 18 (2018) 2392, doi:10.3390/s18072392.";

pub fn section(session: &Session, fit: &Identification) -> Section {
    let mut section = Section::new("Method");
    let tensions = match fit.method {
        Method::Simple => {
            "Tensions are taken from the sensors as exact, without static equilibrium"
        }
        Method::Joint if !fit.dataset.measurements.force_n.is_empty() => {
            "Tensions are estimated as well: their readings have noise, and static equilibrium holds at every pose"
        }
        Method::Joint if fit.dataset.robot.unread_tension().is_some() => {
            "No tensions were measured: they are estimated from their limits and the static equilibrium at every pose"
        }
        Method::Joint => "No tensions were measured",
    };
    section.paragraph(format!(
        "Pulleys and poses are estimated together by least squares from the lengths, tensions and distances at all measured poses, each reading weighted by its noise. {tensions}."
    ));
    let effects = &fit.solution.globals.effects;
    if !effects.is_empty() {
        let names = effects.iter().map(|bound| name(bound, session));
        section.paragraph(format!(
            "The model has these effects besides the geometry: {}.",
            list(&names.collect::<Vec<_>>())
        ));
    }
    let solution = &fit.solution;
    section.note(format!(
        "Weighted least squares (Gauss-Newton with a trust region, poses eliminated): {}, {}, chi-square {:.1} for {:.0} degrees of freedom, {}.",
        count(solution.parameters.len(), "common parameter"),
        count(solution.poses.len(), "pose"),
        solution.chi2,
        solution.degrees_of_freedom,
        if solution.converged() {
            format!("converged after {}", count(solution.iterations, "step"))
        } else {
            "NOT converged".to_owned()
        }
    ));
    section.note(format!("After {SOURCE}"));
    section
}

fn name(bound: &BoundEffect, session: &Session) -> String {
    let title = bound.effect.title();
    let targets = bound.setting(&session.robot).targets;
    if targets.is_empty() {
        title.to_owned()
    } else {
        format!("{title} ({})", list(&targets))
    }
}
