//! Sources with a recipe being edited, with undo.

use std::collections::BTreeMap;
use std::sync::Arc;

use tautline_channels::Source;
use tautline_core::robot::Robot;

use crate::cutting::Times;
use crate::orientation::arrange_per_cable;
use crate::proposal::propose;
use crate::recipe::{Recipe, is_series, resolve};
use crate::sources::make_names_unique;

/// Maximum number of changes that can be undone.
const MOST: usize = 200;

/// Sources with a recipe being edited, and its undo history.
#[derive(Debug, Clone)]
pub struct Draft {
    sources: Arc<Vec<Source>>,
    recipe: Recipe,
    /// Origin of the recipe, as a sentence.
    origin: String,
    /// Assumptions behind the proposal.
    assumptions: Vec<String>,
    undo: Vec<(String, Recipe)>,
    redo: Vec<(String, Recipe)>,
    revision: u64,
}

impl Draft {
    /// Sources with a recipe that is known, such as that of the session, if its channels are there; else with one that is
    /// proposed from names, units and ranges.
    #[must_use]
    pub fn new(mut sources: Vec<Source>, known: Option<Recipe>, robot: &Robot) -> Self {
        arrange_per_cable(&mut sources, robot.cable_count());
        let mut draft = Self {
            sources: Arc::new(sources),
            recipe: Recipe::default(),
            origin: String::new(),
            assumptions: Vec::new(),
            undo: Vec::new(),
            redo: Vec::new(),
            revision: 0,
        };
        let cables = robot.cable_count();
        match known.map(|known| known.for_another()) {
            Some(known) if resolve(&draft.sources, &known, "recipe", cables).is_ok() => {
                draft.recipe = known;
                draft.origin = "The recipe of the last import fits this file and is used.".into();
            }
            _ => draft.propose(robot),
        }
        draft
    }

    fn propose(&mut self, robot: &Robot) {
        (self.recipe, self.assumptions) = propose(&self.sources, robot);
        self.origin = "A recipe is proposed from names, units and ranges.".into();
        self.revision += 1;
    }

    /// Adds sources and proposes entries for their channels.
    pub fn add(&mut self, mut more: Vec<Source>, robot: &Robot) {
        arrange_per_cable(&mut more, robot.cable_count());
        let sources = Arc::make_mut(&mut self.sources);
        sources.extend(more);
        make_names_unique(sources);
        if self.undo.is_empty() {
            return self.propose(robot);
        }
        let (proposed, assumptions) = propose(&self.sources, robot);
        self.assumptions = assumptions;
        let mut recipe = self.recipe.clone();
        for entry in proposed.channels {
            let is_given = recipe
                .channels
                .iter()
                .any(|known| known.quantity == entry.quantity && entry.quantity != "time_s");
            if !is_given {
                recipe.channels.push(entry);
            }
        }
        self.change("add a file", recipe, false);
        self.revision += 1;
    }

    /// Removes a source; if the recipe used one of its channels, it is proposed anew.
    pub fn remove(&mut self, source: usize, robot: &Robot) {
        let sources = Arc::make_mut(&mut self.sources);
        if source < sources.len() {
            sources.remove(source);
        }
        if resolve(&self.sources, &self.recipe, "recipe", robot.cable_count()).is_err() {
            self.propose(robot);
            (self.undo, self.redo) = (Vec::new(), Vec::new());
        }
        self.revision += 1;
    }

    /// The sources.
    #[must_use]
    pub fn sources(&self) -> &Arc<Vec<Source>> {
        &self.sources
    }

    /// The current recipe.
    #[must_use]
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Origin of the recipe, as a sentence.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// Assumptions behind the proposed recipe.
    #[must_use]
    pub fn assumptions(&self) -> &[String] {
        &self.assumptions
    }

    /// Counter of changes to sources and recipe.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Replaces the recipe; `what` names the change in the undo history. A continued change, such as dragging a slider, is
    /// merged with the previous one. Returns whether anything changed.
    pub fn change(&mut self, what: impl Into<String>, recipe: Recipe, goes_on: bool) -> bool {
        if recipe == self.recipe {
            return false;
        }
        let what = what.into();
        let before = std::mem::replace(&mut self.recipe, recipe);
        let is_same = goes_on && self.undo.last().is_some_and(|(last, _)| *last == what);
        if !is_same {
            if self.undo.len() == MOST {
                self.undo.remove(0);
            }
            self.undo.push((what, before));
        }
        self.redo.clear();
        self.revision += 1;
        true
    }

    /// Undoes the last change and returns its name.
    pub fn undo(&mut self) -> Option<String> {
        let (what, recipe) = self.undo.pop()?;
        let after = std::mem::replace(&mut self.recipe, recipe);
        self.redo.push((what.clone(), after));
        self.revision += 1;
        Some(what)
    }

    /// Redoes the last undone change and returns its name.
    pub fn redo(&mut self) -> Option<String> {
        let (what, recipe) = self.redo.pop()?;
        let before = std::mem::replace(&mut self.recipe, recipe);
        self.undo.push((what.clone(), before));
        self.revision += 1;
        Some(what)
    }

    /// Name of the change that would be undone next.
    #[must_use]
    pub fn next_undo(&self) -> Option<&str> {
        self.undo.last().map(|(what, _)| what.as_str())
    }

    /// Name of the change that would be redone next.
    #[must_use]
    pub fn next_redo(&self) -> Option<&str> {
        self.redo.last().map(|(what, _)| what.as_str())
    }
}

/// Columns of `poses.csv` to which a recipe assigns channels, by index of the series and name of the channel.
#[must_use]
pub fn uses(
    sources: &[Source],
    recipe: &Recipe,
    cables: usize,
) -> BTreeMap<(usize, String), String> {
    let mut channels: BTreeMap<(String, Option<usize>), (usize, String)> = BTreeMap::new();
    for entry in &recipe.channels {
        let count = if entry.is_pattern() { cables } else { 1 };
        for one in (0..count).map(|cable| entry.of_cable(cable)) {
            let all = sources.iter().flat_map(|source| &source.series).enumerate();
            let found = all.filter(|(_, series)| {
                let meant = one.series.as_deref();
                meant.is_none_or(|meant| is_series(series, meant))
                    && (series.channel(&one.channel).is_some()
                        || series.text(&one.channel).is_some())
            });
            for (k, _) in found {
                // Every series has its own clock.
                let clock = (one.quantity == "time_s").then_some(k);
                let key = (one.quantity.clone(), clock);
                channels.insert(key, (k, one.channel.clone()));
            }
        }
    }
    let mut uses: BTreeMap<(usize, String), String> = BTreeMap::new();
    for ((column, _), place) in channels {
        let used = uses.entry(place).or_default();
        if !used.is_empty() {
            used.push_str(", ");
        }
        used.push_str(&column);
    }
    uses
}

/// Times of the rows of every series (s), on the common clock of the recipe; those of the files where the recipe is wrong.
#[must_use]
pub fn clock_times(sources: &[Source], recipe: &Recipe, robot: &Robot) -> Vec<Option<Vec<f64>>> {
    match resolve(sources, recipe, "recipe", robot.cable_count()) {
        Ok(mapping) => (0..mapping.series.len())
            .map(|k| Times::of(&mapping, k, recipe).time_s)
            .collect(),
        Err(_) => {
            let series = sources.iter().flat_map(|source| &source.series);
            series
                .map(|series| Some(series.time_s.as_ref()?.iter().collect()))
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use tautline_channels::{Channel, Format, Series};

    use super::*;
    use crate::recipe::Assignment;
    use tautline_core::robot::presets;

    fn source(name: &str, channels: &[&str]) -> Source {
        let channel = |name: &&str| Channel {
            name: (*name).into(),
            unit: None,
            values: vec![0.0, 1.0].into(),
        };
        Source {
            file: format!("{name}.csv"),
            format: Format::Table,
            series: vec![Series {
                name: name.into(),
                rows: 2,
                channels: channels.iter().map(channel).collect(),
                ..Series::default()
            }],
            notices: Vec::new(),
        }
    }

    fn draft() -> (Draft, Robot) {
        let robot = presets::find("mini").expect("a preset").robot;
        let draft = Draft::new(vec![source("log", &["a", "b"])], None, &robot);
        (draft, robot)
    }

    #[test]
    fn changes_are_undone_and_those_that_go_on_are_one() {
        let (mut draft, _) = draft();
        let start = draft.recipe().clone();
        let with = |columns: &[&str]| Recipe {
            channels: columns
                .iter()
                .map(|column| Assignment::new("a", *column))
                .collect(),
            ..start.clone()
        };
        assert!(draft.change("map a", with(&["laser_m"]), false));
        assert!(!draft.change("map a", with(&["laser_m"]), false));
        assert!(draft.change("drag", with(&["rev_1"]), true));
        assert!(draft.change("drag", with(&["rev_2"]), true));
        assert_eq!(draft.undo().as_deref(), Some("drag"));
        assert_eq!(*draft.recipe(), with(&["laser_m"]));
        assert_eq!(draft.next_undo(), Some("map a"));
        assert_eq!(draft.redo().as_deref(), Some("drag"));
        assert_eq!(*draft.recipe(), with(&["rev_2"]));
        draft.undo();
        draft.undo();
        assert_eq!(*draft.recipe(), start);
        assert_eq!(draft.undo(), None);
    }

    #[test]
    fn a_known_recipe_is_used_where_its_channels_are() {
        let (_, robot) = draft();
        let known = Recipe {
            channels: vec![Assignment::new("a", "laser_m")],
            steps: vec![crate::recipe::Step {
                quantity: "rev_1".into(),
                from_pose: 3,
                add: Some(1.0),
            }],
            ..Recipe::default()
        };
        let fits = Draft::new(vec![source("next", &["a"])], Some(known.clone()), &robot);
        assert_eq!(fits.recipe().channels, known.channels);
        assert!(
            fits.recipe().steps.is_empty(),
            "the step was in the other file"
        );
        let other = Draft::new(vec![source("next", &["c"])], Some(known), &robot);
        assert!(other.recipe().channels.is_empty());
        assert!(other.origin().contains("proposed"));
    }

    #[test]
    fn the_later_of_two_channels_is_the_quantity() {
        let sources = [source("log", &["a", "b", "W1", "W2"])];
        let recipe = Recipe {
            channels: vec![
                Assignment::new("W{i}", "rev_{i}"),
                Assignment::new("a", "rev_2"),
                Assignment::new("b", "laser_m"),
            ],
            ..Recipe::default()
        };
        let uses = uses(&sources, &recipe, 2);
        let of = |channel: &str| uses.get(&(0, channel.to_owned())).map(String::as_str);
        assert_eq!(of("W1"), Some("rev_1"));
        assert_eq!(of("W2"), None);
        assert_eq!(of("a"), Some("rev_2"));
        assert_eq!(of("b"), Some("laser_m"));
    }
}
