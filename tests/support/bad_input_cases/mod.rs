//! Datasets that must be refused: each differs in one place from a good one.

mod poses;
mod robot;
mod tables;

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde_json::Value;

/// A dataset with one mistake.
pub struct BadInput {
    /// Description of the mistake.
    pub name: &'static str,
    mistake: Mistake,
    /// Parts that the message has to contain.
    pub expected: &'static [&'static str],
}

/// Change of the good dataset.
enum Mistake {
    /// The value at a JSON pointer of robot.json becomes this JSON text; a new key is added.
    Set(&'static str, &'static str),
    /// The key at a JSON pointer of robot.json is removed.
    Remove(&'static str),
    /// The text of robot.json is replaced in this way.
    RobotText(fn(&str) -> String),
    /// The cell in this line and column of poses.csv becomes this text.
    Cell(usize, &'static str, &'static str),
    /// This column of poses.csv is left out.
    Drop(&'static str),
    /// The text of poses.csv is replaced in this way.
    PosesText(fn(&str) -> String),
    /// A file has this content.
    File(&'static str, &'static [u8]),
    /// A file is missing.
    NoFile(&'static str),
    /// A file is a folder.
    Folder(&'static str),
    /// poses.csv has a line of 100 MB.
    LongLine,
    /// There is no folder.
    NoDataset,
    /// The dataset is a file.
    PlainFile,
}

/// All of them.
#[must_use]
pub fn bad_inputs() -> Vec<BadInput> {
    let mut cases = robot::cases();
    cases.extend(poses::cases());
    cases.extend(tables::cases());
    cases
}

fn case(name: &'static str, mistake: Mistake, expected: &'static [&'static str]) -> BadInput {
    BadInput {
        name,
        mistake,
        expected,
    }
}

/// `robot.json` of the good dataset.
pub const GOOD_ROBOT: &str = include_str!("robot.json");

/// `poses.csv` of the good dataset: a comment, the header in line 2, the home pose in line 3.
pub const GOOD_POSES: &str = include_str!("poses.csv");

/// Writes the good dataset.
///
/// # Errors
/// If a file cannot be written.
pub fn write_good_dataset(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("robot.json"), GOOD_ROBOT)?;
    fs::write(folder.join("poses.csv"), GOOD_POSES)
}

impl BadInput {
    /// Writes the dataset.
    ///
    /// # Errors
    /// If a file cannot be written or the case does not fit the good dataset.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        match &self.mistake {
            Mistake::NoDataset => return Ok(()),
            Mistake::PlainFile => return fs::write(folder, GOOD_POSES),
            _ => write_good_dataset(folder)?,
        }
        let robot = folder.join("robot.json");
        let poses = folder.join("poses.csv");
        match &self.mistake {
            Mistake::Set(pointer, json) => fs::write(robot, set(pointer, Some(json))?),
            Mistake::Remove(pointer) => fs::write(robot, set(pointer, None)?),
            Mistake::RobotText(change) => fs::write(robot, change(GOOD_ROBOT)),
            Mistake::Cell(line, column, text) => fs::write(poses, with_cell(*line, column, text)?),
            Mistake::Drop(column) => fs::write(poses, without_column(column)?),
            Mistake::PosesText(change) => fs::write(poses, change(GOOD_POSES)),
            Mistake::File(name, content) => fs::write(folder.join(name), content),
            Mistake::NoFile(name) => fs::remove_file(folder.join(name)),
            Mistake::Folder(name) => {
                fs::remove_file(folder.join(name))?;
                fs::create_dir(folder.join(name))
            }
            Mistake::LongLine => write_long_line(&poses),
            Mistake::NoDataset | Mistake::PlainFile => Ok(()),
        }
    }
}

fn misfit(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what.to_string())
}

fn set(pointer: &str, json: Option<&str>) -> io::Result<String> {
    let mut robot: Value = serde_json::from_str(GOOD_ROBOT)?;
    let (parent, key) = pointer.rsplit_once('/').ok_or_else(|| misfit(pointer))?;
    let parent = robot.pointer_mut(parent).ok_or_else(|| misfit(pointer))?;
    match (parent, json) {
        (Value::Object(map), Some(json)) => {
            map.insert(key.into(), serde_json::from_str(json)?);
        }
        (Value::Object(map), None) => {
            map.remove(key).ok_or_else(|| misfit(pointer))?;
        }
        (Value::Array(list), Some(json)) => {
            let index: usize = key.parse().map_err(|_| misfit(pointer))?;
            *list.get_mut(index).ok_or_else(|| misfit(pointer))? = serde_json::from_str(json)?;
        }
        _ => return Err(misfit(pointer)),
    }
    Ok(robot.to_string())
}

fn column_index(column: &str) -> io::Result<usize> {
    let header = GOOD_POSES.lines().nth(1).unwrap_or_default();
    let mut names = header.split(',');
    names
        .position(|name| name == column)
        .ok_or_else(|| misfit(column))
}

fn with_cell(line: usize, column: &str, text: &str) -> io::Result<String> {
    let column = column_index(column)?;
    let mut lines: Vec<String> = GOOD_POSES.lines().map(String::from).collect();
    let changed = lines.get_mut(line - 1).ok_or_else(|| misfit("line"))?;
    let mut cells: Vec<&str> = changed.split(',').collect();
    cells[column] = text;
    *changed = cells.join(",");
    Ok(lines.join("\n"))
}

fn without_column(column: &str) -> io::Result<String> {
    let column = column_index(column)?;
    let shorten = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if cells.len() > column {
            cells.remove(column);
        }
        cells.join(",")
    };
    Ok(GOOD_POSES
        .lines()
        .map(shorten)
        .collect::<Vec<_>>()
        .join("\n"))
}

fn write_long_line(path: &Path) -> io::Result<()> {
    let mut out = BufWriter::new(fs::File::create(path)?);
    out.write_all(GOOD_POSES.as_bytes())?;
    let piece = [b'1'; 1 << 20];
    for _ in 0..100 {
        out.write_all(&piece)?;
    }
    out.flush()
}
