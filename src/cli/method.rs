//! `--method`.

use tautline_session::Method;

/// Name of an identification method on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum MethodName {
    Joint,
    Simple,
    Published,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Joint => Self::Joint,
            MethodName::Simple => Self::Simple,
            MethodName::Published => Self::Published,
        }
    }
}
