//! Proposal of a recipe from names, units and ranges.

mod markers;
mod recognition;

use std::collections::{BTreeMap, BTreeSet};

use tautline_core::robot::Robot;

use crate::cutting::{is_recording, sampled_at_rest, sampled_in_motion};
use crate::naming::words::{
    ANGLES, EXTERNAL, GROUP, LABEL, LASER, PER_CABLE, TEMPERATURE, TIME, WANTED,
};
use crate::naming::{Family, families, words_of};
use crate::recipe::{Assignment, Cutting, Kind, Quantity, Recipe, Rest};
use crate::source::{Channel, Format, Series, Source};
use crate::units::{Dimension, parse_unit};
use markers::{Marker, on_platform};
use recognition::{Body, component, is_any, is_whole, kind_name, kind_of};

/// Proposes a recipe; the sentences state the assumptions.
#[must_use]
pub fn propose(sources: &[Source], robot: &Robot) -> (Recipe, Vec<String>) {
    let mut proposal = Proposal {
        robot,
        recipe: Recipe::default(),
        given: BTreeSet::new(),
        notices: Vec::new(),
    };
    let series = sources.iter().flat_map(|source| {
        let format = source.format;
        source.series.iter().map(move |series| (series, format))
    });
    let mut series: Vec<(&Series, Format)> = series.collect();
    // States and commands of joints have the same names: what is measured goes first.
    series.sort_by_key(|(series, format)| is_any(&topic(series, *format), WANTED));
    for (series, format) in series {
        proposal.own_names(series);
        proposal.families(series, format);
        proposal.singles(series, format);
    }
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
    proposal.cutting(sources);
    proposal.home(sources);
    (proposal.recipe, proposal.notices)
}

/// Words of the topic of a series: messages have the same names in each.
fn topic(series: &Series, format: Format) -> Vec<String> {
    match format {
        Format::Mcap | Format::RosBag => words_of(&series.name),
        _ => Vec::new(),
    }
}

struct Proposal<'a> {
    robot: &'a Robot,
    recipe: Recipe,
    /// Columns that already have a channel.
    given: BTreeSet<String>,
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
        let mut candidates: Vec<(Kind, i32, Family)> = Vec::new();
        for family in families(names) {
            let member = family.pattern.replacen("{i}", &family.first.to_string(), 1);
            let Some(channel) = series.channel(&member) else {
                continue;
            };
            let Some((kind, score)) = kind_of(channel) else {
                continue;
            };
            if family.count == cables {
                candidates.push((kind, score, family));
            } else if family.count + 1 >= cables || family.count > 2 {
                self.notices.push(format!(
                    "{}: {} channels {} could be the {} of cables, but the robot has {cables} cables: not used",
                    series.name,
                    family.count,
                    family.pattern,
                    kind_name(kind)
                ));
            }
        }
        candidates.sort_by_key(|(kind, score, _)| (*kind, -score));
        for (kind, _, family) in candidates {
            let column = kind.column_of("{i}");
            if self.is_given(&column) {
                continue;
            }
            let unit = self.unit_by_range(series, &family, kind, format);
            let assignment = Assignment {
                series: Some(series.name.clone()),
                unit,
                first: family.first,
                ..Assignment::new(family.pattern, column)
            };
            self.add(assignment);
        }
    }

    /// The unit of a family without a stated one, if its values suggest a unit other than that of the quantity.
    fn unit_by_range(
        &mut self,
        series: &Series,
        family: &Family,
        kind: Kind,
        format: Format,
    ) -> Option<String> {
        let channels = (0..family.count).filter_map(|k| {
            series.channel(
                &family
                    .pattern
                    .replacen("{i}", &(family.first + k).to_string(), 1),
            )
        });
        let channels: Vec<&Channel> = channels.collect();
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
            Kind::Length => (widest(&|range| range[1].abs()) > 30.0 * frame_m).then_some("mm"),
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
            self.single(series, &text.name, column, None);
        }
        for channel in &series.channels {
            let words = words_of(&channel.name);
            let dimension = channel
                .unit
                .as_deref()
                .and_then(parse_unit)
                .map(|unit| unit.dimension);
            let fits = |expected: Dimension| {
                dimension.is_none_or(|found| found == expected || found == Dimension::Number)
            };
            let column = if is_any(&words, LABEL) && is_whole(channel) && words.len() <= 2 {
                Some("pose")
            } else if series.time_s.is_none()
                && fits(Dimension::Time)
                && (is_any(&words[..words.len().min(1)], TIME)
                    || dimension == Some(Dimension::Time))
            {
                Some("time_s")
            } else if (is_any(&words, LASER) || words == ["range"]) && fits(Dimension::Length) {
                Some("laser_m")
            } else if is_any(&words, TEMPERATURE) && fits(Dimension::Temperature) {
                Some("temperature_c")
            } else {
                ANGLES
                    .iter()
                    .position(|angle| is_any(&words, angle))
                    .filter(|_| fits(Dimension::Angle) && !is_any(&words, WANTED))
                    .map(|k| ["roll_rad", "pitch_rad", "yaw_rad"][k])
            };
            if let Some(column) = column {
                let unit = self.single_unit(channel, column);
                self.single(series, &channel.name, column, unit);
            }
        }
        self.poses(series, format);
    }

    fn single(&mut self, series: &Series, name: &str, column: &str, unit: Option<&str>) {
        if self.is_given(column)
            || self
                .recipe
                .channels
                .iter()
                .any(|known| known.channel == name && known.series.as_ref() == Some(&series.name))
        {
            // The clock of a second series is its own.
            if column != "time_s"
                || self.recipe.channels.iter().any(|known| {
                    known.quantity == "time_s" && known.series.as_ref() == Some(&series.name)
                })
            {
                return;
            }
        }
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
        let topic = topic(series, format);
        let mut bodies: Vec<Body<'_>> = Vec::new();
        let given: BTreeSet<String> = self
            .recipe
            .channels
            .iter()
            .filter(|known| known.series.as_ref() == Some(&series.name))
            .map(|known| known.channel.clone())
            .collect();
        let free = series
            .channels
            .iter()
            .filter(|channel| !given.contains(&channel.name));
        for channel in free {
            let words = words_of(&channel.name);
            let (Some((component, owner)), false) = (
                component(&channel.name, &words),
                is_any(
                    &words,
                    &[
                        "vel",
                        "velocity",
                        "twist",
                        "speed",
                        "acc",
                        "accel",
                        "acceleration",
                        "force",
                        "torque",
                        "error",
                    ],
                ),
            ) else {
                continue;
            };
            let is_wanted = is_any(&words, WANTED) || is_any(&topic, WANTED);
            let is_known = is_wanted
                || is_any(&words, EXTERNAL)
                || is_any(&topic, EXTERNAL)
                || matches!(
                    format,
                    Format::Motive | Format::Nexus | Format::C3d | Format::PointList
                )
                || owner.is_empty();
            if !is_known || is_any(&words, &["marker"]) {
                continue;
            }
            match bodies.iter_mut().find(|(known, ..)| *known == owner) {
                Some((_, _, components)) => components.push((component, channel)),
                None => bodies.push((owner, is_wanted, vec![(component, channel)])),
            }
        }
        // A body with an orientation tells more than a marker without one.
        bodies.sort_by_key(|(_, _, components)| usize::MAX - components.len());
        for (owner, is_wanted, components) in bodies {
            let has = |k: usize| components.iter().any(|(component, _)| *component == k);
            let columns: [&str; 7] = match is_wanted {
                true => ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"],
                false => [
                    "meas_x_m", "meas_y_m", "meas_z_m", "meas_qw", "meas_qx", "meas_qy", "meas_qz",
                ],
            };
            if !(0..3).any(has) || (0..3).any(|k| self.is_given(columns[k])) {
                continue;
            }
            let whole_rotation = (3..7).all(has);
            let up_is_y = format == Format::Motive;
            let unit = self.position_unit(&components, &owner);
            for (component, channel) in &components {
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
            if up_is_y {
                self.notices.push(format!("{}: the y axis of the capture is assumed to point up: x, y, z of the robot are x, -z, y there", series.name));
            }
        }
    }

    /// Assigns three or more markers on the platform if no body has an orientation; returns whether there are any.
    fn markers(&mut self, series: &Series, format: Format) -> bool {
        let mut owners: BTreeMap<String, [Option<&Channel>; 3]> = BTreeMap::new();
        let mut has_orientation = false;
        for channel in &series.channels {
            match component(&channel.name, &words_of(&channel.name)) {
                Some((axis @ 0..3, owner)) => {
                    owners.entry(owner).or_default()[axis] = Some(channel);
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
        let names = |is_on: bool| {
            let some = all
                .iter()
                .enumerate()
                .filter(|(k, _)| chosen.contains(k) == is_on);
            some.map(|(_, (owner, _))| owner.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let mut notice = format!(
            "{}: {} move at constant distances from each other: assumed to be markers on the platform",
            series.name,
            names(true)
        );
        if chosen.len() < all.len() {
            notice += &format!("; not used: {}", names(false));
        }
        self.notices.push(notice);
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

    /// Whether the first pose is the home pose, and whether encoders count from there.
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
