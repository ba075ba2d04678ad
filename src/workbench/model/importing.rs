//! Import of files of other programs into the session.

use std::collections::BTreeMap;
use std::sync::Arc;

use tautline_channels::Source;
use tautline_core::robot::Robot;
use tautline_import::{Change, Draft, ImportError, Imported, PoseReport, Recipe, Suggestion, uses};
use tautline_workflow::importing::Outlines;
use tautline_workflow::readiness::CheckItem;

/// Indices of a channel: its series and its position there; text channels follow numeric ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ChannelPlace {
    /// Index of the series among those of all sources.
    pub series: usize,
    /// Index among the channels of the series.
    pub channel: usize,
}

/// Poses cut by a recipe, or the reason why there are none.
#[derive(Debug)]
pub struct Cut {
    /// Revision of the draft.
    pub revision: u64,
    pub result: Result<Imported, ImportError>,
    /// The check of the poses as readings of the robot.
    pub checks: Vec<CheckItem>,
    /// Times of the rows of each series (s), in the common clock.
    pub times: Vec<Option<Vec<f64>>>,
}

impl Cut {
    /// Poses found in the recording, even if they cannot be those of the robot.
    #[must_use]
    pub fn poses(&self) -> &[PoseReport] {
        match &self.result {
            Ok(imported) => &imported.document.poses,
            Err(error) => &error.poses,
        }
    }

    /// Corrections suggested by the check of the data.
    #[must_use]
    pub fn suggestions(&self) -> &[Suggestion] {
        match &self.result {
            Ok(imported) => &imported.document.suggestions,
            Err(error) => &error.suggestions,
        }
    }
}

/// Sources with their recipe and the poses it cuts.
#[derive(Debug)]
pub struct OpenImport {
    pub draft: Draft,
    /// Outlines of the channels, for plotting.
    pub outlines: Arc<Outlines>,
    /// Columns of poses.csv that the recipe makes of the channels, by series and name.
    pub uses: BTreeMap<(usize, String), String>,
    /// Last cut; of an older revision while a new one is being computed.
    pub cut: Option<Arc<Cut>>,
    pub shown: ChannelPlace,
    /// Whether the poses are in a session already, so that the next file begins another import.
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

    /// Updates the columns that the recipe makes of the channels.
    pub fn follow(&mut self, robot: &Robot) {
        let recipe = self.draft.recipe();
        self.uses = uses(self.draft.sources(), recipe, robot.cable_count());
    }

    /// First channel of revolutions, otherwise of lengths, otherwise the first that is used.
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

    /// Series of all sources.
    pub fn all_series(&self) -> impl Iterator<Item = &tautline_channels::Series> {
        self.draft
            .sources()
            .iter()
            .flat_map(|source| &source.series)
    }

    /// Whether the cut belongs to the present revision.
    #[must_use]
    pub fn is_current(&self) -> bool {
        self.cut
            .as_ref()
            .is_some_and(|cut| cut.revision == self.draft.revision())
    }

    /// Suggestions for the present revision that the recipe does not contain yet.
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

/// State of the import.
#[derive(Debug, Default)]
pub struct ImportState {
    /// Import, once a robot is known.
    pub open: Option<OpenImport>,
    /// Sources without a robot yet.
    pub waiting: Vec<Source>,
    /// Recipe used last, applied to the next file.
    pub last_recipe: Option<Recipe>,
    /// Whether the poses replace those imported before.
    pub replaces: bool,
    /// Whether wrong signs, units and channels found by the next check are corrected in the recipe.
    pub corrects: bool,
}
