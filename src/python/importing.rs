//! Files of other programs as datasets.

use std::path::PathBuf;

use pyo3::prelude::*;
use tautline_channels::{MemoryBudget, Source};
use tautline_core::robot::Robot;
use tautline_import::{
    AngleOrder, Assignment, ImportDocument, PartPlaces, Recipe, align_clocks, arrange_per_cable,
    found, import, import_corrected, propose_around, read_robot_description, read_sources,
};
use tautline_session::parse_versioned;

use crate::boundary::{detached, error, json, parsed_robot};

/// Name of a recipe in messages.
const RECIPE: &str = "recipe";

/// Options of an import.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ImportOptions {
    /// JSON of a recipe; `None`: one is proposed.
    recipe: Option<String>,
    /// `COLUMN=CHANNEL [UNIT]`.
    assignments: Vec<String>,
    angles: Option<String>,
    align_clocks: bool,
    apply_suggestions: bool,
    is_weighed: bool,
    memory_limit_bytes: u64,
}

/// The sources with their recipe.
struct Prepared {
    robot: Robot,
    sources: Vec<Source>,
    recipe: Recipe,
    budget: MemoryBudget,
    notices: Vec<String>,
}

impl ImportOptions {
    fn prepare(&self, py: Python<'_>, paths: &[PathBuf], robot: &str) -> PyResult<Prepared> {
        let robot = parsed_robot(robot)?;
        let angles = self.angles.as_deref().map(str::parse::<AngleOrder>);
        let angles = angles.transpose();
        let angles = angles.map_err(|why| error(format!("angles: {why}")))?;
        let budget = MemoryBudget::new(self.memory_limit_bytes);
        let read = detached(py, |_| {
            read_sources(paths, &budget, &|_| true).map_err(|e| e.to_string())
        })?;
        let (mut sources, mut notices) = (read.value, read.notices);
        arrange_per_cable(&mut sources, robot.cable_count());
        let assigned = self.assignments.iter();
        let assigned = assigned.map(|text| Assignment::parse_each(text, &sources));
        let assigned: Result<Vec<Vec<Assignment>>, String> = assigned.collect();
        let assigned = assigned
            .map_err(|why| error(format!("assign: {why}")))?
            .concat();
        let mut recipe = match &self.recipe {
            Some(text) => {
                let read = parse_versioned::<Recipe>(text.as_bytes(), RECIPE).map_err(error)?;
                notices.extend(read.notices);
                let mut recipe = read.value;
                recipe.channels.extend(assigned);
                recipe
            }
            None => {
                let (recipe, assumptions) = propose_around(&sources, &robot, assigned);
                notices.extend(assumptions);
                recipe
            }
        };
        if let Some(order) = angles {
            recipe.order_angles(order);
        }
        if self.align_clocks {
            let clocks = align_clocks(&sources, &mut recipe, &robot).map_err(error)?;
            notices.extend(clocks.into_iter().map(|clock| clock.sentence));
        }
        Ok(Prepared {
            robot,
            sources,
            recipe,
            budget,
            notices,
        })
    }

    fn document(&self, mut document: ImportDocument, notices: Vec<String>) -> PyResult<String> {
        document.proposed = self.recipe.is_none();
        document.notices.extend(notices);
        json(&document)
    }
}

/// The channels of files and the recipe for them: the result of `import --channels`.
#[pyfunction]
pub fn channels(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    robot: &str,
    options: ImportOptions,
) -> PyResult<String> {
    let prepared = options.prepare(py, &paths, robot)?;
    let Prepared {
        sources, recipe, ..
    } = &prepared;
    let document = found(sources, recipe, RECIPE, &prepared.robot).map_err(error)?;
    options.document(document, prepared.notices)
}

/// `poses.csv`, and the result of the command `import`.
#[pyfunction]
pub fn import_readings(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    robot: &str,
    options: ImportOptions,
) -> PyResult<(String, String)> {
    let prepared = options.prepare(py, &paths, robot)?;
    let Prepared {
        robot,
        sources,
        recipe,
        budget,
        ..
    } = &prepared;
    let imported = detached(py, |_| {
        let imported = match options.apply_suggestions {
            true => {
                let how = (options.is_weighed, budget);
                import_corrected(sources, recipe, RECIPE, robot, how)
            }
            false => import(sources, recipe, RECIPE, robot, budget),
        };
        imported.map_err(|e| e.to_string())
    })?;
    let document = options.document(imported.document, prepared.notices)?;
    Ok((imported.poses_csv, document))
}

/// The robot that files of other programs describe, and notices for the operator.
#[pyfunction]
pub fn import_robot(paths: Vec<PathBuf>) -> PyResult<(String, Vec<String>)> {
    let read = read_robot_description(&paths).map_err(error)?;
    Ok((json(&read.value)?, read.notices))
}

/// The robot whose cables have these attachment points, and the assumptions.
#[pyfunction]
pub fn robot_of_places(
    name: &str,
    pulleys_m: Vec<[f64; 3]>,
    platform_m: Vec<[f64; 3]>,
    drum_diameters_m: Vec<f64>,
) -> PyResult<String> {
    let places = PartPlaces {
        pulleys_m,
        platform_m,
        drum_diameters_m,
        ..PartPlaces::default()
    };
    json(&places.robot(name, Vec::new()).map_err(error)?.value)
}
