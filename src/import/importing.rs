//! Applies a recipe to sources, yielding a table of poses.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use tautline_channels::{MemoryBudget, Source};
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError};
use tautline_session::{escape_formula, read_poses};

use crate::check::{Change, Readings, Suggestion, check};
use crate::commands::complete_commands;
use crate::coverage::{unused, without_channel};
use crate::cutting::{CutPose, Times, cut, number_of};
use crate::document::{ImportDocument, PoseReport, Reading, SourceReport};
use crate::external::place;
use crate::recipe::{Cutting, Mapping, Quantity, QuantityKind as Kind, Recipe, is_series, resolve};
use crate::turning::turn_angles;

/// Maximum number of suggestions applied.
const MOST_CHANGES: usize = 64;
/// Memory (bytes) for poses that are cut only to compare frames; longer recordings are left to the check.
const FRAME_MEMORY: u64 = 256 << 20;
/// Fewest rows per jump of a clock that was set.
const JUMPS: usize = 20;

/// Poses imported from foreign files.
#[derive(Debug, Clone)]
pub struct Imported {
    /// Content of `poses.csv`.
    pub poses_csv: String,
    /// The same table, parsed.
    pub measurements: Measurements,
    /// Record of the import.
    pub document: ImportDocument,
}

/// Converts sources to poses with a recipe, which messages call `recipe_file`.
///
/// # Errors
/// If a channel of the recipe is missing, no pose is found, the readings are impossible for this robot, or the poses need more
/// memory than the budget has left.
pub fn import(
    sources: &[Source],
    recipe: &Recipe,
    recipe_file: &str,
    robot: &Robot,
    budget: &MemoryBudget,
) -> Result<Imported, ImportError> {
    let file = sources.first().map_or("", |source| source.file.as_str());
    let mapping = resolve(sources, recipe, recipe_file, robot.cable_count())?;
    let mut notices = notices(sources, &mapping, robot);
    let mut poses = cut(&mapping, recipe, (robot, budget), file, &mut notices)?;
    turn_angles(&mut poses, recipe, &mut notices);
    complete_commands(&mut poses, robot, &mut notices);
    drop_empty(&mut poses, &mut notices);
    let labels = labels(&poses, recipe, &mut notices);
    apply_steps(&mut poses, &labels, recipe);
    let recipe = &place(&mut poses, recipe, robot, &mut notices)
        .map_err(|message| ReadError::new(file, Location::File, message))?;
    let columns = columns(&mapping, &poses, recipe);
    let readings = readings(&poses, &labels, &columns, recipe);
    let suggestions = suggestions(&mapping, &readings, recipe, robot, &mut notices);
    let poses_csv = table(&poses, &labels, &columns, recipe);
    let read = read_poses(poses_csv.as_bytes(), &format!("{file} as poses.csv"), robot);
    let document = ImportDocument {
        sources: reports(sources, &mapping),
        recipe: recipe.clone(),
        proposed: false,
        poses: poses
            .iter()
            .zip(&labels)
            .map(|(pose, label)| report(pose, *label, recipe))
            .collect(),
        suggestions,
        applied: Vec::new(),
        notices,
    };
    match read {
        Ok(read) => {
            let mut document = document;
            document.notices.extend(read.notices);
            Ok(Imported {
                poses_csv,
                measurements: read.value,
                document,
            })
        }
        // Impossible readings may stem from a known kind of mistake.
        Err(error) => Err(ImportError {
            error,
            suggestions: document.suggestions,
            poses: document.poses.into(),
        }),
    }
}

/// Imports, applies the suggestions of the check, and repeats until there are no new ones. Those that follow from the mass of the
/// platform are applied if it `is_weighed`.
///
/// # Errors
/// As [`import`], for errors that no suggestion corrects.
pub fn import_corrected(
    sources: &[Source],
    recipe: &Recipe,
    recipe_file: &str,
    robot: &Robot,
    (is_weighed, budget): (bool, &MemoryBudget),
) -> Result<Imported, ImportError> {
    let mut recipe = recipe.clone();
    let mut applied: Vec<Suggestion> = Vec::new();
    loop {
        let found = import(sources, &recipe, recipe_file, robot, budget);
        let suggestions = match &found {
            Ok(imported) => &imported.document.suggestions,
            Err(error) => &error.suggestions,
        };
        // A suggestion that recurs did not help.
        let new: Vec<Suggestion> = suggestions
            .iter()
            .filter(|one| !applied.contains(one) && (is_weighed || !one.by_mass))
            .cloned()
            .collect();
        if new.is_empty() || applied.len() > MOST_CHANGES {
            return found.map(|mut imported| {
                imported.document.applied = applied;
                imported
            });
        }
        new.iter()
            .for_each(|suggestion| suggestion.apply(&mut recipe));
        applied.extend(new);
    }
}

/// A sentence if the measured poses of a proposed recipe are in another frame than the robot's that the readings determine.
pub(crate) fn in_other_frame(sources: &[Source], recipe: &Recipe, robot: &Robot) -> Option<String> {
    let mapping = resolve(sources, recipe, "recipe", robot.cable_count()).ok()?;
    let notices = &mut Vec::new();
    let budget = MemoryBudget::new(FRAME_MEMORY);
    let mut poses = cut(&mapping, recipe, (robot, &budget), "", notices).ok()?;
    turn_angles(&mut poses, recipe, notices);
    complete_commands(&mut poses, robot, notices);
    drop_empty(&mut poses, notices);
    let labels = labels(&poses, recipe, notices);
    let columns = columns(&mapping, &poses, recipe);
    let found = check(&readings(&poses, &labels, &columns, recipe), robot);
    let other = found
        .into_iter()
        .find(|suggestion| suggestion.change == Change::AlignInstrument)?;
    let mut aligned = recipe.clone();
    other.apply(&mut aligned);
    place(&mut poses, &aligned, robot, notices).ok()?;
    Some(other.sentence)
}

/// The readings of the columns that are not left empty.
fn readings(poses: &[CutPose], labels: &[i64], columns: &[Quantity], recipe: &Recipe) -> Readings {
    let is_empty = |quantity: &Quantity| {
        recipe
            .left_empty
            .iter()
            .any(|column| *column == quantity.column())
    };
    let quantities = columns.iter().filter(|quantity| !is_empty(quantity));
    let values = |quantity: &Quantity| {
        poses
            .iter()
            .map(|pose| {
                pose.readings
                    .get(quantity)
                    .map_or(f64::NAN, |reading| reading.mean)
            })
            .collect()
    };
    Readings {
        labels: labels.to_vec(),
        columns: quantities
            .map(|quantity| (*quantity, values(quantity)))
            .collect(),
    }
}

/// Suggestions from the check of the data, and for clock jumps that are not closed.
fn suggestions(
    mapping: &Mapping<'_>,
    readings: &Readings,
    recipe: &Recipe,
    robot: &Robot,
    notices: &mut Vec<String>,
) -> Vec<Suggestion> {
    let mut found = check(readings, robot);
    for (k, series) in mapping.series.iter().enumerate() {
        let times = Times::of(mapping, k, recipe);
        let is_closed = recipe
            .clocks
            .iter()
            .any(|clock| clock.close_jumps && is_series(series, &clock.series));
        if times.jumps.len() * JUMPS > series.rows {
            notices.push(format!(
                "the times of {} go backwards {} times in {} rows: they are those of no clock, expected another channel as time_s",
                series.name,
                times.jumps.len(),
                series.rows
            ));
        } else if let Some((row, step)) = times.jumps.first().filter(|_| !is_closed) {
            let sentence = format!(
                "the clock of {} jumps by {step:.3} s at row {}: it was adjusted during the recording; close the jump",
                series.name,
                row + 1
            );
            let change = Change::CloseJumps {
                series: series.name.clone(),
            };
            found.push(Suggestion::new(sentence, change));
        }
    }
    found
}

/// An import error with suspected mistakes in the data.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportError {
    /// The error.
    pub error: ReadError,
    /// Suspected mistakes in the readings.
    pub suggestions: Vec<Suggestion>,
    /// The poses, if cutting succeeded.
    pub poses: Box<[PoseReport]>,
}

impl From<ReadError> for ImportError {
    fn from(error: ReadError) -> Self {
        Self {
            error,
            suggestions: Vec::new(),
            poses: Box::default(),
        }
    }
}

impl std::fmt::Display for ImportError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.error)?;
        let about = |suggestion: &&Suggestion| match &self.error.place {
            Location::Cell(_, column) => suggestion.columns.contains(column),
            _ => false,
        };
        let first = self
            .suggestions
            .iter()
            .find(about)
            .or(self.suggestions.first());
        match (first, self.suggestions.len()) {
            (None, _) => Ok(()),
            (Some(first), 1) => write!(f, " ({}; --apply-suggestions applies it)", first.sentence),
            (Some(first), count) => write!(
                f,
                " ({}; {} more; --apply-suggestions applies them)",
                first.sentence,
                count - 1
            ),
        }
    }
}

impl std::error::Error for ImportError {}

/// Lists the sources and the assignments of a recipe.
///
/// # Errors
/// If a channel of the recipe is missing.
pub fn found(
    sources: &[Source],
    recipe: &Recipe,
    recipe_file: &str,
    robot: &Robot,
) -> Result<ImportDocument, ReadError> {
    let mapping = resolve(sources, recipe, recipe_file, robot.cable_count())?;
    Ok(ImportDocument {
        sources: reports(sources, &mapping),
        recipe: recipe.clone(),
        proposed: false,
        poses: Vec::new(),
        suggestions: Vec::new(),
        applied: Vec::new(),
        notices: notices(sources, &mapping, robot),
    })
}

/// Assignment of each channel.
fn reports(sources: &[Source], mapping: &Mapping<'_>) -> Vec<SourceReport> {
    let mut used: BTreeMap<(String, String), String> = BTreeMap::new();
    let mut add = |mapped: &crate::recipe::Mapped, column: String| {
        let series = mapping.series[mapped.series];
        let name = match mapped.is_text {
            true => &series.texts[mapped.channel].name,
            false => &series.channels[mapped.channel].name,
        };
        let uses = used.entry((series.name.clone(), name.clone())).or_default();
        if !uses.is_empty() {
            uses.push_str(", ");
        }
        uses.push_str(&column);
    };
    for (quantity, mapped) in &mapping.quantities {
        add(mapped, quantity.column());
    }
    for mapped in mapping.times.iter().flatten() {
        add(mapped, "time_s".into());
    }
    let used_as =
        |series: &str, channel: &str| used.get(&(series.to_owned(), channel.to_owned())).cloned();
    sources
        .iter()
        .map(|source| SourceReport::of(source, &used_as))
        .collect()
}

/// Notices about the sources, what is left over, and lost frames.
fn notices(sources: &[Source], mapping: &Mapping<'_>, robot: &Robot) -> Vec<String> {
    let known = sources.iter().flat_map(|source| source.notices.clone());
    let left_over = unused(mapping)
        .into_iter()
        .chain(without_channel(mapping, robot));
    known.chain(left_over).chain(lost_frames(mapping)).collect()
}

/// Notices about runs of rows without a value.
fn lost_frames(mapping: &Mapping<'_>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let mut notices = Vec::new();
    for (quantity, mapped) in mapping
        .quantities
        .iter()
        .filter(|(_, mapped)| !mapped.is_text)
    {
        let series = mapping.series[mapped.series];
        let channel = &series.channels[mapped.channel];
        let runs = channel.lost();
        // The components of one pose are lost together.
        let key = (
            mapped.series,
            quantity.kind,
            runs.first().map(|run| run.start),
            runs.len(),
        );
        if let Some(first) = runs.first()
            && seen.insert(key)
        {
            let rows: usize = runs.iter().map(|run| run.end - run.start).sum();
            notices.push(format!(
                "{}, channel \"{}\": {rows} rows without a value in {} runs, the first at row {}",
                series.name,
                channel.name,
                runs.len(),
                first.start + 1
            ));
        }
    }
    notices
}

fn drop_empty(poses: &mut Vec<CutPose>, notices: &mut Vec<String>) {
    let before = poses.len();
    poses.retain(|pose| !pose.readings.is_empty());
    if poses.len() < before {
        notices.push(format!(
            "{} poses without any reading left out",
            before - poses.len()
        ));
    }
}

/// Labels of the poses: those of the files, the numbers in their names, or consecutive numbers.
fn labels(poses: &[CutPose], recipe: &Recipe, notices: &mut Vec<String>) -> Vec<i64> {
    let first = i64::from(!recipe.first_pose_is_home);
    let in_order = || (0..poses.len() as i64).map(|k| k + first).collect();
    let Some(names) = poses
        .iter()
        .map(|pose| pose.label.as_deref())
        .collect::<Option<Vec<_>>>()
    else {
        return in_order();
    };
    let exact: Option<Vec<i64>> = names.iter().map(|name| name.parse().ok()).collect();
    if let Some(exact) = exact {
        return exact;
    }
    let numbers: Option<Vec<i64>> = names.iter().map(|name| number_of(name)).collect();
    match numbers {
        Some(numbers) if numbers.iter().collect::<HashSet<_>>().len() == numbers.len() => numbers,
        _ => {
            let name = names.first().copied().unwrap_or_default();
            notices.push(format!("pose names such as \"{name}\" contain no unique number: poses are numbered from {first} in the order of the file"));
            in_order()
        }
    }
}

fn apply_steps(poses: &mut [CutPose], labels: &[i64], recipe: &Recipe) {
    for step in &recipe.steps {
        let (Some(quantity), Some(from)) = (
            Quantity::parse(&step.quantity),
            labels.iter().position(|label| *label == step.from_pose),
        ) else {
            continue;
        };
        for pose in &mut poses[from..] {
            match (step.add, pose.readings.get_mut(&quantity)) {
                (Some(add), Some(reading)) => reading.mean += add,
                (None, _) => drop(pose.readings.remove(&quantity)),
                (Some(_), None) => {}
            }
        }
    }
}

/// The numeric columns in the order of the table: those of the recipe, and poses computed from markers or angles.
fn columns(mapping: &Mapping<'_>, poses: &[CutPose], recipe: &Recipe) -> Vec<Quantity> {
    let made = poses.iter().flat_map(|pose| pose.readings.keys());
    let made = made.filter(|quantity| matches!(quantity.kind, Kind::Commanded | Kind::Tracked));
    let mapped = mapping.quantities.keys().chain(made).copied();
    let mapped = mapped.filter(|quantity| {
        let is_source = matches!(
            quantity.kind,
            Kind::Time | Kind::Marker | Kind::CommandedAngle | Kind::TrackedAngle
        );
        // Commanded poses that lack a coordinate are not used.
        let is_left_out = quantity.kind == Kind::Commanded
            && poses
                .iter()
                .all(|pose| !pose.readings.contains_key(quantity));
        !quantity.is_text() && !is_source && !is_left_out
    });
    let empty = recipe
        .left_empty
        .iter()
        .filter_map(|column| Quantity::parse(column));
    let columns: BTreeSet<Quantity> = mapped.chain(empty).collect();
    columns.into_iter().collect()
}

fn table(poses: &[CutPose], labels: &[i64], columns: &[Quantity], recipe: &Recipe) -> String {
    let has_times = poses.iter().any(|pose| pose.time_s.is_some());
    let has_groups = poses.iter().any(|pose| pose.group.is_some());
    let mut header = vec!["pose".to_owned()];
    header.extend(has_groups.then(|| "group".into()));
    header.extend(has_times.then(|| "time_s".into()));
    header.extend(columns.iter().map(|quantity| quantity.column()));
    let mut text = header.join(",");
    text.push('\n');
    for (pose, label) in poses.iter().zip(labels) {
        let mut cells = vec![label.to_string()];
        if has_groups {
            let group = pose.group.clone().unwrap_or_default();
            let group = escape_formula(&group).replace('"', "\"\"");
            cells.push(format!("\"{group}\""));
        }
        if has_times {
            let middle = pose.time_s.map(|[begin, end]| begin + (end - begin) / 2.0);
            cells.push(
                middle
                    .filter(|time| time.is_finite())
                    .map_or_else(String::new, |time| time.to_string()),
            );
        }
        for quantity in columns {
            let is_empty = recipe
                .left_empty
                .iter()
                .any(|column| *column == quantity.column());
            let reading = pose.readings.get(quantity).filter(|_| !is_empty);
            cells.push(reading.map_or_else(String::new, |reading| reading.mean.to_string()));
        }
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

fn report(pose: &CutPose, label: i64, recipe: &Recipe) -> PoseReport {
    let readings = pose.readings.iter().map(|(quantity, reading)| {
        let sd = Some(reading.sd).filter(|sd| sd.is_finite());
        (
            quantity.column(),
            Reading {
                mean: reading.mean,
                sd,
                number: reading.number,
            },
        )
    });
    PoseReport {
        pose: label,
        begin_s: pose
            .time_s
            .map(|time| time[0])
            .filter(|time| time.is_finite()),
        end_s: pose
            .time_s
            .map(|time| time[1])
            .filter(|time| time.is_finite()),
        first_row: pose.first_row,
        rows: pose.rows,
        // For poses of single rows the table is complete.
        readings: if matches!(recipe.cutting, Cutting::Rows | Cutting::Motion) {
            BTreeMap::new()
        } else {
            readings.collect()
        },
    }
}
