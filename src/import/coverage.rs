//! Coverage of an import: unused channels, and instruments without a channel.

use std::collections::BTreeSet;

use tautline_channels::{Series, Source};
use tautline_core::robot::Robot;

use crate::naming::{Family, families, is_label};
use crate::recipe::{Mapping, QuantityKind as Kind};

/// Most names in one notice.
const MOST: usize = 12;

/// Names the channels that no quantity uses, and the series of which nothing is used.
pub(crate) fn unused(mapping: &Mapping<'_>) -> Vec<String> {
    let mut notices = Vec::new();
    let mut whole: Vec<String> = Vec::new();
    for (k, series) in mapping.series.iter().enumerate() {
        let mapped = mapping
            .quantities
            .values()
            .chain(mapping.times.iter().flatten());
        let used: BTreeSet<(bool, usize)> = mapped
            .filter(|mapped| mapped.series == k)
            .map(|mapped| (mapped.is_text, mapped.channel))
            .collect();
        let names = unused_names(series, &used);
        if used.is_empty() {
            whole.push(series.name.clone());
        } else if !names.is_empty() {
            notices.push(format!("{}: not used: {}", series.name, listed(&names)));
        }
    }
    if !whole.is_empty() && whole.len() < mapping.series.len() {
        notices.push(format!("no channel is used of {}", listed(&whole)));
    }
    notices
}

/// The unused channels of a series with their units; those that differ by a number only are named together.
fn unused_names(series: &Series, used: &BTreeSet<(bool, usize)>) -> Vec<String> {
    let with_unit = |name: &str, unit: Option<&String>| match unit {
        Some(unit) => format!("{name} [{unit}]"),
        None => name.to_owned(),
    };
    let channels = series.channels.iter().enumerate();
    let left: Vec<(&str, Option<&String>)> = channels
        .filter(|(k, channel)| !used.contains(&(false, *k)) && !is_label(&channel.name))
        .map(|(_, channel)| (channel.name.as_str(), channel.unit.as_ref()))
        .collect();
    let mut found = families(left.iter().map(|(name, _)| *name));
    found.retain(|family| family.count > 1);
    found.sort_by_key(|family| usize::MAX - family.count);
    let mut named: BTreeSet<String> = BTreeSet::new();
    let mut names = Vec::new();
    for (name, unit) in left {
        if named.contains(name) {
            continue;
        }
        let members = |family: &Family| -> Vec<String> {
            (0..family.count).map(|k| family.member(k)).collect()
        };
        let family = found.iter().map(members).find(|members| {
            let is_free = members.iter().all(|member| !named.contains(member));
            is_free && members.iter().any(|member| member == name)
        });
        match family {
            Some(members) => {
                let ends = format!("{} to {}", members[0], members[members.len() - 1]);
                names.push(with_unit(&ends, unit));
                named.extend(members);
            }
            None => names.push(with_unit(name, unit)),
        }
    }
    let texts = series.texts.iter().enumerate();
    // Labels join the poses of several series without an entry of their own.
    let texts = texts.filter(|(k, text)| !used.contains(&(true, *k)) && !is_label(&text.name));
    names.extend(texts.map(|(_, text)| text.name.clone()));
    names
}

/// The channels of files in words, those that differ by a number only together.
#[must_use]
pub fn channel_names(sources: &[Source]) -> String {
    let series = sources.iter().flat_map(|source| &source.series);
    let names = series.flat_map(|series| unused_names(series, &BTreeSet::new()));
    listed(&names.collect::<Vec<_>>())
}

fn listed(names: &[String]) -> String {
    match names.len() {
        count if count > MOST => format!("{} and {} more", names[..MOST].join(", "), count - MOST),
        _ => names.join(", "),
    }
}

/// States which instruments of the robot have no channel.
pub(crate) fn without_channel(mapping: &Mapping<'_>, robot: &Robot) -> Option<String> {
    let has = |kinds: &[Kind]| {
        let mut mapped = mapping.quantities.keys();
        mapped.any(|quantity| kinds.contains(&quantity.kind))
    };
    let reads_swivel = robot
        .cables
        .iter()
        .any(|c| c.pulley.swivel_sd_rad.is_some());
    let instruments = [
        (robot.laser.is_some(), "a laser", [Kind::Laser].as_slice()),
        (robot.has_force_sensors(), "force sensors", &[Kind::Force]),
        (
            robot.inclinometer.is_some(),
            "an inclinometer",
            &[Kind::Inclination],
        ),
        (
            robot.tracker.is_some(),
            "a tracker",
            &[Kind::Tracked, Kind::Marker],
        ),
        (reads_swivel, "swivel sensors", &[Kind::Swivel]),
    ];
    let missing: Vec<&str> = instruments
        .iter()
        .filter(|(is_there, _, kinds)| *is_there && !has(kinds))
        .map(|(_, name, _)| *name)
        .collect();
    let them = match missing[..] {
        [] => return None,
        ["force sensors" | "swivel sensors"] => "them",
        [_] => "it",
        _ => "them",
    };
    let names = missing.join(" and ");
    Some(format!(
        "the robot has {names}, but there is no channel for {them}"
    ))
}

#[cfg(test)]
mod tests {
    use tautline_channels::{Channel, Format, Source};
    use tautline_core::robot::presets;

    use super::*;
    use crate::recipe::{Assignment, Recipe, resolve};

    fn channel(name: &str, unit: Option<&str>) -> Channel {
        Channel {
            name: name.into(),
            unit: unit.map(Into::into),
            values: vec![1.0, 2.0].into(),
        }
    }

    #[test]
    fn what_is_left_over_is_named() {
        let rev = (1..=8).map(|k| channel(&format!("W{k}"), Some("rev")));
        let speed = (1..=8).map(|k| channel(&format!("v{k}"), Some("mm/s")));
        let single = [channel("LDS", Some("mm")), channel("index", None)];
        let series = |name: &str, channels: Vec<Channel>| Series {
            name: name.into(),
            rows: 2,
            channels,
            ..Series::default()
        };
        let log = rev.chain(speed).chain(single).collect();
        let sources = [Source {
            file: "log.csv".into(),
            format: Format::Table,
            series: vec![
                series("log", log),
                series("spare", vec![channel("a", None)]),
            ],
            notices: Vec::new(),
        }];
        let recipe = Recipe {
            channels: vec![Assignment::new("W{i}", "rev_{i}")],
            ..Recipe::default()
        };
        let mapping = resolve(&sources, &recipe, "recipe", 8).expect("channels");
        assert_eq!(
            unused(&mapping),
            [
                "log: not used: v1 to v8 [mm/s], LDS [mm], index",
                "no channel is used of spare",
            ]
        );
        let mut robot = presets::find("mini").expect("a preset").robot;
        assert_eq!(
            without_channel(&mapping, &robot).as_deref(),
            Some("the robot has a laser and force sensors, but there is no channel for them")
        );
        for cable in &mut robot.cables {
            cable.force_sensor = None;
        }
        assert_eq!(
            without_channel(&mapping, &robot).as_deref(),
            Some("the robot has a laser, but there is no channel for it")
        );
        robot.laser = None;
        assert_eq!(without_channel(&mapping, &robot), None);
    }
}
