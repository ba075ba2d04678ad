//! Table of drawn cases: which effects are visible on which robot.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::Result;

use super::{effects_by_robot, kinds};
use crate::tables::hidden::{Drawn, Plan, Wanted};

/// For each effect and robot the number of visible and of all draws, and the largest noncentrality.
#[must_use]
pub fn drawn_markdown(draws: &[(Plan, Result<Option<Drawn>>)]) -> String {
    let mut cells: BTreeMap<(&str, &str), (usize, usize, f64)> = BTreeMap::new();
    let mut ids = Vec::new();
    let mut others = String::new();
    for (plan, drawn) in draws {
        let drawn = match drawn {
            Ok(Some(drawn)) => drawn,
            Ok(None) => continue,
            Err(error) => {
                let _ = writeln!(others, "{plan:?}: {error:#}");
                continue;
            }
        };
        let id = match plan.wanted {
            Wanted::One(id, _) | Wanted::Outside(id) => id,
            wanted => kinds::name(wanted),
        };
        if !ids.contains(&id) {
            ids.push(id);
        }
        let cell = cells.entry((id, plan.robot)).or_default();
        cell.0 += usize::from(drawn.visible);
        cell.1 += 1;
        // For effects outside the catalogue the second noncentrality counts, which the nearest effect of the catalogue
        // leaves.
        let value = drawn.noncentralities.last().copied().unwrap_or(0.0);
        cell.2 = cell.2.max(value);
    }
    let cells = cells.into_iter();
    let cells = cells.map(|(at, (seen, of, most))| (at, format!("{seen}/{of}, {most:.1e}")));
    let caption = "Visible of drawn, and the largest noncentrality (outside the catalogue: of what the \
                   nearest effect in it leaves).";
    effects_by_robot(caption, &ids, &cells.collect()) + &others
}
