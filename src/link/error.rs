//! Errors of controllers and instruments.

use std::fmt;

use tautline_session::CertificateFingerprint;

/// A server whose certificate the operator has not trusted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UntrustedServer {
    /// Its address, without path and options.
    pub server: String,
    /// SHA-256 of its certificate.
    pub fingerprint: CertificateFingerprint,
    /// SHA-256 of the certificate that is trusted for it, if it is another one.
    pub known: Option<CertificateFingerprint>,
}

impl fmt::Display for UntrustedServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            server,
            fingerprint,
            known,
        } = self;
        match known {
            None => write!(
                f,
                "the certificate of {server} is not trusted yet: compare its SHA-256 fingerprint {fingerprint} with the one at the server"
            ),
            Some(known) => write!(
                f,
                "the certificate of {server} has changed: found the SHA-256 fingerprint {fingerprint}, expected {known}. Unless a new one was made at the server, somebody else answers in its place"
            ),
        }
    }
}

/// An error of a controller or instrument, as one sentence for the operator.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// There is no connection, or it broke.
    #[error("the connection to the controller is lost: {0}")]
    Disconnected(String),
    /// No response in time.
    #[error("the controller did not answer within {seconds} s when asked {request}")]
    Timeout {
        /// The request, as an infinitive with "to" or a noun with "for".
        request: String,
        /// Timeout (s).
        seconds: f64,
    },
    /// The controller is not armed.
    #[error("the controller is not armed: arm it before it may move or change values")]
    NotArmed,
    /// Another program is armed at the controller; states the evidence.
    #[error("another program is armed at the controller: {0}")]
    Occupied(String),
    /// The controller refuses the command at present.
    #[error("the controller refused: {0}")]
    Refused(String),
    /// The controller does not know the user, or denies access.
    #[error("the controller refused: {0}")]
    UnknownUser(String),
    /// The certificate of the controller's server is unknown, or another than the one that is trusted.
    #[error("{0}")]
    Untrusted(Box<UntrustedServer>),
    /// The controller reports a fault.
    #[error("the controller reports a fault: {0}")]
    Fault(String),
    /// The controller was restarted, so that its encoders have lost their zero; states the evidence.
    #[error(
        "the controller was restarted ({0}): its encoders have lost their zero. Poses measured before and after belong to separate series, each with its own homing"
    )]
    Restarted(String),
    /// A pose or tension is outside the limits.
    #[error("outside the limits: {0}")]
    Limit(String),
    /// There is no parameter with this name.
    #[error("the controller has no parameter \"{0}\"")]
    UnknownParameter(String),
    /// The parameter cannot have this value.
    #[error("parameter \"{name}\" cannot be {value}: {reason}")]
    InvalidValue {
        /// Name of the parameter.
        name: String,
        /// The value.
        value: f64,
        /// Reason.
        reason: String,
    },
    /// The external laser distance sensor cannot be used.
    #[error("the laser distance sensor: {0}")]
    Laser(String),
    /// A controller or run cannot be set up.
    #[error("{0}")]
    Setup(String),
}

impl LinkError {
    /// Whether the connection is lost and must be re-established.
    #[must_use]
    pub fn is_disconnection(&self) -> bool {
        matches!(self, Self::Disconnected(_))
    }
}
