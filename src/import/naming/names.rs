//! Names of channels: numbers in them, and words.

use std::collections::BTreeMap;

use super::words::split_compound;

/// Channels whose names differ by one number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Family {
    /// The name with `{i}` for the number.
    pub pattern: String,
    /// Smallest number.
    pub first: usize,
    /// Number of members.
    pub count: usize,
}

impl Family {
    /// The name of a member, counted from 0.
    pub fn member(&self, k: usize) -> String {
        self.pattern
            .replacen("{i}", &(self.first + k).to_string(), 1)
    }
}

/// The families among names: names that differ in one number only, with consecutive numbers.
pub(crate) fn families<'a>(names: impl Iterator<Item = &'a str>) -> Vec<Family> {
    let mut patterns: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for name in names {
        for (pattern, number) in patterns_of(name) {
            patterns.entry(pattern).or_default().push(number);
        }
    }
    let mut families = Vec::new();
    for (pattern, mut numbers) in patterns {
        numbers.sort_unstable();
        numbers.dedup();
        let first = numbers[0];
        let whole = numbers
            .iter()
            .enumerate()
            .all(|(k, number)| *number == first + k);
        if whole && first <= 1 {
            families.push(Family {
                pattern,
                first,
                count: numbers.len(),
            });
        }
    }
    families
}

/// The pattern of a family with one channel per cable to which a name belongs, and the number of its first channel; if the
/// name contains several numbers, the pattern with as many channels as cables.
pub fn pattern_of<'a>(
    names: impl Iterator<Item = &'a str>,
    name: &str,
    cables: usize,
) -> Option<(String, usize)> {
    let own = patterns_of(name);
    let is_own = |family: &Family| {
        let numbers = family.first..family.first + family.count.min(cables);
        own.iter()
            .any(|(pattern, number)| *pattern == family.pattern && numbers.contains(number))
    };
    let found = families(names)
        .into_iter()
        .filter(|family| family.count >= cables && is_own(family));
    let best = found.min_by_key(|family| family.count)?;
    Some((best.pattern, best.first))
}

/// The name with each of its numbers in turn replaced by `{i}`.
fn patterns_of(name: &str) -> Vec<(String, usize)> {
    let bytes = name.as_bytes();
    let mut patterns = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if !bytes[at].is_ascii_digit() {
            at += 1;
            continue;
        }
        let end = bytes[at..]
            .iter()
            .position(|byte| !byte.is_ascii_digit())
            .map_or(bytes.len(), |length| at + length);
        // Numbers with leading zeros would need another pattern for each length.
        let canonical = end - at <= 3 && (bytes[at] != b'0' || end - at == 1);
        if canonical && let Ok(number) = name[at..end].parse() {
            patterns.push((format!("{}{{i}}{}", &name[..at], &name[end..]), number));
        }
        at = end;
    }
    patterns
}

/// The words of a name, in lower case, and the known words of compounds: `GVL.Winch1_ActPos [mm]` is gvl, winch, act, pos, mm.
pub(crate) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let letters: Vec<char> = name.chars().collect();
    for (k, letter) in letters.iter().enumerate() {
        if !letter.is_alphabetic() {
            continue;
        }
        let last = k.checked_sub(1).map_or(' ', |before| letters[before]);
        let next = letters.get(k + 1).copied().unwrap_or(' ');
        let begins = !last.is_alphabetic()
            || (letter.is_uppercase() && last.is_lowercase())
            // The last capital of several begins a word: `LCForce`.
            || (letter.is_uppercase() && last.is_uppercase() && next.is_lowercase());
        if begins {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut() {
            word.extend(letter.to_lowercase());
        }
    }
    let parts = |word: String| -> Vec<String> {
        let parts = split_compound(&word).into_iter();
        parts.map(str::to_owned).collect()
    };
    words.into_iter().flat_map(parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_by_one_number_are_a_family() {
        let names = [
            "time",
            "Winch1.Pos",
            "Winch2.Pos",
            "Winch3.Pos",
            "x[0]",
            "x[1]",
            "F1",
            "F3",
            "t2",
        ];
        let found = families(names.into_iter());
        let family = |pattern: &str, first, count| Family {
            pattern: pattern.into(),
            first,
            count,
        };
        assert_eq!(
            found,
            [family("Winch{i}.Pos", 1, 3), family("x[{i}]", 0, 2)]
        );
    }

    #[test]
    fn the_pattern_of_a_channel_has_one_for_each_cable() {
        let names = ["A1.W1", "A1.W2", "A1.W3", "A2.W1", "t"];
        let of = |name| pattern_of(names.into_iter(), name, 3);
        assert_eq!(of("A1.W2"), Some(("A1.W{i}".into(), 1)));
        assert_eq!(of("A2.W1"), None);
        assert_eq!(of("t"), None);
    }

    #[test]
    fn names_are_split_into_words() {
        assert_eq!(
            words("GVL.Winch1_ActPos [mm]"),
            ["gvl", "winch", "act", "pos", "mm"]
        );
        assert_eq!(words("fKraft"), ["f", "kraft"]);
        assert_eq!(words("Seillänge 3"), ["seillänge"]);
        assert_eq!(words("LCForce_1"), ["lc", "force"]);
        assert_eq!(words("Motorwinkel[2]"), ["motor", "winkel"]);
        assert_eq!(words("cablelengthdot"), ["cable", "length", "dot"]);
        assert_eq!(words("xSoll px posz"), ["x", "soll", "p", "x", "pos", "z"]);
        assert_eq!(
            words("distal offset listed"),
            ["distal", "offset", "listed"]
        );
    }
}
