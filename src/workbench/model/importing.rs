//! Files of other programs on their way into the session.

use std::collections::BTreeMap;
use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_import::{
    Change, Draft, ImportError, Imported, PoseReport, Recipe, Source, Suggestion, uses,
};
use tautline_workflow::importing::Outlines;
use tautline_workflow::readiness::CheckItem;

/// A channel, by the indices of its series and of itself; those of text follow those of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ChannelPlace {
    /// Index of the series among those of all sources.
    pub series: usize,
    /// Index in it.
    pub channel: usize,
}

/// Poses that were cut with a recipe, or why there are none.
#[derive(Debug)]
pub struct Cut {
    /// The revision of the draft that it is of.
    pub revision: u64,
    pub result: Result<Imported, ImportError>,
    /// The check of the poses as readings of the robot.
    pub checks: Vec<CheckItem>,
    /// Times of the rows of each series (s), on the common clock.
    pub times: Vec<Option<Vec<f64>>>,
}

impl Cut {
    /// The poses as they lie in the recording, also where they cannot be those of the robot.
    #[must_use]
    pub fn poses(&self) -> &[PoseReport] {
        match &self.result {
            Ok(imported) => &imported.document.poses,
            Err(error) => &error.poses,
        }
    }

    /// What the check of the data suggests.
    #[must_use]
    pub fn suggestions(&self) -> &[Suggestion] {
        match &self.result {
            Ok(imported) => &imported.document.suggestions,
            Err(error) => &error.suggestions,
        }
    }
}

/// Sources with their recipe and the poses cut with it.
#[derive(Debug)]
pub struct OpenImport {
    pub draft: Draft,
    /// Courses of the channels.
    pub outlines: Arc<Outlines>,
    /// What the recipe makes of the channels: columns of poses.csv by series and name.
    pub uses: BTreeMap<(usize, String), String>,
    /// The last cut; of an older revision while a new one is made.
    pub cut: Option<Arc<Cut>>,
    pub shown: ChannelPlace,
    /// Whether its poses are in a session, so that the next file begins another import.
    pub is_taken: bool,
}

impl OpenImport {
    #[must_use]
    pub fn new(sources: Vec<Source>, known: Option<Recipe>, robot: &Robot) -> Self {
        let draft = Draft::new(sources, known, robot);
        let mut open = Self {
            outlines: Arc::new(Outlines::of(draft.sources())),
            uses: BTreeMap::new(),
            cut: None,
            shown: ChannelPlace {
                series: 0,
                channel: 0,
            },
            is_taken: false,
            draft,
        };
        open.follow(robot);
        open.shown = open.first_used().unwrap_or(open.shown);
        open
    }

    pub fn add(&mut self, more: Vec<Source>, robot: &Robot) {
        self.draft.add(more, robot);
        self.outlines = Arc::new(Outlines::of(self.draft.sources()));
        self.follow(robot);
    }

    pub fn remove(&mut self, source: usize, robot: &Robot) {
        self.draft.remove(source, robot);
        self.outlines = Arc::new(Outlines::of(self.draft.sources()));
        self.follow(robot);
        self.shown = self.first_used().unwrap_or(ChannelPlace {
            series: 0,
            channel: 0,
        });
    }

    /// Finds what the recipe makes of the channels.
    pub fn follow(&mut self, robot: &Robot) {
        let recipe = self.draft.recipe();
        self.uses = uses(self.draft.sources(), recipe, robot.cable_count());
    }

    /// The first channel of numbers that moves, else the first that is used.
    fn first_used(&self) -> Option<ChannelPlace> {
        let place = |column: &str| {
            let mut found = self
                .uses
                .iter()
                .filter(|(_, used)| used.starts_with(column));
            found.find_map(|((series, name), _)| self.place(*series, name))
        };
        place("rev_").or_else(|| place("length_")).or_else(|| {
            let mut used = self.uses.keys();
            used.find_map(|(series, name)| self.place(*series, name))
        })
    }

    fn place(&self, series: usize, name: &str) -> Option<ChannelPlace> {
        let one = self.all_series().nth(series)?;
        let channel = one.channels.iter().position(|known| known.name == name)?;
        Some(ChannelPlace { series, channel })
    }

    /// The series of all sources.
    pub fn all_series(&self) -> impl Iterator<Item = &tautline_import::Series> {
        self.draft
            .sources()
            .iter()
            .flat_map(|source| &source.series)
    }

    /// Whether the cut is of the recipe as it is now.
    #[must_use]
    pub fn is_current(&self) -> bool {
        self.cut
            .as_ref()
            .is_some_and(|cut| cut.revision == self.draft.revision())
    }

    /// What the check suggests of the recipe as it is now, except what the recipe has already.
    #[must_use]
    pub fn suggestions(&self) -> Vec<Suggestion> {
        let cut = self.cut.iter().filter(|_| self.is_current());
        let all = cut.flat_map(|cut| cut.suggestions());
        let is_new = |suggestion: &&Suggestion| match &suggestion.change {
            Change::LeaveEmpty {
                column,
                from_pose: None,
            } => !self.draft.recipe().left_empty.contains(column),
            _ => true,
        };
        all.filter(is_new).cloned().collect()
    }
}

/// Files of other programs on their way into the session.
#[derive(Debug, Default)]
pub struct ImportState {
    /// The import, once a robot is known.
    pub open: Option<OpenImport>,
    /// Sources that wait for a robot.
    pub waiting: Vec<Source>,
    /// The recipe that was used last, for the next file.
    pub last_recipe: Option<Recipe>,
    /// Whether the poses replace those that the session imported before.
    pub replaces: bool,
    /// Whether the signs, units and channels that the next check finds wrong are corrected in the recipe.
    pub corrects: bool,
}
