//! Certificates: their fields, and the check of a server's certificate.

use std::net::IpAddr;
use std::time::SystemTime;

use opcua_crypto::{KeySize, PublicKey, Thumbprint, X509};
use tautline_session::CertificateFingerprint;
use x509_cert::Certificate;
use x509_cert::der::{Decode, Encode, Header, SliceReader};
use x509_cert::ext::pkix::name::GeneralName;
use x509_cert::ext::pkix::{ExtendedKeyUsage, KeyUsage, SubjectAltName};
use x509_cert::time::Time;

use crate::error::LinkError;

/// Sizes of keys that the policies allow (bits).
const KEY_BITS: std::ops::RangeInclusive<usize> = 2048..=4096;
/// Uses of a key, by their identifiers: server authentication, and any.
const SERVER_USES: [&str; 2] = ["1.3.6.1.5.5.7.3.1", "2.5.29.37.0"];

/// The reason why the size of a key is not allowed by the policies, as the rest of a sentence.
pub(super) fn size_problem(key: &PublicKey) -> Option<String> {
    let bits = key.bit_length();
    let (low, high) = (KEY_BITS.start(), KEY_BITS.end());
    (!KEY_BITS.contains(&bits))
        .then(|| format!("has a key of {bits} bits, expected {low} to {high}"))
}

/// The fields of a certificate.
pub(super) struct Fields(Certificate);

impl Fields {
    /// The fields; `None` if it is no certificate.
    pub fn of(der: &[u8]) -> Option<Self> {
        Certificate::from_der(der).ok().map(Self)
    }

    fn names(&self) -> Vec<GeneralName> {
        let names = self.0.tbs_certificate.get::<SubjectAltName>();
        names
            .ok()
            .flatten()
            .map_or(Vec::new(), |(_, names)| names.0)
    }

    /// Name of the application.
    pub fn uri(&self) -> Option<String> {
        self.names().into_iter().find_map(|name| match name {
            GeneralName::UniformResourceIdentifier(uri) => Some(uri.to_string()),
            _ => None,
        })
    }

    /// Names and addresses of the computer.
    fn hosts(&self) -> Vec<String> {
        let hosts = self.names().into_iter().filter_map(|name| match name {
            GeneralName::DnsName(name) => Some(name.to_string()),
            GeneralName::IpAddress(bytes) => {
                let bytes = bytes.as_bytes();
                let short = <[u8; 4]>::try_from(bytes).map(IpAddr::from);
                let address = short.or_else(|_| <[u8; 16]>::try_from(bytes).map(IpAddr::from));
                address.ok().map(|address| address.to_string())
            }
            _ => None,
        });
        hosts.collect()
    }

    /// The last day on which it is valid.
    pub fn last_day(&self) -> String {
        day(&self.0.tbs_certificate.validity.not_after)
    }

    /// The reason why the certificate is not valid at a time, as the rest of a sentence that begins with the certificate;
    /// `advice` is for an expired one.
    pub fn time_problem(&self, now: SystemTime, advice: &str) -> Option<String> {
        let validity = &self.0.tbs_certificate.validity;
        if now > validity.not_after.to_system_time() {
            return Some(format!("expired on {}: {advice}", self.last_day()));
        }
        let first = validity.not_before.to_system_time();
        (now < first).then(|| {
            format!(
                "is valid only from {}: check the clocks of this computer and of the server",
                day(&validity.not_before)
            )
        })
    }

    /// The reason why it is not the certificate of a host.
    fn host_problem(&self, host: &str) -> Option<String> {
        let hosts = self.hosts();
        let address = host.parse::<IpAddr>().ok();
        let is_same = |known: &String| match address {
            Some(address) => known.parse() == Ok(address),
            None => known.eq_ignore_ascii_case(host),
        };
        if hosts.iter().any(is_same) {
            return None;
        }
        Some(match hosts.is_empty() {
            true => format!(
                "names no computer, expected {host:?}: make one at the server that names it"
            ),
            false => format!(
                "is that of {}, expected {host:?}: connect under a name that it has, or make one at the server that names this one",
                hosts.join(", ").escape_debug()
            ),
        })
    }

    /// The reason why it is not the certificate of the application named by the server, if it names one.
    fn application_problem(&self, application: &str) -> Option<String> {
        let own = self.uri().unwrap_or_default();
        (own != application && !application.is_empty()).then(|| {
            let (own, application) = (own.escape_debug(), application.escape_debug());
            format!("is that of the application \"{own}\", expected \"{application}\": make one at the server with the name that it states")
        })
    }

    /// The reason why its key may not be used for server authentication.
    fn use_problem(&self) -> Option<String> {
        let fields = &self.0.tbs_certificate;
        let Ok(usage) = fields.get::<KeyUsage>() else {
            return Some("has uses of its key that cannot be read".to_owned());
        };
        let is_fit = |usage: &KeyUsage| {
            usage.digital_signature() && (usage.key_encipherment() || usage.data_encipherment())
        };
        if usage.is_some_and(|(_, usage)| !is_fit(&usage)) {
            return Some("is not made for this: its key may not both sign and encrypt".to_owned());
        }
        let Ok(purposes) = fields.get::<ExtendedKeyUsage>() else {
            return Some("has purposes that cannot be read".to_owned());
        };
        let is_server = |purposes: &ExtendedKeyUsage| {
            let mut purposes = purposes.0.iter().map(ToString::to_string);
            purposes.any(|purpose| SERVER_USES.contains(&purpose.as_str()))
        };
        purposes
            .is_some_and(|(_, purposes)| !is_server(&purposes))
            .then(|| "is not made for this: it is not that of a server".to_owned())
    }
}

fn day(time: &Time) -> String {
    time.to_string().chars().take(10).collect()
}

/// The certificate of a server.
#[derive(Debug, Clone)]
pub(super) struct ServerCertificate {
    der: Vec<u8>,
    certificate: X509,
    key: PublicKey,
}

impl ServerCertificate {
    /// The certificate that a server sent, which may be followed by those of its issuers.
    pub fn read(sent: &[u8]) -> Result<Self, LinkError> {
        let wrong = |what: String| LinkError::Refused(format!("its certificate {what}"));
        let unreadable = || wrong("cannot be read".to_owned());
        let der = first(sent).ok_or_else(unreadable)?;
        let certificate = X509::from_der(der).map_err(|_| unreadable())?;
        // The crate computes thumbprints from a new encoding of the certificate.
        if certificate.to_der().ok().as_deref() != Some(der) {
            return Err(wrong("is not encoded as the standard demands".to_owned()));
        }
        let key = certificate
            .public_key()
            .map_err(|_| wrong("has a key of another kind than RSA".to_owned()))?;
        if let Some(problem) = size_problem(&key) {
            return Err(wrong(problem));
        }
        Ok(Self {
            der: der.to_vec(),
            certificate,
            key,
        })
    }

    /// Checks it for a server on this host, with this application name, at this time; the error is a sentence.
    pub fn check(
        &self,
        (host, application): (&str, &str),
        now: SystemTime,
    ) -> Result<(), LinkError> {
        let fields = Fields::of(&self.der);
        let problem = match fields {
            None => Some("cannot be read".to_owned()),
            Some(fields) => fields
                .time_problem(now, "make a new one at the server and trust that")
                .or_else(|| fields.host_problem(host))
                .or_else(|| fields.application_problem(application))
                .or_else(|| fields.use_problem()),
        };
        problem.map_or(Ok(()), |what| {
            Err(LinkError::Refused(format!("its certificate {what}")))
        })
    }

    /// Whether a server sent this certificate, possibly followed by those of its issuers.
    pub fn is(&self, sent: &[u8]) -> bool {
        first(sent) == Some(&self.der)
    }

    pub fn der(&self) -> &[u8] {
        &self.der
    }

    pub fn x509(&self) -> &X509 {
        &self.certificate
    }

    pub fn key(&self) -> &PublicKey {
        &self.key
    }

    pub fn fingerprint(&self) -> CertificateFingerprint {
        CertificateFingerprint::of(&self.der)
    }

    pub fn thumbprint(&self) -> Thumbprint {
        self.certificate.thumbprint()
    }
}

/// The first of several certificates.
fn first(chain: &[u8]) -> Option<&[u8]> {
    let mut reader = SliceReader::new(chain).ok()?;
    let header = Header::decode(&mut reader).ok()?;
    let length = (header.encoded_len().ok()? + header.length).ok()?;
    chain.get(..usize::try_from(length).ok()?)
}
