//! The server in a process of its own: it reads orders as lines of JSON, and reports the values that clients write.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};
use tautline_core::robot::Robot;
use tautline_link::SystemClock;
use tautline_link::ads::{AdsAddress, AdsOptions};
use tautline_link::opcua::{self, Credentials, OpcUaAddress, OpcUaOptions, OpcUaServer};
use tautline_link::symbols::SymbolController;
use tautline_session::{CertificateFingerprint, SymbolMapping};

use super::host::{Host, Orders, Written, ads_client};
use super::keys::TestKeys;
use crate::support::python::python;

/// Time limit for an order.
const PATIENCE: Duration = Duration::from_secs(60);

/// A protocol, and the server that speaks it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// pyads' test server.
    Ads,
    /// asyncua's server, without security.
    OpcUa,
    /// asyncua's server, which signs and encrypts and knows one user.
    OpcUaEncrypted,
}

/// The user that an encrypted server knows.
pub const USER: &str = "anna";
/// The password of the user.
pub const PASSWORD: &str = "Gr\u{fc}\u{df}e & 1";

/// The namespace of the nodes of a server that speaks OPC UA, as their names have it.
const NAMESPACE: &str = "ns=4;s=";

impl Protocol {
    /// A symbol as clients name it.
    #[must_use]
    pub fn name_of(self, symbol: &str) -> String {
        match self {
            Self::Ads => symbol.to_owned(),
            Self::OpcUa | Self::OpcUaEncrypted => format!("{NAMESPACE}{symbol}"),
        }
    }

    /// The mapping with the names that this protocol has.
    #[must_use]
    pub fn mapping(self, mapping: &SymbolMapping) -> SymbolMapping {
        let mut mapping = mapping.clone();
        for name in mapping.names_mut() {
            *name = self.name_of(name);
        }
        mapping
    }

    fn script(self) -> &'static str {
        match self {
            Self::Ads => "tests/support/ads/server.py",
            Self::OpcUa | Self::OpcUaEncrypted => "tests/support/ads/opcua_server.py",
        }
    }

    /// The security of the server, as its script reads it.
    fn security(self) -> Option<Value> {
        (self == Self::OpcUaEncrypted).then(
            || json!({"policies": ["Basic256Sha256_SignAndEncrypt"], "user": [USER, PASSWORD]}),
        )
    }
}

/// Makes certificates of users with their keys in a folder; the script says under which names.
///
/// # Panics
/// If its Python environment is missing.
pub fn user_certificates(folder: &Path) {
    let mut made = python("tests/support/ads/user_certificates.py");
    let status = made.arg(folder).status().expect("a process");
    assert!(status.success(), "the certificates are made");
}

/// Gives orders to a process, as lines of JSON.
fn orders_to(pipe: ChildStdin) -> Orders {
    let pipe = Mutex::new(pipe);
    Orders::new(move |order| {
        let mut pipe = pipe.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = writeln!(pipe, "{order}");
        let _ = pipe.flush();
    })
}

/// A server; its process ends when it is dropped.
pub struct Server {
    /// Protocol of the server.
    pub protocol: Protocol,
    process: Child,
    orders: Orders,
    port: u16,
    /// SHA-256 of its certificate, if it has one.
    pub fingerprint: Option<CertificateFingerprint>,
    next: AtomicU64,
    done: Mutex<Receiver<Value>>,
    /// Receiver of the values that clients wrote.
    wrote: Mutex<Option<Receiver<Written>>>,
}

impl Server {
    /// Starts a server on a free port.
    ///
    /// # Panics
    /// If its Python environment is missing.
    #[must_use]
    pub fn start(protocol: Protocol) -> Self {
        Self::with_security(protocol, protocol.security().as_ref())
    }

    /// Starts a server whose security is that of its script; see there.
    ///
    /// # Panics
    /// If its Python environment is missing.
    #[must_use]
    pub fn with_security(protocol: Protocol, security: Option<&Value>) -> Self {
        let mut process = python(protocol.script())
            .args(security.map(Value::to_string))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a process");
        let orders = process.stdin.take().expect("a pipe");
        let output = process.stdout.take().expect("a pipe");
        let (done, wrote, port) = (channel(), channel(), channel());
        std::thread::spawn(move || listen(BufReader::new(output), &done.0, &wrote.0, &port.0));
        let begun = port.1.recv_timeout(PATIENCE).expect("the server's port");
        Self {
            protocol,
            process,
            orders: orders_to(orders),
            port: begun.0,
            fingerprint: begun.1,
            next: AtomicU64::new(1),
            done: Mutex::new(done.1),
            wrote: Mutex::new(Some(wrote.1)),
        }
    }

    /// Address for clients over ADS.
    #[must_use]
    pub fn address(&self) -> AdsAddress {
        AdsAddress {
            host: "127.0.0.1".to_owned(),
            port: self.port,
            net_id: [127, 0, 0, 1, 1, 1],
            ams_port: 851,
        }
    }

    /// Address for clients over OPC UA.
    #[must_use]
    pub fn url(&self) -> OpcUaAddress {
        OpcUaAddress {
            host: "127.0.0.1".to_owned(),
            port: self.port,
            path: String::new(),
            security: None,
            policy: None,
            user: (self.protocol == Protocol::OpcUaEncrypted).then(|| USER.to_owned()),
            user_certificate: None,
        }
    }

    /// Credentials of a client that trusts this server and knows its user.
    #[must_use]
    pub fn credentials(&self) -> Credentials {
        let keys = match self.fingerprint {
            Some(fingerprint) => TestKeys::trusting(&self.url().origin(), fingerprint),
            None => TestKeys::default(),
        };
        keys.with_password(PASSWORD)
    }

    /// Gives an order, waits until it is carried out, and returns the number of requests of each kind so far.
    ///
    /// # Panics
    /// If the server does not answer.
    pub fn order(&self, mut order: Value) -> BTreeMap<String, u64> {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        order["id"] = json!(id);
        self.orders.give(&order);
        let done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = done.recv_timeout(PATIENCE).expect("the order is done");
        assert_eq!(answer["done"], json!(id));
        serde_json::from_value(answer["counts"].clone()).expect("counts")
    }

    /// Number of requests of a kind so far: "read", "write", "lookup" or "state".
    #[must_use]
    pub fn count(&self, kind: &str) -> u64 {
        self.order(json!({})).get(kind).copied().unwrap_or(0)
    }

    /// Plans a fault at request `number` (from 1) of a kind. The connection ends "before" or "after" the request is
    /// treated, or "half" way through the answer; "stray" changes the number of the answer instead, and "late" delays
    /// the answer by three seconds.
    pub fn fault(&self, kind: &str, number: u64, action: &str) {
        self.order(json!({"fault": {"kind": kind, "number": number, "action": action}}));
    }
}

impl Host for Server {
    fn address(&self) -> AdsAddress {
        self.address()
    }

    fn choice(&self) -> String {
        match self.protocol {
            Protocol::Ads => format!("ads:{}", self.address()),
            Protocol::OpcUa | Protocol::OpcUaEncrypted => self.url().to_string(),
        }
    }

    fn client(
        &self,
        mapping: &SymbolMapping,
        robot: &Robot,
        options: AdsOptions,
    ) -> SymbolController {
        let mapping = self.protocol.mapping(mapping);
        match self.protocol {
            Protocol::Ads => ads_client(self.address(), (&mapping, robot), options),
            Protocol::OpcUa | Protocol::OpcUaEncrypted => {
                let clock = Arc::new(SystemClock::start());
                let server = OpcUaServer {
                    address: self.url(),
                    options: OpcUaOptions {
                        timeout_s: options.timeout_s,
                        acknowledge_s: options.acknowledge_s,
                    },
                    credentials: self.credentials(),
                };
                let made = opcua::controller(server, &mapping, robot, clock);
                made.expect("a mapping that fits")
            }
        }
    }

    fn orders(&self) -> Orders {
        self.orders.clone()
    }

    fn wrote(&self) -> Receiver<Written> {
        let mut wrote = self.wrote.lock().unwrap_or_else(PoisonError::into_inner);
        wrote.take().expect("taken once")
    }

    fn carry_out(&self, order: Value) {
        self.order(order);
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Port and certificate of a server that has begun.
type Begun = (u16, Option<CertificateFingerprint>);

fn listen(
    output: impl BufRead,
    done: &Sender<Value>,
    wrote: &Sender<Written>,
    begun: &Sender<Begun>,
) {
    for line in output.lines() {
        let Ok(line) = line else { return };
        let told: Value = serde_json::from_str(&line).expect("JSON from the server");
        if let Some(name) = told["wrote"].as_str() {
            // Truth values come as such, numbers that are none as null.
            let number = |value: &Value| match value {
                Value::Bool(on) => f64::from(u8::from(*on)),
                value => value.as_f64().unwrap_or(f64::NAN),
            };
            let values = told["values"].as_array().map(Vec::as_slice);
            let values = values.unwrap_or_default().iter().map(number).collect();
            let _ = wrote.send((name.to_owned(), values));
        } else if let Some(found) = told["port"].as_u64() {
            let fingerprint = told["fingerprint"].as_str();
            let fingerprint = fingerprint.map(|text| text.parse().expect("a fingerprint"));
            let _ = begun.send((u16::try_from(found).expect("a port"), fingerprint));
        } else {
            let _ = done.send(told);
        }
    }
}
