//! Human-readable form of a plan.

use crate::isolability;
use crate::output::say;
use crate::table;
use tautline_workflow::planning::PlanDocument;
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
    let mut rows = table::numbers(&["Parameter", "prior sd", "expected sd", "at random poses"]);
    let random = &plan.random.parameters;
    for (expected, random) in plan.expected.parameters.iter().zip(random) {
        let show = |sd: Option<f64>| {
            sd.map_or("undetermined".to_owned(), |sd| quantity(sd, &expected.unit))
        };
        table::push(
            &mut rows,
            &[
                expected.name.clone(),
                expected
                    .prior_sd
                    .map_or("unknown".to_owned(), |sd| quantity(sd, &expected.unit)),
                show(expected.sd),
                show(random.sd),
            ],
        );
    }
    say!("{rows}");
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
