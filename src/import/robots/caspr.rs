//! Models of CASPR: `..._cables.xml` and `..._bodies.xml`.
//!
//! A cable runs from link 0, the base, to link 1, the platform. At the base it leaves an `attachment`, a point, or a
//! `base_rotating_pulley`: `fixed_location` is the point that stays when the pulley swivels, our entry point,
//! `cable_entry_vector` the direction in which the cable reaches it, our swivel axis.
//! Source: Lau et al., CASPR, 2016, `BaseRotatingPulleyAttachment`.

use tautline_core::geometry::{Coordinate, Vec3};
use tautline_core::robot::{Cable, Platform, Robot};
use tautline_session::{Loaded, ReadError, quoted};

use super::{Element, Guide, cable_of, robot_of};

pub(super) fn robot(
    file: &str,
    cables: &Element,
    bodies: Option<(&str, &Element)>,
) -> Result<Loaded<Robot>, ReadError> {
    let mut notices = Vec::new();
    let body = bodies.map(|(file, root)| body(file, root)).transpose()?;
    let platform = body.unwrap_or_else(|| {
        notices.push(format!("{file}: without the file of the bodies the platform is assumed to have six degrees of freedom and no mass"));
        Platform { free: Coordinate::ALL.to_vec(), mass_kg: None, center_of_mass_m: [0.0; 3], inertia_kg_m2: None, wrench_sd: None }
    });
    let set = cable_set(file, cables)?;
    let mut cables = Vec::new();
    for element in &set.children {
        cables.push(cable(file, element, &platform, cables.len() + 1)?);
    }
    if let Some(element) = set
        .children
        .iter()
        .find(|element| element.name != "cable_ideal")
    {
        notices.push(format!("{file}, line {}: stiffness of <{}> left out: cables are inelastic unless robot.json states their stiffness", element.line, element.name));
    }
    robot_of(file, platform, cables, notices)
}

/// The default set of cables, or the first one.
fn cable_set<'a>(file: &str, root: &'a Element) -> Result<&'a Element, ReadError> {
    let mut sets = root
        .children
        .iter()
        .filter(|child| child.name == "cable_set");
    let wanted = root.attribute("default_cable_set");
    let set = match wanted {
        Some(wanted) => sets.find(|set| set.attribute("id") == Some(wanted)),
        None => sets.next(),
    };
    set.ok_or_else(|| {
        let which = wanted.map_or_else(String::new, |wanted| format!(" {}", quoted(wanted)));
        root.error(
            file,
            &format!("found no cable_set{which}, expected the cables of the robot"),
        )
    })
}

fn body(file: &str, root: &Element) -> Result<Platform, ReadError> {
    let links: Vec<&Element> = root
        .children
        .iter()
        .filter(|child| child.name.starts_with("link"))
        .collect();
    let [link] = links[..] else {
        return Err(root.error(
            file,
            &format!("found {} links, expected one platform", links.len()),
        ));
    };
    let child = |of: &'_ Element, name: &str| of.child(name).is_some();
    let joint = link
        .child("joint")
        .ok_or_else(|| link.error(file, "found no joint, expected the joint of the platform"))?;
    let kind = joint.attribute("type").unwrap_or_default();
    let free = freedom(kind).ok_or_else(|| {
        joint.error(
            file,
            &format!(
                "found the type {}, expected SPATIAL, PLANAR or TRANSLATIONAL",
                quoted(kind)
            ),
        )
    })?;
    let physical = link.child("physical");
    let of = |name: &str| physical.and_then(|physical| physical.child(name));
    let mass_kg = of("mass")
        .map(|mass| mass.numbers::<1>(file))
        .transpose()?
        .map(|[mass]| mass);
    let center_of_mass_m = of("com_location")
        .map(|place| place.numbers::<3>(file))
        .transpose()?
        .unwrap_or_default();
    if child(link, "parent")
        && link
            .child("parent")
            .and_then(|parent| parent.child("location"))
            .map(|place| place.numbers::<3>(file))
            .transpose()?
            .is_some_and(|place| place != [0.0; 3])
    {
        return Err(link.error(
            file,
            "found a platform whose joint is not at the origin of the base, expected no offset",
        ));
    }
    Ok(Platform {
        free,
        mass_kg: mass_kg.filter(|mass| *mass > 0.0),
        center_of_mass_m,
        inertia_kg_m2: None,
        wrench_sd: None,
    })
}

/// Free coordinates of a joint. Joint types with different rotation parameters have the same freedom.
fn freedom(joint: &str) -> Option<Vec<Coordinate>> {
    use Coordinate::{Rx, Ry, Rz, X, Y, Z};
    Some(match joint {
        _ if joint.starts_with("SPATIAL") => Coordinate::ALL.to_vec(),
        "PLANAR_XY" => vec![X, Y, Rz],
        "PLANAR_XZ" => vec![X, Z, Ry],
        "PLANAR_YZ" => vec![Y, Z, Rx],
        "TRANSLATIONAL_XY" => vec![X, Y],
        "TRANSLATIONAL_XZ" => vec![X, Z],
        "TRANSLATIONAL_YZ" => vec![Y, Z],
        "TRANSLATIONAL_XYZ" => vec![X, Y, Z],
        _ => return None,
    })
}

fn cable(
    file: &str,
    element: &Element,
    platform: &Platform,
    number: usize,
) -> Result<Cable, ReadError> {
    let attachments = element
        .child("attachments")
        .ok_or_else(|| element.error(file, "found no attachments, expected two"))?;
    let [base, end] = &attachments.children[..] else {
        let found = attachments.children.len();
        return Err(attachments.error(
            file,
            &format!("found {found} attachments, expected two: base and platform"),
        ));
    };
    let need = |of: &Element, name: &str| -> Result<[f64; 3], ReadError> {
        let place = of
            .child(name)
            .ok_or_else(|| of.error(file, &format!("found no <{name}>, expected three numbers")))?;
        place.numbers::<3>(file)
    };
    let on_link = |of: &Element, link: f64| -> Result<(), ReadError> {
        match of
            .child("link")
            .map(|link| link.numbers::<1>(file))
            .transpose()?
        {
            Some([found]) if found != link => {
                Err(of.error(file, &format!("found link {found}, expected {link}")))
            }
            _ => Ok(()),
        }
    };
    let (entry_point_m, radius_m, axis) = match base.name.as_str() {
        "attachment" => {
            on_link(base, 0.0)?;
            // An eyelet has no swivel axis; the value is arbitrary.
            (need(base, "location")?, 0.0, [0.0, 0.0, 1.0])
        }
        "base_rotating_pulley" => {
            let radius = base
                .child("pulley_radius")
                .ok_or_else(|| base.error(file, "found no <pulley_radius>, expected a number"))?;
            let [radius_m] = radius.numbers::<1>(file)?;
            (
                need(base, "fixed_location")?,
                radius_m,
                need(base, "cable_entry_vector")?,
            )
        }
        name => {
            return Err(base.error(
                file,
                &format!(
                    "found the attachment <{name}>, expected a point or a base_rotating_pulley"
                ),
            ));
        }
    };
    on_link(end, 1.0)?;
    let mut platform_anchor_m = need(end, "location")?;
    let reference = [end, element]
        .iter()
        .find_map(|of| of.attribute("attachment_reference"));
    if reference == Some("com") {
        for (anchor, center) in platform_anchor_m.iter_mut().zip(platform.center_of_mass_m) {
            *anchor += center;
        }
    }
    let name = element.attribute("name").map(str::to_owned);
    let axis = Vec3::from(axis)
        .try_normalize(1e-9)
        .ok_or_else(|| base.error(file, "found a cable_entry_vector of zero length"))?;
    let guide = Guide {
        entry_point_m,
        swivel_axis: axis.into(),
        radius_m,
    };
    Ok(cable_of(name, number, guide, platform_anchor_m))
}
