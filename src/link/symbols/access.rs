//! Interface of protocols: connections to a symbol server, for looking up, reading and writing symbols.

use super::layout::{RequiredSymbol, Slot};
use crate::controller::LinkProtection;
use crate::error::LinkError;

/// A symbol of a mapping, and the controller's answer about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SymbolCheck {
    /// Name; for patterns that of one cable.
    pub name: String,
    /// The controller's answer.
    pub found: SymbolFound,
}

/// A controller's answer about a symbol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SymbolFound {
    /// It exists and can be used.
    Good {
        /// Name of its type in the controller.
        type_name: String,
    },
    /// It does not exist; contains the controller's response.
    Missing(String),
    /// It exists but cannot be used.
    Wrong {
        /// Name of its type in the controller.
        type_name: String,
        /// The problem with the type.
        why: String,
    },
}

/// Required type of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Expected {
    /// A truth value.
    Flag,
    /// An integer.
    Integer,
    /// An integer or a truth value.
    Code,
    /// A counter that wraps at 2^32.
    Counter,
    /// Any number.
    Number,
    /// Characters.
    Text,
}

/// Kind of a symbol's value, independent of the protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ValueKind {
    Flag,
    /// An unsigned integer of 32 bits.
    Counter,
    /// Any other integer.
    Integer,
    Real,
    Text,
    Other,
}

impl Expected {
    fn allows(self, kind: ValueKind) -> bool {
        use ValueKind::{Counter, Flag, Integer, Real, Text};
        match self {
            Self::Flag => kind == Flag,
            Self::Integer => matches!(kind, Integer | Counter),
            Self::Code => matches!(kind, Integer | Counter | Flag),
            Self::Counter => kind == Counter,
            Self::Number => matches!(kind, Integer | Counter | Flag | Real),
            Self::Text => kind == Text,
        }
    }
}

/// Required number of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Count {
    Exactly(usize),
    AtLeast(usize),
}

impl RequiredSymbol {
    /// The problem with a symbol of this kind and number of elements, to be appended to the name of its type; `names`
    /// are the protocol's names for the required types.
    pub fn problem(
        &self,
        (kind, has): (ValueKind, usize),
        names: fn(Expected) -> &'static str,
    ) -> Option<String> {
        if !self.expected.allows(kind) || has == 0 {
            return Some(format!("expected {}", names(self.expected)));
        }
        match self.count {
            Count::Exactly(count) if has != count => {
                Some(format!("which has {has} values, expected {count}"))
            }
            Count::AtLeast(count) if has < count => {
                Some(format!("which has {has} values, expected at least {count}"))
            }
            _ => None,
        }
    }
}

/// Errors of a request to a program.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// The connection can no longer be used.
    Lost(LinkError),
    /// The request was rejected, but the connection is intact.
    Refused(LinkError),
}

impl Failure {
    /// A rejection with the given text.
    pub fn refused(text: String) -> Self {
        Self::Refused(LinkError::Refused(text))
    }

    /// Returns the error.
    pub fn into_error(self) -> LinkError {
        match self {
            Self::Lost(error) | Self::Refused(error) => error,
        }
    }
}

/// Content of a symbol when it was read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Content {
    Numbers(Vec<f64>),
    Text(String),
}

/// Contents of symbols when they were read, by the symbols' indices.
pub(crate) struct SymbolValues(pub Vec<Option<Content>>);

impl SymbolValues {
    /// A number; NaN if its symbol was not read.
    pub fn number(&self, slot: Slot) -> f64 {
        match self.0.get(slot.symbol) {
            Some(Some(Content::Numbers(numbers))) => {
                numbers.get(slot.element).copied().unwrap_or(f64::NAN)
            }
            _ => f64::NAN,
        }
    }

    /// A text; empty if its symbol was not read.
    pub fn text(&self, slot: Slot) -> &str {
        match self.0.get(slot.symbol) {
            Some(Some(Content::Text(text))) => text,
            _ => "",
        }
    }
}

/// A server of symbols. Nothing is sent before [`SymbolServer::connect`].
pub(crate) trait SymbolServer: Send {
    /// Its address, for the operator.
    fn place(&self) -> String;

    /// Connects to a running program.
    fn connect(&self) -> Result<Box<dyn SymbolAccess>, LinkError>;
}

/// A connection to a symbol server. Each call ends, answered or not, after a bounded time.
pub(crate) trait SymbolAccess: Send {
    /// Looks up symbols, which are then known by their index. They can be read and written only if all are good.
    fn look_up(&mut self, wanted: &[RequiredSymbol]) -> Result<Vec<SymbolFound>, LinkError>;

    /// Protection of the messages.
    fn protection(&self) -> LinkProtection {
        LinkProtection::Open
    }

    /// Reason why the program does not run, if it does not.
    fn problem(&mut self) -> Result<Option<String>, Failure>;

    /// Checks that the symbols are still those that were looked up, before they are written without being read first.
    fn check_unchanged(&mut self) -> Result<(), Failure>;

    /// Reads symbols in one request, at the same instant if the controller supports that.
    fn read(&mut self, indices: &mut dyn Iterator<Item = usize>) -> Result<SymbolValues, Failure>;

    /// Subscribes to symbols, sent every `every_s` seconds, replacing earlier subscriptions.
    fn subscribe(
        &mut self,
        _indices: &mut dyn Iterator<Item = usize>,
        _every_s: f64,
    ) -> Result<(), Failure> {
        let text = "it does not send readings on its own";
        Err(Failure::refused(text.to_owned()))
    }

    /// The values sent since the last call, the oldest first. Does not wait.
    fn sent(&mut self) -> Result<Vec<SymbolValues>, Failure> {
        Ok(Vec::new())
    }

    /// Ends what the controller would otherwise continue after the connection.
    fn close(&mut self) {}

    /// Writes numbers in order.
    fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure>;
}

/// Indices of known symbols, each once and in order.
pub(crate) fn each_once(indices: &mut dyn Iterator<Item = usize>, known: usize) -> Vec<usize> {
    let mut wanted: Vec<usize> = indices.filter(|index| *index < known).collect();
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

/// Largest number of names in one message.
const NAMES: usize = 4;

/// Connects and looks up all symbols; missing ones are reported together.
pub(super) fn connect(
    server: &dyn SymbolServer,
    wanted: &[RequiredSymbol],
) -> Result<Box<dyn SymbolAccess>, LinkError> {
    let mut access = server.connect()?;
    let found = access.look_up(wanted)?;
    let mut missing: Vec<String> = Vec::new();
    for (want, found) in wanted.iter().zip(found) {
        match found {
            SymbolFound::Good { .. } => {}
            SymbolFound::Missing(why) => missing.push(format!("{}: {why}", want.name)),
            SymbolFound::Wrong { type_name, why } => {
                return Err(LinkError::Setup(format!(
                    "the controller's symbol {} is of type {type_name}, {why}",
                    want.name
                )));
            }
        }
    }
    if missing.is_empty() {
        return Ok(access);
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
