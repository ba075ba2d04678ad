//! Notifications: values that a controller sends in every cycle.
//!
//! A frame holds stamps, each with the values of one instant; a stamp holds samples, each with the bytes of one subscribed symbol.

use std::collections::BTreeMap;

/// Time units of subscriptions and stamps per second.
const UNITS_PER_S: f64 = 1e7;
/// Transmission mode: the controller sends in every cycle, whether values have changed or not.
const EVERY_CYCLE: u32 = 3;
/// Length of the reserved part of a subscription (bytes).
const RESERVED: usize = 16;

/// The end of a subscription request, after the address: transmission mode and interval.
pub(super) fn cycle(every_s: f64) -> Vec<u8> {
    // No delay beyond the cycle, so that values are shown at once.
    let words = [EVERY_CYCLE, 0, units(every_s)].map(u32::to_le_bytes);
    [words.concat(), vec![0; RESERVED]].concat()
}

/// An interval in units of subscriptions and stamps.
fn units(every_s: f64) -> u32 {
    // The cast saturates, as intended.
    (every_s * UNITS_PER_S).round() as u32
}

/// Values of one instant, by subscription.
pub(super) type NotifiedValues = BTreeMap<u32, Vec<u8>>;

/// Collects the values of one instant. They may arrive in several frames and, as subscriptions begin in different cycles of
/// the controller, with stamps that differ by less than the interval of the subscriptions.
#[derive(Debug)]
pub(super) struct Rows {
    /// Interval of the subscriptions, in units of the stamps.
    every: u64,
    /// Values received since the last row, with their stamps.
    latest: BTreeMap<u32, (u64, Vec<u8>)>,
}

impl Rows {
    /// Rows of subscriptions that are sent every `every_s` seconds.
    pub fn new(every_s: f64) -> Self {
        Self {
            every: u64::from(units(every_s)),
            latest: BTreeMap::new(),
        }
    }

    /// Adds a frame and returns the rows that have a value for each of `subscriptions` subscriptions. Inconsistent
    /// frames and rows with gaps are dropped.
    pub fn take(&mut self, frame: &[u8], subscriptions: usize) -> Vec<NotifiedValues> {
        let mut full = Vec::new();
        for (stamp, samples) in parse(frame).unwrap_or_default() {
            for (handle, bytes) in samples {
                self.latest.insert(handle, (stamp, bytes.to_vec()));
            }
            // A value older than an interval is replaced by its successor.
            self.latest
                .retain(|_, (at, _)| stamp.abs_diff(*at) < self.every);
            if self.latest.len() == subscriptions {
                let row = std::mem::take(&mut self.latest).into_iter();
                full.push(row.map(|(handle, (_, bytes))| (handle, bytes)).collect());
            }
        }
        full
    }
}

type Stamp<'a> = (u64, Vec<(u32, &'a [u8])>);

/// The stamps of a frame; `None` if its lengths are inconsistent.
fn parse(frame: &[u8]) -> Option<Vec<Stamp<'_>>> {
    let mut bytes = Bytes(frame);
    let (length, count) = (bytes.word()?, bytes.word()?);
    if usize::try_from(length).ok()? != bytes.0.len() + 4 {
        return None;
    }
    let mut stamps = Vec::new();
    for _ in 0..count {
        let stamp = u64::from_le_bytes(bytes.take(8)?.try_into().ok()?);
        let mut samples = Vec::new();
        for _ in 0..bytes.word()? {
            let (handle, size) = (bytes.word()?, bytes.word()?);
            samples.push((handle, bytes.take(usize::try_from(size).ok()?)?));
        }
        stamps.push((stamp, samples));
    }
    bytes.0.is_empty().then_some(stamps)
}

struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn word(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of an interval of ten units.
    fn empty() -> Rows {
        Rows::new(10.0 / UNITS_PER_S)
    }

    type Samples<'a> = &'a [(u32, &'a [u8])];

    fn frame(stamps: &[(u64, Samples<'_>)]) -> Vec<u8> {
        let mut rest = (stamps.len() as u32).to_le_bytes().to_vec();
        for (stamp, samples) in stamps {
            rest.extend(stamp.to_le_bytes());
            rest.extend((samples.len() as u32).to_le_bytes());
            for (handle, bytes) in *samples {
                rest.extend(handle.to_le_bytes());
                rest.extend((bytes.len() as u32).to_le_bytes());
                rest.extend(*bytes);
            }
        }
        [&(rest.len() as u32).to_le_bytes()[..], &rest].concat()
    }

    fn row(values: [&[u8]; 2]) -> NotifiedValues {
        (1..).zip(values.map(<[u8]>::to_vec)).collect()
    }

    #[test]
    fn rows_are_complete_however_they_are_cut_into_frames() {
        let (a, b, c, d): ([u8; 2], [u8; 1], [u8; 2], [u8; 1]) = ([1, 2], [3], [4, 5], [6]);
        let expected = vec![row([&a, &b]), row([&c, &d])];
        let whole = frame(&[(10, &[(1, &a), (2, &b)]), (20, &[(1, &c), (2, &d)])]);
        assert_eq!(empty().take(&whole, 2), expected);
        let mut rows = empty();
        let parts = [
            frame(&[(10, &[(1, &a)])]),
            frame(&[(10, &[(2, &b)]), (20, &[(2, &d)])]),
            frame(&[(20, &[(1, &c)])]),
        ];
        let taken: Vec<NotifiedValues> = parts.iter().flat_map(|part| rows.take(part, 2)).collect();
        assert_eq!(taken, expected);
    }

    #[test]
    fn subscriptions_of_different_cycles_are_put_together() {
        let value = |number: u8| [number];
        let mut rows = empty();
        for cycle in 0..5 {
            let at = 100 + 10 * u64::from(cycle);
            let first = frame(&[(at, &[(1, &value(cycle))])]);
            assert!(rows.take(&first, 2).is_empty());
            let second = frame(&[(at + 7, &[(2, &value(cycle + 100))])]);
            let expected = row([&value(cycle), &value(cycle + 100)]);
            assert_eq!(rows.take(&second, 2), [expected]);
        }
    }

    #[test]
    fn rows_with_gaps_and_frames_that_do_not_add_up_are_left_out() {
        let mut rows = empty();
        assert!(rows.take(&frame(&[(10, &[(1, &[1])])]), 2).is_empty());
        let next = frame(&[(20, &[(2, &[2])]), (20, &[(1, &[3])])]);
        assert_eq!(rows.take(&next, 2), [row([&[3], &[2]])]);
        let whole = frame(&[(30, &[(1, &[1, 2]), (2, &[3])])]);
        for length in 0..whole.len() {
            assert!(empty().take(&whole[..length], 2).is_empty(), "{length}");
        }
        let mut huge = whole.clone();
        huge[4..8].fill(0xff);
        assert!(empty().take(&huge, 2).is_empty());
        assert!(empty().take(&[whole, vec![0]].concat(), 2).is_empty());
    }

    #[test]
    fn a_cycle_is_stated_in_units_of_100_ns() {
        let words = cycle(0.01);
        assert_eq!(words[..4], [3, 0, 0, 0]);
        assert_eq!(words[8..12], 100_000_u32.to_le_bytes());
        assert_eq!(words.len(), 28);
    }
}
