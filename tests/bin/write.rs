//! Prints validation tables: `truth`, `table1`, `hangprinter`, `nist`; `write` puts all into
//! docs/VALIDATION.md.

use anyhow::{Result, bail};
use tautline_validation::{hangprinter, table1, truth};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("truth") => {
            let sets = arguments.get(1).map_or(Ok(1000), |n| n.parse())?;
            let rows: Result<Vec<_>> = ["mini", "hall", "suspended", "planar"]
                .iter()
                .map(|name| truth::study(name, sets, 1000))
                .collect();
            println!("{}", truth::markdown(&rows?));
        }
        Some("table1") => println!("{}", table1::markdown(&table1::study(10)?)),
        Some("hangprinter") => {
            let folder = arguments
                .get(1)
                .map_or("../shared/data/hangprinter", String::as_str);
            println!(
                "{}",
                hangprinter::markdown(&hangprinter::study(folder.as_ref())?)
            );
        }
        _ => bail!("what to validate: truth"),
    }
    Ok(())
}
