//! A connection whose symbols are known.

use std::sync::Arc;

use super::address::AdsAddress;
use super::check::{SymbolCheck, SymbolFound};
use super::layout::{Count, Layout, Slot, Wanted};
use super::line::{Line, Place, Trouble};
use super::options::AdsOptions;
use super::symbols::{Symbol, encode};
use crate::clock::Clock;
use crate::controller::LinkError;

/// Values that are written in one request, so that a controller's task is not held up.
const BATCH: usize = 64;
/// Most names in one message.
const NAMES: usize = 4;
/// More bytes than any symbol of ours has: a controller that says so is not to fill the memory.
const LARGEST: usize = 1 << 20;

/// Why something was not done.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Failure {
    /// The connection is of no more use.
    Lost(LinkError),
    /// The connection is well.
    Refused(LinkError),
}

impl Failure {
    fn of(trouble: Trouble, what: &str) -> Self {
        match trouble {
            Trouble::Lost(error) => Self::Lost(error),
            Trouble::Refused(code) => {
                Self::Refused(LinkError::Refused(format!("{what}: {}", code.explain())))
            }
        }
    }
}

/// The bytes of symbols that were read, by the symbols' indices.
pub(super) struct Raw<'l> {
    symbols: &'l [Symbol],
    bytes: Vec<Vec<u8>>,
}

impl Raw<'_> {
    /// A number; not a number where its symbol was not read.
    pub fn number(&self, slot: Slot) -> f64 {
        match (self.symbols.get(slot.symbol), self.bytes.get(slot.symbol)) {
            (Some(symbol), Some(bytes)) => symbol.number(bytes, slot.element),
            _ => f64::NAN,
        }
    }

    /// A text.
    pub fn text(&self, slot: Slot) -> String {
        let bytes = self.bytes.get(slot.symbol);
        Symbol::text(bytes.map_or(&[][..], Vec::as_slice))
    }
}

pub(super) struct Live {
    line: Line,
    symbols: Vec<Symbol>,
    /// What tells programs apart, where the controller says it.
    version: Option<u8>,
}

impl Live {
    /// Connects and looks all symbols up.
    pub fn connect(
        address: &AdsAddress,
        layout: &Layout,
        options: &AdsOptions,
        clock: Arc<dyn Clock>,
    ) -> Result<Self, LinkError> {
        let mut line = Line::open(address, options, clock)?;
        let at = format!("the program at {address}");
        let (running, state) = line.state().map_err(|trouble| opening(trouble, &at))?;
        if !running {
            return Err(LinkError::Refused(not_running(&state)));
        }
        let version = line.read(&[Place::VERSION]);
        let version = version.map_err(|trouble| opening(trouble, &at))?;
        let version = version.into_iter().next().and_then(Result::ok);
        Ok(Self {
            symbols: symbols(&line, &layout.wanted)?,
            version: version.and_then(|bytes| bytes.first().copied()),
            line,
        })
    }

    /// Whether the program runs, and what it does else.
    pub fn running(&self) -> Result<Option<String>, Failure> {
        let state = self.line.state();
        let (running, state) = state.map_err(|t| Failure::of(t, "the state of the program"))?;
        Ok((!running).then(|| not_running(&state)))
    }

    /// Reads symbols, all at the same moment where the controller can do that.
    pub fn read(&mut self, indices: impl Iterator<Item = usize>) -> Result<Raw<'_>, Failure> {
        let mut wanted: Vec<usize> = indices.collect();
        wanted.sort_unstable();
        wanted.dedup();
        wanted.retain(|index| *index < self.symbols.len());
        let version = self.version.map(|_| Place::VERSION);
        let places = wanted.iter().map(|index| whole(&self.symbols[*index]));
        let places: Vec<Place> = version.into_iter().chain(places).collect();
        let answers = self.line.read(&places);
        let answers = answers.map_err(|t| Failure::of(t, "reading symbols"))?;
        let mut answers = answers.into_iter();
        if let Some(known) = self.version {
            let now = answers.next();
            if now.is_some_and(|now| now.is_ok_and(|bytes| bytes != [known])) {
                return Err(changed());
            }
        }
        let mut bytes = vec![Vec::new(); self.symbols.len()];
        for (index, answer) in wanted.into_iter().zip(answers) {
            let name = &self.symbols[index].name;
            bytes[index] = answer.map_err(|code| Failure::of(Trouble::Refused(code), name))?;
        }
        Ok(Raw {
            symbols: &self.symbols,
            bytes,
        })
    }

    /// Writes numbers in their order, after making sure that the program is still the same.
    pub fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        if let Some(known) = self.version {
            let now = self.line.read(&[Place::VERSION]);
            let now = now.map_err(|t| Failure::of(t, "the version of the program"))?;
            if now.iter().flatten().any(|bytes| *bytes != [known]) {
                return Err(changed());
            }
        }
        for batch in values.chunks(BATCH) {
            self.write_at_once(batch)?;
        }
        Ok(())
    }

    /// Writes numbers directly after the program was heard of.
    pub fn write_at_once(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        let mut list = Vec::with_capacity(values.len());
        for (slot, value) in values {
            let symbol = self.symbols.get(slot.symbol);
            let told = symbol.and_then(|symbol| {
                let (offset, size) = symbol.place(slot.element)?;
                let group = symbol.group;
                Some((
                    Place {
                        group,
                        offset,
                        size,
                    },
                    encode(symbol.kind, *value)?,
                ))
            });
            let Some(told) = told else {
                let (name, kind) = symbol.map_or(("", ""), |s| (&s.name, &s.type_name));
                return Err(Failure::Refused(LinkError::Refused(format!(
                    "its symbol {name} of type {kind} cannot hold {value}"
                ))));
            };
            list.push(told);
        }
        self.line.write(&list).map_err(|(trouble, index)| {
            let symbol = values
                .get(index)
                .and_then(|(slot, _)| self.symbols.get(slot.symbol));
            Failure::of(trouble, symbol.map_or("writing", |symbol| &symbol.name))
        })
    }
}

fn whole(symbol: &Symbol) -> Place {
    Place {
        group: symbol.group,
        offset: symbol.offset,
        size: symbol.size,
    }
}

fn not_running(state: &str) -> String {
    format!("its program does not run, its state is {state:?}: start it")
}

fn changed() -> Failure {
    let text = "its program was changed meanwhile: connect again";
    Failure::Lost(LinkError::Disconnected(text.to_owned()))
}

fn opening(trouble: Trouble, what: &str) -> LinkError {
    match Failure::of(trouble, what) {
        Failure::Lost(error) | Failure::Refused(error) => error,
    }
}

/// Looks symbols up; all that are missing are told together.
fn symbols(line: &Line, wanted: &[Wanted]) -> Result<Vec<Symbol>, LinkError> {
    let mut found = Vec::with_capacity(wanted.len());
    let mut missing: Vec<String> = Vec::new();
    for want in wanted {
        match line.symbol(&want.name) {
            Ok(symbol) => {
                symbol.check(want.expected)?;
                check_count(&symbol, want.count)?;
                found.push(symbol);
            }
            Err(Trouble::Refused(code)) => {
                missing.push(format!("{}: {}", want.name, code.explain()));
            }
            Err(Trouble::Lost(error)) => return Err(error),
        }
    }
    if missing.is_empty() {
        return Ok(found);
    }
    let (all, more) = (missing.len(), missing.len().saturating_sub(NAMES));
    missing.truncate(NAMES);
    let more = match more {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Err(LinkError::Setup(format!(
        "the controller does not have {all} of the symbols that it should: {}{more}",
        missing.join(", ")
    )))
}

/// Connects and looks all symbols up, the wrong ones, too; nothing is written.
pub(super) fn look_up(
    address: &AdsAddress,
    layout: &Layout,
    options: &AdsOptions,
    clock: Arc<dyn Clock>,
) -> Result<Vec<SymbolCheck>, LinkError> {
    let line = Line::open(address, options, clock)?;
    let at = format!("the program at {address}");
    let (running, state) = line.state().map_err(|trouble| opening(trouble, &at))?;
    if !running {
        return Err(LinkError::Refused(not_running(&state)));
    }
    let mut checks = Vec::with_capacity(layout.wanted.len());
    for want in &layout.wanted {
        let found = match line.symbol(&want.name) {
            Ok(symbol) => {
                let wrong = match symbol.check(want.expected) {
                    Err(_) => Some(format!("expected {}", want.expected.describe())),
                    Ok(()) => check_count(&symbol, want.count)
                        .err()
                        .map(|e| e.to_string()),
                };
                let (type_name, bytes) = (symbol.type_name, symbol.size);
                match wrong {
                    None => SymbolFound::Good { type_name, bytes },
                    Some(why) => SymbolFound::Wrong {
                        type_name,
                        bytes,
                        why,
                    },
                }
            }
            Err(Trouble::Refused(code)) => SymbolFound::Missing(code.explain()),
            Err(Trouble::Lost(error)) => return Err(error),
        };
        checks.push(SymbolCheck {
            name: want.name.clone(),
            found,
        });
    }
    Ok(checks)
}

fn check_count(symbol: &Symbol, count: Count) -> Result<(), LinkError> {
    let has = symbol.count();
    let expected = match count {
        Count::Exactly(count) if has == count => return within(symbol),
        Count::AtLeast(count) if has >= count => return within(symbol),
        Count::Exactly(count) => count.to_string(),
        Count::AtLeast(count) => format!("at least {count}"),
    };
    Err(LinkError::Setup(format!(
        "the controller's symbol {} of type {} has {has} values, expected {expected}",
        symbol.name, symbol.type_name
    )))
}

fn within(symbol: &Symbol) -> Result<(), LinkError> {
    if symbol.size <= LARGEST {
        return Ok(());
    }
    Err(LinkError::Setup(format!(
        "the controller's symbol {} of type {} has {} bytes, at most {LARGEST} were expected",
        symbol.name, symbol.type_name, symbol.size
    )))
}
