//! A verification as text.

use tautline_session::Stage;
use tautline_workflow::accuracy::{Accuracy, VerificationDocument};
use tautline_workflow::adjusting::title;

use crate::output::say;
use crate::table::{self, mm};

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
    let mut rows = Vec::new();
    if let (Some(b), Some(a)) = (&before.poses, &after.poses) {
        let mut add = |name: &str, b, a| rows.push((name.to_owned(), b, a));
        add(
            "largest pose accuracy AP",
            b.largest_accuracy_m,
            a.largest_accuracy_m,
        );
        add(
            "mean pose accuracy AP",
            b.mean_accuracy_m,
            a.mean_accuracy_m,
        );
        let [before, after] = [b, a].map(|one| one.largest_repeatability_m);
        add("largest pose repeatability RP", before, after);
    }
    for b in &before.paths {
        if let Some(a) = after.paths.iter().find(|a| a.target == b.target) {
            let name = format!("{}: path accuracy AT", b.target);
            rows.push((name, b.accuracy_m, a.accuracy_m));
        }
    }
    table::rows(rows).print(&[
        ("mm", &|(name, ..)| name.clone()),
        ("before", &|(_, before_m, _)| mm(*before_m, 3)),
        ("after", &|(.., after_m)| mm(*after_m, 3)),
        ("ratio", &|(_, before_m, after_m)| {
            format!("{:.1}", before_m / after_m)
        }),
    ]);
}
