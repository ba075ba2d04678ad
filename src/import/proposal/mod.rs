//! Proposal of a recipe from names, units and ranges.

mod evidence;
mod markers;
mod motion;
mod recognition;

use std::collections::{BTreeMap, BTreeSet};

use tautline_channels::{Channel, Dimension, Format, Series, Source, parse_unit};
use tautline_core::robot::Robot;

use crate::cutting::{is_recording, sampled_at_rest, sampled_in_motion};
use crate::importing::in_other_frame;
use crate::naming::words::{
    ANGLES, GROUP, HOT, LABEL, LASER, NO_CLOCK, OTHER, PER_CABLE, RANGE, TEMPERATURE, TIME, TRAVEL,
};
use crate::naming::{Family, families, words_of};
use crate::recipe::{
    AngleOrder, Assignment, Cutting, Quantity, QuantityKind as Kind, Recipe, Rest, resolve,
};
use evidence::{are_quaternion, is_clock, magnitude};
use markers::{Marker, on_platform};
use motion::CommandedPoses;
use recognition::{
    Component, Origin, Recognised, angle, component, is_any, is_of_pose, is_wanted, is_whole,
    kind_name, kind_of, origin_of,
};

/// The columns of which a table has one kind: where the winches are.
const OF_WINCHES: [&str; 3] = ["rev_{i}", "change_{i}_m", "length_{i}_m"];

/// Proposes a recipe; the sentences state the assumptions.
#[must_use]
pub fn propose(sources: &[Source], robot: &Robot) -> (Recipe, Vec<String>) {
    propose_around(sources, robot, Vec::new())
}

/// Proposes a recipe around assignments that are known; the sentences state the assumptions.
#[must_use]
pub fn propose_around(
    sources: &[Source],
    robot: &Robot,
    known: Vec<Assignment>,
) -> (Recipe, Vec<String>) {
    let mut proposal = Proposal {
        robot,
        given: known.iter().map(|known| known.quantity.clone()).collect(),
        miscounted: Vec::new(),
        recipe: Recipe::default(),
        known,
        notices: Vec::new(),
    };
    let series = sources.iter().flat_map(|source| {
        let format = source.format;
        source.series.iter().map(move |series| (series, format))
    });
    let mut series: Vec<(&Series, Format)> = series.collect();
    // States and commands of joints have the same names: measured ones come first.
    series.sort_by_key(|(series, format)| is_wanted(&topic(series, *format)));
    for (series, format) in series {
        proposal.own_names(series);
        proposal.families(series, format);
        proposal.singles(series, format);
    }
    proposal.by_motion(sources);
    proposal.tell_miscounted();
    let names_repeat = |name: &str| {
        let all = sources.iter().flat_map(|source| &source.series);
        all.filter(|series| series.channel(name).is_some() || series.text(name).is_some())
            .count()
            > 1
    };
    for assignment in &mut proposal.recipe.channels {
        let first = assignment
            .channel
            .replacen("{i}", &assignment.first.to_string(), 1);
        if !names_repeat(&first) {
            assignment.series = None;
        }
    }
    // A later entry overrides an earlier one.
    proposal.recipe.channels.append(&mut proposal.known);
    proposal.cutting(sources);
    proposal.home(sources);
    proposal.instrument(sources);
    (proposal.recipe, proposal.notices)
}

/// Words of the topic of a series: messages have the same names in each.
fn topic(series: &Series, format: Format) -> Vec<String> {
    match format {
        Format::Mcap | Format::RosBag => words_of(&series.name),
        _ => Vec::new(),
    }
}

/// The channels of a family in their order.
fn members<'s>(series: &'s Series, family: &Family) -> Vec<&'s Channel> {
    let names = (0..family.count).map(|k| family.member(k));
    names.filter_map(|name| series.channel(&name)).collect()
}

/// Whether a series has a position, i.e. an x coordinate of a pose of unknown origin.
fn has_position(series: &Series) -> bool {
    let found = series
        .channels
        .iter()
        .filter_map(|channel| component(&channel.name));
    let mut open = found.filter(|found| found.origin == Origin::Open && found.is_pose);
    open.any(|found| found.index == 0)
}

/// Channels of one pose, each with the index of its component.
type Components<'a> = Vec<(usize, &'a Channel)>;

/// A pose in a series.
struct Body<'a> {
    owner: String,
    origin: Origin,
    components: Components<'a>,
    /// Angles about x, y, z, where an orientation is stated as such.
    angles: Components<'a>,
    order: Option<AngleOrder>,
}

/// Adds components to the body of this owner: its position, its quaternion, or from 7 on angles about x, y, z.
fn add<'a>(bodies: &mut Vec<Body<'a>>, owner: String, origin: Origin, components: Components<'a>) {
    let known = bodies
        .iter_mut()
        .find(|body| body.owner == owner && body.origin == origin);
    let body = match known {
        Some(body) => body,
        None => {
            bodies.push(Body {
                owner,
                origin,
                components: Vec::new(),
                angles: Vec::new(),
                order: None,
            });
            let last = bodies.len() - 1;
            &mut bodies[last]
        }
    };
    for (index, channel) in components {
        let of = match index {
            0..7 => &mut body.components,
            _ => &mut body.angles,
        };
        if of.iter().all(|(known, _)| *known != index % 7) {
            of.push((index % 7, channel));
        }
    }
}

/// Gives a quaternion with a name of its own to the only position of the same origin, `x_des` and `quat_cmd`, or one whose origin
/// its name leaves open to the only position that lacks one.
fn join_rotations(bodies: &mut Vec<Body<'_>>) {
    for origin in [Origin::Commanded, Origin::Measured, Origin::Open] {
        join_rotation(bodies, origin, |body| body.origin == origin);
    }
    join_rotation(bodies, Origin::Open, |_| true);
}

fn join_rotation(bodies: &mut Vec<Body<'_>>, origin: Origin, takes: impl Fn(&Body<'_>) -> bool) {
    let has_rotation = |body: &Body<'_>| body.components.iter().any(|(k, _)| *k > 2);
    let has_position = |body: &Body<'_>| body.components.iter().any(|(k, _)| *k < 3);
    let places = |is_meant: &dyn Fn(&Body<'_>) -> bool| -> Vec<usize> {
        let all = bodies.iter().enumerate();
        all.filter(|(_, body)| is_meant(body))
            .map(|(k, _)| k)
            .collect()
    };
    let rotations = places(&|body| body.origin == origin && !has_position(body));
    let positions = places(&|body| takes(body) && has_position(body) && !has_rotation(body));
    if let ([rotation], [position]) = (&rotations[..], &positions[..]) {
        let components = std::mem::take(&mut bodies[*rotation].components);
        bodies[*position].components.extend(components);
        bodies.remove(*rotation);
    }
}

/// Angles of a platform in radians are smaller.
const QUARTER_TURN_RAD: f64 = 1.6;

/// Words of vectors that are poses.
const VECTORS: &[&str] = &[
    "x",
    "p",
    "pose",
    "tcp",
    "ee",
    "effector",
    "pf",
    "platform",
    "plattform",
];

/// Poses that are numbered vectors, such as `x_des(:,1)` to `x_des(:,7)`, and quaternions `q0` to `q3`.
fn vectors(series: &Series) -> Vec<(Origin, Components<'_>)> {
    let mut found = Vec::new();
    let names = series.channels.iter().map(|channel| channel.name.as_str());
    for family in families(names) {
        let channels = members(series, &family);
        // `S.pose(:,1)` is in a struct.
        let leaf = family.pattern.rsplit('.').next().unwrap_or_default();
        let words = words_of(&leaf.replacen("{i}", "", 1));
        let is_pose = !words.is_empty()
            && words
                .iter()
                .all(|word| is_of_pose(word) || matches!(word.as_str(), "x" | "e"));
        if !is_pose || channels.len() != family.count || is_any(&words, OTHER) {
            continue;
        }
        let origin = origin_of(&words);
        // `pos[{i}]` are as likely positions of axes.
        let is_vector =
            is_any(&words, VECTORS) && family.pattern.contains(['(', '[', '_', '.', '{']);
        let rotation = |of: &[&'_ Channel]| -> Option<[usize; 4]> {
            // Rotations of a platform are small: the scalar is the larger one at the end where it may stand.
            let is_last = magnitude(of.last()?) > magnitude(of.first()?);
            are_quaternion(of).then_some(match is_last {
                true => [4, 5, 6, 3],
                false => [3, 4, 5, 6],
            })
        };
        let places: Option<Vec<usize>> = match channels.len() {
            4 => rotation(&channels).map(|places| places.to_vec()),
            // The rotation of a tool (TCP) of an industrial robot is a rotation vector.
            6 if is_vector && !is_any(&words, &["tcp"]) => Some(vec![0, 1, 2, 7, 8, 9]),
            3 | 6 if is_vector => Some(vec![0, 1, 2]),
            7 if is_vector => {
                rotation(&channels[3..]).map(|places| [&[0, 1, 2], &places[..]].concat())
            }
            _ => None,
        };
        if let Some(places) = places {
            found.push((origin, places.into_iter().zip(channels).collect()));
        }
    }
    found
}

struct Proposal<'a> {
    robot: &'a Robot,
    recipe: Recipe,
    /// Assignments that are not to be proposed.
    known: Vec<Assignment>,
    /// Columns that already have a channel.
    given: BTreeSet<String>,
    /// Families whose number is not that of the cables: series, channels, and the notice to be given if nothing else uses them.
    miscounted: Vec<(String, Vec<String>, String)>,
    notices: Vec<String>,
}

impl Proposal<'_> {
    fn add(&mut self, assignment: Assignment) {
        self.given.insert(assignment.quantity.clone());
        self.recipe.channels.push(assignment);
    }

    fn is_given(&self, column: &str) -> bool {
        self.given.contains(column)
    }

    /// Whether an existing entry of a recipe assigns the channel.
    fn is_known(&self, name: &str) -> bool {
        let mut known = self.known.iter();
        known.any(|known| known.channel == name || known.is_pattern_of(name))
    }

    /// Channels with the names of the columns of `poses.csv`.
    fn own_names(&mut self, series: &Series) {
        let cables = self.robot.cable_count();
        for (kind, _) in PER_CABLE {
            let all = (1..=cables).all(|number| {
                series
                    .channel(&kind.column_of(&number.to_string()))
                    .is_some()
            });
            let pattern = kind.column_of("{i}");
            if all && !self.is_given(&pattern) {
                self.add(Assignment {
                    series: Some(series.name.clone()),
                    ..Assignment::new(pattern.clone(), pattern)
                });
            }
        }
        let names = series.channels.iter().map(|channel| &channel.name);
        for name in names.chain(series.texts.iter().map(|text| &text.name)) {
            let Some(quantity) = Quantity::parse(name).filter(|quantity| !quantity.is_per_cable())
            else {
                continue;
            };
            let is_text = series.channel(name).is_none();
            if !self.is_given(name) && (!is_text || quantity.is_text()) {
                self.add(Assignment {
                    series: Some(series.name.clone()),
                    ..Assignment::new(name.clone(), name.clone())
                });
            }
        }
    }

    /// One channel for each cable.
    fn families(&mut self, series: &Series, format: Format) {
        let cables = self.robot.cable_count();
        let names = series.channels.iter().map(|channel| channel.name.as_str());
        let mut candidates: Vec<(Recognised, Family)> = Vec::new();
        for family in families(names) {
            let channels = members(series, &family);
            let is_known = channels.iter().any(|channel| self.is_known(&channel.name));
            if channels.len() != family.count || is_known || are_quaternion(&channels) {
                continue;
            }
            let Some(recognised) = kind_of(&channels) else {
                continue;
            };
            if family.count == cables {
                candidates.push((recognised, family));
            } else if family.count + 1 >= cables || family.count > 2 {
                let sentence = format!(
                    "{}: {} channels {} could be the {} of cables, but the robot has {cables} cables: not used",
                    series.name,
                    family.count,
                    family.pattern,
                    kind_name(recognised.kind)
                );
                let members = channels.iter().map(|channel| channel.name.clone());
                self.miscounted
                    .push((series.name.clone(), members.collect(), sentence));
            }
        }
        candidates.sort_by_key(|(recognised, _)| (recognised.kind, -recognised.score));
        for (recognised, family) in candidates {
            let column = recognised.kind.column_of("{i}");
            if self.is_given(&column) {
                continue;
            }
            if recognised.is_counts {
                self.notices.push(format!(
                    "{}: {} look like encoder counts, of which the file does not state how many make a revolution: not used; for 4096, --set \"{column}={} [rev/4096]\"",
                    series.name, family.pattern, family.pattern
                ));
                continue;
            }
            if recognised.by_values {
                self.notices.push(format!(
                    "{}: {} vary as tensions do and are taken for them",
                    series.name, family.pattern
                ));
            }
            let unit = self.unit_by_range(series, &family, recognised.kind, format);
            let assignment = Assignment {
                series: Some(series.name.clone()),
                unit,
                first: family.first,
                ..Assignment::new(family.pattern, column)
            };
            self.add(assignment);
        }
    }

    /// States which families have another number than that of the cables and no other use.
    fn tell_miscounted(&mut self) {
        for (series, members, sentence) in std::mem::take(&mut self.miscounted) {
            let mut uses = self.recipe.channels.iter().chain(&self.known);
            let is_used = uses.any(|entry| {
                let is_here = entry.series.as_ref().is_none_or(|of| *of == series);
                let mut members = members.iter();
                is_here && members.any(|name| entry.channel == *name || entry.is_pattern_of(name))
            });
            if !is_used {
                self.notices.push(sentence);
            }
        }
    }

    /// Assigns families whose names are unknown, but whose values follow the cables at the commanded poses.
    fn by_motion(&mut self, sources: &[Source]) {
        let moves = OF_WINCHES.iter().any(|column| self.is_given(column));
        let pulls = self.is_given("force_{i}_n");
        let known = self.recipe.channels.iter().chain(&self.known).cloned();
        let trial = Recipe {
            channels: known.collect(),
            ..Recipe::default()
        };
        let cables = self.robot.cable_count();
        let Ok(mapping) = resolve(sources, &trial, "recipe", cables) else {
            return;
        };
        let Some(poses) = CommandedPoses::of(&mapping, self.robot) else {
            return;
        };
        let series = mapping.series[poses.series];
        let names = series.channels.iter().map(|channel| channel.name.as_str());
        let mut found: Vec<Assignment> = Vec::new();
        for family in families(names)
            .into_iter()
            .filter(|family| family.count == cables)
        {
            let channels = members(series, &family);
            let is_free = |channel: &&Channel| {
                let mut uses = trial.channels.iter();
                !uses.any(|known| {
                    known.channel == channel.name || known.is_pattern_of(&channel.name)
                })
            };
            let says_other = |channel: &&Channel| {
                let words = words_of(&channel.name);
                channel.unit.is_some() || is_wanted(&words) || is_any(&words, OTHER)
            };
            let is_full = channels.len() == cables;
            if !is_full || !channels.iter().all(is_free) || channels.iter().any(says_other) {
                continue;
            }
            let has = |column: &str| found.iter().any(|known| known.quantity == column);
            let entry = |kind: Kind, unit: Option<&str>, reversed: bool| Assignment {
                series: Some(series.name.clone()),
                unit: unit.map(str::to_owned),
                reversed,
                first: family.first,
                ..Assignment::new(family.pattern.clone(), kind.column_of("{i}"))
            };
            let is_moving = moves || OF_WINCHES.iter().any(|column| has(column));
            let followed = poses.followed_by(&channels, self.robot);
            if let Some((kind, unit, reversed)) = followed.filter(|_| !is_moving) {
                self.notices.push(format!(
                    "{}: {} follow the lengths of the cables at the commanded poses: taken for {}",
                    series.name,
                    family.pattern,
                    match (kind, unit) {
                        (Kind::Length, unit) => format!("lengths in {}", unit.unwrap_or("m")),
                        (Kind::Change, unit) => {
                            format!("lengths since home in {}", unit.unwrap_or("m"))
                        }
                        (_, unit) => format!("winches in {}", unit.unwrap_or("rev")),
                    }
                ));
                found.push(entry(kind, unit, reversed));
            } else if !pulls && !has("force_{i}_n") && poses.are_carried_by(&channels, self.robot) {
                self.notices.push(format!(
                    "{}: {} carry the platform at the commanded poses: taken for forces in N",
                    series.name, family.pattern
                ));
                found.push(entry(Kind::Force, None, false));
            }
        }
        found.into_iter().for_each(|entry| self.add(entry));
    }

    /// The unit of a family without a stated one, if its values suggest a unit other than that of the quantity.
    fn unit_by_range(
        &mut self,
        series: &Series,
        family: &Family,
        kind: Kind,
        format: Format,
    ) -> Option<String> {
        let channels = members(series, family);
        if channels.iter().any(|channel| channel.unit.is_some()) {
            return None;
        }
        let frame_m = self.robot.frame_size_m()?;
        let ranges: Vec<[f64; 2]> = channels
            .iter()
            .map(|channel| channel.summary().range)
            .collect();
        let widest = |of: &dyn Fn(&[f64; 2]) -> f64| ranges.iter().map(of).fold(0.0, f64::max);
        let is_ros = matches!(format, Format::Mcap | Format::RosBag);
        let unit = match kind {
            Kind::Change | Kind::Length => {
                (widest(&|range| range[1].abs()) > 30.0 * frame_m).then_some("mm")
            }
            Kind::Swivel => (widest(&|range| range[1] - range[0]) > 6.5).then_some("deg"),
            Kind::Revolutions => {
                let per_revolution = self.robot.cables[0].winch.cable_per_revolution_m();
                let frames = widest(&|range| range[1] - range[0]) * per_revolution / frame_m;
                // A calibration moves cables by a fraction of the frame's size, never by a multiple of it.
                if frames > 30.0 {
                    Some("deg")
                // ROS states joint angles in radians.
                } else if frames > 2.0 || is_ros && family.pattern.starts_with("position[") {
                    Some("rad")
                } else {
                    None
                }
            }
            _ => None,
        }?;
        let reason = match format {
            Format::Mcap | Format::RosBag => "by its range and the conventions of ROS",
            _ => "by its range",
        };
        self.notices.push(format!(
            "{}: no unit is stated for {}; {reason} it is assumed to be {unit}",
            series.name, family.pattern
        ));
        Some(unit.into())
    }

    /// Quantities with a single channel.
    fn singles(&mut self, series: &Series, format: Format) {
        for text in &series.texts {
            let words = words_of(&text.name);
            let column = match () {
                () if is_any(&words, GROUP) => "group",
                () if is_any(&words, LABEL) => "pose",
                () => continue,
            };
            if self.is_open(series, &text.name, column) {
                self.single(series, &text.name, column, None);
            }
        }
        let names = series.channels.iter().map(|channel| channel.name.as_str());
        let several: BTreeSet<String> = families(names)
            .iter()
            .filter(|family| family.count > 1)
            .flat_map(|family| (0..family.count).map(|k| family.member(k)))
            .collect();
        for channel in &series.channels {
            let is_one = !several.contains(&channel.name);
            if let Some(column) = self.single_column(series, channel, is_one)
                && self.is_open(series, &channel.name, column)
            {
                let unit = self.single_unit(channel, column);
                self.single(series, &channel.name, column, unit);
            }
        }
        self.poses(series, format);
    }

    /// The column of a channel that is the only one of its kind; `is_one`: no other name differs by a number only.
    fn single_column(
        &self,
        series: &Series,
        channel: &Channel,
        is_one: bool,
    ) -> Option<&'static str> {
        let words = words_of(&channel.name);
        let unit = channel.unit.as_deref().map(parse_unit);
        // An unknown unit measures no quantity of ours.
        let dimension = match unit {
            Some(unit) => Some(unit?.dimension),
            None => None,
        };
        let fits = |expected: Dimension| {
            dimension.is_none_or(|found| found == expected || found == Dimension::Number)
        };
        let is_time = dimension == Some(Dimension::Time)
            || is_any(&words[..words.len().min(1)], TIME)
            || is_any(&words[words.len().saturating_sub(1)..], TIME) && words.len() > 1;
        let is_distance = is_any(&words, LASER)
            || is_any(&words, &["range"])
                && words.iter().all(|word| RANGE.contains(&word.as_str()));
        let is_temperature =
            is_any(&words, TEMPERATURE) || dimension == Some(Dimension::Temperature) && is_one;
        if is_any(&words, LABEL) && is_whole(channel) && words.len() <= 2 {
            Some("pose")
        } else if series.time_s.is_none()
            && is_time
            && fits(Dimension::Time)
            && !is_any(&words, NO_CLOCK)
            && is_clock(channel)
        {
            Some("time_s")
        } else if is_distance
            && is_one
            && fits(Dimension::Length)
            && !(is_any(&words, OTHER) || is_any(&words, TRAVEL) || is_wanted(&words))
        {
            Some("laser_m")
        } else if is_temperature && is_one && fits(Dimension::Temperature) && !is_any(&words, HOT) {
            Some("temperature_c")
        } else {
            ANGLES
                .iter()
                .position(|angle| is_any(&words, angle))
                .filter(|_| {
                    // Next to a position, and without an inclinometer, these are angles of a pose.
                    let is_of_pose = self.robot.inclinometer.is_none() && has_position(series);
                    if is_of_pose {
                        return false;
                    }
                    let is_other = is_any(&words, OTHER) || origin_of(&words) != Origin::Open;
                    fits(Dimension::Angle) && is_one && !is_other
                })
                .map(|k| ["roll_rad", "pitch_rad", "yaw_rad"][k])
        }
    }

    /// Whether neither the channel nor the column is assigned.
    fn is_open(&self, series: &Series, name: &str, column: &str) -> bool {
        let mut here = self.recipe.channels.iter();
        let mut here_is = |is_meant: &dyn Fn(&Assignment) -> bool| {
            here.any(|known| known.series.as_ref() == Some(&series.name) && is_meant(known))
        };
        match column {
            // Every series has its own clock.
            "time_s" => !here_is(&|known| known.quantity == "time_s"),
            _ => {
                !self.is_known(name)
                    && !self.is_given(column)
                    && !here_is(&|known| known.channel == name)
            }
        }
    }

    fn single(&mut self, series: &Series, name: &str, column: &str, unit: Option<&str>) {
        self.add(Assignment {
            series: Some(series.name.clone()),
            unit: unit.map(Into::into),
            ..Assignment::new(name, column)
        });
    }

    /// The unit of a channel without a stated one, from its range.
    fn single_unit(&mut self, channel: &Channel, column: &str) -> Option<&'static str> {
        if channel.unit.is_some() {
            return None;
        }
        let range = channel.summary().range;
        let largest = range[0].abs().max(range[1].abs());
        let frame_m = self.robot.frame_size_m()?;
        let unit = match column {
            // No recording begins this number of seconds after 1970.
            "time_s" if largest > 1e17 => "ns",
            "time_s" if largest > 1e14 => "us",
            "time_s" if largest > 1e11 => "ms",
            "laser_m" if largest > 30.0 * frame_m => "mm",
            "roll_rad" | "pitch_rad" | "yaw_rad" if largest > 3.2 => "deg",
            _ => return None,
        };
        self.notices.push(format!(
            "no unit is stated for {}; by its range it is assumed to be {unit}",
            channel.name
        ));
        Some(unit)
    }

    /// Coordinates of poses: commanded, and measured by an instrument.
    fn poses(&mut self, series: &Series, format: Format) {
        if self.markers(series, format) {
            return;
        }
        let mut bodies = self.bodies(series, format);
        // Poses of stated origin come first, and bodies with an orientation before markers without one.
        bodies.sort_by_key(|body| (body.origin, usize::MAX - body.components.len()));
        for body in bodies {
            self.pose(series, format, body);
        }
    }

    /// The poses in a series: channels that are named as components, and vectors.
    fn bodies<'s>(&self, series: &'s Series, format: Format) -> Vec<Body<'s>> {
        let topic = topic(series, format);
        let is_capture = matches!(
            format,
            Format::Motive | Format::Nexus | Format::C3d | Format::PointList
        );
        let with_topic = |origin: Origin| match origin {
            Origin::Open if is_capture => Origin::Measured,
            Origin::Open => origin_of(&topic),
            stated => stated,
        };
        let is_free = |channel: &Channel| {
            let known = self.recipe.channels.iter();
            !self.is_known(&channel.name)
                && !known
                    .filter(|known| known.series.as_ref() == Some(&series.name))
                    .any(|known| {
                        known.channel == channel.name || known.is_pattern_of(&channel.name)
                    })
        };
        let mut bodies: Vec<Body<'s>> = Vec::new();
        let mut in_vectors: BTreeSet<&str> = BTreeSet::new();
        for (origin, components) in vectors(series) {
            if !components.iter().all(|(_, channel)| is_free(channel)) {
                continue;
            }
            in_vectors.extend(components.iter().map(|(_, channel)| channel.name.as_str()));
            let owner = String::new();
            add(&mut bodies, owner, with_topic(origin), components);
        }
        for channel in &series.channels {
            let words = words_of(&channel.name);
            let is_taken = in_vectors.contains(channel.name.as_str()) || !is_free(channel);
            let is_other = is_any(&words, OTHER) || is_any(&words, &["twist", "force", "wrench"]);
            if is_taken || is_other {
                continue;
            }
            let Some(Component {
                index,
                owner,
                origin,
                is_pose,
            }) = component(&channel.name)
            else {
                continue;
            };
            let origin = with_topic(origin);
            // A coordinate of anything else than the platform, such as of a person.
            if origin == Origin::Open && !is_pose && !owner.is_empty() {
                continue;
            }
            add(&mut bodies, owner, origin, vec![(index, channel)]);
        }
        join_rotations(&mut bodies);
        for channel in series.channels.iter().filter(|channel| is_free(channel)) {
            let fits = channel.unit.as_deref().is_none_or(|unit| {
                parse_unit(unit).is_some_and(|unit| unit.dimension == Dimension::Angle)
            });
            if let Some((found, order)) = angle(&channel.name).filter(|_| fits) {
                let origin = with_topic(found.origin);
                let of = bodies
                    .iter_mut()
                    .find(|body| body.owner == found.owner && body.origin == origin);
                if let Some(body) = of {
                    body.angles.push((found.index, channel));
                    body.order = body.order.or(order);
                }
            }
        }
        bodies
    }

    /// Assigns the components of a pose.
    fn pose(&mut self, series: &Series, format: Format, body: Body<'_>) {
        let has = |k: usize| body.components.iter().any(|(component, _)| *component == k);
        let is_open = body.origin == Origin::Open;
        let is_commanded = match body.origin {
            Origin::Commanded => true,
            Origin::Measured => false,
            // Without an instrument a pose is where the controller takes the platform to be.
            Origin::Open => self.robot.tracker.is_none() || self.is_given("meas_x_m"),
        };
        let columns: [&str; 7] = match is_commanded {
            true => ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"],
            false => [
                "meas_x_m", "meas_y_m", "meas_z_m", "meas_qw", "meas_qx", "meas_qy", "meas_qz",
            ],
        };
        if !(0..3).any(has) || (0..3).any(|k| self.is_given(columns[k])) {
            return;
        }
        let whole_rotation = (3..7).all(has);
        let up_is_y = format == Format::Motive;
        let unit = self.position_unit(&body.components, &body.owner);
        for (component, channel) in &body.components {
            if *component > 2 && !whole_rotation {
                continue;
            }
            // Motive's y axis is up and its z axis points to the viewer; ours is z up: (x, y, z) is (x, -z, y) there.
            let (place, reversed) = match (up_is_y, *component) {
                (true, 1) => (2, false),
                (true, 2) => (1, true),
                (true, 5) => (6, false),
                (true, 6) => (5, true),
                (_, component) => (component, false),
            };
            let unit = unit.filter(|_| *component < 3).map(Into::into);
            self.add(Assignment {
                series: Some(series.name.clone()),
                unit,
                reversed,
                ..Assignment::new(channel.name.clone(), columns[place])
            });
        }
        if !whole_rotation {
            self.angles(series, &body, is_commanded);
        }
        if is_open {
            let names = body
                .components
                .iter()
                .map(|(_, channel)| channel.name.as_str());
            let names: Vec<&str> = names.collect();
            let (what, other) = match is_commanded {
                true => (
                    "commanded",
                    "; if an instrument measured them, state it as `tracker` in robot.json and import again",
                ),
                false => ("measured", ""),
            };
            self.notices.push(format!(
                "{}: {} are taken for {what} poses, which their names do not state{other}",
                series.name,
                names.join(", ")
            ));
        }
        if up_is_y {
            self.notices.push(format!("{}: the y axis of the capture is assumed to point up: x, y, z of the robot are x, -z, y there", series.name));
        }
    }

    /// Assigns the angles of a pose.
    fn angles(&mut self, series: &Series, body: &Body<'_>, is_commanded: bool) {
        let about = |axis: usize| body.angles.iter().find(|(known, _)| *known == axis);
        let (Some((_, x)), Some((_, y)), Some((_, z))) = (about(0), about(1), about(2)) else {
            return;
        };
        let order = body.order.unwrap_or(AngleOrder::XYZ);
        let kind = match is_commanded {
            true => Kind::CommandedAngle,
            false => Kind::TrackedAngle,
        };
        let angles = order.sort([*x, *y, *z]);
        let widest = angles.iter().map(|channel| {
            let [low, high] = channel.summary().range;
            low.abs().max(high.abs())
        });
        let is_stated = angles.iter().all(|channel| channel.unit.is_some());
        let in_degrees = !is_stated && widest.fold(0.0, f64::max) > QUARTER_TURN_RAD;
        for (index, channel) in angles.iter().enumerate() {
            self.add(Assignment {
                series: Some(series.name.clone()),
                unit: in_degrees.then(|| "deg".to_owned()),
                ..Assignment::new(channel.name.clone(), Quantity { kind, index }.column())
            });
        }
        let stated = self.recipe.angles.get_or_insert_default();
        match is_commanded {
            true => stated.commanded = Some(order),
            false => stated.measured = Some(order),
        }
        let [first, second, third] = angles.map(|channel| channel.name.as_str());
        self.notices.push(format!(
            "{}: {first}, {second}, {third}{} are taken for angles of R = {} in this order, each about an axis of the turned frame; --angles states another one",
            series.name,
            if in_degrees { " in degrees" } else { "" },
            order.product()
        ));
    }

    /// Assigns three or more markers on the platform if no body has an orientation; returns whether there are any.
    fn markers(&mut self, series: &Series, format: Format) -> bool {
        let mut owners: BTreeMap<String, [Option<&Channel>; 3]> = BTreeMap::new();
        let mut has_orientation = false;
        for channel in &series.channels {
            match component(&channel.name) {
                Some(found) if found.index < 3 => {
                    owners.entry(found.owner).or_default()[found.index] = Some(channel);
                }
                Some(_) => has_orientation = true,
                None => {}
            }
        }
        let is_capture = matches!(format, Format::Motive | Format::Nexus | Format::C3d);
        let whole = owners.into_iter().filter_map(|(owner, [x, y, z])| {
            let is_marker = is_capture || owner.to_lowercase().contains("marker");
            is_marker.then_some((owner, [x?, y?, z?]))
        });
        let all: Vec<Marker<'_>> = whole.collect();
        if has_orientation || self.is_given("meas_x_m") || self.is_given("marker_1_x_m") {
            return false;
        }
        let chosen = on_platform(&all);
        if chosen.is_empty() {
            return false;
        }
        for (number, (owner, channels)) in chosen.iter().map(|k| &all[*k]).enumerate() {
            let components: Vec<(usize, &Channel)> = channels.iter().copied().enumerate().collect();
            let unit = self.position_unit(&components, owner).map(str::to_owned);
            for (axis, channel) in components {
                let index = 3 * number + axis;
                let kind = Kind::Marker;
                self.add(Assignment {
                    series: Some(series.name.clone()),
                    unit: unit.clone(),
                    ..Assignment::new(channel.name.clone(), Quantity { kind, index }.column())
                });
            }
        }
        let moving = all.iter().enumerate().filter(|(k, _)| chosen.contains(k));
        let moving: Vec<&str> = moving.map(|(_, (owner, _))| owner.as_str()).collect();
        self.notices.push(format!(
            "{}: {} move at constant distances from each other: assumed to be markers on the platform",
            series.name,
            moving.join(", ")
        ));
        true
    }

    fn position_unit(
        &mut self,
        components: &[(usize, &Channel)],
        owner: &str,
    ) -> Option<&'static str> {
        let positions = components.iter().filter(|(component, _)| *component < 3);
        let positions: Vec<&Channel> = positions.map(|(_, channel)| *channel).collect();
        if positions.iter().any(|channel| channel.unit.is_some()) {
            return None;
        }
        let largest = positions
            .iter()
            .flat_map(|channel| channel.summary().range)
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let frame_m = self.robot.frame_size_m()?;
        if largest < 10.0 * frame_m {
            return None;
        }
        let of = if owner.is_empty() {
            "the coordinates"
        } else {
            owner
        };
        self.notices.push(format!(
            "no unit is stated for {of}; by their range they are assumed to be in mm"
        ));
        Some("mm")
    }

    fn cutting(&mut self, sources: &[Source]) {
        let series = || sources.iter().flat_map(|source| &source.series);
        let label = self
            .recipe
            .channels
            .iter()
            .find(|known| known.quantity == "pose");
        let repeats = label.is_some_and(|label| {
            series().any(|series| {
                match (series.channel(&label.channel), series.text(&label.channel)) {
                    (Some(channel), _) => {
                        let next = channel.values.iter().skip(1);
                        channel
                            .values
                            .iter()
                            .zip(next)
                            .any(|(one, next)| one == next)
                    }
                    (None, Some(text)) => text.codes.windows(2).any(|pair| pair[0] == pair[1]),
                    (None, None) => false,
                }
            })
        });
        self.recipe.cutting = if repeats {
            Cutting::Labels
        } else if series().any(is_recording) && sampled_at_rest(sources, &self.recipe, self.robot) {
            Cutting::Rest(Rest::default())
        } else if sampled_in_motion(sources, &self.recipe, self.robot) {
            Cutting::Motion
        } else {
            Cutting::Rows
        };
    }

    /// Asks for the frame of the instrument if poses are not in the base frame.
    fn instrument(&mut self, sources: &[Source]) {
        if !self.is_given("meas_x_m") {
            return;
        }
        if let Some(sentence) = in_other_frame(sources, &self.recipe, self.robot) {
            self.notices.push(format!(
                "{sentence}: the frame of the instrument is found from the poses"
            ));
            self.recipe.instrument = Some(Box::default());
        }
    }

    /// Assumes that the first pose is the home pose, unless poses have labels, and counts revolutions from there.
    fn home(&mut self, sources: &[Source]) {
        let has_labels = self
            .recipe
            .channels
            .iter()
            .any(|known| known.quantity == "pose");
        let revolutions = self
            .recipe
            .channels
            .iter_mut()
            .find(|known| known.quantity == "rev_{i}");
        let (Some(assignment), Some(_), false) = (revolutions, self.robot.home, has_labels) else {
            return;
        };
        let mut largest = 0.0_f64;
        let mut span = 0.0_f64;
        for number in assignment.first..assignment.first + self.robot.cable_count() {
            let name = assignment.channel.replacen("{i}", &number.to_string(), 1);
            let channel = sources
                .iter()
                .flat_map(|source| &source.series)
                .find_map(|series| series.channel(&name));
            let Some(channel) = channel else { return };
            let [low, high] = channel.summary().range;
            let first = channel.values.iter().find(|value| !value.is_nan());
            largest = largest.max(first.map_or(0.0, f64::abs));
            span = span.max(high - low);
        }
        self.recipe.first_pose_is_home = true;
        if largest > 0.02 * span {
            assignment.from_first_pose = true;
            self.notices.push("the revolutions do not begin at 0: they are counted from the first pose, which is assumed to be the home pose".into());
        } else {
            self.notices.push("the first pose is assumed to be the home pose, because the revolutions begin at 0 there".into());
        }
    }
}

#[cfg(test)]
mod tests;
