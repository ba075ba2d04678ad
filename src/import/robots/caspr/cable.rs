//! The cables of a set: attachments, stiffness and limits of the tension.

use tautline_core::geometry::Vec3;
use tautline_core::robot::{Cable, Platform, Robot, TensionLimits};
use tautline_files::{ReadError, quoted};

use super::super::description::{Guide, cable_of, filled_for};
use super::super::dialect::{Meaning, Setting};
use super::super::settings::Settings;
use super::Element;

/// Parts of a new file of the cables. CASPR finds their set by an `id` of the type ID.
const CABLES: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!DOCTYPE cables [<!ATTLIST cable_set id ID #REQUIRED>]>\n<cables default_cable_set=\"calibrated\">\n  <cable_set id=\"calibrated\">\n{cables}  </cable_set>\n</cables>\n";
const CABLE: &str = "    <{kind} name=\"{name}\" attachment_reference=\"joint\">\n      <properties>{stiffness}<force_min>{least}</force_min><force_max>{most}</force_max></properties>\n      <attachments>\n        {base}\n        <attachment><link>1</link><location>{anchor}</location></attachment>\n      </attachments>\n    </{kind}>\n";
const PULLEY: &str = "<base_rotating_pulley><fixed_location>{entry}</fixed_location><pulley_radius>{radius}</pulley_radius><cable_entry_vector>{swivel}</cable_entry_vector></base_rotating_pulley>";
const POINT: &str = "<attachment><link>0</link><location>{entry}</location></attachment>";

/// A new file of the cables. CASPR needs limits of the tension: without them none is too large.
pub(super) fn new_text(robot: &Robot) -> String {
    let tension = robot.limits.and_then(|limits| limits.tension);
    let [least, most] = tension.map_or([0.0, f64::INFINITY], |all| [all.lower_n, all.upper_n]);
    let cable = |cable: &Cable| {
        let (kind, stiffness) = match cable.cable.axial_stiffness_n {
            Some(stiffness_n) => ("cable_linear_spring", format!("<K>{stiffness_n}</K>")),
            None => ("cable_ideal", String::new()),
        };
        let is_point = cable.pulley.radius_m == 0.0;
        let part = CABLE.replace("{base}", if is_point { POINT } else { PULLEY });
        let part = part
            .replace("{kind}", kind)
            .replace("{stiffness}", &stiffness);
        filled_for(&part, " ", 0, cable)
    };
    let cables: String = robot.cables.iter().map(cable).collect();
    CABLES
        .replace("{cables}", &cables)
        .replace("{least}", &least.to_string())
        .replace("{most}", &most.to_string())
}

/// Makes the points of cables, whose elements are those of a set, parameters.
pub(super) fn add_points(
    set: &Element,
    cables: &[Cable],
    settings: &mut Settings<'_>,
) -> Result<(), ReadError> {
    for (element, cable) in set.children.iter().zip(cables) {
        let all = element.child("attachments");
        for (number, end) in (0..).zip(all.iter().flat_map(|all| &all.children)) {
            let (part, row): (_, fn(usize) -> Setting) = match (number, reference(element, end)) {
                (0, _) => ("base", Setting::entry),
                (_, Some("com")) => ("platform", |axis| Setting {
                    meaning: Meaning::AnchorFromMass(axis),
                    ..Setting::anchor(axis)
                }),
                _ => ("platform", Setting::anchor),
            };
            let point = end.child("fixed_location").or(end.child("location"));
            if let Some(at) = point.and_then(Element::text_place) {
                settings.point(&format!("{} {part}", cable.name), at, &cable.name, row)?;
            }
        }
    }
    Ok(())
}

/// The point of the platform from which the end of a cable is placed.
fn reference<'x>(cable: &'x Element, end: &'x Element) -> Option<&'x str> {
    let mut stated = [end, cable].into_iter();
    stated.find_map(|of| of.attribute("attachment_reference"))
}

/// The default set of cables, or the first one; a notice names the others.
pub(super) fn cable_set<'a>(
    file: &str,
    root: &'a Element,
    notices: &mut Vec<String>,
) -> Result<&'a Element, ReadError> {
    let sets: Vec<&Element> = root.of_kind("cable_set").collect();
    let id = |set: &Element| quoted(set.attribute("id").unwrap_or_default());
    let wanted = root.attribute("default_cable_set");
    let used = match wanted {
        Some(wanted) => sets
            .iter()
            .position(|set| set.attribute("id") == Some(wanted)),
        None => (!sets.is_empty()).then_some(0),
    };
    let Some(used) = used else {
        let which = wanted.map_or_else(String::new, |wanted| format!(" {}", quoted(wanted)));
        let message = format!("found no cable_set{which}, expected the cables of the robot");
        return Err(root.error(file, &message));
    };
    let others: Vec<String> = sets
        .iter()
        .enumerate()
        .filter(|(k, _)| *k != used)
        .map(|(_, set)| id(set))
        .collect();
    if !others.is_empty() {
        notices.push(format!(
            "{file}: the cable set {} is used; for {} change default_cable_set in the file",
            id(sets[used]),
            others.join(", ")
        ));
    }
    Ok(sets[used])
}

/// The cables of a set in their order.
pub(super) fn cables(
    file: &str,
    set: &Element,
    platform: &Platform,
    notices: &mut Vec<String>,
) -> Result<Vec<Cable>, ReadError> {
    let mut cables: Vec<Cable> = Vec::new();
    let mut has_stiffness_left_out = false;
    for element in &set.children {
        let number = cables.len() + 1;
        let mut cable = cable(file, element, platform, number)?;
        if let Some(first) = cables.iter().position(|known| known.name == cable.name) {
            let name = format!("{} ({number})", cable.name);
            notices.push(format!(
                "{file}, line {}: cable {number} has the name {} of cable {}: it is called {}",
                element.line,
                quoted(&cable.name),
                first + 1,
                quoted(&name)
            ));
            cable.name = name;
        }
        match element.name.as_str() {
            "cable_ideal" => {}
            "cable_linear_spring" => {
                cable.cable.axial_stiffness_n = Some(stiffness(file, element)?);
            }
            name if name.starts_with("cable_vsd_") => {
                if !has_stiffness_left_out {
                    notices.push(format!("{file}, line {}: the variable stiffness of <{name}> is left out: such cables are inelastic unless robot.json states their stiffness", element.line));
                }
                has_stiffness_left_out = true;
            }
            name if name.starts_with("cable_passive_") => {
                return Err(element.error(
                    file,
                    "found a passive spring, expected cables with a winch: forces of springs between base and platform are not modelled",
                ));
            }
            _ => {
                return Err(element.error(
                    file,
                    "found an actuator that is no cable, expected <cable_ideal>, <cable_linear_spring> or <cable_vsd_...>",
                ));
            }
        }
        cables.push(cable);
    }
    Ok(cables)
}

/// Axial stiffness (N): CASPR divides `K` by the length of the cable.
fn stiffness(file: &str, element: &Element) -> Result<f64, ReadError> {
    let stated = element
        .child("properties")
        .and_then(|properties| properties.child("K"))
        .ok_or_else(|| element.error(file, "found no <K>, expected the stiffness of the cable"))?;
    match stated.numbers::<1>(file)? {
        [value] if value > 0.0 => Ok(value),
        [value] => {
            let message = format!("found {value}, expected a stiffness greater than 0");
            Err(stated.error(file, &message))
        }
    }
}

/// Limits that hold for all cables of a set, if every cable states its own: the narrowest of them. The reference is the
/// middle, from which tensions deviate as little as possible (Pott, Bruckmann, Mikelsons, 2009).
pub(super) fn tension_limits(
    file: &str,
    set: &Element,
    notices: &mut Vec<String>,
) -> Result<Option<TensionLimits>, ReadError> {
    let mut limits: Vec<[f64; 2]> = Vec::new();
    for element in &set.children {
        let properties = element.child("properties");
        let of = |name: &str| -> Result<Option<f64>, ReadError> {
            let stated = properties.and_then(|properties| properties.child(name));
            let stated = stated.filter(|one| !one.text().eq_ignore_ascii_case("inf"));
            let value = stated.map(|stated| stated.numbers::<1>(file)).transpose()?;
            Ok(value.map(|[value]| value))
        };
        let (Some(lower), Some(upper)) = (of("force_min")?, of("force_max")?) else {
            return Ok(None);
        };
        if lower < 0.0 || lower >= upper {
            let message = format!(
                "found force_min {lower} and force_max {upper}, expected a range of tensions"
            );
            return Err(element.error(file, &message));
        }
        limits.push([lower, upper]);
    }
    let lower_n = limits.iter().map(|[lower, _]| *lower).fold(0.0, f64::max);
    let upper_n = limits
        .iter()
        .map(|[_, upper]| *upper)
        .fold(f64::INFINITY, f64::min);
    if limits.is_empty() || lower_n >= upper_n {
        notices.push(format!(
            "{file}, line {}: the ranges of tension of the cables have nothing in common: left out",
            set.line
        ));
        return Ok(None);
    }
    if limits.iter().any(|range| *range != [lower_n, upper_n]) {
        notices.push(format!(
            "{file}: the limits of the tension differ between the cables; {lower_n} to {upper_n} N, which no cable exceeds, is used for all"
        ));
    }
    Ok(Some(TensionLimits {
        lower_n,
        reference_n: (lower_n + upper_n) / 2.0,
        upper_n,
    }))
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
        let message = format!("found {found} attachments, expected two: base and platform");
        return Err(attachments.error(file, &message));
    };
    let guide = guide(file, base)?;
    check_link(file, end, 1.0)?;
    let mut platform_anchor_m = point(file, end, "location")?;
    if reference(element, end) == Some("com") {
        for (anchor, center) in platform_anchor_m.iter_mut().zip(platform.center_of_mass_m) {
            *anchor += center;
        }
    }
    let name = element.attribute("name").map(str::trim);
    let name = name.filter(|name| !name.is_empty()).map(str::to_owned);
    Ok(cable_of(name, number, guide, platform_anchor_m))
}

fn guide(file: &str, base: &Element) -> Result<Guide, ReadError> {
    match base.name.as_str() {
        "attachment" => {
            check_link(file, base, 0.0)?;
            Ok(Guide {
                entry_point_m: point(file, base, "location")?,
                // An eyelet has no swivel axis; the value is arbitrary.
                swivel_axis: [0.0, 0.0, 1.0],
                radius_m: 0.0,
            })
        }
        "base_rotating_pulley" => {
            let radius = base
                .child("pulley_radius")
                .ok_or_else(|| base.error(file, "found no <pulley_radius>, expected a number"))?;
            let [radius_m] = radius.numbers::<1>(file)?;
            let axis = Vec3::from(point(file, base, "cable_entry_vector")?)
                .try_normalize(1e-9)
                .ok_or_else(|| base.error(file, "found a cable_entry_vector of zero length"))?;
            Ok(Guide {
                entry_point_m: point(file, base, "fixed_location")?,
                swivel_axis: axis.into(),
                radius_m,
            })
        }
        name => {
            let message = format!(
                "found the attachment <{name}>, expected a point or a base_rotating_pulley"
            );
            Err(base.error(file, &message))
        }
    }
}

fn point(file: &str, of: &Element, name: &str) -> Result<[f64; 3], ReadError> {
    let place = of
        .child(name)
        .ok_or_else(|| of.error(file, &format!("found no <{name}>, expected three numbers")))?;
    place.numbers::<3>(file)
}

fn check_link(file: &str, of: &Element, link: f64) -> Result<(), ReadError> {
    let stated = of.child("link").map(|stated| stated.numbers::<1>(file));
    match stated.transpose()? {
        Some([found]) if found != link => {
            Err(of.error(file, &format!("found link {found}, expected {link}")))
        }
        _ => Ok(()),
    }
}
