//! Finds the channel of each quantity in the sources.

use std::collections::BTreeMap;

use tautline_channels::{Series, Source};
use tautline_files::{Location, ReadError, quoted};

use super::{Assignment, Quantity, Recipe};

/// The channel of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mapped {
    /// Index of the series.
    pub series: usize,
    /// Index of the channel, or of the text.
    pub channel: usize,
    /// Whether the channel is a column of texts.
    pub is_text: bool,
    /// `value = factor x + offset` in the unit of the quantity.
    pub factor: f64,
    /// Offset in the unit of the quantity.
    pub offset: f64,
    /// Whether the value at the first pose is subtracted.
    pub from_first_pose: bool,
    /// Index of the entry in the recipe.
    pub assignment: usize,
}

/// All series of the sources, and the channel of each quantity.
pub(crate) struct Mapping<'a> {
    pub series: Vec<&'a Series>,
    pub quantities: BTreeMap<Quantity, Mapped>,
    /// Time channel of each series, if the recipe assigns one.
    pub times: Vec<Option<Mapped>>,
}

/// Finds the channels of a recipe; `recipe_file` is its name for messages.
///
/// # Errors
/// For the first entry whose channel is missing or ambiguous, or whose unit does not match.
pub(crate) fn resolve<'a>(
    sources: &'a [Source],
    recipe: &Recipe,
    recipe_file: &str,
    cables: usize,
) -> Result<Mapping<'a>, ReadError> {
    let series: Vec<&Series> = sources.iter().flat_map(|source| &source.series).collect();
    let mut mapping = Mapping {
        times: vec![None; series.len()],
        series,
        quantities: BTreeMap::new(),
    };
    for (k, assignment) in recipe.channels.iter().enumerate() {
        let fail = |key: &str, message: String| {
            ReadError::new(
                recipe_file,
                Location::Pointer(format!("/channels/{k}/{key}")),
                message,
            )
        };
        let numbers = if assignment.quantity.contains("{i}") {
            1..=cables
        } else {
            1..=1
        };
        for number in numbers {
            let column = assignment.quantity.replacen("{i}", &number.to_string(), 1);
            let channel =
                assignment
                    .channel
                    .replacen("{i}", &(number - 1 + assignment.first).to_string(), 1);
            let Some(quantity) = Quantity::parse(&column) else {
                return Err(fail(
                    "quantity",
                    format!("found {}, expected a column of poses.csv", quoted(&column)),
                ));
            };
            if quantity.is_per_cable() && quantity.index >= cables {
                return Err(fail(
                    "quantity",
                    format!(
                        "found {}, but the robot has {cables} cables",
                        quoted(&column)
                    ),
                ));
            }
            let (place, index, is_text) = find(&mapping.series, assignment, &channel)
                .map_err(|message| fail("channel", message))?;
            if is_text && !quantity.is_text() {
                return Err(fail(
                    "channel",
                    format!(
                        "found {}, which is a text column, expected numbers",
                        quoted(&channel)
                    ),
                ));
            }
            let stated = if is_text {
                None
            } else {
                mapping.series[place].channels[index].unit.as_deref()
            };
            let unit = assignment.unit.as_deref().or(stated);
            let (factor, offset) = match unit {
                None => (1.0, 0.0),
                Some(unit) => quantity.conversion(unit).ok_or_else(|| {
                    let message = format!(
                        "the file states {} for {}, expected {}",
                        quoted(unit),
                        quoted(&channel),
                        quantity.expected_unit()
                    );
                    fail("unit", message)
                })?,
            };
            let sign = if assignment.reversed {
                -assignment.factor
            } else {
                assignment.factor
            };
            let mapped = Mapped {
                series: place,
                channel: index,
                is_text,
                factor: factor * sign,
                offset: offset * sign + assignment.offset,
                from_first_pose: assignment.from_first_pose,
                assignment: k,
            };
            if quantity.kind == super::QuantityKind::Time {
                mapping.times[place] = Some(mapped);
            } else {
                mapping.quantities.insert(quantity, mapped);
            }
        }
    }
    Ok(mapping)
}

/// Whether a name in a recipe refers to a series: the name of the series or its end.
pub(crate) fn is_series(series: &Series, meant: &str) -> bool {
    series.name == meant || series.name.ends_with(meant)
}

/// Series and index of a channel, and whether it is text.
fn find(
    series: &[&Series],
    assignment: &Assignment,
    channel: &str,
) -> Result<(usize, usize, bool), String> {
    let meant = |series: &Series| {
        assignment
            .series
            .as_ref()
            .is_none_or(|meant| is_series(series, meant))
    };
    let mut found = Vec::new();
    for (place, one) in series
        .iter()
        .enumerate()
        .filter(|(_, series)| meant(series))
    {
        let number = one.channels.iter().position(|known| known.name == channel);
        let text = one.texts.iter().position(|known| known.name == channel);
        found.extend(number.map(|index| (place, index, false)));
        found.extend(text.map(|index| (place, index, true)));
    }
    match found[..] {
        [one] => Ok(one),
        [] => {
            let names = series
                .iter()
                .flat_map(|series| series.channels.iter().map(|channel| channel.name.as_str()));
            let names: Vec<String> = names.take(6).map(quoted).collect();
            let of = assignment
                .series
                .as_ref()
                .map_or_else(String::new, |series| {
                    format!(" of the series {}", quoted(series))
                });
            Err(format!(
                "found no channel {}{of}, expected one of {}, ...",
                quoted(channel),
                names.join(", ")
            ))
        }
        _ => {
            let names: Vec<String> = found
                .iter()
                .map(|(place, ..)| quoted(&series[*place].name))
                .collect();
            Err(format!(
                "found {} in the series {}, expected the key \"series\" to say which",
                quoted(channel),
                names.join(" and ")
            ))
        }
    }
}
