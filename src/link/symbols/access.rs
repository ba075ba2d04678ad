//! What a protocol has to offer: connections to a server of symbols, which are looked up, read and written.

use super::layout::{Slot, Wanted};
use crate::error::LinkError;

/// A symbol of a mapping and what the controller says about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SymbolCheck {
    /// Its name, that of one cable where there is one for each.
    pub name: String,
    /// What the controller says.
    pub found: SymbolFound,
}

/// What a controller says about a symbol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SymbolFound {
    /// It exists and can be used.
    Good {
        /// Its type as the controller calls it.
        type_name: String,
    },
    /// It does not exist; the controller's answer.
    Missing(String),
    /// It exists but cannot be used.
    Wrong {
        /// Its type as the controller calls it.
        type_name: String,
        /// What is wrong with the type.
        why: String,
    },
}

/// What a symbol has to be.
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

/// What kind of value a symbol has, whatever the protocol calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ValueKind {
    Flag,
    /// An integer without sign of 32 bits.
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

/// How many elements a symbol has to have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Count {
    Exactly(usize),
    AtLeast(usize),
}

impl Wanted {
    /// What is wrong with a symbol of this kind and so many elements, to be read after the name of its type; `names`
    /// are those of the types that the protocol has for what is expected.
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

/// Why a request to a program failed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// The connection cannot be used any more.
    Lost(LinkError),
    /// The connection is still good.
    Refused(LinkError),
}

impl Failure {
    /// A refusal in words.
    pub fn refused(text: String) -> Self {
        Self::Refused(LinkError::Refused(text))
    }

    /// The error alone.
    pub fn into_error(self) -> LinkError {
        match self {
            Self::Lost(error) | Self::Refused(error) => error,
        }
    }
}

/// What a symbol held when it was read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Content {
    Numbers(Vec<f64>),
    Text(String),
}

/// What symbols held when they were read, by the symbols' indices.
pub(crate) struct SymbolValues(pub Vec<Option<Content>>);

impl SymbolValues {
    /// A number; NaN where its symbol was not read.
    pub fn number(&self, slot: Slot) -> f64 {
        match self.0.get(slot.symbol) {
            Some(Some(Content::Numbers(numbers))) => {
                numbers.get(slot.element).copied().unwrap_or(f64::NAN)
            }
            _ => f64::NAN,
        }
    }

    /// A text; empty where its symbol was not read.
    pub fn text(&self, slot: Slot) -> &str {
        match self.0.get(slot.symbol) {
            Some(Some(Content::Text(text))) => text,
            _ => "",
        }
    }
}

/// A server of symbols. Nothing is sent before [`SymbolServer::connect`].
pub(crate) trait SymbolServer: Send {
    /// Where it is, for the operator.
    fn place(&self) -> String;

    /// Connects to a program that runs.
    fn connect(&self) -> Result<Box<dyn SymbolAccess>, LinkError>;
}

/// A connection to a server of symbols. Each call is over, answered or not, after a bounded time.
pub(crate) trait SymbolAccess: Send {
    /// Looks symbols up, which are known by their index after that. They can be read and written only if all are good.
    fn look_up(&mut self, wanted: &[Wanted]) -> Result<Vec<SymbolFound>, LinkError>;

    /// Why the program does not run, if it does not.
    fn problem(&mut self) -> Result<Option<String>, Failure>;

    /// Checks that the symbols are still those that were looked up, before they are written without being read first.
    fn check_unchanged(&mut self) -> Result<(), Failure>;

    /// Reads symbols in one request, at the same moment where the controller can do that.
    fn read(&mut self, indices: &mut dyn Iterator<Item = usize>) -> Result<SymbolValues, Failure>;

    /// Has symbols sent every so many seconds, in place of those before.
    fn subscribe(
        &mut self,
        _indices: &mut dyn Iterator<Item = usize>,
        _every_s: f64,
    ) -> Result<(), Failure> {
        let text = "it sends nothing of its own accord";
        Err(Failure::refused(text.to_owned()))
    }

    /// What was sent since this was last asked, the oldest first. Does not wait.
    fn sent(&mut self) -> Result<Vec<SymbolValues>, Failure> {
        Ok(Vec::new())
    }

    /// Ends what the controller would go on with after the connection.
    fn close(&mut self) {}

    /// Writes numbers in their order.
    fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure>;
}

/// Indices of symbols, each once and in order, that are among so many.
pub(crate) fn each_once(indices: &mut dyn Iterator<Item = usize>, known: usize) -> Vec<usize> {
    let mut wanted: Vec<usize> = indices.filter(|index| *index < known).collect();
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

/// Most names in one message.
const NAMES: usize = 4;

/// Connects and looks all symbols up; all that are missing are named together.
pub(super) fn connect(
    server: &dyn SymbolServer,
    wanted: &[Wanted],
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
