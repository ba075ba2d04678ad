//! Security of OPC UA against asyncua: policies, users, certificates, keys that expire.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tautline_core::robot::presets;
use tautline_link::opcua::{Credentials, OpcUaAddress, OpcUaOptions, OpcUaServer, controller};
use tautline_link::symbols::SymbolController;
use tautline_link::{Controller, LinkError, LinkProtection, SystemClock};
use tautline_session::{
    CertificateFingerprint, OpcUaPolicy, OpcUaSecurity, SymbolMapping, write_symbols,
};
use tautline_validation::support::ads::symbols::{Style, declarations, global, mapping};
use tautline_validation::support::ads::{PASSWORD, Protocol, Server, TestKeys, USER};
use tautline_validation::support::program::{self, Folder};

/// All policies of the server.
pub(super) const POLICIES: [&str; 6] = [
    "Aes128Sha256RsaOaep_Sign",
    "Aes128Sha256RsaOaep_SignAndEncrypt",
    "Basic256Sha256_Sign",
    "Basic256Sha256_SignAndEncrypt",
    "Aes256Sha256RsaPss_Sign",
    "Aes256Sha256RsaPss_SignAndEncrypt",
];

/// A server with the variables of a controller.
pub(super) fn server(mut security: Value) -> Server {
    security["user"] = json!([USER, PASSWORD]);
    let server = Server::with_security(Protocol::OpcUaEncrypted, Some(&security));
    let robot = presets::find("mini").expect("a preset").robot;
    server.order(json!({ "declare": declarations(&robot, Style::Arrays) }));
    server
}

fn encrypted(certificate: Value) -> Server {
    server(json!({"policies": ["Basic256Sha256_SignAndEncrypt"], "certificate": certificate}))
}

pub(super) fn client(
    address: OpcUaAddress,
    credentials: Credentials,
    timeout_s: f64,
) -> SymbolController {
    let robot = presets::find("mini").expect("a preset").robot;
    let mapping: SymbolMapping = Protocol::OpcUa.mapping(&mapping(&robot, Style::Arrays));
    let server = OpcUaServer {
        address,
        options: OpcUaOptions {
            timeout_s,
            acknowledge_s: timeout_s,
        },
        credentials,
    };
    let clock = std::sync::Arc::new(SystemClock::start());
    controller(server, &mapping, &robot, clock).expect("a mapping that fits")
}

/// Reason why a client cannot connect.
pub(super) fn refused(address: OpcUaAddress, credentials: Credentials) -> LinkError {
    let mut client = client(address, credentials, 20.0);
    let error = client.connect().expect_err("refused");
    assert_eq!(client.protection(), None);
    let told = error.to_string();
    assert!(!told.contains(PASSWORD), "{told}");
    error
}

#[test]
fn every_policy_signs_or_encrypts_what_is_read_and_written() {
    let server = server(json!({ "policies": POLICIES }));
    for policy in OpcUaPolicy::ALL {
        for security in [OpcUaSecurity::Sign, OpcUaSecurity::SignAndEncrypt] {
            let address = OpcUaAddress {
                security: Some(security),
                policy: Some(policy),
                ..server.url()
            };
            let mut client = client(address, server.credentials(), 20.0);
            client.connect().expect("connected");
            client.sample().expect("a sample");
            let writes = server.count("write");
            // The release is written; no program behind the variables counts the time.
            let told = client.arm().expect_err("no program").to_string();
            assert!(told.contains("its time changed 0 times"), "{told}");
            assert!(server.count("write") > writes, "{policy} {security}");
            let what = match security {
                OpcUaSecurity::SignAndEncrypt => "Signed and encrypted",
                _ => "Signed, not encrypted",
            };
            let words = format!("{what} with {policy}");
            assert_eq!(client.protection(), Some(LinkProtection::Protected(words)));
        }
    }
    let mut client = client(server.url(), server.credentials(), 20.0);
    client.connect().expect("connected");
    let best = "Signed and encrypted with Aes256_Sha256_RsaPss".to_owned();
    assert_eq!(client.protection(), Some(LinkProtection::Protected(best)));
}

#[test]
fn keys_are_renewed_before_they_expire() {
    let server = server(json!({
        "policies": ["Basic256Sha256_SignAndEncrypt"],
        "lifetime_ms": 4000,
    }));
    let mut client = client(server.url(), server.credentials(), 3.0);
    client.connect().expect("connected");
    // Live values are in transit meanwhile, under the previous keys.
    client.subscribe(0.05).expect("it sends");
    for turn in 0..3 {
        std::thread::sleep(Duration::from_millis(3100));
        server.order(json!({"set": {global("time"): [f64::from(turn)]}}));
        client.sample().expect("a sample under the next keys");
    }
    let begun = Instant::now();
    let mut times: Vec<f64> = Vec::new();
    while !times.contains(&1.0) {
        assert!(begun.elapsed() < Duration::from_secs(60), "{times:?}");
        let sent = client.sent().expect("a connection");
        times.extend(sent.iter().map(|sample| sample.time_s));
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(times.ends_with(&[0.0, 1.0]), "{times:?}");
}

#[test]
fn users_are_known_by_name_and_password() {
    let server = encrypted(json!({}));
    let trusted = || {
        let fingerprint = server.fingerprint.expect("a certificate");
        TestKeys::trusting(&server.url().origin(), fingerprint)
    };
    for (user, password) in [(USER, "wrong"), ("otto", PASSWORD)] {
        let address = OpcUaAddress {
            user: Some(user.to_owned()),
            ..server.url()
        };
        let told = refused(address, trusted().with_password(password)).to_string();
        let expected = format!("it does not know the user {user:?} with this password");
        assert!(told.contains(&expected), "{told}");
    }
    let without = Credentials {
        password: None,
        ..trusted().with_password("")
    };
    let told = refused(server.url(), without).to_string();
    assert!(
        told.contains("the user \"anna\" needs a password"),
        "{told}"
    );
    let anonymous = OpcUaAddress {
        user: None,
        ..server.url()
    };
    let told = refused(anonymous, trusted().with_password("")).to_string();
    assert!(told.contains("it takes no anonymous clients"), "{told}");
}

#[test]
fn a_certificate_is_refused_until_it_is_trusted_and_again_when_it_changes() {
    let server = encrypted(json!({}));
    let fingerprint = server.fingerprint.expect("a certificate");
    let error = refused(server.url(), TestKeys::default().with_password(PASSWORD));
    let LinkError::Untrusted(unknown) = error else {
        panic!("{error}");
    };
    assert_eq!((unknown.fingerprint, unknown.known), (fingerprint, None));
    assert!(
        unknown.to_string().contains("is not trusted yet"),
        "{unknown}"
    );
    assert!(
        unknown.to_string().contains(&fingerprint.to_string()),
        "{unknown}"
    );
    let other = CertificateFingerprint::of(b"another");
    let keys = TestKeys::trusting(&server.url().origin(), other);
    let error = refused(server.url(), keys.with_password(PASSWORD));
    let LinkError::Untrusted(changed) = error else {
        panic!("{error}");
    };
    assert_eq!(changed.known, Some(other));
    assert!(changed.to_string().contains("has changed"), "{changed}");
}

#[test]
fn certificates_that_do_not_fit_are_refused_in_a_sentence_each() {
    for (wrong, why) in [
        (
            json!({"until": 2021}),
            "its certificate expired on 2021-01-01",
        ),
        (
            json!({"host": "127.0.0.2"}),
            "its certificate is that of plc, 127.0.0.2, expected \"127.0.0.1\"",
        ),
        (
            json!({"application": "urn:other"}),
            "its certificate is that of the application \"urn:other\", expected \"urn:tests\"",
        ),
        (json!({"purpose": "4"}), "it is not that of a server"),
        (
            json!({"signs": false}),
            "its key may not both sign and encrypt",
        ),
        (
            json!({"bits": 1024}),
            "has a key of 1024 bits, expected 2048 to 4096",
        ),
    ] {
        let server = encrypted(wrong);
        let told = refused(server.url(), server.credentials()).to_string();
        assert!(told.contains(why), "{told} lacks {why}");
    }
}

#[test]
fn long_keys_have_room_for_their_padding() {
    let server = server(json!({"policies": POLICIES, "certificate": {"bits": 4096}}));
    let mut client = client(server.url(), server.credentials(), 20.0);
    client.connect().expect("connected");
    client.sample().expect("a sample");
}

#[test]
fn what_is_not_offered_is_said_with_what_is() {
    let server = encrypted(json!({}));
    let address = OpcUaAddress {
        security: Some(OpcUaSecurity::Sign),
        ..server.url()
    };
    let told = refused(address, server.credentials()).to_string();
    let expected = "it does not offer security Sign; it offers SignAndEncrypt with Basic256Sha256";
    assert!(told.contains(expected), "{told}");
}

#[test]
fn a_trusted_server_that_offers_no_security_any_more_is_refused() {
    let server = Server::start(Protocol::OpcUa);
    let fingerprint = CertificateFingerprint::of(b"that it had");
    let keys = || TestKeys::trusting(&server.url().origin(), fingerprint).with_password("");
    let told = refused(server.url(), keys()).to_string();
    assert!(told.contains("it offers no security any more"), "{told}");
    let intended = OpcUaAddress {
        security: Some(OpcUaSecurity::None),
        ..server.url()
    };
    let mut client = client(intended, keys(), 20.0);
    // Without the variables of a controller: the connection itself is what matters.
    let told = client.connect().expect_err("no variables").to_string();
    assert!(told.contains("of the symbols"), "{told}");
}

#[test]
fn a_password_is_never_sent_where_others_can_read_it() {
    let open = |server: &Server| OpcUaAddress {
        security: Some(OpcUaSecurity::None),
        ..server.url()
    };
    let bare = server(json!({"policies": ["NoSecurity"]}));
    let told = refused(open(&bare), bare.credentials()).to_string();
    assert!(
        told.contains("without encryption that Tautline has"),
        "{told}"
    );
    // A server that accepts the password encrypted also accepts it on an open channel.
    let both = server(json!({"policies": ["NoSecurity", "Basic256Sha256_SignAndEncrypt"]}));
    let mut client = client(open(&both), both.credentials(), 20.0);
    client.connect().expect("connected");
    assert_eq!(client.protection(), Some(LinkProtection::Open));
    let unknown = TestKeys::default().with_password(PASSWORD);
    let error = refused(open(&both), unknown);
    assert!(matches!(error, LinkError::Untrusted(_)), "{error}");
}

/// Everything below a folder, as text.
pub(super) fn content(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let texts = entries.map(|entry| {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => content(&path),
            false => String::from_utf8_lossy(&std::fs::read(&path).expect("a file")).into_owned(),
        }
    });
    texts.collect()
}

/// The program that measures at a server, for a user whose files and session `s.json` are in a folder.
pub(super) fn measuring(
    folder: &Folder,
    controller: &str,
    password: Option<&str>,
    more: &[&str],
) -> Command {
    let (file, symbols) = (folder.join("s.json"), folder.join("nodes.json"));
    let robot = presets::find("mini").expect("a preset").robot;
    let nodes = Protocol::OpcUa.mapping(&mapping(&robot, Style::Arrays));
    write_symbols(Path::new(&symbols), &nodes).expect("written");
    let words = ["measure", &file, "--robot", "mini", "--poses", "8", "--arm"];
    let link = ["--controller", controller, "--symbols", &symbols];
    let patience = ["--timeout", "20"];
    let mut command = program::command(&[&words[..], &link, &patience, more].concat());
    command.env("TAUTLINE_HOME", folder.path());
    match password {
        Some(password) => command.env("TAUTLINE_PASSWORD", password),
        None => command.env_remove("TAUTLINE_PASSWORD"),
    };
    command
}

#[test]
fn a_server_is_trusted_and_a_password_given_on_the_command_line() {
    let server = encrypted(json!({}));
    let folder = Folder::new();
    let controller = server.url().to_string();
    assert!(controller.ends_with("?user=anna"), "{controller}");
    let measure = |password: Option<&str>, more: &[&str]| {
        let more = [&["--quiet"], more].concat();
        program::run(&mut measuring(&folder, &controller, password, &more))
    };
    let fingerprint = server.fingerprint.expect("a certificate").to_string();
    measure(None, &[]).refused(&["the user \"anna\" needs a password", "TAUTLINE_PASSWORD"]);
    let unknown = measure(Some(PASSWORD), &[]);
    assert_eq!(unknown.code, Some(1), "{}", unknown.stderr);
    let advice = format!("add --trust-server {fingerprint}");
    assert!(unknown.stderr.contains(&advice), "{}", unknown.stderr);
    let wrong = ["--trust-server", "12:34"];
    measure(Some(PASSWORD), &wrong).refused(&["--trust-server: found \"12:34\"", "SHA-256"]);
    let trusting = ["--trust-server", &fingerprint];
    let refused = measure(Some("wrong"), &trusting);
    assert!(
        refused.stderr.contains("BadUserAccessDenied"),
        "{}",
        refused.stderr
    );
    // The variables exist, but no program that takes part in arming.
    let alone = measure(Some(PASSWORD), &[]);
    assert_eq!(alone.code, Some(1), "{}", alone.stderr);
    assert!(alone.stderr.contains("time"), "{}", alone.stderr);
    for told in [&unknown, &refused, &alone] {
        assert!(!told.stderr.contains(PASSWORD), "{}", told.stderr);
    }
    assert!(!content(folder.path()).contains(PASSWORD));
}

#[test]
fn the_certificate_is_shown_and_exported() {
    let folder = Folder::new();
    let (home, out) = (folder.join("home"), folder.join("tautline.der"));
    let run = |words: &[&str]| {
        program::run(program::command(words).env("TAUTLINE_HOME", &home)).succeeded()
    };
    let shown = run(&["certificate"]).stdout;
    assert!(shown.contains("application: urn:"), "{shown}");
    run(&["certificate", "-o", &out]);
    let der = std::fs::read(&out).expect("a certificate");
    let fingerprint = CertificateFingerprint::of(&der).to_string();
    assert!(
        shown.contains(&fingerprint),
        "the same at each call: {shown}"
    );
    assert!(!shown.contains("PRIVATE"), "{shown}");
}
