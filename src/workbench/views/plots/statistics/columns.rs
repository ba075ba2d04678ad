//! Visible columns of the table. If there is no room for all, the columns that name the row stay and the others are
//! paged, so that none is cut off.

use std::ops::Range;

use super::rows::Heading;

/// Smallest width of a column of names (points).
const LEAST: f32 = 72.0;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VisibleColumns {
    /// Widths of the columns that name the row (points).
    pub(crate) names: Vec<f32>,
    /// Indices of the other columns.
    pub(crate) others: Range<usize>,
    /// Whether there are more to the left and to the right.
    pub(crate) more: [bool; 2],
}

impl VisibleColumns {
    /// Visible columns of a table of this width, with `space` after each (points): the first `names`, and the others
    /// from index `from` on, or from an earlier one if that would leave room unused.
    pub(crate) fn of(heads: &[Heading], names: usize, from: usize, width: f32, space: f32) -> Self {
        let (naming, others) = heads.split_at(names.min(heads.len()));
        let widest = others.iter().map(|head| head.width).fold(0.0, f32::max);
        let mut named: Vec<f32> = naming.iter().map(|head| head.width).collect();
        let taken = |named: &[f32]| named.iter().map(|width| width + space).sum::<f32>();
        let missing = taken(&named) + widest - width;
        if let Some(longest) = named.iter_mut().max_by(|a, b| a.total_cmp(b)) {
            // A name is shortened before a number is cut off.
            *longest = (*longest - missing.max(0.0)).max(LEAST.min(*longest));
        }
        let room = width - taken(&named);
        let fits = |range: Range<usize>| {
            let count = range.len();
            let widths = others[range].iter().map(|head| head.width).sum::<f32>();
            count <= 1 || widths + space * (count - 1) as f32 <= room
        };
        let count = others.len();
        let last = (0..count).find(|from| fits(*from..count)).unwrap_or(count);
        let from = from.min(last);
        let ends = (from + 1..=count).rev();
        let to = ends.into_iter().find(|to| fits(from..*to)).unwrap_or(count);
        Self {
            names: named,
            others: names + from..names + to,
            more: [from > 0, to < count],
        }
    }

    /// Indices of all visible columns.
    pub(crate) fn places(&self) -> impl Iterator<Item = usize> + Clone + use<> {
        (0..self.names.len()).chain(self.others.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACE: f32 = 8.0;

    /// Total width of the visible columns (points).
    fn width(seen: &VisibleColumns, heads: &[Heading]) -> f32 {
        let others = heads[seen.others.clone()].iter().map(|head| head.width);
        let widths: Vec<f32> = seen.names.iter().copied().chain(others).collect();
        widths.iter().sum::<f32>() + SPACE * (widths.len() - 1) as f32
    }

    /// Headings of columns with these widths (points).
    fn heads(widths: &[f32]) -> Vec<Heading> {
        let head = |width: &f32| Heading {
            title: "",
            help: "",
            is_number: true,
            width: *width,
        };
        widths.iter().map(head).collect()
    }

    const READINGS: [f32; 10] = [44.0, 150.0, 58.0, 66.0, 54.0, 80.0, 88.0, 80.0, 92.0, 80.0];
    const VALUES: [f32; 8] = [230.0, 70.0, 84.0, 84.0, 80.0, 70.0, 70.0, 150.0];

    #[test]
    fn columns_are_whole_and_all_are_reached_at_every_width() {
        for (widths, names) in [(&READINGS[..], 2), (&VALUES[..], 1)] {
            let heads = &heads(widths);
            for room in [260.0, 400.0, 512.0, 640.0, 760.0, 1200.0] {
                let mut reached = std::collections::BTreeSet::new();
                let mut from = 0;
                loop {
                    let seen = VisibleColumns::of(heads, names, from, room, SPACE);
                    assert!(width(&seen, heads) <= room, "{names} in {room}: {seen:?}");
                    assert!(!seen.others.is_empty());
                    reached.extend(seen.places());
                    if !seen.more[1] {
                        break;
                    }
                    from += 1;
                }
                assert_eq!(reached.len(), heads.len(), "{names} in {room}");
            }
        }
    }

    #[test]
    fn all_columns_are_visible_if_they_have_room() {
        let heads = heads(&READINGS);
        let seen = VisibleColumns::of(&heads, 2, 7, 2000.0, SPACE);
        assert_eq!(seen.places().count(), heads.len());
        assert_eq!(seen.more, [false, false]);
    }
}
