//! Groups of cells that differ only in laser and number of poses.

use tautline_workflow::wording::units::significant;

use crate::file::{Choice, Method};
use crate::plan::StudyPlan;
use crate::result::{CellResult, StudyResult};

/// Cells that differ only in laser and number of poses.
pub struct Group<'a> {
    /// Common properties of the cells.
    pub title: String,
    /// Largest side of the frame (m).
    pub size_m: Option<f64>,
    /// The cells.
    pub cells: Vec<&'a CellResult>,
}

impl<'a> Group<'a> {
    /// Numbers of poses, rising.
    pub fn poses(&self) -> Vec<usize> {
        let mut poses: Vec<usize> = self
            .cells
            .iter()
            .map(|cell| cell.planned.combination.poses)
            .collect();
        poses.sort_unstable();
        poses.dedup();
        poses
    }

    /// Names of lasers, the most accurate first; no laser comes last.
    pub fn lasers(&self) -> Vec<&'a str> {
        let mut lasers: Vec<(&str, f64)> = self
            .cells
            .iter()
            .map(|cell| {
                (
                    cell.planned.combination.laser.as_str(),
                    cell.planned.laser_sd_m.unwrap_or(f64::INFINITY),
                )
            })
            .collect();
        lasers.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(b.0)));
        lasers.dedup_by_key(|laser| laser.0);
        lasers.into_iter().map(|laser| laser.0).collect()
    }

    /// Cells with a laser and this number of poses, sorted by standard deviation.
    pub fn over_laser(&self, poses: usize) -> Vec<&'a CellResult> {
        let has = |cell: &&&CellResult| {
            cell.planned.combination.poses == poses && cell.planned.laser_sd_m.is_some()
        };
        let mut cells: Vec<&CellResult> = self.cells.iter().filter(has).copied().collect();
        cells.sort_by(|a, b| {
            a.planned
                .laser_sd_m
                .unwrap_or(0.0)
                .total_cmp(&b.planned.laser_sd_m.unwrap_or(0.0))
        });
        cells
    }

    /// Cells with this laser, sorted by number of poses.
    pub fn over_poses(&self, laser: &str) -> Vec<&'a CellResult> {
        let has = |cell: &&&CellResult| cell.planned.combination.laser == laser;
        let mut cells: Vec<&CellResult> = self.cells.iter().filter(has).copied().collect();
        cells.sort_by_key(|cell| cell.planned.combination.poses);
        cells
    }
}

/// The groups of a study, in the order of its cells.
pub fn groups<'a>(plan: &StudyPlan, result: &'a StudyResult) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    for cell in &result.cells {
        let title = title(plan, cell);
        match groups.iter_mut().find(|group| group.title == title) {
            Some(group) => group.cells.push(cell),
            None => groups.push(Group {
                title,
                size_m: cell.planned.combination.size_m,
                cells: vec![cell],
            }),
        }
    }
    groups
}

/// A laser of the catalogue, in words.
pub fn laser_name(laser: &str) -> &str {
    match laser {
        "none" => "no laser",
        "own" => "own laser",
        named => named,
    }
}

/// Properties that a cell shares with the others of its group, in words.
pub fn title(plan: &StudyPlan, cell: &CellResult) -> String {
    let cell = &cell.planned.combination;
    let robot = plan
        .robots
        .get(cell.robot)
        .map_or("robot", |robot| robot.name.as_str());
    let mut parts = vec![robot.to_owned()];
    let mut add = |value: Option<f64>, scale: f64, before: &str, unit: &str| {
        parts
            .extend(value.map(|value| format!("{before}{} {unit}", significant(scale * value, 2))));
    };
    add(cell.size_m, 1.0, "", "m");
    add(cell.home_sd_m, 1e3, "home ", "mm");
    add(
        cell.inclinometer_sd_rad.filter(|sd| *sd > 0.0),
        1e3,
        "inclinometer ",
        "mrad",
    );
    add(cell.length_sd_m, 1e3, "lengths ", "mm");
    add(cell.tension_sd_n, 1.0, "tensions ", "N");
    // A property of all cells does not distinguish groups.
    let design = &plan.study.design;
    let is_random = cell.choice == Choice::Random && design.choice.len() > 1;
    parts.extend(is_random.then(|| "random poses".to_owned()));
    let is_simple = cell.method == Method::Simple && design.methods.len() > 1;
    parts.extend(is_simple.then(|| "tensions taken as exact".to_owned()));
    parts.join(", ")
}
