//! Packs what the equations of many poses need.

use std::sync::Arc;

use super::columns::{Column, ColumnStore};
use crate::effect::{
    BoundEffect, CablePort, CablePorts, Circumstances, Dual, PlatformPort, PlatformPorts, Stage,
};
use crate::estimation::problem::{Geometry, Globals, Problem};
use crate::geometry::Pose;
use crate::measurement::Measurements;
use crate::real::Packet;
use crate::robot::Cable;

/// A free parameter acts on a port of a cable with this slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct CableLink {
    pub port: CablePort,
    pub parameter: usize,
    pub slope: Column,
    /// Whether the slope is in proportion to the port, so that it is better known at the port's estimate than at its
    /// reading: noise in both would bias the parameter.
    pub is_proportional: bool,
    /// Relative change of the noise of a length per unit of the parameter, which scales the reading.
    pub relative_noise: f64,
}

/// A free parameter acts on a port of the platform with this slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlatformLink {
    pub port: PlatformPort,
    pub parameter: usize,
    pub slope: Column,
}

/// Ports of all poses, and how the free effects act on them.
#[derive(Clone)]
pub(super) struct PortInputs<T: Packet> {
    pub store: ColumnStore<T>,
    pub cables: Vec<[Column; CablePort::COUNT]>,
    pub cable_links: Vec<Vec<CableLink>>,
    pub platform: [Column; PlatformPort::COUNT],
    pub platform_links: Vec<PlatformLink>,
}

/// Which rows are packed, and as what.
#[derive(Debug, Clone, Copy)]
pub(super) struct Selection<'a> {
    pub rows: &'a [usize],
    pub is_home: bool,
    /// What effects may depend on; there if there are effects.
    pub circumstances: Option<&'a Circumstances>,
}

/// What effects may depend on: as the problem knows it, else at the commanded poses, else the tracker's, else
/// home; nothing without effects.
pub(super) fn circumstances_of(problem: &Problem<'_>) -> Option<Arc<Circumstances>> {
    if problem.held_effects.is_empty() && problem.free_effects.is_empty() {
        return None;
    }
    if let Some(known) = &problem.circumstances {
        return Some(Arc::clone(known));
    }
    let data = &problem.dataset.measurements;
    let home = nominal_home(problem);
    let pose = |row: usize| {
        let commanded = data.commanded.get(row).copied().flatten();
        let tracked = data.tracked_position_at(row).map(|position| Pose {
            position,
            orientation: home.orientation,
        });
        commanded.or(tracked).unwrap_or(home)
    };
    let poses: Vec<Pose> = (0..data.len()).map(pose).collect();
    Some(Arc::new(Circumstances::new(
        &problem.dataset.robot,
        data,
        problem.home_row(),
        &poses,
        None,
    )))
}

fn nominal_home(problem: &Problem<'_>) -> Pose {
    let home = problem.dataset.robot.home;
    home.map_or_else(Pose::identity, |home| home.pose())
}

/// Cable paid out since home as the reading tells, or the absolute length read (m).
fn nominal_paid(cable: &Cable, data: &Measurements, at: (usize, usize), is_home: bool) -> f64 {
    if is_home {
        0.0
    } else if data.revolutions.is_empty() {
        data.length_m.get(at.0, at.1)
    } else {
        cable.winch.cable_per_revolution_m() * data.revolutions.get(at.0, at.1)
    }
}

/// Tension as the sensor tells (N); 0 without a sensor, NaN where it was not read.
fn nominal_tension(cable: &Cable, data: &Measurements, at: (usize, usize)) -> f64 {
    match cable.force_sensor {
        Some(sensor) if !data.force_n.is_empty() => sensor.tension_n(data.force_n.get(at.0, at.1)),
        _ => 0.0,
    }
}

/// The ports of a cable before any effect, at one row.
fn nominal_cable_ports(
    cable: &Cable,
    data: &Measurements,
    at: (usize, usize),
    is_home: bool,
) -> CablePorts {
    let paid = nominal_paid(cable, data, at, is_home);
    let tension = nominal_tension(cable, data, at);
    CablePorts::nominal(cable, paid, tension)
}

/// Change of a port per unit of the reading behind it, at the first selected row; its slope is that by the `chosen`
/// parameter. Every effect that acts on a reading scales it or adds to it. Noise is the reading's, so what
/// scales a reading scales its noise: without this, readings that shrink would seem to fit better.
fn reading_gain(
    problem: &Problem<'_>,
    globals: &Globals,
    selection: Selection<'_>,
    (index, port): (usize, ReadPort),
    chosen: Option<usize>,
) -> Dual {
    let concerned = concerned(globals, |bound| bound.cables.contains(&index));
    let (Some(circumstances), Some(row)) = (selection.circumstances, selection.rows.first()) else {
        return Dual::constant(1.0);
    };
    let cable = &problem.dataset.robot.cables[index];
    let values = seeded(problem, globals, chosen);
    let port_at = |reading: f64| {
        let mut ports = CablePorts::nominal(cable, reading, reading);
        for k in &concerned {
            let effect = globals.effects[*k].effect;
            effect.change_cable(&values[*k], circumstances.cable(*row, index), &mut ports);
        }
        match port {
            ReadPort::Paid => ports.paid,
            ReadPort::Tension => ports.tension,
        }
    };
    port_at(1.0) - port_at(0.0)
}

/// A port that starts from a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReadPort {
    Paid,
    Tension,
}

/// By how much the effects scale the noise of a cable's readings.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoiseGain {
    /// 1 where revolutions are counted: how evenly cable lies on a drum is in metres, whatever the drum's scale.
    pub length: f64,
    pub tension: f64,
}

impl NoiseGain {
    pub fn of(
        problem: &Problem<'_>,
        globals: &Globals,
        selection: Selection<'_>,
        index: usize,
    ) -> Self {
        let gain = |port| reading_gain(problem, globals, selection, (index, port), None).value;
        Self {
            length: if reads_lengths(problem) {
                gain(ReadPort::Paid).abs()
            } else {
                1.0
            },
            tension: gain(ReadPort::Tension).abs(),
        }
    }
}

/// Whether lengths of cables are read rather than revolutions of motors.
fn reads_lengths(problem: &Problem<'_>) -> bool {
    problem.dataset.measurements.revolutions.is_empty()
}

/// Values of all effects, with the `chosen` free parameter as the variable of differentiation.
fn seeded(problem: &Problem<'_>, globals: &Globals, chosen: Option<usize>) -> Vec<Vec<Dual>> {
    let mut number = 0;
    let held = problem.held_effects.len();
    let mut seed = |effect: usize, value: f64| {
        let is_chosen = effect >= held && chosen == Some(number);
        number += usize::from(effect >= held);
        if is_chosen {
            Dual::variable(value)
        } else {
            Dual::constant(value)
        }
    };
    globals
        .effects
        .iter()
        .enumerate()
        .map(|(k, bound)| bound.values.iter().map(|v| seed(k, *v)).collect())
        .collect()
}

impl<T: Packet> PortInputs<T> {
    /// Packs the ports of the selected rows.
    pub fn build(
        token: T::Token,
        problem: &Problem<'_>,
        globals: &Globals,
        selection: Selection<'_>,
    ) -> Self {
        let mut store = ColumnStore::new(token);
        let robot = &problem.dataset.robot;
        let mut cables = Vec::with_capacity(robot.cable_count());
        let mut cable_links = Vec::with_capacity(robot.cable_count());
        for index in 0..robot.cable_count() {
            let (columns, links) = pack_cable(&mut store, problem, globals, selection, index);
            cables.push(columns);
            cable_links.push(links);
        }
        let (platform, platform_links) = pack_platform(&mut store, problem, globals, selection);
        Self {
            store,
            cables,
            cable_links,
            platform,
            platform_links,
        }
    }
}

/// The free parameters by number, those that are given and not estimated left out, and the effect, by its number
/// in `Globals::effects`, to which each belongs.
fn owners(problem: &Problem<'_>) -> Vec<(usize, usize)> {
    if problem.geometry == Geometry::Held {
        return Vec::new();
    }
    let held = problem.held_effects.len();
    let owned = |(k, bound): (usize, &BoundEffect)| {
        let parameters = bound.effect.parameters().iter();
        parameters.map(move |parameter| (held + k, parameter.discrete))
    };
    let free = problem.free_effects.iter().enumerate();
    let numbered = free.flat_map(owned).enumerate();
    numbered
        .filter(|(_, (_, discrete))| !discrete)
        .map(|(parameter, (owner, _))| (parameter, owner))
        .collect()
}

/// The effects that satisfy a condition, in the order in which they act.
fn concerned(globals: &Globals, condition: impl Fn(&BoundEffect) -> bool) -> Vec<usize> {
    let mut found: Vec<usize> = (0..globals.effects.len())
        .filter(|k| condition(&globals.effects[*k]))
        .collect();
    found.sort_by_key(|k| globals.effects[*k].effect.stage());
    found
}

type PlatformScalars = [Dual; PlatformPort::COUNT];

/// Packs the ports of the platform; only what differs from pose to pose takes space per pose.
fn pack_platform<T: Packet>(
    store: &mut ColumnStore<T>,
    problem: &Problem<'_>,
    globals: &Globals,
    selection: Selection<'_>,
) -> ([Column; PlatformPort::COUNT], Vec<PlatformLink>) {
    let nominal = PlatformPorts::nominal(&problem.dataset.robot);
    let concerned = concerned(globals, BoundEffect::acts_on_platform);
    let mut links = Vec::new();
    let (false, Some(circumstances)) = (concerned.is_empty(), selection.circumstances) else {
        let scalars = nominal.scalars();
        let columns = std::array::from_fn(|port| store.uniform(scalars[port].value));
        return (columns, links);
    };
    let scalars = |chosen: Option<usize>| -> Vec<PlatformScalars> {
        let values = seeded(problem, globals, chosen);
        let at = |row: &usize| {
            let mut ports = nominal;
            for k in &concerned {
                let effect = globals.effects[*k].effect;
                effect.change_platform(&values[*k], circumstances.platform(*row), &mut ports);
            }
            ports.scalars()
        };
        selection.rows.iter().map(at).collect()
    };
    let plain = scalars(None);
    let columns = std::array::from_fn(|port| pack_scalars(store, &plain, None, |s| s[port].value));
    for (parameter, owner) in owners(problem) {
        if !concerned.contains(&owner) {
            continue;
        }
        let scalars = scalars(Some(parameter));
        for (position, port) in PlatformPort::ALL.iter().enumerate() {
            if scalars.iter().any(|s| s[position].slope != 0.0) {
                let slope = pack_scalars(store, &scalars, Some(0.0), |s| s[position].slope);
                links.push(PlatformLink {
                    port: *port,
                    parameter,
                    slope,
                });
            }
        }
    }
    (columns, links)
}

/// Packs the ports of one cable; only what differs from pose to pose takes space per pose.
fn pack_cable<T: Packet>(
    store: &mut ColumnStore<T>,
    problem: &Problem<'_>,
    globals: &Globals,
    selection: Selection<'_>,
    index: usize,
) -> ([Column; CablePort::COUNT], Vec<CableLink>) {
    let data = &problem.dataset.measurements;
    let cable = &problem.dataset.robot.cables[index];
    let concerned = concerned(globals, |bound| bound.cables.contains(&index));
    let scalars_at = |row: usize, values: &[Vec<Dual>]| {
        let mut ports = nominal_cable_ports(cable, data, (row, index), selection.is_home);
        if let Some(circumstances) = selection.circumstances {
            let at = circumstances.cable(row, index);
            for k in &concerned {
                let effect = globals.effects[*k].effect;
                effect.change_cable(&values[*k], at, &mut ports);
            }
        }
        // The error of the tension at home is a parameter of its own; like the errors at the other
        // poses it concerns the tension that the effects have made of the reading.
        if selection.is_home {
            ports.tension += Dual::constant(globals.home_tension_error_n[index]);
        }
        ports.scalars()
    };
    let plain = seeded(problem, globals, None);
    let scalars: Vec<_> = if concerned.is_empty() && !selection.is_home {
        let first = selection.rows.first().copied().into_iter();
        first.map(|row| scalars_at(row, &plain)).collect()
    } else {
        selection
            .rows
            .iter()
            .map(|row| scalars_at(*row, &plain))
            .collect()
    };
    let columns = if concerned.is_empty() && !selection.is_home {
        pack_plain(store, cable, data, selection, index, &scalars)
    } else {
        std::array::from_fn(|port| {
            pack_scalars(store, &scalars, padding_of(port), |s| s[port].value)
        })
    };
    let mut links = Vec::new();
    for (parameter, owner) in owners(problem) {
        if !concerned.contains(&owner) {
            continue;
        }
        let values = seeded(problem, globals, Some(parameter));
        let scalars: Vec<_> = selection
            .rows
            .iter()
            .map(|row| scalars_at(*row, &values))
            .collect();
        for (position, port) in CablePort::ALL.iter().enumerate() {
            // Nothing moves a reading that was not made.
            let slope_of = |s: &[Dual; CablePort::COUNT]| {
                let port = s[position];
                if port.value.is_nan() { 0.0 } else { port.slope }
            };
            if !scalars.iter().any(|s| slope_of(s) != 0.0) {
                continue;
            }
            let slope = pack_scalars(store, &scalars, Some(0.0), slope_of);
            let is_ratio = globals.effects[owner].effect.stage() == Stage::Ratio;
            let scales_noise = is_ratio && *port == CablePort::Paid && reads_lengths(problem);
            links.push(CableLink {
                port: *port,
                parameter,
                slope,
                is_proportional: is_ratio && *port == CablePort::Tension,
                relative_noise: if scales_noise {
                    let at = (index, ReadPort::Paid);
                    let gain = reading_gain(problem, globals, selection, at, Some(parameter));
                    gain.slope / gain.value
                } else {
                    0.0
                },
            });
        }
    }
    (columns, links)
}

/// Readings are missing in the lanes that fill up the last packet; all else repeats its last value.
fn padding_of(port: usize) -> Option<f64> {
    (port < 2).then_some(f64::NAN)
}

/// Without effects only the first two ports, paid and tension, differ from pose to pose.
fn pack_plain<T: Packet>(
    store: &mut ColumnStore<T>,
    cable: &Cable,
    data: &Measurements,
    selection: Selection<'_>,
    index: usize,
    first: &[[Dual; CablePort::COUNT]],
) -> [Column; CablePort::COUNT] {
    let rows = selection.rows.iter();
    let paid = rows
        .clone()
        .map(|row| nominal_paid(cable, data, (*row, index), false));
    let tension = rows.map(|row| nominal_tension(cable, data, (*row, index)));
    let paid = store.varying(paid, f64::NAN);
    let tension = store.varying(tension, f64::NAN);
    std::array::from_fn(|port| match port {
        0 => paid,
        1 => tension,
        _ => store.uniform(first.first().map_or(0.0, |scalars| scalars[port].value)),
    })
}

fn pack_scalars<T: Packet, const N: usize>(
    store: &mut ColumnStore<T>,
    scalars: &[[Dual; N]],
    padding: Option<f64>,
    pick: impl Fn(&[Dual; N]) -> f64,
) -> Column {
    let (Some(first), Some(last)) = (scalars.first().map(&pick), scalars.last().map(&pick)) else {
        return store.uniform(0.0);
    };
    if padding.is_some_and(f64::is_nan) || scalars.iter().any(|s| pick(s) != first) {
        store.varying(scalars.iter().map(pick), padding.unwrap_or(last))
    } else {
        store.uniform(first)
    }
}
