//! Cable robots in URDF of ROS and SDF of Gazebo: models of named frames, each in another one.
//!
//! A cable comes from the frame `pulley_NAME` and ends at the frame `anchor_NAME`; those with numbers belong to `cable-1` and so on. The
//! platform is the frame in which the first anchor is. Frames are the links of URDF, in the parents of their joints, and the links and
//! frames of SDF. Lengths are in metres; orientations are angles about the fixed axes x, y, z (rad).
//! Source: ROS wiki, `urdf/XML`; SDFormat 1.7, pose frame semantics.

use std::ops::Range;

use tautline_core::geometry::Pose;
use tautline_core::robot::{Cable, Platform};
use tautline_files::{ReadError, quoted};

use super::description::{Guide, INERTIA, cable_of, filled, in_frame, pose_of, simulated};
use super::dialect::{Dialect, ForeignRobot, Setting};
use super::settings::Settings;
use super::xml::{self, Element};

pub(super) static URDF: Dialect = Dialect {
    name: "urdf",
    has_winches: false,
    is_in: |text| xml::has_tag(text, "<robot") && !text.contains("<models"),
    read,
    new_text: |robot| filled(NEW_URDF, " ", robot),
    bodies: None,
};
pub(super) static SDF: Dialect = Dialect {
    name: "sdf",
    is_in: |text| xml::has_tag(text, "<sdf"),
    new_text: |robot| filled(NEW_SDF, " ", robot),
    ..URDF
};

/// A root that is called world is fixed by simulators.
const NEW_URDF: [&str; 3] = [
    "<?xml version=\"1.0\"?>\n<robot name=\"{robot}\">\n  <link name=\"world\"/>\n  <link name=\"platform\">\n    <inertial>\n      <origin xyz=\"{center}\"/>\n      <mass value=\"{mass}\"/>\n      <inertia ixx=\"{ixx}\" ixy=\"{ixy}\" ixz=\"{ixz}\" iyy=\"{iyy}\" iyz=\"{iyz}\" izz=\"{izz}\"/>\n    </inertial>\n  </link>\n  <joint name=\"platform_joint\" type=\"floating\">\n    <parent link=\"world\"/>\n    <child link=\"platform\"/>\n    <origin xyz=\"{place}\" rpy=\"{turn}\"/>\n  </joint>\n",
    "  <link name=\"pulley_{cable}\"/>\n  <joint name=\"pulley_{cable}_joint\" type=\"fixed\">\n    <parent link=\"world\"/>\n    <child link=\"pulley_{cable}\"/>\n    <origin xyz=\"{entry}\"/>\n  </joint>\n  <link name=\"anchor_{cable}\"/>\n  <joint name=\"anchor_{cable}_joint\" type=\"fixed\">\n    <parent link=\"platform\"/>\n    <child link=\"anchor_{cable}\"/>\n    <origin xyz=\"{anchor}\"/>\n  </joint>\n",
    "</robot>\n",
];
const NEW_SDF: [&str; 3] = [
    "<?xml version=\"1.0\"?>\n<sdf version=\"1.7\">\n  <model name=\"{robot}\">\n    <link name=\"base\"/>\n    <joint name=\"base_joint\" type=\"fixed\">\n      <parent>world</parent>\n      <child>base</child>\n    </joint>\n    <link name=\"platform\">\n      <pose>{place} {turn}</pose>\n      <inertial>\n        <pose>{center} 0 0 0</pose>\n        <mass>{mass}</mass>\n        <inertia>\n          <ixx>{ixx}</ixx>\n          <ixy>{ixy}</ixy>\n          <ixz>{ixz}</ixz>\n          <iyy>{iyy}</iyy>\n          <iyz>{iyz}</iyz>\n          <izz>{izz}</izz>\n        </inertia>\n      </inertial>\n    </link>\n",
    "    <frame name=\"pulley_{cable}\" attached_to=\"base\">\n      <pose>{entry} 0 0 0</pose>\n    </frame>\n    <frame name=\"anchor_{cable}\" attached_to=\"platform\">\n      <pose>{anchor} 0 0 0</pose>\n    </frame>\n",
    "  </model>\n</sdf>\n",
];

/// A frame relative to another one, which has no name if it is the base.
struct Frame<'x> {
    name: &'x str,
    within: &'x str,
    pose: Pose,
    /// Bytes of its position in the text.
    at: Option<Range<usize>>,
    element: &'x Element,
}

/// The frames of a model.
struct Model<'x> {
    file: &'x str,
    root: &'x Element,
    frames: Vec<Frame<'x>>,
}

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let root = xml::parse(text, file)?;
    let worlds = root.of_kind("world").chain([&root]);
    // A world may hold other models, such as a ground plane.
    let models = worlds.flat_map(|world| world.of_kind("model"));
    let largest = models.max_by_key(|model| model.children.len());
    let mut model = Model {
        file,
        root: largest.unwrap_or(&root),
        frames: Vec::new(),
    };
    let root = model.root;
    for link in root.of_kind("link").chain(root.of_kind("frame")) {
        let name = link.attribute("name").unwrap_or_default();
        let is_above = |joint: &&Element| joint.in_child("child", "link") == Some(name);
        let element = root.of_kind("joint").find(is_above).unwrap_or(link);
        let outer = element.in_child("parent", "link");
        let outer = outer.or_else(|| element.in_child("pose", "relative_to"));
        let outer = outer.or_else(|| element.attribute("attached_to"));
        let origin = element.child("origin").and_then(|one| one.place("xyz"));
        let stated = || element.child("pose")?.text_place();
        model.frames.push(Frame {
            name,
            within: outer.unwrap_or_default(),
            pose: pose(file, element)?,
            at: origin.or_else(stated),
            element,
        });
    }
    let mut settings = Settings::new(file, text);
    let (name, cables) = model.cables(&mut settings)?;
    let notices = vec![format!(
        "{file}: the link {} is taken to move freely, correct platform.free in robot.json otherwise; its inertia is left out unless it is in the axes of the link",
        quoted(name)
    )];
    let mut links = root.of_kind("link");
    let link = links.find(|link| link.attribute("name") == Some(name));
    let platform = platform_of(file, link.and_then(|link| link.child("inertial")))?;
    simulated(platform, cables, &model.pose(name)?, notices, settings)
}

/// The pose of an element in the one that it is in.
fn pose(file: &str, of: &Element) -> Result<Pose, ReadError> {
    let mut numbers = [0.0; 6];
    if let Some(pose) = of.child("pose") {
        if let Some(other) = pose
            .attribute("degrees")
            .or(pose.attribute("rotation_format"))
        {
            let message = format!("found {}, expected angles in radians", quoted(other));
            return Err(pose.error(file, &message));
        }
        numbers = pose.numbers::<6>(file)?;
    } else if let Some(origin) = of.child("origin") {
        for (name, at) in [("xyz", 0), ("rpy", 3)] {
            if let Some(stated) = origin.list(file, name, 3)? {
                numbers[at..at + 3].copy_from_slice(&stated);
            }
        }
    }
    let [x, y, z, roll, pitch, yaw] = numbers;
    Ok(pose_of([x, y, z], [roll, pitch, yaw]))
}

/// The platform with this `<inertial>`, whose inertia is known only in its own axes.
fn platform_of(file: &str, inertial: Option<&Element>) -> Result<Platform, ReadError> {
    let mut platform = Platform::spatial(None);
    if let Some(inertial) = inertial {
        let center = pose(file, inertial)?;
        platform.center_of_mass_m = center.position.into();
        platform.mass_kg = inertial.value(file, "mass")?;
        let inertia = inertial.child("inertia");
        if let Some(stated) = inertia.filter(|_| center.orientation.angle() == 0.0) {
            let values = INERTIA.map(|name| stated.value(file, name));
            let values: Vec<Option<f64>> = values.into_iter().collect::<Result<_, _>>()?;
            let values = values.into_iter().map(Option::unwrap_or_default);
            platform.inertia_kg_m2 = values.collect::<Vec<f64>>().try_into().ok();
        }
    }
    Ok(platform)
}

impl<'x> Model<'x> {
    /// The pose of a frame in the base.
    fn pose(&self, name: &str) -> Result<Pose, ReadError> {
        let (mut pose, mut outer) = (Pose::identity(), name);
        for _ in 0..=self.frames.len() {
            if outer.is_empty() || outer == "__model__" {
                return Ok(pose);
            }
            let Some(frame) = self.frames.iter().find(|frame| frame.name == outer) else {
                break;
            };
            pose = in_frame(&frame.pose, &pose);
            outer = frame.within;
        }
        let [name, outer] = [name, outer].map(quoted);
        let message =
            format!("found {name} within {outer}, expected a frame of this file in the base");
        Err(self.root.error(self.file, &message))
    }

    /// The frames of a kind, each with the rest of its name.
    fn points(&self, kind: &str) -> Vec<(&'x str, &Frame<'x>)> {
        let of_kind = |frame: &Frame<'x>| frame.name.strip_prefix(kind);
        let all = self.frames.iter();
        let all = all.filter_map(|frame| Some((of_kind(frame)?, frame)));
        let name = |name: &'x str| name.trim_start_matches(['_', '-']);
        all.map(|(rest, frame)| (name(rest), frame)).collect()
    }

    /// The platform, and the cables between the frames, whose positions become parameters.
    fn cables(&self, settings: &mut Settings<'_>) -> Result<(&'x str, Vec<Cable>), ReadError> {
        let (anchors, mut cables) = (self.points("anchor"), Vec::new());
        let platform = anchors.first().ok_or_else(|| {
            let message = "found no cables, expected frames pulley_NAME and anchor_NAME, or the yaml from which cdpr generates a model";
            self.root.error(self.file, message)
        })?;
        let platform = platform.1.within;
        let home = self.pose(platform)?;
        for (name, pulley) in self.points("pulley") {
            let anchor = anchors.iter().find(|(other, _)| *other == name);
            let (_, anchor) = anchor.ok_or_else(|| {
                let message = format!("found no anchor_{name}, expected the end of its cable");
                pulley.element.error(self.file, &message)
            })?;
            let name = match name.parse::<u32>() {
                Ok(_) => format!("cable-{name}"),
                Err(_) => name.to_owned(),
            };
            if let Some(at) = pulley.at.clone() {
                settings.point(pulley.name, at, &name, Setting::entry)?;
            }
            if let Some(at) = anchor.at.clone().filter(|_| anchor.within == platform) {
                settings.point(anchor.name, at, &name, Setting::anchor)?;
            }
            let guide = Guide::eyelet(self.pose(pulley.name)?.position.into());
            let end = self.pose(anchor.name)?.position - home.position;
            let end = home.orientation.inverse() * end;
            cables.push(cable_of(Some(name), 0, guide, end.into()));
        }
        Ok((platform, cables))
    }
}
