//! Layout of the symbols of a mapping for one robot: which element of which symbol holds which quantity.

use tautline_core::effect;
use tautline_core::robot::Robot;
use tautline_session::{
    SymbolList, SymbolMapping, SymbolNames, SymbolParameter, SymbolPose, SymbolReadings,
    SymbolValue, is_per_cable, name_of_cable,
};

use super::access::{Count, Expected};
use crate::error::LinkError;
use crate::parameters::{EffectName, parameters_and_home_lengths};

/// A required symbol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RequiredSymbol {
    pub name: String,
    pub expected: Expected,
    /// Number of its elements.
    pub count: Count,
}

/// One number: an element of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Slot {
    /// Index of the symbol among the required symbols.
    pub symbol: usize,
    pub element: usize,
}

/// Numbers that are read as `raw * scale + offset`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Channel {
    pub slots: Vec<Slot>,
    pub scale: f64,
    pub offset: f64,
}

/// A pose and its representation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseSlots {
    pub slots: Vec<Slot>,
    pub written: SymbolPose,
}

/// Symbols of a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandSlots {
    pub target: PoseSlots,
    pub kind: Slot,
    pub number: Slot,
    pub acknowledged: Slot,
}

/// A parameter and its slot.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ParameterSlot {
    pub name: String,
    pub unit: &'static str,
    pub slot: Slot,
    pub scale: f64,
}

/// Readings of every sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ReadingSlots {
    pub revolutions: Channel,
    pub force: Option<Channel>,
    pub swivel: Option<Channel>,
    pub laser: Option<Channel>,
    pub laser_valid: Option<Slot>,
    pub temperature: Option<Channel>,
    pub time: Option<Channel>,
    pub inclination: Option<Channel>,
    pub pose: Option<PoseSlots>,
    /// Value that changes with every start of the controller.
    pub started: Option<Slot>,
}

/// Status of the controller, read with every sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StatusSlots {
    pub moving: Option<Slot>,
    pub fault: Option<Slot>,
    pub fault_text: Option<Slot>,
    pub acknowledged: Option<Slot>,
    /// Permission to move and write; written when armed.
    pub release: Option<Slot>,
    /// Counter of the program that is armed.
    pub watchdog: Option<Slot>,
}

impl StatusSlots {
    /// Indices of the status symbols.
    pub fn symbols(&self) -> impl Iterator<Item = usize> {
        let all = [
            self.moving,
            self.fault,
            self.fault_text,
            self.acknowledged,
            self.release,
            self.watchdog,
        ];
        all.into_iter().flatten().map(|slot| slot.symbol)
    }
}

/// All symbols that are read and written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub wanted: Vec<RequiredSymbol>,
    /// Number of symbols, starting from the first, with readings for display.
    pub shown: usize,
    /// Number of symbols, starting from the first, read with every sample.
    pub sampled: usize,
    pub readings: ReadingSlots,
    pub status: StatusSlots,
    pub command: Option<CommandSlots>,
    pub parameters: Vec<ParameterSlot>,
}

impl Layout {
    pub fn of(mapping: &SymbolMapping, robot: &Robot) -> Result<Self, LinkError> {
        let checked = mapping.check(robot);
        checked.map_err(|e| LinkError::Setup(format!("the symbols: {e}")))?;
        let mut symbols = Symbols(Vec::new());
        let mut readings = symbols.readings(&mapping.readings, robot);
        let shown = symbols.0.len();
        readings.started = symbols.optional(&mapping.state.started, Expected::Number);
        let status = symbols.status(mapping);
        let sampled = symbols.0.len();
        let command = mapping.command.as_ref().map(|command| CommandSlots {
            target: symbols.pose(&command.target),
            kind: symbols.single(&command.kind, Expected::Integer),
            number: symbols.single(&command.number, Expected::Counter),
            acknowledged: symbols.single(&command.acknowledged, Expected::Counter),
        });
        let parameters = symbols.parameters(&mapping.parameters, robot)?;
        Ok(Self {
            wanted: symbols.0,
            shown,
            sampled,
            readings,
            status,
            command,
            parameters,
        })
    }
}

/// Collects the symbols.
struct Symbols(Vec<RequiredSymbol>);

impl Symbols {
    /// Index of a required symbol, which is included once however often it is named.
    fn want(&mut self, name: &str, expected: Expected, count: Count) -> usize {
        let known =
            |w: &RequiredSymbol| w.name == name && w.expected == expected && w.count == count;
        self.0.iter().position(known).unwrap_or_else(|| {
            self.0.push(RequiredSymbol {
                name: name.to_owned(),
                expected,
                count,
            });
            self.0.len() - 1
        })
    }

    fn single(&mut self, name: &str, expected: Expected) -> Slot {
        Slot {
            symbol: self.want(name, expected, Count::Exactly(1)),
            element: 0,
        }
    }

    fn optional(&mut self, name: &Option<String>, expected: Expected) -> Option<Slot> {
        name.as_ref().map(|name| self.single(name, expected))
    }

    fn readings(&mut self, readings: &SymbolReadings, robot: &Robot) -> ReadingSlots {
        let mut cables = |symbols: &SymbolList| self.per_cable(symbols, robot);
        let revolutions = cables(&readings.revolutions);
        let force = readings.force.as_ref().map(&mut cables);
        let swivel = readings.swivel.as_ref().map(&mut cables);
        let mut number = |symbol: &SymbolValue| self.number(symbol);
        ReadingSlots {
            revolutions,
            force,
            swivel,
            laser: readings.laser.as_ref().map(&mut number),
            temperature: readings.temperature.as_ref().map(&mut number),
            time: readings.time.as_ref().map(&mut number),
            laser_valid: self.optional(&readings.laser_valid, Expected::Flag),
            inclination: readings.inclination.as_ref().map(|symbols| Channel {
                slots: self.listed(&symbols.symbol, 3),
                scale: symbols.scale,
                offset: symbols.offset,
            }),
            pose: readings.pose.as_ref().map(|pose| self.pose(pose)),
            started: None,
        }
    }

    fn status(&mut self, mapping: &SymbolMapping) -> StatusSlots {
        let command = mapping.command.as_ref();
        StatusSlots {
            moving: self.optional(&mapping.state.moving, Expected::Flag),
            fault: self.optional(&mapping.state.fault, Expected::Code),
            fault_text: self.optional(&mapping.state.fault_text, Expected::Text),
            acknowledged: command.map(|c| self.single(&c.acknowledged, Expected::Counter)),
            release: self.optional(&mapping.release, Expected::Flag),
            watchdog: self.optional(&mapping.watchdog, Expected::Counter),
        }
    }

    /// `count` numbers: an array of exactly that length, or one symbol each.
    fn listed(&mut self, names: &SymbolNames, count: usize) -> Vec<Slot> {
        match names {
            SymbolNames::One(name) => {
                let symbol = self.want(name, Expected::Number, Count::Exactly(count));
                (0..count).map(|element| Slot { symbol, element }).collect()
            }
            SymbolNames::Each(names) => names
                .iter()
                .map(|name| self.single(name, Expected::Number))
                .collect(),
        }
    }

    fn per_cable(&mut self, symbols: &SymbolList, robot: &Robot) -> Channel {
        let slots = match &symbols.symbol {
            SymbolNames::One(pattern) if is_per_cable(pattern) => {
                let cables = robot.cables.iter().enumerate();
                cables
                    .map(|(k, cable)| {
                        let name = name_of_cable(pattern, &cable.name, k);
                        self.single(&name, Expected::Number)
                    })
                    .collect()
            }
            names => self.listed(names, robot.cable_count()),
        };
        Channel {
            slots,
            scale: symbols.scale,
            offset: symbols.offset,
        }
    }

    fn number(&mut self, symbol: &SymbolValue) -> Channel {
        Channel {
            slots: vec![self.single(&symbol.symbol, Expected::Number)],
            scale: symbol.scale,
            offset: symbol.offset,
        }
    }

    fn pose(&mut self, pose: &SymbolPose) -> PoseSlots {
        PoseSlots {
            slots: self.listed(&pose.symbol, pose.rotation.pose_values()),
            written: pose.clone(),
        }
    }

    fn parameters(
        &mut self,
        list: &[SymbolParameter],
        robot: &Robot,
    ) -> Result<Vec<ParameterSlot>, LinkError> {
        let known = parameters_and_home_lengths(robot);
        let mut slots = Vec::new();
        for parameter in list {
            let each = is_per_cable(&parameter.name);
            let cables = if each { robot.cable_count() } else { 1 };
            let mut found = 0;
            for (k, cable) in robot.cables.iter().enumerate().take(cables) {
                let name = match each {
                    true => name_of_cable(&parameter.name, &cable.name, k),
                    false => parameter.name.clone(),
                };
                let listed = known.iter().find(|p| p.name == name).map(|p| p.unit);
                // A correction for only some cables is not an error.
                let Some(unit) = listed.or_else(|| unit_of_effect(&name)) else {
                    continue;
                };
                found += 1;
                let slot = self.parameter(parameter, &cable.name, k);
                let scale = parameter.scale;
                slots.push(ParameterSlot {
                    name,
                    unit,
                    slot,
                    scale,
                });
            }
            if found == 0 {
                return Err(LinkError::UnknownParameter(parameter.name.clone()));
            }
        }
        Ok(slots)
    }

    fn parameter(&mut self, parameter: &SymbolParameter, cable: &str, k: usize) -> Slot {
        let size = |number: u32| usize::try_from(number).unwrap_or(usize::MAX);
        let symbol = name_of_cable(&parameter.symbol, cable, k);
        let element = match is_per_cable(&parameter.symbol) {
            true => size(parameter.element),
            false => {
                size(parameter.element).saturating_add(k.saturating_mul(size(parameter.stride)))
            }
        };
        // One entry for all elements of an array, so that it is read once.
        let least = element.saturating_add(1);
        let same = |w: &RequiredSymbol| w.name == symbol && matches!(w.count, Count::AtLeast(_));
        let known = self.0.iter().position(same);
        let index =
            known.unwrap_or_else(|| self.want(&symbol, Expected::Number, Count::AtLeast(least)));
        if let Some(RequiredSymbol {
            count: Count::AtLeast(count),
            ..
        }) = self.0.get_mut(index)
        {
            *count = (*count).max(least);
        }
        Slot {
            symbol: index,
            element,
        }
    }
}

/// Unit of the parameter of an effect that this robot does not have, but could have.
fn unit_of_effect(name: &str) -> Option<&'static str> {
    let read = EffectName::read(name)?;
    let effect = effect::find(read.effect)?;
    let mut parameters = effect.parameters().iter();
    let found = parameters.find(|parameter| parameter.name == read.parameter)?;
    Some(found.unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::parameters_of;
    use crate::testing::preset;

    #[test]
    fn the_default_reads_few_symbols_and_knows_all_parameters() {
        let robot = preset("mini").robot;
        let layout = Layout::of(&SymbolMapping::default_for(&robot), &robot).unwrap();
        let names: Vec<_> = layout.parameters.iter().map(|p| &p.name).collect();
        let known = parameters_of(&robot);
        assert_eq!(names.len(), known.len());
        assert!(known.iter().all(|p| names.contains(&&p.name)));
        assert_eq!(layout.wanted.len() - layout.sampled, 3 + 6);
        let last = layout
            .parameters
            .iter()
            .find(|p| p.name == "cable-8.entry_point.z_m");
        assert_eq!(last.map(|p| p.slot.element), Some(23));
        let points = layout
            .wanted
            .iter()
            .find(|w| w.name.ends_with("entry_point"));
        assert_eq!(points.map(|w| w.count), Some(Count::AtLeast(24)));
    }

    #[test]
    fn one_symbol_per_cable_and_value() {
        let robot = preset("mini").robot;
        let mut mapping = SymbolMapping::default_for(&robot);
        mapping.readings.revolutions.symbol = SymbolNames::One("W[{n}].turns".into());
        mapping.parameters = vec![SymbolParameter {
            name: "{cable}.pulley.radius_m".into(),
            symbol: "W[{n}].radius".into(),
            element: 0,
            stride: 1,
            scale: 1e-3,
        }];
        let layout = Layout::of(&mapping, &robot).unwrap();
        let third = layout.readings.revolutions.slots[2];
        assert_eq!(layout.wanted[third.symbol].name, "W[3].turns");
        let radius = &layout.parameters[7];
        assert_eq!(layout.wanted[radius.slot.symbol].name, "W[8].radius");
        assert_eq!(radius.slot.element, 0);
    }

    #[test]
    fn parameters_that_do_not_exist_are_refused() {
        let robot = preset("mini").robot;
        let mut mapping = SymbolMapping::default_for(&robot);
        mapping.parameters[0].name = "{cable}.entry_point.w_m".into();
        let refused = Layout::of(&mapping, &robot).unwrap_err();
        assert_eq!(
            refused,
            LinkError::UnknownParameter("{cable}.entry_point.w_m".into())
        );
        mapping.parameters[0].name = "effect.winch_scale.{cable}.scale".into();
        let layout = Layout::of(&mapping, &robot).unwrap();
        assert_eq!(
            layout.parameters[0].name,
            "effect.winch_scale.cable-1.scale"
        );
    }
}
