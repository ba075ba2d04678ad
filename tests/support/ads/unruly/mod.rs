//! A server that misbehaves, written from the protocol: AMS over TCP with the requests that a client of symbols needs,
//! and a list of faults. It shares no code with the link, nor with pyads.

mod answers;
mod faults;
mod memory;

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tautline_link::ads::AdsAddress;

use super::host::{Host, Orders, Written};
use answers::{
    RELEASE_HANDLE, SUBSCRIBE, SYMBOL_HANDLE, SYMBOL_INFO, Subscription, UNSUBSCRIBE,
    WRITE_TOGETHER, answer, notification,
};
pub use faults::Action;
use faults::misbehave;
use memory::Memory;

/// Kind of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RequestKind {
    /// The state of the program.
    State,
    /// The description or handle of a symbol, or a subscription to it.
    Lookup,
    /// Values.
    Read,
    /// Parameters to write.
    Write,
    /// Commands, the release and the watchdog to write.
    Command,
}

/// Symbols that are written without a parameter being changed.
const COMMANDS: [&str; 5] = ["target", "kind", "number", "release", "watchdog"];

/// A planned fault: the action at request `number` (from 1) of a kind.
#[derive(Debug)]
struct Fault {
    kind: RequestKind,
    number: u64,
    action: Action,
}

/// A planned wrong reading: the value of an element at reading `number` (from 1) of its symbol.
#[derive(Debug)]
struct WrongReading {
    symbol: String,
    element: usize,
    value: f64,
    number: u64,
}

type BeforeValue = Box<dyn FnMut(u64, &mut Memory) + Send>;

#[derive(Default)]
struct State {
    memory: Memory,
    handles: Vec<String>,
    /// Number of the ADS state; 5: run.
    state: u16,
    faults: Vec<Fault>,
    wrong_readings: Vec<WrongReading>,
    counts: BTreeMap<RequestKind, u64>,
    /// Values of parameters that were written so far.
    values: u64,
    /// Nobody can connect.
    down: bool,
    /// Connections, to end them.
    open: Vec<TcpStream>,
    /// Connections so far.
    connections: u64,
    /// Subscriptions by their handles.
    subscriptions: BTreeMap<u32, Subscription>,
    last_subscription: u32,
    /// Values that were sent in notifications so far.
    notified: usize,
    /// The symbol that shows the time, and the instant at which it was zero.
    clock: Option<(String, Instant)>,
    /// Called before each value of a parameter is written, with the number of values before.
    before_value: Option<BeforeValue>,
}

impl State {
    fn show_time(&mut self) {
        if let Some((name, zero)) = &self.clock {
            let time_s = zero.elapsed().as_secs_f64();
            self.memory.variable(name).set(&[json!(time_s)]);
        }
    }

    fn action(&mut self, kind: RequestKind) -> Option<Action> {
        *self.counts.entry(kind).or_default() += 1;
        let due = self.faults.iter_mut().filter(|fault| fault.kind == kind);
        due.for_each(|fault| fault.number = fault.number.saturating_sub(1));
        let at = self.faults.iter().position(|fault| fault.number == 0)?;
        Some(self.faults.remove(at).action)
    }
}

/// The server.
pub struct Unruly {
    port: u16,
    state: Arc<Mutex<State>>,
    wrote: Mutex<Option<Receiver<Written>>>,
    sender: Sender<Written>,
    ends: Arc<AtomicBool>,
    acceptor: Option<JoinHandle<()>>,
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Unruly {
    /// Starts a server on a free port.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        listener.set_nonblocking(true).expect("a mode of sockets");
        let port = listener.local_addr().expect("an address").port();
        let state = Arc::new(Mutex::new(State {
            state: 5,
            ..State::default()
        }));
        let (sender, wrote) = channel();
        let ends = Arc::new(AtomicBool::new(false));
        let (shared, end, tell) = (Arc::clone(&state), Arc::clone(&ends), sender.clone());
        let acceptor = std::thread::spawn(move || {
            while !end.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((socket, _)) => serve(socket, &shared, &tell),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => {
                        sleep(Duration::from_millis(2));
                    }
                    Err(_) => return,
                }
            }
        });
        Self {
            port,
            state,
            wrote: Mutex::new(Some(wrote)),
            sender,
            ends,
            acceptor: Some(acceptor),
        }
    }

    /// Plans a fault at request `number` (from 1, counted from now) of a kind.
    pub fn fault(&self, kind: RequestKind, number: u64, action: Action) {
        lock(&self.state).faults.push(Fault {
            kind,
            number,
            action,
        });
    }

    /// Plans that an LREAL reads as another value at reading `number` (from 1, counted from now) of its symbol.
    pub fn wrong_reading(&self, (symbol, element): (&str, usize), value: f64, number: u64) {
        lock(&self.state).wrong_readings.push(WrongReading {
            symbol: symbol.to_owned(),
            element,
            value,
            number,
        });
    }

    /// The planned faults that have not happened yet are forgotten.
    pub fn forgive(&self) {
        let mut state = lock(&self.state);
        state.faults.clear();
        state.wrong_readings.clear();
    }

    /// Clients can connect again.
    pub fn up(&self) {
        lock(&self.state).down = false;
    }

    /// Nobody can connect any more, and connections end.
    pub fn down(&self) {
        let mut state = lock(&self.state);
        state.down = true;
        for socket in state.open.drain(..) {
            let _ = socket.shutdown(Shutdown::Both);
        }
    }

    /// Number of requests of a kind so far.
    #[must_use]
    pub fn count(&self, kind: RequestKind) -> u64 {
        lock(&self.state).counts.get(&kind).copied().unwrap_or(0)
    }

    /// Number of values of parameters that were written so far.
    #[must_use]
    pub fn values(&self) -> u64 {
        lock(&self.state).values
    }

    /// The values of a symbol.
    #[must_use]
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        lock(&self.state).memory.variable(name).numbers()
    }

    /// Another client writes values: the controller's program sees it as any other.
    pub fn write_as_another(&self, name: &str, values: &[f64]) {
        let mut state = lock(&self.state);
        let variable = state.memory.variable(name);
        let json: Vec<Value> = values.iter().map(|value| json!(value)).collect();
        variable.set(&json);
        let _ = self.sender.send((name.to_owned(), values.to_vec()));
    }

    /// A symbol shows the time since `zero` (s) from now on, whatever the controller's program does.
    pub fn run_clock(&self, name: &str, zero: Instant) {
        lock(&self.state).clock = Some((name.to_owned(), zero));
    }

    /// Number of cycles in which the values of all present subscriptions were sent so far.
    #[must_use]
    pub fn cycles_sent(&self) -> f64 {
        let state = lock(&self.state);
        state.notified as f64 / state.subscriptions.len() as f64
    }

    /// Number of symbols that clients are subscribed to.
    #[must_use]
    pub fn subscriptions(&self) -> usize {
        lock(&self.state).subscriptions.len()
    }

    /// Calls a function before each value of a parameter that a client writes, with the number of values before it.
    pub fn before_value(&self, does: impl FnMut(u64, &mut Memory) + Send + 'static) {
        lock(&self.state).before_value = Some(Box::new(does));
    }
}

impl Host for Unruly {
    fn address(&self) -> AdsAddress {
        AdsAddress {
            host: "127.0.0.1".to_owned(),
            port: self.port,
            net_id: [127, 0, 0, 1, 1, 1],
            ams_port: 851,
        }
    }

    fn wrote(&self) -> Receiver<Written> {
        let mut wrote = self.wrote.lock().unwrap_or_else(PoisonError::into_inner);
        wrote.take().expect("taken once")
    }

    /// Orders are carried out at once: `declare` and `set` as pyads' server takes them, and `state`.
    fn orders(&self) -> Orders {
        let state = Arc::clone(&self.state);
        Orders::new(move |order: &Value| {
            let mut state = lock(&state);
            for declaration in order["declare"].as_array().into_iter().flatten() {
                state.memory.declare(declaration);
            }
            for (name, values) in order["set"].as_object().into_iter().flatten() {
                let values = values.as_array().map_or(&[][..], Vec::as_slice);
                state.memory.variable(name).set(values);
            }
            if let Some(number) = order["state"].as_u64() {
                state.state = number as u16;
            }
        })
    }

    fn carry_out(&self, order: Value) {
        self.orders().give(&order);
    }
}

impl Drop for Unruly {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        self.down();
        if let Some(acceptor) = self.acceptor.take() {
            let _ = acceptor.join();
        }
    }
}

/// Serves a client on a thread of its own.
fn serve(socket: TcpStream, state: &Arc<Mutex<State>>, tell: &Sender<Written>) {
    let mut known = lock(state);
    if known.down {
        return;
    }
    let _ = socket.set_nonblocking(false);
    let _ = socket.set_nodelay(true);
    known.open.extend(socket.try_clone());
    known.connections += 1;
    let connection = known.connections;
    let (state, tell) = (Arc::clone(state), tell.clone());
    drop(known);
    std::thread::spawn(move || {
        let mut socket = socket;
        while wait(&mut socket, &state, connection).is_some()
            && treat(&mut socket, connection, &state, &tell).is_some()
        {}
        let mut known = lock(&state);
        known
            .subscriptions
            .retain(|_, subscription| subscription.connection != connection);
        drop(known);
        let _ = socket.shutdown(Shutdown::Both);
    });
}

/// Sends due notifications until a request arrives.
fn wait(socket: &mut TcpStream, state: &Mutex<State>, connection: u64) -> Option<()> {
    loop {
        let mut known = lock(state);
        let subscribed = !known.subscriptions.is_empty();
        known.show_time();
        let due = notification(&mut known, connection);
        drop(known);
        if let Some(due) = due {
            send(socket, &due)?;
        }
        let pause = subscribed.then_some(Duration::from_millis(1));
        socket.set_read_timeout(pause).ok()?;
        match socket.peek(&mut [0]) {
            Ok(0) => return None,
            Ok(_) => return socket.set_read_timeout(None).ok(),
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {}
                _ => return None,
            },
        }
    }
}

/// A request without its headers, and the headers as the answer has them.
struct Request {
    command: u16,
    number: [u8; 4],
    addresses: [u8; 16],
    data: Vec<u8>,
    /// Number of the connection that it came by.
    connection: u64,
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn receive(socket: &mut TcpStream, connection: u64) -> Option<Request> {
    let mut outer = [0; 6];
    socket.read_exact(&mut outer).ok()?;
    let mut frame = vec![0; word(&outer, 2)? as usize];
    socket.read_exact(&mut frame).ok()?;
    // The answer goes back to where the request came from.
    let mut addresses = [0; 16];
    addresses[..8].copy_from_slice(frame.get(8..16)?);
    addresses[8..].copy_from_slice(frame.get(..8)?);
    Some(Request {
        command: u16::from_le_bytes([frame[16], frame[17]]),
        number: frame.get(28..32)?.try_into().ok()?,
        addresses,
        data: frame.split_off(32),
        connection,
    })
}

fn is_command(name: &str) -> bool {
    COMMANDS.iter().any(|known| name.ends_with(known))
}

fn kind_of(request: &Request, memory: &mut Memory) -> RequestKind {
    let group = word(&request.data, 0).unwrap_or(0);
    // Of several values the first one decides.
    let head = match request.command {
        9 => 16,
        _ => 0,
    };
    match (request.command, group) {
        (4, _) => RequestKind::State,
        (SUBSCRIBE | UNSUBSCRIBE, _) => RequestKind::Lookup,
        (3, RELEASE_HANDLE) | (_, SYMBOL_INFO | SYMBOL_HANDLE) => RequestKind::Lookup,
        (3, _) | (9, WRITE_TOGETHER) => {
            let place = word(&request.data, head).zip(word(&request.data, head + 4));
            let name = place.and_then(|(group, offset)| memory.name_at(group, offset));
            match name.is_some_and(|name| is_command(&name)) {
                true => RequestKind::Command,
                false => RequestKind::Write,
            }
        }
        _ => RequestKind::Read,
    }
}

/// Takes one request and answers it; `None` where the connection ends.
fn treat(
    socket: &mut TcpStream,
    connection: u64,
    state: &Mutex<State>,
    tell: &Sender<Written>,
) -> Option<()> {
    let request = receive(socket, connection)?;
    let mut known = lock(state);
    known.show_time();
    let kind = kind_of(&request, &mut known.memory);
    let action = known.action(kind);
    if action == Some(Action::DropBefore) {
        return None;
    }
    let limit = match action {
        Some(Action::DownAfterValues(count)) => count,
        _ => usize::MAX,
    };
    let content = match action {
        // A refused request is not carried out.
        Some(Action::Code(_)) => Vec::new(),
        _ => answer(&mut known, &request, limit, tell),
    };
    if limit < usize::MAX {
        known.down = true;
        return None;
    }
    drop(known);
    let plain = frame(&request, 0, &content);
    match action {
        None => send(socket, &plain),
        Some(action) => misbehave(socket, &request, &content, action),
    }
}

fn send(socket: &mut TcpStream, bytes: &[u8]) -> Option<()> {
    socket.write_all(bytes).ok()
}

fn frame(request: &Request, code: u32, content: &[u8]) -> Vec<u8> {
    let mut frame = vec![0, 0];
    frame.extend_from_slice(&(32 + content.len() as u32).to_le_bytes());
    frame.extend_from_slice(&request.addresses);
    frame.extend_from_slice(&request.command.to_le_bytes());
    frame.extend_from_slice(&[5, 0]);
    frame.extend_from_slice(&(content.len() as u32).to_le_bytes());
    frame.extend_from_slice(&code.to_le_bytes());
    frame.extend_from_slice(&request.number);
    frame.extend_from_slice(content);
    frame
}
