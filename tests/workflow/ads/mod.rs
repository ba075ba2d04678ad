//! The links to controllers against servers that share no code with them: those of pyads and of asyncua in processes of
//! their own, with the simulated robot behind them.

/// Tests of functions that take the protocol, over each of them.
macro_rules! over_both {
    ($($name:ident),+ $(,)?) => {
        mod over_ads {
            $(#[test]
            fn $name() {
                super::$name(tautline_validation::ads::Protocol::Ads);
            })+
        }
        mod over_opcua {
            $(#[test]
            fn $name() {
                super::$name(tautline_validation::ads::Protocol::OpcUa);
            })+
        }
    };
}
use over_both;

mod adjusting;
mod calibrating;
mod faults;
mod page;
mod program;
mod setting_up;
