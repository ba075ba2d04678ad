//! A connection to a running program whose symbols are known.

use tautline_core::robot::Robot;
use tautline_session::AdsMapping;

use super::address::AdsAddress;
use super::client::{AdsClient, RequestError};
use super::codes::AdsCode;
use super::layout::{Layout, Slot, Wanted};
use super::options::AdsOptions;
use super::symbols::{Place, Symbol, SymbolCheck, SymbolFound, encode};
use crate::error::LinkError;

/// Values that are written in one request, so that a controller's task is not held up.
const BATCH: usize = 64;
/// Most names in one message.
const NAMES: usize = 4;

/// Why a request to a program failed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Failure {
    /// The connection cannot be used any more.
    Lost(LinkError),
    /// The connection is still good.
    Refused(LinkError),
}

impl Failure {
    fn of(error: RequestError, what: &str) -> Self {
        match error {
            RequestError::Lost(error) => Self::Lost(error),
            RequestError::Refused(code) => Self::of_code(code, what),
        }
    }

    fn of_code(code: AdsCode, what: &str) -> Self {
        Self::Refused(LinkError::Refused(format!("{what}: {}", code.explain())))
    }

    fn into_error(self) -> LinkError {
        match self {
            Self::Lost(error) | Self::Refused(error) => error,
        }
    }
}

/// The bytes of symbols that were read, by the symbols' indices.
pub(super) struct SymbolValues<'l> {
    symbols: &'l [Symbol],
    bytes: Vec<Vec<u8>>,
}

impl SymbolValues<'_> {
    /// A number; NaN where its symbol was not read.
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

/// A program of a controller.
pub(super) struct Program {
    client: AdsClient,
    symbols: Vec<Symbol>,
    /// Number that changes with the program, where the controller has one.
    version: Option<u8>,
}

impl Program {
    /// Connects and looks all symbols up.
    pub fn connect(
        address: &AdsAddress,
        layout: &Layout,
        options: &AdsOptions,
    ) -> Result<Self, LinkError> {
        let mut client = open(address, options)?;
        let version = client.read(&[Place::VERSION]).map_err(|error| {
            Failure::of(error, &format!("the program at {address}")).into_error()
        })?;
        let version = version.into_iter().next().and_then(Result::ok);
        Ok(Self {
            symbols: usable_symbols(&mut client, &layout.wanted)?,
            version: version.and_then(|bytes| bytes.first().copied()),
            client,
        })
    }

    /// Why the program does not run, if it does not.
    pub fn problem(&mut self) -> Result<Option<String>, Failure> {
        let state = self.client.state();
        let (running, state) = state.map_err(|e| Failure::of(e, "the state of the program"))?;
        Ok((!running).then(|| not_running(&state)))
    }

    /// Reads symbols, all at the same moment where the controller can do that.
    pub fn read(
        &mut self,
        indices: impl Iterator<Item = usize>,
    ) -> Result<SymbolValues<'_>, Failure> {
        let mut wanted: Vec<usize> = indices.collect();
        wanted.sort_unstable();
        wanted.dedup();
        wanted.retain(|index| *index < self.symbols.len());
        let version = self.version.map(|_| Place::VERSION);
        let places = wanted.iter().map(|index| self.symbols[*index].place());
        let places: Vec<Place> = version.into_iter().chain(places).collect();
        let answers = self.client.read(&places);
        let answers = answers.map_err(|e| Failure::of(e, "reading symbols"))?;
        let mut answers = answers.into_iter();
        if let Some(known) = self.version {
            let now = answers.next();
            if now.is_some_and(|now| now.is_ok_and(|bytes| bytes != [known])) {
                return Err(program_changed());
            }
        }
        let mut bytes = vec![Vec::new(); self.symbols.len()];
        for (index, answer) in wanted.into_iter().zip(answers) {
            let name = &self.symbols[index].name;
            bytes[index] = answer.map_err(|code| Failure::of_code(code, name))?;
        }
        Ok(SymbolValues {
            symbols: &self.symbols,
            bytes,
        })
    }

    /// Writes numbers in their order, after a check that the program is still the same.
    pub fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        if let Some(known) = self.version {
            let now = self.client.read(&[Place::VERSION]);
            let now = now.map_err(|e| Failure::of(e, "the version of the program"))?;
            if now.iter().flatten().any(|bytes| *bytes != [known]) {
                return Err(program_changed());
            }
        }
        for batch in values.chunks(BATCH) {
            self.write_at_once(batch)?;
        }
        Ok(())
    }

    /// Writes numbers without that check, directly after the program was read from.
    pub fn write_at_once(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        let mut list = Vec::with_capacity(values.len());
        for (slot, value) in values {
            let symbol = self.symbols.get(slot.symbol);
            let written = symbol.and_then(|symbol| {
                Some((
                    symbol.element_place(slot.element)?,
                    encode(symbol.kind, *value)?,
                ))
            });
            let Some(written) = written else {
                let (name, kind) = symbol.map_or(("", ""), |s| (&s.name, &s.type_name));
                return Err(Failure::Refused(LinkError::Refused(format!(
                    "its symbol {name} of type {kind} cannot hold {value}"
                ))));
            };
            list.push(written);
        }
        self.client.write(&list).map_err(|(error, index)| {
            let symbol = values
                .get(index)
                .and_then(|(slot, _)| self.symbols.get(slot.symbol));
            Failure::of(error, symbol.map_or("writing", |symbol| &symbol.name))
        })
    }
}

fn not_running(state: &str) -> String {
    format!("its program does not run, its state is {state:?}: start it")
}

fn program_changed() -> Failure {
    let text = "its program was changed in the meantime: connect again";
    Failure::Lost(LinkError::Disconnected(text.to_owned()))
}

/// Connects to a program that runs.
fn open(address: &AdsAddress, options: &AdsOptions) -> Result<AdsClient, LinkError> {
    let mut client = AdsClient::open(address, options)?;
    let (running, state) = client
        .state()
        .map_err(|error| Failure::of(error, &format!("the program at {address}")).into_error())?;
    match running {
        true => Ok(client),
        false => Err(LinkError::Refused(not_running(&state))),
    }
}

/// Looks a symbol up: what the controller says about it, and the symbol if it can be used.
fn look_up(
    client: &mut AdsClient,
    wanted: &Wanted,
) -> Result<(SymbolFound, Option<Symbol>), LinkError> {
    let symbol = match client.symbol(&wanted.name) {
        Ok(symbol) => symbol,
        Err(RequestError::Refused(code)) => {
            return Ok((SymbolFound::Missing(code.explain()), None));
        }
        Err(RequestError::Lost(error)) => return Err(error),
    };
    let (type_name, bytes) = (symbol.type_name.clone(), symbol.size);
    Ok(match wanted.problem(&symbol) {
        None => (SymbolFound::Good { type_name, bytes }, Some(symbol)),
        Some(why) => {
            let wrong = SymbolFound::Wrong {
                type_name,
                bytes,
                why,
            };
            (wrong, None)
        }
    })
}

/// The symbols that are wanted; all that are missing are named together.
fn usable_symbols(client: &mut AdsClient, wanted: &[Wanted]) -> Result<Vec<Symbol>, LinkError> {
    let mut symbols = Vec::with_capacity(wanted.len());
    let mut missing: Vec<String> = Vec::new();
    for want in wanted {
        let (found, symbol) = look_up(client, want)?;
        symbols.extend(symbol);
        match found {
            SymbolFound::Good { .. } => {}
            SymbolFound::Missing(why) => missing.push(format!("{}: {why}", want.name)),
            SymbolFound::Wrong { type_name, why, .. } => {
                return Err(LinkError::Setup(format!(
                    "the controller's symbol {} is of type {type_name}, {why}",
                    want.name
                )));
            }
        }
    }
    if missing.is_empty() {
        return Ok(symbols);
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

/// Connects, looks up every symbol of a mapping and closes the connection. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, the controller cannot be connected or its program does not run.
pub fn check_symbols(
    address: &AdsAddress,
    mapping: &AdsMapping,
    robot: &Robot,
    options: &AdsOptions,
) -> Result<Vec<SymbolCheck>, LinkError> {
    let layout = Layout::of(mapping, robot)?;
    let mut client = open(address, options)?;
    let check = |wanted: &Wanted| {
        let (found, _) = look_up(&mut client, wanted)?;
        Ok(SymbolCheck {
            name: wanted.name.clone(),
            found,
        })
    };
    layout.wanted.iter().map(check).collect()
}
