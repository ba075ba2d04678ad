//! The links to controllers against servers that share no code with them: those of pyads and of asyncua in processes of
//! their own, with the simulated robot behind them.

/// Tests of functions that take the protocol, over each of them.
macro_rules! over_all {
    ($($name:ident),+ $(,)?) => {
        mod over_ads {
            $(#[test]
            fn $name() {
                super::$name(tautline_validation::support::ads::Protocol::Ads);
            })+
        }
        mod over_opcua {
            $(#[test]
            fn $name() {
                super::$name(tautline_validation::support::ads::Protocol::OpcUa);
            })+
        }
        mod over_opcua_encrypted {
            $(#[test]
            fn $name() {
                super::$name(tautline_validation::support::ads::Protocol::OpcUaEncrypted);
            })+
        }
    };
}
use over_all;

mod adjusting;
mod calibrating;
mod faults;
mod kills;
mod live;
#[cfg(target_os = "linux")]
mod opcua_passwords;
mod opcua_security;
mod opcua_user_certificate;
mod page;
mod program;
mod setting_up;
mod until;
