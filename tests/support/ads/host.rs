//! Interface of a server for the controller's program behind it.

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use serde_json::Value;
use tautline_core::robot::Robot;
use tautline_link::SystemClock;
use tautline_link::ads::{self, AdsAddress, AdsOptions};
use tautline_link::symbols::SymbolController;
use tautline_session::SymbolMapping;

/// A symbol that was written, and all its values.
pub type Written = (String, Vec<f64>);

/// Sends orders to a server.
#[derive(Clone)]
pub struct Orders(Arc<dyn Fn(&Value) + Send + Sync>);

impl Orders {
    /// Orders that are given by a function.
    pub fn new(give: impl Fn(&Value) + Send + Sync + 'static) -> Self {
        Self(Arc::new(give))
    }

    /// Gives an order without waiting for it. A server that has ended takes none.
    pub fn give(&self, order: &Value) {
        (self.0)(order);
    }
}

/// A server of symbols.
pub trait Host {
    /// Address for clients.
    fn address(&self) -> AdsAddress;

    /// Value of `--controller` for this server.
    fn choice(&self) -> String {
        format!("ads:{}", self.address())
    }

    /// A client with the timeouts of these options. The mapping has the names of [`super::symbols`].
    ///
    /// # Panics
    /// If the mapping does not fit.
    fn client(
        &self,
        mapping: &SymbolMapping,
        robot: &Robot,
        options: AdsOptions,
    ) -> SymbolController {
        ads_client(self.address(), (mapping, robot), options)
    }

    /// Sends orders without waiting for them.
    fn orders(&self) -> Orders;

    /// Receiver of the values that clients write. It can be taken once.
    fn wrote(&self) -> Receiver<Written>;

    /// Gives an order and waits until it is carried out.
    fn carry_out(&self, order: Value);
}

/// A client that speaks ADS.
pub(super) fn ads_client(
    address: AdsAddress,
    (mapping, robot): (&SymbolMapping, &Robot),
    options: AdsOptions,
) -> SymbolController {
    let clock = Arc::new(SystemClock::start());
    let made = ads::controller(address, mapping, robot, options, clock);
    made.expect("a mapping that fits")
}
