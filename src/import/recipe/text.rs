//! Assignments as a line of text: `rev_{i}=theta(:,{i}) [rad]`.

use tautline_channels::{Series, Source};
use tautline_files::quoted;

use super::{Assignment, Quantity};
use crate::coverage::channel_names;

impl Assignment {
    /// As [`Self::parse`], for channels with names in place of numbers, too: `length_{i}_m=belt_{tl,tr,br,bl} [mm]`.
    ///
    /// # Errors
    /// Those of [`Self::parse`], for the first name that has one.
    pub fn parse_each(text: &str, sources: &[Source]) -> Result<Vec<Self>, String> {
        let list = || {
            let (column, channel) = text.split_once('=')?;
            let (before, rest) = channel.split_once('{')?;
            let (names, after) = rest
                .split_once('}')
                .filter(|(list, _)| list.contains(','))?;
            let line = |(k, name): (usize, &str)| {
                let column = column.replacen("{i}", &(k + 1).to_string(), 1);
                format!("{column}={before}{}{after}", name.trim())
            };
            Some(names.split(',').enumerate().map(line).collect::<Vec<_>>())
        };
        match (Self::parse(text, sources), list()) {
            (Err(_), Some(lines)) => lines
                .iter()
                .map(|line| Self::parse(line, sources))
                .collect(),
            (whole, _) => whole.map(|one| vec![one]),
        }
    }

    /// Reads `COLUMN=CHANNEL [UNIT]` with `{i}` for the number of the cable, which the channels may count from 0.
    ///
    /// # Errors
    /// If the column is none of `poses.csv`, the unit does not fit, or no series or several have the channel.
    pub fn parse(text: &str, sources: &[Source]) -> Result<Self, String> {
        let Some((column, channel)) = text.split_once('=') else {
            return Err(format!(
                "found {}, expected COLUMN=CHANNEL [UNIT], such as rev_{{i}}=theta(:,{{i}}) [rad]",
                quoted(text)
            ));
        };
        let column = column.trim();
        let Some(quantity) = Quantity::parse_pattern(column) else {
            return Err(format!(
                "found the column {}, expected one of poses.csv, such as rev_{{i}}, length_{{i}}_m, force_{{i}}_n, laser_m, x_m or time_s",
                quoted(column)
            ));
        };
        // `x[3]` is a name, `x [mm]` has a unit.
        let unit = channel
            .trim()
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once(" ["));
        let (channel, unit) = match unit {
            Some((channel, unit)) => (channel.trim(), Some(unit.trim())),
            None => (channel.trim(), None),
        };
        if let Some(unit) = unit
            && quantity.conversion(unit).is_none()
        {
            let expected = quantity.expected_unit();
            return Err(format!(
                "found the unit {} for {column}, expected {expected}",
                quoted(unit)
            ));
        }
        let has = |series: &&Series, first: usize| {
            let name = channel.replacen("{i}", &first.to_string(), 1);
            series.channel(&name).is_some() || series.text(&name).is_some()
        };
        let series = || sources.iter().flat_map(|source| &source.series);
        let first = [0, 1]
            .into_iter()
            .find(|first| series().any(|one| has(&one, *first)));
        let Some(first) = first else {
            return Err(format!(
                "found no channel {}, expected one of {}",
                quoted(channel),
                channel_names(sources)
            ));
        };
        let of: Vec<&str> = series()
            .filter(|one| has(one, first))
            .map(|one| one.name.as_str())
            .collect();
        if of.len() > 1 {
            return Err(format!(
                "found {} in the series {}, expected a recipe with the key \"series\" (--recipe-out writes one)",
                quoted(channel),
                of.join(" and ")
            ));
        }
        Ok(Self {
            unit: unit.map(str::to_owned),
            first: if channel.contains("{i}") { first } else { 1 },
            ..Self::new(channel, column)
        })
    }
}

#[cfg(test)]
mod tests {
    use tautline_channels::{Channel, Format};

    use super::*;

    fn sources() -> [Source; 1] {
        let names = ["theta(:,1)", "theta(:,2)", "F0", "F1", "x[3]", "LDS"];
        let channel = |name: &&str| Channel {
            name: (*name).into(),
            ..Channel::default()
        };
        [Source {
            file: "log.mat".into(),
            format: Format::Matlab,
            series: vec![Series {
                name: "log".into(),
                channels: names.iter().map(channel).collect(),
                ..Series::default()
            }],
            notices: Vec::new(),
        }]
    }

    #[test]
    fn assignments_are_read_from_text() {
        let parse = |text: &str| Assignment::parse(text, &sources());
        let rev = Assignment {
            unit: Some("rad".into()),
            ..Assignment::new("theta(:,{i})", "rev_{i}")
        };
        assert_eq!(parse("rev_{i}=theta(:,{i}) [rad]"), Ok(rev));
        let force = Assignment {
            first: 0,
            ..Assignment::new("F{i}", "force_{i}_n")
        };
        assert_eq!(parse(" force_{i}_n = F{i} "), Ok(force));
        assert_eq!(parse("x_m=x[3]"), Ok(Assignment::new("x[3]", "x_m")));
        let counts = parse("rev_1=theta(:,1) [rev/4096]").expect("an assignment");
        assert_eq!(counts.unit.as_deref(), Some("rev/4096"));
    }

    #[test]
    fn names_may_stand_in_place_of_numbers() {
        let each = |text: &str| Assignment::parse_each(text, &sources());
        let named = each("force_{i}_n={LDS, x[3]} [kN]").expect("two");
        let named: Vec<_> = named
            .iter()
            .map(|one| (&*one.channel, &*one.quantity))
            .collect();
        assert_eq!(named, [("LDS", "force_1_n"), ("x[3]", "force_2_n")]);
        assert_eq!(each("x_m=x[3]"), Ok(vec![Assignment::new("x[3]", "x_m")]));
        let unknown = each("force_{i}_n=F{0,7}").expect_err("no F7");
        assert!(unknown.starts_with("found no channel \"F7\""), "{unknown}");
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, part) in [
            ("rev_1", "found \"rev_1\", expected COLUMN=CHANNEL [UNIT]"),
            (
                "ref_{i}=F{i}",
                "found the column \"ref_{i}\", expected one of poses.csv",
            ),
            (
                "laser_m=LDS [N]",
                "found the unit \"N\" for laser_m, expected a unit of length",
            ),
            (
                "laser_m=laser",
                "found no channel \"laser\", expected one of theta(:,1) to theta(:,2), F0 to F1, x[3], LDS",
            ),
        ] {
            let error = Assignment::parse(text, &sources()).expect_err(text);
            assert!(error.contains(part), "{error} lacks {part}");
        }
    }
}
