//! Human-readable form of a plan.

use crate::isolability;
use crate::output::say;
use crate::table;
use tautline_workflow::planning::{ExpectedParameter, PlanDocument};
use tautline_workflow::wording::units::quantity;

/// Prints the plan and its expected standard deviations.
pub fn print(plan: &PlanDocument) {
    let refused = &plan.refused;
    say!(
        "{} poses for {}, chosen for {} from {} feasible ones",
        plan.poses.len(),
        plan.robot,
        match plan.goal.as_str() {
            "faults" => "detecting and separating faults",
            "both" => "geometry and faults",
            "accuracy" => "accuracy in the volume",
            _ => "the geometry",
        },
        plan.candidates
    );
    say!(
        "rejected of {} drawn: {} without tensions that hold the platform, {} without them on the way from home, {} without a \
         cable path, {} without a usable laser distance, {} too close to the frame",
        refused.tried,
        refused.tension,
        refused.way,
        refused.kinematics,
        refused.laser,
        refused.frame
    );
    if let Some(sentence) = &plan.unchecked_tensions {
        say!("{sentence}");
    }
    say!(
        "travel distance {:.1} m; largest correlation of a coordinate with time {:.2}",
        plan.travel_m,
        plan.largest_time_correlation
    );
    let show = |parameter: &ExpectedParameter, sd: Option<f64>, without: &str| {
        sd.map_or(without.to_owned(), |sd| quantity(sd, &parameter.unit))
    };
    table::rows(plan.expected.parameters.iter().zip(&plan.random.parameters)).print(&[
        ("Parameter", &|(one, _)| one.name.clone()),
        ("prior sd", &|(one, _)| show(one, one.prior_sd, "unknown")),
        ("expected sd", &|(one, _)| show(one, one.sd, "undetermined")),
        ("at random poses", &|(one, random)| {
            show(one, random.sd, "undetermined")
        }),
    ]);
    let metres = |value: Option<f64>| value.map_or("undetermined".to_owned(), |v| quantity(v, "m"));
    say!(
        "entry points: sd {} rms, {} along the worst direction; at random poses {} and {}",
        metres(plan.expected.mean_m),
        metres(plan.expected.worst_m),
        metres(plan.random.mean_m),
        metres(plan.random.worst_m)
    );
    if let (Some(expected), Some(random)) = (plan.expected.platform_m, plan.random.platform_m) {
        say!(
            "expected rms position error of the platform with these values in the controller: {}; at random poses {}",
            quantity(expected, "m"),
            quantity(random, "m")
        );
    }
    if let Some(document) = &plan.isolability {
        isolability::print(document);
    }
}
