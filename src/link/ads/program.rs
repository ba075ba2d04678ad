//! A connection to a running program with known symbols.

use super::address::AdsAddress;
use super::client::{AdsClient, RequestError};
use super::codes::AdsCode;
use super::notifications::NotifiedValues;
use super::options::AdsOptions;
use super::symbols::{Symbol, SymbolAddress, encode};
use crate::error::LinkError;
use crate::symbols::{
    Failure, RequiredSymbol, Slot, SymbolAccess, SymbolFound, SymbolServer, SymbolValues, each_once,
};

fn failure(error: RequestError, what: &str) -> Failure {
    match error {
        RequestError::Lost(error) => Failure::Lost(error),
        RequestError::Refused(code) => refused(code, what),
    }
}

fn refused(code: AdsCode, what: &str) -> Failure {
    Failure::refused(format!("{what}: {}", code.explain()))
}

/// A program to connect to.
pub(super) struct AdsServer {
    pub address: AdsAddress,
    pub options: AdsOptions,
}

impl SymbolServer for AdsServer {
    fn place(&self) -> String {
        self.address.to_string()
    }

    fn connect(&self) -> Result<Box<dyn SymbolAccess>, LinkError> {
        let what = format!("the program at {}", self.address);
        let to_error = |error| failure(error, &what).into_error();
        let mut client = AdsClient::open(&self.address, &self.options)?;
        let (running, state) = client.state().map_err(to_error)?;
        if !running {
            return Err(LinkError::Refused(not_running(&state)));
        }
        let version = client.read(&[SymbolAddress::VERSION]).map_err(to_error)?;
        let version = version.into_iter().next().and_then(Result::ok);
        Ok(Box::new(Program {
            client,
            symbols: Vec::new(),
            subscribed: Vec::new(),
            version: version.and_then(|bytes| bytes.first().copied()),
        }))
    }
}

/// A connected program.
pub(super) struct Program {
    client: AdsClient,
    symbols: Vec<Symbol>,
    /// The handle of each subscription, with the index of its symbol.
    subscribed: Vec<(u32, usize)>,
    /// Number that changes with the program, if the controller has one.
    version: Option<u8>,
}

impl SymbolAccess for Program {
    fn look_up(&mut self, wanted: &[RequiredSymbol]) -> Result<Vec<SymbolFound>, LinkError> {
        self.symbols.clear();
        let mut all = Vec::with_capacity(wanted.len());
        for want in wanted {
            let symbol = match self.client.symbol(&want.name) {
                Ok(symbol) => symbol,
                Err(RequestError::Refused(code)) => {
                    all.push(SymbolFound::Missing(code.explain()));
                    continue;
                }
                Err(RequestError::Lost(error)) => return Err(error),
            };
            let type_name = symbol.type_name.clone();
            all.push(match symbol.problem(want) {
                None => SymbolFound::Good { type_name },
                Some(why) => SymbolFound::Wrong { type_name, why },
            });
            self.symbols.push(symbol);
        }
        Ok(all)
    }

    fn problem(&mut self) -> Result<Option<String>, Failure> {
        let state = self.client.state();
        let (running, state) = state.map_err(|e| failure(e, "the state of the program"))?;
        Ok((!running).then(|| not_running(&state)))
    }

    fn check_unchanged(&mut self) -> Result<(), Failure> {
        let Some(known) = self.version else {
            return Ok(());
        };
        let now = self.client.read(&[SymbolAddress::VERSION]);
        let now = now.map_err(|e| failure(e, "the version of the program"))?;
        match now.iter().flatten().any(|bytes| *bytes != [known]) {
            true => Err(program_changed()),
            false => Ok(()),
        }
    }

    fn read(&mut self, indices: &mut dyn Iterator<Item = usize>) -> Result<SymbolValues, Failure> {
        let wanted = each_once(indices, self.symbols.len());
        let version = self.version.map(|_| SymbolAddress::VERSION);
        let places = wanted.iter().map(|index| self.symbols[*index].place());
        let places: Vec<SymbolAddress> = version.into_iter().chain(places).collect();
        let answers = self.client.read(&places);
        let answers = answers.map_err(|e| failure(e, "reading symbols"))?;
        let mut answers = answers.into_iter();
        if let Some(known) = self.version {
            let now = answers.next();
            if now.is_some_and(|now| now.is_ok_and(|bytes| bytes != [known])) {
                return Err(program_changed());
            }
        }
        let mut contents = vec![None; self.symbols.len()];
        for (index, answer) in wanted.into_iter().zip(answers) {
            let symbol = &self.symbols[index];
            let bytes = answer.map_err(|code| refused(code, &symbol.name))?;
            contents[index] = Some(symbol.content(&bytes));
        }
        Ok(SymbolValues(contents))
    }

    fn subscribe(
        &mut self,
        indices: &mut dyn Iterator<Item = usize>,
        every_s: f64,
    ) -> Result<(), Failure> {
        let wanted = each_once(indices, self.symbols.len());
        let places = wanted.iter().map(|index| self.symbols[*index].place());
        let places: Vec<SymbolAddress> = places.collect();
        self.subscribed.clear();
        let handles = self.client.subscribe(&places, every_s);
        let handles = handles.map_err(|e| failure(e, "subscribing to symbols"))?;
        self.subscribed = handles.into_iter().zip(wanted).collect();
        Ok(())
    }

    fn sent(&mut self) -> Result<Vec<SymbolValues>, Failure> {
        let rows = self.client.notified();
        let rows = rows.map_err(|e| failure(e, "subscribed symbols"))?;
        let values = |row: NotifiedValues| {
            let mut contents = vec![None; self.symbols.len()];
            for (handle, index) in &self.subscribed {
                let symbol = &self.symbols[*index];
                let bytes = row
                    .get(handle)
                    .filter(|bytes| bytes.len() == symbol.place().size)?;
                contents[*index] = Some(symbol.content(bytes));
            }
            Some(SymbolValues(contents))
        };
        Ok(rows.into_iter().filter_map(values).collect())
    }

    fn close(&mut self) {
        // Otherwise they end later, with the connection.
        let _ = self.client.unsubscribe();
    }

    fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
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
                return Err(Failure::refused(format!(
                    "its symbol {name} of type {kind} cannot hold {value}"
                )));
            };
            list.push(written);
        }
        self.client.write(&list).map_err(|(error, index)| {
            let symbol = values
                .get(index)
                .and_then(|(slot, _)| self.symbols.get(slot.symbol));
            failure(error, symbol.map_or("writing", |symbol| &symbol.name))
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
