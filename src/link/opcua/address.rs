//! Address of an OPC UA controller.

use std::fmt;
use std::str::FromStr;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use tautline_session::{
    OpcUaPlace, OpcUaPolicy, OpcUaSecurity, UserCertificateFiles, without_user,
};

use super::passwords::Account;
use crate::error::LinkError;

/// Prefix of addresses.
const SCHEME: &str = "opc.tcp://";
/// Options with the files of a user's certificate.
const CERTIFICATE: &str = "user-certificate";
const KEY: &str = "user-key";
/// Characters of a user or a path that stand for themselves in an address.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'/')
    .remove(b'\\');

/// Address of a controller: `opc.tcp://HOST[:PORT][/PATH][?security=..&policy=..&user=NAME]`, or with
/// `user-certificate=FILE&user-key=FILE` in place of the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpcUaAddress {
    /// Host name or address.
    pub host: String,
    /// TCP port; 4840 by default.
    pub port: u16,
    /// Path with its leading slash; empty for most controllers.
    pub path: String,
    /// Protection of messages; without it the best that the server offers.
    pub security: Option<OpcUaSecurity>,
    /// Algorithms of the protection; without it the best that the server offers.
    pub policy: Option<OpcUaPolicy>,
    /// Name of the user; without it and a certificate an anonymous one.
    pub user: Option<String>,
    /// Certificate of the user, instead of a name.
    pub user_certificate: Option<UserCertificateFiles>,
}

impl OpcUaAddress {
    /// The address without path and options, under which a server is trusted.
    #[must_use]
    pub fn origin(&self) -> String {
        let Self { host, port, .. } = self;
        match host.contains(':') {
            true => format!("{SCHEME}[{host}]:{port}"),
            false => format!("{SCHEME}{}:{port}", host.to_lowercase()),
        }
    }

    /// The user with a password at the server.
    #[must_use]
    pub fn account(&self) -> Option<Account> {
        let user = self.user.clone()?;
        let server = self.origin();
        Some(Account { server, user })
    }

    /// The address without options, which names the controller however it is reached.
    #[must_use]
    pub fn url(&self) -> String {
        let Self {
            host, port, path, ..
        } = self;
        match host.contains(':') {
            true => format!("{SCHEME}[{host}]:{port}{path}"),
            false => format!("{SCHEME}{host}:{port}{path}"),
        }
    }

    /// The address as a session stores it, which may be opened in another folder.
    #[must_use]
    pub fn place(&self, timeout_s: f64) -> OpcUaPlace {
        let address = self.clone();
        OpcUaPlace {
            host: address.host,
            port: address.port,
            path: address.path,
            security: address.security,
            policy: address.policy,
            user: address.user,
            user_certificate: address.user_certificate.map(|files| files.absolute()),
            timeout_s,
        }
    }
}

impl From<&OpcUaPlace> for OpcUaAddress {
    fn from(place: &OpcUaPlace) -> Self {
        let place = place.clone();
        Self {
            host: place.host,
            port: place.port,
            path: place.path,
            security: place.security,
            policy: place.policy,
            user: place.user,
            user_certificate: place.user_certificate,
        }
    }
}

/// A value with the name `text`, or what was expected.
fn named<T: Copy + fmt::Display>(all: &[T], (key, text): (&str, &str)) -> Result<T, String> {
    let mut known = all.iter().copied();
    known
        .find(|value| value.to_string() == text)
        .ok_or_else(|| {
            let names: Vec<String> = all.iter().map(ToString::to_string).collect();
            format!("has {key}={text:?}, expected {}", names.join(", "))
        })
}

/// A text of an option, whose special characters are written as `%20`.
fn decoded((key, value): (&str, &str)) -> Result<String, String> {
    let text = percent_decode_str(value).decode_utf8();
    let text = text.map_err(|_| format!("has a {key} that is not UTF-8"))?;
    Ok(text.into_owned())
}

/// Options after the question mark.
fn read_options(address: &mut OpcUaAddress, query: &str) -> Result<(), String> {
    let (mut certificate, mut private_key) = (None, None);
    for option in query.split('&') {
        let (key, value) = option.split_once('=').unwrap_or((option, ""));
        match key {
            "security" => address.security = Some(named(&OpcUaSecurity::ALL, (key, value))?),
            "policy" => address.policy = Some(named(&OpcUaPolicy::ALL, (key, value))?),
            "user" => address.user = Some(decoded((key, value))?),
            CERTIFICATE => certificate = Some(decoded((key, value))?),
            KEY => private_key = Some(decoded((key, value))?),
            "password" => {
                return Err("has a password, which others could read there: give the user only, the password is asked for or taken from TAUTLINE_PASSWORD".to_owned());
            }
            // Its value is not shown, as it may be a secret.
            key => {
                return Err(format!(
                    "has an unknown option {key:?}, expected security, policy, user, {CERTIFICATE} or {KEY}"
                ));
            }
        }
    }
    address.user_certificate = match (certificate, private_key) {
        (Some(certificate), Some(key)) => Some(UserCertificateFiles { certificate, key }),
        (None, None) => None,
        (Some(_), None) => return Err(format!("has {CERTIFICATE}, expected {KEY} with it")),
        (None, Some(_)) => return Err(format!("has {KEY}, expected {CERTIFICATE} with it")),
    };
    let checked = address.place(1.0).check();
    checked.map_err(|error| format!("has an option that does not fit: {}", error.message))
}

impl FromStr for OpcUaAddress {
    type Err = LinkError;

    fn from_str(text: &str) -> Result<Self, LinkError> {
        let wrong = |what: &str| {
            LinkError::Setup(format!(
                "the address {:?} {what}, expected opc.tcp://HOST[:PORT], like opc.tcp://192.168.0.5:4840",
                without_user(text)
            ))
        };
        let rest = text.trim().strip_prefix(SCHEME);
        let rest = rest.ok_or_else(|| wrong("does not begin with opc.tcp://"))?;
        let (rest, query) = match rest.split_once('?') {
            Some((rest, query)) => (rest, Some(query)),
            None => (rest, None),
        };
        let (place, path) = rest.split_at(rest.find('/').unwrap_or(rest.len()));
        // A numeric IPv6 host contains colons and is written in brackets.
        let (host, port) = match place.rsplit_once(':') {
            Some((host, port)) if !port.ends_with(']') => {
                (host, port.parse().ok().filter(|port| *port != 0))
            }
            _ => (place, Some(OpcUaPlace::PORT)),
        };
        let host = host.trim_start_matches('[').trim_end_matches(']');
        let strange = |c: char| c.is_whitespace() || c.is_control() || c == '@';
        if host.is_empty() || rest.contains(strange) {
            return Err(wrong("has no host, or a character that is not allowed"));
        }
        let mut address = Self {
            host: host.to_owned(),
            port: port.ok_or_else(|| wrong("has an invalid port"))?,
            path: path.to_owned(),
            security: None,
            policy: None,
            user: None,
            user_certificate: None,
        };
        if let Some(query) = query {
            let options = read_options(&mut address, query);
            options.map_err(|what| {
                LinkError::Setup(format!("the address {:?} {what}", without_user(text)))
            })?;
        }
        Ok(address)
    }
}

impl fmt::Display for OpcUaAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.url())?;
        let encoded = |text: &str| utf8_percent_encode(text, PLAIN).to_string();
        let files = self.user_certificate.as_ref();
        let options = [
            (
                "security",
                self.security.map(|security| security.to_string()),
            ),
            ("policy", self.policy.map(|policy| policy.to_string())),
            ("user", self.user.as_deref().map(encoded)),
            (CERTIFICATE, files.map(|files| encoded(&files.certificate))),
            (KEY, files.map(|files| encoded(&files.key))),
        ];
        let options = options
            .into_iter()
            .filter_map(|(key, value)| Some((key, value?)));
        for (k, (key, value)) in options.enumerate() {
            let sign = if k == 0 { '?' } else { '&' };
            write!(f, "{sign}{key}={value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_shown() {
        for (text, shown) in [
            ("opc.tcp://plc", "opc.tcp://plc:4840"),
            ("opc.tcp://10.0.0.5:4841", "opc.tcp://10.0.0.5:4841"),
            (
                "opc.tcp://[fe80::1]/UA/Server",
                "opc.tcp://[fe80::1]:4840/UA/Server",
            ),
            (
                "opc.tcp://plc?security=SignAndEncrypt&policy=Basic256Sha256&user=PLANT\\anna",
                "opc.tcp://plc:4840?security=SignAndEncrypt&policy=Basic256Sha256&user=PLANT\\anna",
            ),
            (
                "opc.tcp://plc/UA?user=anna%20%26%20co@plant",
                "opc.tcp://plc:4840/UA?user=anna%20%26%20co%40plant",
            ),
            (
                "opc.tcp://plc?user-key=/home/anna/own key.pem&user-certificate=C:\\anna.der",
                "opc.tcp://plc:4840?user-certificate=C%3A\\anna.der&user-key=/home/anna/own%20key.pem",
            ),
        ] {
            let address: OpcUaAddress = text.parse().expect(text);
            assert_eq!(address.to_string(), shown);
            assert_eq!(shown.parse(), Ok(address));
        }
        for (text, why) in [
            ("plc:4840", "does not begin"),
            ("opc.tcp://", "has no host"),
            ("opc.tcp://plc:0", "an invalid port"),
            ("opc.tcp://user:secret@plc", "not allowed"),
            (
                "opc.tcp://plc?password=secret",
                "has a password, which others",
            ),
            ("opc.tcp://plc?pass=secret", "an unknown option \"pass\""),
            (
                "opc.tcp://plc?user=",
                "found \"\", expected the name of a user",
            ),
            (
                "opc.tcp://plc?security=yes",
                "expected None, Sign, SignAndEncrypt",
            ),
            (
                "opc.tcp://plc?policy=Basic256",
                "Aes128_Sha256_RsaOaep, Basic256Sha256",
            ),
            (
                "opc.tcp://plc?security=None&policy=Basic256Sha256",
                "without security, expected no policy",
            ),
            (
                "opc.tcp://plc?user-certificate=anna.der",
                "has user-certificate, expected user-key with it",
            ),
            (
                "opc.tcp://plc?user-certificate=anna.der&user-key=",
                "expected the file with the private key",
            ),
            (
                "opc.tcp://plc?user=anna&user-certificate=a&user-key=b",
                "a certificate names its user",
            ),
        ] {
            let told = text.parse::<OpcUaAddress>().expect_err(text).to_string();
            assert!(told.contains(why), "{text}: {told}");
            assert!(!told.contains("secret"), "{told}");
        }
    }
}
