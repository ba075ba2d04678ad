//! Sources and a recipe to a table of poses.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_session::{ReadError, read_poses};

use crate::cutting::{CutPose, cut, number_of};
use crate::document::{ImportDocument, PoseReport, Reading, SourceReport};
use crate::recipe::{Cutting, Kind, Mapping, Quantity, Recipe, resolve};
use crate::source::Source;

/// Poses made of foreign files.
#[derive(Debug, Clone)]
pub struct Imported {
    /// The table of poses.
    pub poses_csv: String,
    /// The same, as it is read.
    pub measurements: Measurements,
    /// What was done.
    pub document: ImportDocument,
}

/// Makes poses of sources; `recipe_file` is the recipe's name for messages.
///
/// # Errors
/// If a channel of the recipe is not there, no pose is found, or the readings cannot be those of this robot.
pub fn import(
    sources: &[Source],
    recipe: &Recipe,
    recipe_file: &str,
    robot: &Robot,
) -> Result<Imported, ReadError> {
    let file = sources.first().map_or("", |source| source.file.as_str());
    let mapping = resolve(sources, recipe, recipe_file, robot.cable_count())?;
    let mut notices: Vec<String> = sources
        .iter()
        .flat_map(|source| source.notices.clone())
        .collect();
    notices.extend(lost_frames(&mapping));
    let mut poses = cut(&mapping, recipe, robot, file, &mut notices)?;
    drop_empty(&mut poses, &mut notices);
    let labels = labels(&poses, recipe, &mut notices);
    apply_steps(&mut poses, &labels, recipe);
    let columns = columns(&mapping, recipe);
    let poses_csv = table(&poses, &labels, &columns, recipe);
    let read = read_poses(poses_csv.as_bytes(), &format!("{file} as poses.csv"), robot)?;
    notices.extend(read.notices);
    let document = ImportDocument {
        sources: reports(sources, &mapping),
        recipe: recipe.clone(),
        proposed: false,
        poses: poses
            .iter()
            .zip(&labels)
            .map(|(pose, label)| report(pose, *label, recipe))
            .collect(),
        notices,
    };
    Ok(Imported {
        poses_csv,
        measurements: read.value,
        document,
    })
}

/// What is in the sources, and what a recipe would make of it.
///
/// # Errors
/// If a channel of the recipe is not there.
pub fn found(
    sources: &[Source],
    recipe: &Recipe,
    recipe_file: &str,
    robot: &Robot,
) -> Result<ImportDocument, ReadError> {
    let mapping = resolve(sources, recipe, recipe_file, robot.cable_count())?;
    let mut notices: Vec<String> = sources
        .iter()
        .flat_map(|source| source.notices.clone())
        .collect();
    notices.extend(lost_frames(&mapping));
    Ok(ImportDocument {
        sources: reports(sources, &mapping),
        recipe: recipe.clone(),
        proposed: false,
        poses: Vec::new(),
        notices,
    })
}

/// What is made of each channel.
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

/// Runs of rows that an instrument lost.
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

/// Labels of the poses: those of the files, the numbers in their names, or their order.
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
            notices.push(format!("names of poses such as \"{name}\" have no number of their own: numbered from {first} in the order of the file"));
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
        for reading in poses[from..]
            .iter_mut()
            .filter_map(|pose| pose.readings.get_mut(&quantity))
        {
            reading.mean += step.add;
        }
    }
}

/// The columns of numbers, in the order of the table.
fn columns(mapping: &Mapping<'_>, recipe: &Recipe) -> Vec<Quantity> {
    let mapped = mapping
        .quantities
        .keys()
        .copied()
        .filter(|quantity| !quantity.is_text() && quantity.kind != Kind::Time);
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
            cells.push(format!("\"{}\"", group.replace('"', "\"\"")));
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
        rows: pose.rows,
        // Of single rows the table says it all.
        readings: if recipe.cutting == Cutting::Rows {
            BTreeMap::new()
        } else {
            readings.collect()
        },
    }
}
