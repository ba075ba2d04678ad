//! A verification as text.

use tautline_session::Stage;
use tautline_workflow::accuracy::{Accuracy, VerificationDocument};
use tautline_workflow::adjusting::title;

use crate::output::say;
use crate::table;

/// Prints this run and the change by the adjustment.
pub fn print(document: &VerificationDocument) {
    let now = match document.stage {
        Stage::Before => &document.before,
        Stage::After => &document.after,
    };
    if let Some(accuracy) = now {
        say!("{}", title(document.stage));
        crate::accuracy::print(accuracy);
    }
    if let (Some(before), Some(after)) = (&document.before, &document.after) {
        print_both(before, after);
    }
}

fn print_both(before: &Accuracy, after: &Accuracy) {
    let mut lines = table::numbers(&["mm", "before", "after", "ratio"]);
    let mut add = |name: String, before_m: f64, after_m: f64| {
        let cells = [
            name,
            table::mm(before_m, 3),
            table::mm(after_m, 3),
            format!("{:.1}", before_m / after_m),
        ];
        table::push(&mut lines, &cells);
    };
    if let (Some(b), Some(a)) = (&before.poses, &after.poses) {
        for (name, b, a) in [
            (
                "largest pose accuracy AP",
                b.largest_accuracy_m,
                a.largest_accuracy_m,
            ),
            (
                "mean pose accuracy AP",
                b.mean_accuracy_m,
                a.mean_accuracy_m,
            ),
            (
                "largest pose repeatability RP",
                b.largest_repeatability_m,
                a.largest_repeatability_m,
            ),
        ] {
            add(name.to_owned(), b, a);
        }
    }
    for b in &before.paths {
        let Some(a) = after.paths.iter().find(|a| a.target == b.target) else {
            continue;
        };
        add(
            format!("{}: path accuracy AT", b.target),
            b.accuracy_m,
            a.accuracy_m,
        );
    }
    say!("{lines}");
}
