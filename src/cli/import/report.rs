//! Human-readable form of an import: channels, recipe and poses.

use tautline_import::{ChannelReport, Cutting, ImportDocument, Recipe};

use crate::output::say;
use crate::table;

/// Prints the result of an import, with every channel if they were requested.
pub fn print(document: &ImportDocument, list_channels: bool) {
    for source in &document.sources {
        say!("{}: {}", source.file, source.format);
        for series in &source.series {
            let used = series
                .channels
                .iter()
                .filter(|channel| channel.used_as.is_some());
            let (rows, all) = (series.rows, series.channels.len());
            say!(
                "{}: {rows} rows, {all} channels, {} used",
                series.name,
                used.count()
            );
            if list_channels {
                let mut channels =
                    table::texts(&["channel", "unit", "values", "gaps", "from", "to", "becomes"]);
                for channel in &series.channels {
                    channels.add_row(cells(channel));
                }
                say!("{channels}");
            }
        }
    }
    let whose = if document.proposed {
        "proposed"
    } else {
        "given"
    };
    say!("Recipe ({whose}): {}", cutting(&document.recipe));
    for entry in &document.recipe.channels {
        let unit = entry
            .unit
            .as_ref()
            .map_or_else(String::new, |unit| format!(" in {unit}"));
        let sign = if entry.reversed { ", reversed" } else { "" };
        let from = if entry.from_first_pose {
            ", from the first pose"
        } else {
            ""
        };
        say!(
            "  {} is {}{unit}{sign}{from}",
            entry.quantity,
            entry.channel
        );
    }
    for suggestion in &document.applied {
        say!("Corrected: {}", suggestion.sentence);
    }
    for suggestion in &document.suggestions {
        let option = match suggestion.by_mass {
            true => "--apply-suggestions --weighed",
            false => "--apply-suggestions",
        };
        say!("Check: {} ({option})", suggestion.sentence);
    }
}

fn cells(channel: &ChannelReport) -> [String; 7] {
    let [from, to] = channel.range.map_or_else(
        || ["text".to_owned(), String::new()],
        |range| range.map(number),
    );
    [
        channel.name.clone(),
        channel.unit.clone().unwrap_or_default(),
        channel.values.to_string(),
        channel.gaps.to_string(),
        from,
        to,
        channel.used_as.clone().unwrap_or_else(|| "-".into()),
    ]
}

/// A number with at most six significant digits.
fn number(value: f64) -> String {
    let text = format!("{value:.5e}");
    let rounded: f64 = text.parse().unwrap_or(value);
    rounded.to_string()
}

fn cutting(recipe: &Recipe) -> String {
    match &recipe.cutting {
        Cutting::Rows => "every row is a pose".into(),
        Cutting::Labels => "consecutive rows with the same label are a pose".into(),
        Cutting::Motion => "every row is a sample of a recording in motion".into(),
        Cutting::Rest(rest) => format!("rests of {} s and more are poses", rest.minimum_s),
    }
}
