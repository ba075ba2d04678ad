//! Packs the inputs that the equations of many poses need.

use std::sync::Arc;

use super::columns::{ColumnStore, StoredColumn};
use super::effects_on_ports::{EffectsOnPorts, Ports, Variable};
use super::layout::Layout;
use super::motion::MotionColumns;
use crate::effect::{
    BetterKnown, BoundEffect, CablePort, CablePorts, Dual, PlatformPort, PlatformPorts,
    PoseContexts, Stage,
};
use crate::estimation::globals::Globals;
use crate::estimation::problem::Problem;
use crate::geometry::Pose;
use crate::measurement::Measurements;
use crate::real::Packet;
use crate::robot::Cable;

/// Slope with which a free parameter acts on a port.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link<Port> {
    pub port: Port,
    /// Column of effects of the parameter.
    pub parameter: usize,
    /// Index of that column among those of the owner of the port, a cable or the platform.
    pub own: usize,
    pub slope: StoredColumn,
    /// Whether the slope is proportional to the port, so that it is evaluated at the estimate of the port rather than at its
    /// reading: noise common to both would bias the parameter.
    pub is_proportional: bool,
    /// Relative change of the noise of a length per unit of the parameter, if the parameter scales the reading.
    pub relative_noise: f64,
}

/// Ports of all poses, and the action of the free effects on them.
#[derive(Clone)]
pub(super) struct PortInputs<T: Packet> {
    pub store: ColumnStore<T>,
    pub cables: Vec<CableColumns>,
    pub platform: PlatformPorts<StoredColumn>,
    pub platform_links: Vec<Link<PlatformPort>>,
    /// Motion of the platform; `None` at rest.
    pub motion: Option<MotionColumns>,
}

/// Ports of one cable, and the action of the free effects on them.
#[derive(Clone)]
pub(super) struct CableColumns {
    pub ports: CablePorts<StoredColumn>,
    pub links: Vec<Link<CablePort>>,
}

/// The rows that are packed, and whether they are the home row.
#[derive(Debug, Clone)]
pub(super) struct Selection {
    pub rows: Vec<usize>,
    pub is_home: bool,
    /// Contexts of the readings; present if there are effects or motion.
    pub contexts: Option<Arc<PoseContexts>>,
    /// The row at which the effects' scaling of the noise is evaluated, the same for all parts of a problem.
    pub noise_row: Option<usize>,
}

/// Contexts for a problem: those it carries, else at the commanded poses, else at the tracker's, else
/// at the home pose; `None` without effects at rest.
pub(super) fn contexts_of(problem: &Problem<'_>) -> Option<Arc<PoseContexts>> {
    if !problem.depends_on_poses() {
        return None;
    }
    if let Some(known) = &problem.contexts {
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
    Some(Arc::new(PoseContexts::new(
        &problem.dataset.robot,
        data,
        problem.home_row(),
        &poses,
        BetterKnown::default(),
    )))
}

fn nominal_home(problem: &Problem<'_>) -> Pose {
    let home = problem.dataset.robot.home;
    home.map_or_else(Pose::identity, |home| home.pose())
}

/// Length paid out since home according to the reading, or the absolute length read (m).
fn nominal_paid(cable: &Cable, data: &Measurements, at: (usize, usize), is_home: bool) -> f64 {
    if is_home {
        0.0
    } else if data.revolutions.is_empty() {
        data.length_m.get(at.0, at.1)
    } else {
        cable.winch.cable_per_revolution_m() * data.revolutions.get(at.0, at.1)
    }
}

/// Tension of a `(row, cable)` as read or as assumed (N); 0 if tensions are not modelled, NaN where it was not read.
fn nominal_tension(problem: &Problem<'_>, selection: &Selection, at: (usize, usize)) -> f64 {
    let data = &problem.dataset.measurements;
    let sensor = problem.dataset.robot.cables[at.1].force_sensor;
    match (&selection.contexts, sensor) {
        (Some(contexts), _) if problem.assumes_tensions() => contexts.cable(at.0, at.1).tension_n,
        (_, Some(sensor)) if !data.force_n.is_empty() => {
            sensor.tension_n(data.force_n.get(at.0, at.1))
        }
        _ => 0.0,
    }
}

/// Ports of a cable at a `(row, cable)` before any effect.
fn nominal_cable_ports(
    problem: &Problem<'_>,
    selection: &Selection,
    at: (usize, usize),
) -> CablePorts {
    let cable = &problem.dataset.robot.cables[at.1];
    let data = &problem.dataset.measurements;
    let paid = nominal_paid(cable, data, at, selection.is_home);
    let tension = nominal_tension(problem, selection, at);
    CablePorts::nominal(cable, paid, tension)
}

/// Derivative of a port with respect to the reading behind it, at one row; its slope is that by the `chosen` parameter. Every
/// effect that acts on a reading scales it or adds to it. A factor on a reading applies to its noise, too: otherwise, shrinking
/// the readings would seem to improve the fit.
fn reading_gain(
    problem: &Problem<'_>,
    globals: &Globals,
    selection: &Selection,
    (index, port): (usize, CablePort),
    chosen: Option<EstimatedParameter>,
) -> Dual {
    let concerned = concerned(globals, |bound| bound.cables.contains(&index));
    let (Some(contexts), Some(row)) = (&selection.contexts, selection.noise_row) else {
        return Dual::constant(1.0);
    };
    let cable = &problem.dataset.robot.cables[index];
    let values = seeded(&concerned, chosen);
    let port_at = |reading: f64| {
        let mut ports = CablePorts::nominal(cable, reading, reading);
        for ((_, bound), values) in concerned.iter().zip(&values) {
            bound.change_cable(values, contexts.at_row(row), index, &mut ports);
        }
        ports.get(port)
    };
    // Effects of the catalogue are affine in the reading; a formula of the user may have no value at 0.
    let at = contexts.cable(row, index);
    let has_formulas = concerned
        .iter()
        .any(|(_, bound)| bound.effect.is_hypothesis());
    let from = match port {
        _ if !has_formulas => 0.0,
        CablePort::Tension => at.tension_n,
        _ => at.paid_m,
    };
    port_at(from + 1.0) - port_at(from)
}

/// Factors by which the effects scale the noise of a cable's readings.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoiseGain {
    /// 1 where revolutions are counted: the irregularity of winding is in metres, whatever the scale of the drum.
    pub length: f64,
    pub tension: f64,
}

impl NoiseGain {
    pub fn of(
        problem: &Problem<'_>,
        globals: &Globals,
        selection: &Selection,
        index: usize,
    ) -> Self {
        let gain = |port| reading_gain(problem, globals, selection, (index, port), None).value;
        Self {
            length: if reads_lengths(problem) {
                gain(CablePort::Paid).abs()
            } else {
                1.0
            },
            tension: gain(CablePort::Tension).abs(),
        }
    }
}

/// Whether cable lengths are read directly rather than motor revolutions.
fn reads_lengths(problem: &Problem<'_>) -> bool {
    problem.dataset.measurements.revolutions.is_empty()
}

/// An effect with its index in [`Globals::acting`].
type Acting<'g> = (usize, &'g BoundEffect);

/// An estimated parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct EstimatedParameter {
    /// Its column of effects.
    column: usize,
    /// Index of that column among those of the cable or of the platform.
    own: usize,
    /// Index of the effect in [`Globals::acting`], and of the parameter there.
    owner: usize,
    parameter: usize,
}

/// Values of some effects, with the `chosen` parameter as the variable of differentiation.
fn seeded(effects: &[Acting<'_>], chosen: Option<EstimatedParameter>) -> Vec<Vec<Dual>> {
    let of = |(index, bound): &Acting<'_>| {
        let own = chosen.filter(|chosen| chosen.owner == *index);
        let seed = |(k, value): (usize, &f64)| match own {
            Some(chosen) if chosen.parameter == k => Dual::variable(*value),
            _ => Dual::constant(*value),
        };
        bound.values.iter().enumerate().map(seed).collect()
    };
    effects.iter().map(of).collect()
}

impl<T: Packet> PortInputs<T> {
    /// Packs the ports of the selected rows.
    pub fn build(
        token: T::Token,
        problem: &Problem<'_>,
        globals: &Globals,
        selection: &Selection,
        layout: &Layout,
    ) -> Self {
        let mut store = ColumnStore::new(token);
        let from = Source {
            problem,
            globals,
            selection,
            layout,
        };
        let cables = (0..layout.cables).map(|index| pack_cable(&mut store, from, index));
        let cables = cables.collect();
        let (platform, platform_links) = pack_platform(&mut store, from);
        let motion = MotionColumns::pack(&mut store, problem, selection);
        Self {
            motion,
            store,
            cables,
            platform,
            platform_links,
        }
    }
}

/// Inputs from which the ports are packed.
#[derive(Clone, Copy)]
struct Source<'s> {
    problem: &'s Problem<'s>,
    globals: &'s Globals,
    selection: &'s Selection,
    layout: &'s Layout,
}

impl Source<'_> {
    /// The estimated parameters of these columns of effects.
    fn estimated_parameters(&self, columns: &[usize]) -> Vec<EstimatedParameter> {
        let problem = self.problem;
        let free = problem.free_effects.len();
        let parameter = |(own, column): (usize, &usize)| {
            let (effect, parameter) = self.layout.effect_parameters[*column];
            // Held deviations act before the estimated ones.
            let held_deviations = if effect < free {
                0
            } else {
                problem.held_deviations.len()
            };
            EstimatedParameter {
                column: *column,
                own,
                owner: problem.held_effects.len() + held_deviations + effect,
                parameter,
            }
        };
        columns.iter().enumerate().map(parameter).collect()
    }
}

/// The effects that satisfy a condition, in the order in which they act.
fn concerned(globals: &Globals, condition: impl Fn(&BoundEffect) -> bool) -> Vec<Acting<'_>> {
    let acting = globals.acting().enumerate();
    let mut found: Vec<_> = acting.filter(|(_, bound)| condition(bound)).collect();
    found.sort_by_key(|(_, bound)| bound.effect.stage);
    found
}

/// Slopes of one port by one parameter, at every row.
struct PortSlopes<Port> {
    port: Port,
    slopes: Vec<f64>,
}

/// Ports at every row with their slopes.
struct PortsWithSlopes<P: Ports> {
    ports: Vec<P>,
    /// Of the ports that depend on each estimated parameter.
    slopes: Vec<Vec<PortSlopes<P::Port>>>,
}

/// Applies effects to the ports of every row.
fn ports_and_slopes<P: Ports>(
    rows: &[usize],
    effects: &[Acting<'_>],
    parameters: &[EstimatedParameter],
    nominal: impl Fn(usize) -> P,
    change: impl Fn(&BoundEffect, &[Dual], usize, &mut P),
) -> PortsWithSlopes<P> {
    let constant = seeded(effects, None);
    let variable = |chosen: &EstimatedParameter| {
        let position = effects.iter().position(|(index, _)| *index == chosen.owner);
        position.map(|effect| Variable {
            effect,
            values: seeded(&effects[effect..=effect], Some(*chosen)).remove(0),
        })
    };
    let variables: Vec<Variable> = parameters.iter().filter_map(variable).collect();
    let mut slopes: Vec<Vec<PortSlopes<P::Port>>> = variables.iter().map(|_| vec![]).collect();
    let mut state = EffectsOnPorts::with_capacity(effects.len());
    let mut ports = Vec::with_capacity(rows.len());
    for (at, row) in rows.iter().copied().enumerate() {
        let act = |effect: usize, values: Option<&[Dual]>, ports: &mut P| {
            let values = values.unwrap_or(&constant[effect]);
            change(effects[effect].1, values, row, ports);
        };
        let apply = |effect: usize, ports: &mut P| act(effect, None, ports);
        ports.push(state.apply(nominal(row), effects.len(), apply));
        for (variable, slopes) in variables.iter().zip(&mut slopes) {
            state.slopes(variable, act, |port, slope| {
                let known = slopes.iter().position(|of| of.port == port);
                let index = known.unwrap_or_else(|| {
                    slopes.push(PortSlopes {
                        port,
                        slopes: vec![0.0; rows.len()],
                    });
                    slopes.len() - 1
                });
                slopes[index].slopes[at] = slope;
            });
        }
    }
    PortsWithSlopes { ports, slopes }
}

/// Packs the ports of the platform; only ports that vary take space per pose.
fn pack_platform<T: Packet>(
    store: &mut ColumnStore<T>,
    from: Source<'_>,
) -> (PlatformPorts<StoredColumn>, Vec<Link<PlatformPort>>) {
    let nominal = PlatformPorts::nominal(&from.problem.dataset.robot);
    let concerned = concerned(from.globals, BoundEffect::acts_on_platform);
    let mut links = Vec::new();
    let (false, Some(contexts)) = (concerned.is_empty(), &from.selection.contexts) else {
        let columns = PlatformPorts::from_fn(|port| store.uniform(nominal.get(port).value));
        return (columns, links);
    };
    let parameters = from.estimated_parameters(from.layout.effects_of_platform());
    let PortsWithSlopes { ports, slopes } = ports_and_slopes(
        &from.selection.rows,
        &concerned,
        &parameters,
        |_| nominal,
        |bound, values, row, ports| {
            bound.change_platform(values, contexts.at_row(row), ports);
        },
    );
    let columns = PlatformPorts::from_fn(|port| pack(store, &ports, None, |p| p.get(port).value));
    for (chosen, slopes) in parameters.iter().zip(&slopes) {
        links.extend(slopes.iter().map(|of| Link {
            port: of.port,
            parameter: chosen.column,
            own: chosen.own,
            slope: pack(store, &of.slopes, Some(0.0), |slope| *slope),
            is_proportional: false,
            relative_noise: 0.0,
        }));
    }
    (columns, links)
}

/// Packs the ports of one cable; only ports that vary take space per pose.
fn pack_cable<T: Packet>(
    store: &mut ColumnStore<T>,
    from: Source<'_>,
    index: usize,
) -> CableColumns {
    let concerned = concerned(from.globals, |bound| bound.cables.contains(&index));
    let (false, Some(contexts)) = (concerned.is_empty(), &from.selection.contexts) else {
        return CableColumns {
            ports: pack_without_effects(store, from, index),
            links: Vec::new(),
        };
    };
    let parameters = from.estimated_parameters(from.layout.effects_of_cable(index));
    let PortsWithSlopes { mut ports, slopes } = ports_and_slopes(
        &from.selection.rows,
        &concerned,
        &parameters,
        |row| nominal_cable_ports(from.problem, from.selection, (row, index)),
        |bound, values, row, ports| {
            bound.change_cable(values, contexts.at_row(row), index, ports);
        },
    );
    for ports in &mut ports {
        ports.tension.value += home_error(from.globals, from.selection, index);
    }
    let columns =
        CablePorts::from_fn(|port| pack(store, &ports, padding_of(port), |p| p.get(port).value));
    let mut links = Vec::new();
    for (chosen, slopes) in parameters.iter().zip(&slopes) {
        let stage = concerned.iter().find(|(index, _)| *index == chosen.owner);
        let is_ratio = stage.is_some_and(|(_, bound)| bound.effect.stage == Stage::Ratio);
        for of in slopes {
            let scales_noise =
                is_ratio && of.port == CablePort::Paid && reads_lengths(from.problem);
            links.push(Link {
                port: of.port,
                parameter: chosen.column,
                own: chosen.own,
                slope: pack(store, &of.slopes, Some(0.0), |slope| *slope),
                is_proportional: is_ratio && of.port == CablePort::Tension,
                relative_noise: if scales_noise {
                    let at = (index, of.port);
                    let gain = reading_gain(
                        from.problem,
                        from.globals,
                        from.selection,
                        at,
                        Some(*chosen),
                    );
                    gain.slope / gain.value
                } else {
                    0.0
                },
            });
        }
    }
    CableColumns {
        ports: columns,
        links,
    }
}

/// Error of the tension reading of a cable (N) at home, where it is a parameter of its own; like the errors at the other
/// poses it refers to the tension after the effects have corrected the reading.
fn home_error(globals: &Globals, selection: &Selection, index: usize) -> f64 {
    if selection.is_home {
        globals.home_tension_error_n[index]
    } else {
        0.0
    }
}

/// Padding of the last packet: readings are missing there, everything else repeats its last value.
fn padding_of(port: CablePort) -> Option<f64> {
    matches!(port, CablePort::Paid | CablePort::Tension).then_some(f64::NAN)
}

/// Without effects only the readings (length paid out and tension) vary from pose to pose.
fn pack_without_effects<T: Packet>(
    store: &mut ColumnStore<T>,
    from: Source<'_>,
    index: usize,
) -> CablePorts<StoredColumn> {
    let Source {
        problem, selection, ..
    } = from;
    let data = &problem.dataset.measurements;
    let cable = &problem.dataset.robot.cables[index];
    let nominal = CablePorts::nominal(cable, 0.0, 0.0);
    let rows = selection.rows.iter();
    let home_error = home_error(from.globals, selection, index);
    CablePorts::from_fn(|port| match port {
        CablePort::Paid => {
            let paid = |row: &usize| nominal_paid(cable, data, (*row, index), selection.is_home);
            store.varying(rows.clone().map(paid), f64::NAN)
        }
        CablePort::Tension => {
            let read = |row: &usize| nominal_tension(problem, selection, (*row, index));
            let tension = rows.clone().map(|row| read(row) + home_error);
            store.varying(tension, f64::NAN)
        }
        _ => store.uniform(nominal.get(port).value),
    })
}

fn pack<T: Packet, P>(
    store: &mut ColumnStore<T>,
    ports: &[P],
    padding: Option<f64>,
    pick: impl Fn(&P) -> f64,
) -> StoredColumn {
    let (Some(first), Some(last)) = (ports.first().map(&pick), ports.last().map(&pick)) else {
        return store.uniform(0.0);
    };
    if padding.is_some_and(f64::is_nan) || ports.iter().any(|p| pick(p) != first) {
        store.varying(ports.iter().map(pick), padding.unwrap_or(last))
    } else {
        store.uniform(first)
    }
}
