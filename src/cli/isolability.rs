//! Table of the faults that poses reveal.

use tautline_workflow::isolability::{CONFUSED, IsolabilityDocument, IsolabilityTable, percent};

use crate::output::say;
use crate::table;

/// Largest number of confusable faults listed for each.
const MOST_RIVALS: usize = 3;

/// Prints the probability of detection of every fault and the faults it could be confused with.
pub fn print(document: &IsolabilityDocument) {
    let table = IsolabilityTable::of(document);
    say!("{}", table.summary());
    let confused = |fault: usize| {
        let rivals = document.rivals(fault);
        let mut named: Vec<String> = (rivals.iter().take(MOST_RIVALS))
            .map(|k| {
                let confusion = document.confusion[fault][*k];
                format!("{} ({})", document.faults[*k].name(), percent(confusion))
            })
            .collect();
        if rivals.len() > MOST_RIVALS {
            named.push(format!("and {} more", rivals.len() - MOST_RIVALS));
        }
        named.join(", ")
    };
    table::rows(document.faults.iter().enumerate()).print_texts(&[
        ("Fault", &|(_, fault)| fault.name()),
        ("typical size", &|(_, fault)| fault.size.clone()),
        ("seen", &|(_, fault)| percent(fault.detection)),
        ("could be confused with", &|(index, _)| confused(*index)),
    ]);
    say!(
        "seen: probability that diagnosis names or lists it; confused: something is seen, but the other is not ruled out, with a \
         probability of {} or more",
        percent(CONFUSED)
    );
}
