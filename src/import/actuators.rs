//! Logs with one row per actuator: a column with the number of the cable, and rows that follow each other for all cables.

use std::collections::BTreeMap;

use tautline_channels::{Channel, Series, Source, TextChannel};

use crate::naming::words::TIME;
use crate::naming::words_of;

/// Words of a column with the number of an actuator.
const NUMBER: &[&str] = &[
    "id", "index", "idx", "axis", "achse", "motor", "cable", "seil", "winch", "winde", "joint",
    "actuator", "drive", "node", "channel", "kanal", "nr", "no", "number",
];
/// Share of the rows of an actuator that may be missing, relative to the one with most rows.
const MISSING: f64 = 0.1;

/// Gives each channel of a log with one row per actuator one channel for each cable; a notice of the file says so.
pub(crate) fn spread_actuators(sources: &mut [Source], cables: usize) {
    for source in sources {
        for series in &mut source.series {
            let Some(found) = Rows::of(series, cables) else {
                continue;
            };
            source.notices.push(format!(
                "{}: one row for each of the {cables} values of {}{}: its channels are NAME[{}] to NAME[{}]",
                source.file,
                found.number,
                found.of_kind(series),
                found.first,
                found.first + cables - 1
            ));
            *series = found.spread(series, cables);
        }
    }
}

fn is_time(name: &str) -> bool {
    words_of(name)
        .iter()
        .any(|word| TIME.contains(&word.as_str()))
}

/// The rows of the actuators in a series.
struct Rows {
    /// Name of the column with the number.
    number: String,
    /// Smallest number.
    first: usize,
    /// Column of text and its value in these rows, if rows of other devices have other values.
    kind: Option<(usize, u32)>,
    /// Row of each actuator at each time.
    rows: Vec<Vec<Option<usize>>>,
}

impl Rows {
    fn of(series: &Series, cables: usize) -> Option<Self> {
        if cables < 2 || series.rows < 2 * cables {
            return None;
        }
        let is_number = |channel: &&Channel| {
            let words = words_of(&channel.name);
            words.iter().any(|word| NUMBER.contains(&word.as_str())) && channel.unit.is_none()
        };
        let kinds = series.texts.iter().enumerate().flat_map(|(k, text)| {
            let codes = 0..text.distinct.len().min(16) as u32;
            codes.map(move |code| Some((k, code)))
        });
        let kinds: Vec<Option<(usize, u32)>> = std::iter::once(None).chain(kinds).collect();
        let channels = series.channels.iter().filter(is_number);
        channels
            .flat_map(|channel| kinds.iter().map(move |kind| (channel, *kind)))
            .find_map(|(channel, kind)| Self::by(series, channel, kind, cables))
    }

    /// The rows by a column of numbers; `None` unless the numbers of the cables repeat in it.
    fn by(
        series: &Series,
        channel: &Channel,
        kind: Option<(usize, u32)>,
        cables: usize,
    ) -> Option<Self> {
        let is_meant = |row: usize| {
            kind.is_none_or(|(text, code)| series.texts[text].codes.get(row) == Some(&code))
        };
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        let mut rows: Vec<Vec<Option<usize>>> = Vec::new();
        let mut numbers = Vec::new();
        for row in (0..series.rows).filter(|row| is_meant(*row)) {
            let value = channel.values.at(row);
            if !(0.0..1000.0).contains(&value) || value.fract() != 0.0 {
                return None;
            }
            let number = value as usize;
            *counts.entry(number).or_default() += 1;
            numbers.push((row, number));
        }
        let first = *counts.keys().next()?;
        let is_whole = counts.len() == cables && counts.keys().copied().eq(first..first + cables);
        let most = *counts.values().max()? as f64;
        let is_even = counts
            .values()
            .all(|count| *count as f64 >= (1.0 - MISSING) * most);
        if first > 1 || !is_whole || !is_even || most < 2.0 {
            return None;
        }
        // Rows of one time differ in their numbers, and have the same time where there is one.
        let clock = series
            .channels
            .iter()
            .find(|channel| is_time(&channel.name));
        let time = |row: usize| clock.map(|clock| clock.values.at(row));
        let shares_times = numbers
            .windows(2)
            .any(|pair| time(pair[0].0) == time(pair[1].0));
        let is_same_time = |rows: &[Option<usize>], row: usize| {
            let first = rows.iter().flatten().next();
            clock.is_none() || !shares_times || first.is_some_and(|first| time(*first) == time(row))
        };
        for (row, number) in numbers {
            let place = number - first;
            match rows.last_mut() {
                Some(last) if last[place].is_none() && is_same_time(last, row) => {
                    last[place] = Some(row);
                }
                _ => {
                    let mut next = vec![None; cables];
                    next[place] = Some(row);
                    rows.push(next);
                }
            }
        }
        (rows.len() as f64 <= (1.0 + MISSING) * most).then(|| Self {
            number: channel.name.clone(),
            first,
            kind,
            rows,
        })
    }

    fn of_kind(&self, series: &Series) -> String {
        let Some((text, code)) = self.kind else {
            return String::new();
        };
        let text = &series.texts[text];
        format!(
            " where {} is {}, the other rows are not used",
            text.name, text.distinct[code as usize]
        )
    }

    fn spread(&self, series: &Series, cables: usize) -> Series {
        let leader = |row: &Vec<Option<usize>>| row.iter().flatten().next().copied();
        let leaders: Vec<usize> = self.rows.iter().filter_map(leader).collect();
        let mut spread = Series {
            name: series.name.clone(),
            rows: self.rows.len(),
            time_s: series
                .time_s
                .as_ref()
                .map(|times| leaders.iter().map(|row| times.at(*row)).collect()),
            ..Series::default()
        };
        for channel in series
            .channels
            .iter()
            .filter(|channel| channel.name != self.number)
        {
            let of = |cable: usize| -> Vec<f64> {
                let row = |rows: &Vec<Option<usize>>| {
                    rows[cable].map_or(f64::NAN, |row| channel.values.at(row))
                };
                self.rows.iter().map(row).collect()
            };
            let add = |name: String, values: Vec<f64>| Channel {
                name,
                unit: channel.unit.clone(),
                values: values.into(),
            };
            if self.is_common(channel) {
                let values = leaders.iter().map(|row| channel.values.at(*row)).collect();
                spread.channels.push(add(channel.name.clone(), values));
                continue;
            }
            for cable in 0..cables {
                let name = format!("{}[{}]", channel.name, self.first + cable);
                spread.channels.push(add(name, of(cable)));
            }
        }
        let texts = series.texts.iter().enumerate();
        let texts = texts.filter(|(k, _)| self.kind.is_none_or(|(kind, _)| kind != *k));
        spread.texts = texts
            .map(|(_, text)| TextChannel {
                codes: leaders
                    .iter()
                    .filter_map(|row| text.codes.get(*row).copied())
                    .collect(),
                ..text.clone()
            })
            .collect();
        spread
    }

    /// Whether a channel, such as the number of a pose, has the same value for all actuators at each time.
    fn is_common(&self, channel: &Channel) -> bool {
        let is_one = |rows: &Vec<Option<usize>>| {
            let mut values = rows.iter().flatten().map(|row| channel.values.at(*row));
            let first = values.next();
            values.all(|value| Some(value) == first)
        };
        is_time(&channel.name) || self.rows.iter().all(is_one)
    }
}

#[cfg(test)]
mod tests {
    use tautline_channels::{Format, TextChannel};

    use super::*;

    fn channel(name: &str, values: Vec<f64>) -> Channel {
        Channel {
            name: name.into(),
            unit: None,
            values: values.into(),
        }
    }

    fn source(channels: Vec<Channel>, texts: &[&str]) -> Source {
        let mut kinds = TextChannel {
            name: "type".into(),
            ..TextChannel::default()
        };
        for text in texts {
            let known = kinds.distinct.iter().position(|one| one == text);
            let code = known.unwrap_or(kinds.distinct.len());
            if known.is_none() {
                kinds.distinct.push((*text).to_owned());
            }
            kinds.codes.push(code as u32);
        }
        Source {
            file: "log.csv".into(),
            format: Format::Table,
            series: vec![Series {
                name: "log".into(),
                rows: channels[0].values.len(),
                channels,
                texts: (!texts.iter().all(|text| text.is_empty()))
                    .then_some(kinds)
                    .into_iter()
                    .collect(),
                ..Series::default()
            }],
            notices: Vec::new(),
        }
    }

    /// Rows of three motors at four times, between rows of another device; one row is missing.
    #[test]
    fn rows_of_actuators_become_channels_of_each() {
        let mut rows: Vec<(&str, [f64; 3])> = Vec::new();
        for time in 0..40 {
            for id in [2, 1, 3] {
                if (time, id) != (2, 1) {
                    rows.push((
                        "motor",
                        [f64::from(time), f64::from(id), f64::from(10 * time + id)],
                    ));
                }
            }
            rows.push(("imu", [f64::from(time), 7.0, -1.0]));
        }
        let column = |k: usize| rows.iter().map(|(_, row)| row[k]).collect();
        let channels = vec![
            channel("time", column(0)),
            channel("id", column(1)),
            channel("position", column(2)),
        ];
        let kinds: Vec<&str> = rows.iter().map(|(kind, _)| *kind).collect();
        let mut log = [source(channels, &kinds)];
        spread_actuators(&mut log, 3);
        let series = &log[0].series[0];
        let names: Vec<&str> = series
            .channels
            .iter()
            .map(|one| one.name.as_str())
            .collect();
        assert_eq!(names, ["time", "position[1]", "position[2]", "position[3]"]);
        assert!(
            log[0].notices[0]
                .contains("one row for each of the 3 values of id where type is motor")
        );
        assert_eq!(series.rows, 40);
        let times = &series.channels[0].values;
        for (cable, channel) in series.channels[1..].iter().enumerate() {
            let seen = channel
                .values
                .iter()
                .enumerate()
                .filter(|(_, value)| !value.is_nan());
            let mut count = 0;
            for (row, value) in seen {
                assert_eq!(value, 10.0 * times.at(row) + (cable + 1) as f64);
                count += 1;
            }
            assert_eq!(count, if cable == 0 { 39 } else { 40 });
        }
    }

    #[test]
    fn other_numbers_are_left_alone() {
        let pose: Vec<f64> = (0..24).map(f64::from).collect();
        let state: Vec<f64> = (0..24).map(|row| f64::from(row / 8)).collect();
        let before = source(
            vec![channel("no", pose), channel("axis state", state)],
            &["a"; 24],
        );
        let mut after = [before.clone()];
        spread_actuators(&mut after, 3);
        assert_eq!(after[0], before);
    }
}
