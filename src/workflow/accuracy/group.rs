//! The rows of a check.csv, by commanded pose and by point of a path.

use tautline_core::accuracy::iso9283::Target;
use tautline_core::geometry::Pose;
use tautline_session::{CheckKind, CheckPose, CheckRow};

/// Distance beyond which commanded poses count as different (m and rad), far below the accuracy of any robot.
const SAME_POSE: f64 = 1e-6;

/// All rows of one pose or path.
pub struct Group {
    /// Whether it is a pose or a path.
    pub kind: CheckKind,
    /// Name of the pose or path in the file.
    pub name: String,
    /// The single commanded pose, or the points along the path in order.
    pub points: Vec<Point>,
}

/// All rows of one commanded pose or one point of a path.
pub struct Point {
    /// Number of the point along the path.
    pub sample: i64,
    /// Numbers of the cycles, ascending.
    cycles: Vec<i64>,
    /// Commanded and attained poses.
    pub target: Target,
    /// Whether commanded and attained orientation are known in every cycle.
    pub oriented: bool,
    /// Whether they are known in any cycle.
    pub some_oriented: bool,
}

impl Point {
    /// Commanded position (m).
    pub fn commanded_m(&self) -> [f64; 3] {
        self.target.commanded.position.into()
    }
}

/// Groups the rows in the order in which the poses and paths first occur.
///
/// # Errors
/// One sentence if the rows of a pose or path are inconsistent.
pub fn group(rows: &[CheckRow]) -> Result<Vec<Group>, String> {
    let mut groups: Vec<(CheckKind, &str, Vec<&CheckRow>)> = Vec::new();
    let mut index_of = std::collections::HashMap::new();
    for row in rows {
        let key = (row.kind, row.target.as_str());
        let index = *index_of.entry(key).or_insert(groups.len());
        match groups.get_mut(index) {
            Some((_, _, rows)) => rows.push(row),
            None => groups.push((row.kind, &row.target, vec![row])),
        }
    }
    groups
        .into_iter()
        .map(|(kind, name, rows)| {
            let points = points(rows).and_then(|points| check_cycles(kind, points));
            Ok(Group {
                kind,
                name: name.to_owned(),
                points: points.map_err(|e| format!("{} \"{name}\", {e}", word(kind)))?,
            })
        })
        .collect()
}

/// Word for a pose or path in messages.
pub fn word(kind: CheckKind) -> &'static str {
    match kind {
        CheckKind::Pose => "pose",
        CheckKind::Path => "path",
    }
}

fn points(mut rows: Vec<&CheckRow>) -> Result<Vec<Point>, String> {
    rows.sort_by_key(|row| (row.sample, row.cycle));
    rows.chunk_by(|a, b| a.sample == b.sample)
        .map(point)
        .collect()
}

fn point(rows: &[&CheckRow]) -> Result<Point, String> {
    let first = rows[0];
    let known = |row: &&CheckRow| {
        row.commanded.orientation_wxyz.is_some() && row.attained.orientation_wxyz.is_some()
    };
    let commanded = pose(&first.commanded);
    let is_other = |row: &&&CheckRow| {
        let difference = pose(&row.commanded).difference(&commanded);
        // A missing orientation is compatible with any other.
        let given =
            row.commanded.orientation_wxyz.is_some() == first.commanded.orientation_wxyz.is_some();
        let compared = if given { 6 } else { 3 };
        difference.rows(0, compared).amax() > SAME_POSE
    };
    if let Some(row) = rows.iter().find(is_other) {
        let (sample, cycle, before) = (first.sample, row.cycle, first.cycle);
        return Err(format!(
            "sample {sample}: the commanded pose of cycle {cycle} differs from that of cycle {before}, \
             expected the same in every cycle"
        ));
    }
    Ok(Point {
        sample: first.sample,
        cycles: rows.iter().map(|row| row.cycle).collect(),
        target: Target {
            commanded,
            attained: rows.iter().map(|row| pose(&row.attained)).collect(),
        },
        oriented: rows.iter().all(known),
        some_oriented: rows.iter().any(known),
    })
}

fn pose(pose: &CheckPose) -> Pose {
    let orientation = pose.orientation_wxyz.unwrap_or([1.0, 0.0, 0.0, 0.0]);
    Pose::from_parts(pose.position_m, orientation)
}

/// Checks that a pose is one point, and that every point has the same cycles, at least two.
fn check_cycles(kind: CheckKind, points: Vec<Point>) -> Result<Vec<Point>, String> {
    if let (CheckKind::Pose, [first, second, ..]) = (kind, points.as_slice()) {
        return Err(format!(
            "found the samples {} and {}, expected one: only a path has several",
            first.sample, second.sample
        ));
    }
    let expected = &points[0].cycles;
    for point in &points {
        let lacks = |cycles: &[i64], other: &[i64]| {
            let missing = other.iter().find(|cycle| !cycles.contains(cycle));
            missing.copied()
        };
        let missing = lacks(&point.cycles, expected).map(|cycle| (cycle, point.sample));
        let surplus = || lacks(expected, &point.cycles).map(|cycle| (cycle, points[0].sample));
        if let Some((cycle, sample)) = missing.or_else(surplus) {
            return Err(format!(
                "sample {sample}: found no row of cycle {cycle}, expected every point in every cycle"
            ));
        }
    }
    if let [only] = expected.as_slice() {
        return Err(format!(
            "found only cycle {only}, expected at least 2 cycles for the repeatability"
        ));
    }
    Ok(points)
}
