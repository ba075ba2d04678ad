//! Edits of a recipe: assignments of single channels and of patterns.

use super::{Assignment, Quantity, Recipe};

/// Placeholder of the cable number in names of channels and columns.
const NUMBER: &str = "{i}";

impl Assignment {
    /// Whether the entry is a pattern that assigns one channel per cable.
    #[must_use]
    pub fn is_pattern(&self) -> bool {
        self.quantity.contains(NUMBER)
    }

    /// The entry of one cable, counted from 0; the entry itself if it is not a pattern.
    #[must_use]
    pub fn of_cable(&self, cable: usize) -> Self {
        if !self.is_pattern() {
            return self.clone();
        }
        Self {
            channel: self.channel_of(cable),
            quantity: self.quantity.replacen(NUMBER, &(cable + 1).to_string(), 1),
            first: 1,
            ..self.clone()
        }
    }

    /// The channel of a cable, counted from 0.
    #[must_use]
    pub fn channel_of(&self, cable: usize) -> String {
        let number = (cable + self.first).to_string();
        self.channel.replacen(NUMBER, &number, 1)
    }

    /// One entry per channel, for a robot with `cables` cables.
    fn singles(&self, cables: usize) -> Vec<Self> {
        let count = if self.is_pattern() { cables } else { 1 };
        (0..count).map(|cable| self.of_cable(cable)).collect()
    }

    /// Whether a channel name matches the pattern of the entry with any number.
    pub(crate) fn is_pattern_of(&self, name: &str) -> bool {
        let Some((before, after)) = self.channel.split_once(NUMBER) else {
            return false;
        };
        let number = name
            .strip_prefix(before)
            .and_then(|rest| rest.strip_suffix(after));
        number.is_some_and(|number| number.parse::<usize>().is_ok())
    }

    fn is_of(&self, series: &str, channel: &str) -> bool {
        let named = self.series.as_ref();
        self.channel == channel && named.is_none_or(|named| series.ends_with(named.as_str()))
    }
}

impl Recipe {
    /// The entry that assigns a channel; `None` if the channel is not used.
    #[must_use]
    pub fn entry_of(&self, series: &str, channel: &str, cables: usize) -> Option<&Assignment> {
        self.channels
            .iter()
            .enumerate()
            .rev()
            .find_map(|(k, entry)| {
                let singles = entry.singles(cables);
                let own = singles.iter().find(|one| one.is_of(series, channel))?;
                // A later entry with the same quantity supersedes this one.
                let is_replaced = self.channels[k + 1..]
                    .iter()
                    .flat_map(|later| later.singles(cables))
                    .any(|later| later.quantity == own.quantity && later.quantity != "time_s");
                (!is_replaced).then_some(entry)
            })
    }

    /// Assigns a channel or the channels of a pattern, replacing earlier assignments of these channels and quantities.
    pub fn assign(&mut self, series: &str, assignment: Assignment, cables: usize) {
        for one in assignment.singles(cables) {
            self.release(series, &one.channel, cables);
            if Quantity::parse(&one.quantity).is_some_and(|quantity| quantity.column() != "time_s")
            {
                self.channels.retain(|entry| entry.quantity != one.quantity);
            }
            self.left_empty.retain(|column| *column != one.quantity);
        }
        self.channels
            .retain(|entry| !assignment.is_pattern() || entry.quantity != assignment.quantity);
        self.channels.push(assignment);
    }

    /// Removes the assignment of a channel. A pattern that contains it is split into entries for the other cables.
    pub fn release(&mut self, series: &str, channel: &str, cables: usize) {
        let mut kept = Vec::with_capacity(self.channels.len());
        for entry in self.channels.drain(..) {
            let singles = entry.singles(cables);
            if singles.iter().any(|one| one.is_of(series, channel)) {
                let others = singles.into_iter();
                kept.extend(others.filter(|one| !one.is_of(series, channel)));
            } else {
                kept.push(entry);
            }
        }
        self.channels = kept;
    }

    /// The recipe for another recording: without encoder steps and clocks, which belong to this one.
    #[must_use]
    pub fn for_another(&self) -> Self {
        Self {
            steps: Vec::new(),
            clocks: Vec::new(),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe() -> Recipe {
        Recipe {
            channels: vec![
                Assignment::new("W{i}.Pos", "rev_{i}"),
                Assignment::new("F{i}", "force_{i}_n"),
            ],
            ..Recipe::default()
        }
    }

    fn quantity(recipe: &Recipe, channel: &str) -> Option<String> {
        let entry = recipe.entry_of("log", channel, 3)?;
        let singles = entry.singles(3).into_iter();
        let mut own = singles.filter(|one| one.channel == channel);
        own.next().map(|one| one.quantity)
    }

    #[test]
    fn a_channel_of_a_pattern_becomes_something_else() {
        let mut recipe = recipe();
        recipe.assign("log", Assignment::new("W2.Pos", "length_2_m"), 3);
        assert_eq!(quantity(&recipe, "W1.Pos").as_deref(), Some("rev_1"));
        assert_eq!(quantity(&recipe, "W2.Pos").as_deref(), Some("length_2_m"));
        assert_eq!(quantity(&recipe, "W3.Pos").as_deref(), Some("rev_3"));
        recipe.release("log", "W2.Pos", 3);
        assert_eq!(quantity(&recipe, "W2.Pos"), None);
        let columns: Vec<&str> = recipe
            .channels
            .iter()
            .map(|one| one.quantity.as_str())
            .collect();
        assert_eq!(columns, ["rev_1", "rev_3", "force_{i}_n"]);
    }

    #[test]
    fn a_pattern_replaces_what_its_quantities_were() {
        let mut recipe = recipe();
        recipe.assign("log", Assignment::new("laser", "rev_2"), 3);
        recipe.assign("log", Assignment::new("Enc{i}", "rev_{i}"), 3);
        assert_eq!(quantity(&recipe, "W1.Pos"), None);
        assert_eq!(quantity(&recipe, "laser"), None);
        assert_eq!(quantity(&recipe, "Enc3").as_deref(), Some("rev_3"));
        assert_eq!(quantity(&recipe, "F3").as_deref(), Some("force_3_n"));
    }

    #[test]
    fn a_later_entry_takes_a_quantity_from_an_earlier_channel() {
        let mut recipe = recipe();
        recipe.channels.push(Assignment::new("Spare", "rev_2"));
        assert_eq!(quantity(&recipe, "W2.Pos"), None);
        assert_eq!(quantity(&recipe, "Spare").as_deref(), Some("rev_2"));
    }

    #[test]
    fn series_tell_channels_of_one_name_apart() {
        let mut recipe = Recipe::default();
        let of = |series: &str| Assignment {
            series: Some(series.into()),
            ..Assignment::new("x", "x_m")
        };
        recipe.assign("take 1", of("take 1"), 3);
        assert!(recipe.entry_of("take 1", "x", 3).is_some());
        assert!(recipe.entry_of("take 2", "x", 3).is_none());
        recipe.release("take 2", "x", 3);
        assert!(recipe.entry_of("take 1", "x", 3).is_some());
    }
}
