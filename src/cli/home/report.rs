//! A measured home pose as text.

use tautline_workflow::precalibration::HomeDocument;
use tautline_workflow::wording::{count, units};

use crate::output::say;

/// Probability below which the scatter of the measurements is reported as doubtful.
const DOUBTFUL: f64 = 0.01;

/// Prints the document.
pub fn print(document: &HomeDocument) {
    let position = document.position_m.map(|v| units::mm(v, 3)).join(", ");
    let sds = document.position_sd_m.map(|v| units::mm(v, 3)).join(", ");
    let turned = document.orientation_sd_rad.into_iter().fold(0.0, f64::max);
    say!(
        "home pose by {}: position {position} mm, standard deviations {sds} mm and {:.4}°",
        count(document.measurements, "measurement"),
        turned.to_degrees()
    );
    if let Some(p) = document.p_value.filter(|p| *p < DOUBTFUL) {
        say!(
            "the measurements differ more than their standard deviations say (p = {p:.1e}): the standard deviations of the \
             mean are not valid"
        );
    }
}
