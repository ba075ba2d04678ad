//! Passwords in the keyring of the desktop, by the program against a Secret Service that shares no code with it.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;
use tautline_session::{Folders, TrustedServers};
use tautline_validation::support::ads::{PASSWORD, Server, USER};
use tautline_validation::support::keyring::{SecretService, StoredItem};
use tautline_validation::support::program::{self, Answer, Folder};

use super::opcua_security::{content, measuring, server};

/// A user at a server that it trusts, with a session of its own.
struct Desk {
    server: Server,
    folder: Folder,
}

impl Desk {
    fn new() -> Self {
        let server = server(json!({"policies": ["Basic256Sha256_SignAndEncrypt"]}));
        let folder = Folder::new();
        let mut servers = TrustedServers::default();
        let fingerprint = server.fingerprint.expect("a certificate");
        servers.trust(&server.url().origin(), fingerprint);
        let path = Folders::below(folder.path()).trusted_servers();
        servers.write(&path).expect("written");
        Self { server, folder }
    }

    /// Item of the user in a keyring.
    fn item(&self, secret: &str) -> StoredItem {
        let service = format!("Tautline {}", self.server.url().origin());
        let attributes = [("service", service.as_str()), ("username", USER)];
        let attributes = attributes.map(|(name, value)| (name.to_owned(), value.to_owned()));
        StoredItem {
            attributes: attributes.into(),
            secret: secret.to_owned(),
        }
    }

    fn measure(&self, keyring: &SecretService, given: Option<&str>, more: &[&str]) -> Answer {
        let controller = self.server.url().to_string();
        let mut command = measuring(&self.folder, &controller, given, more);
        keyring.serve(&mut command);
        let answer = program::run(&mut command);
        assert!(!answer.stderr.contains(PASSWORD), "{}", answer.stderr);
        assert!(!content(self.folder.path()).contains(PASSWORD));
        answer
    }
}

/// Whether the user was accepted: the variables exist, but no program that takes part in arming.
fn is_accepted(answer: &Answer) -> bool {
    answer.stderr.contains("its time changed")
}

#[test]
fn a_password_is_kept_once_it_was_accepted_and_found_again() {
    let (desk, keyring) = (Desk::new(), SecretService::start(&[], false));
    let save = ["--save-password"];
    let wrong = desk.measure(&keyring, Some("wrong"), &save);
    assert!(
        wrong.stderr.contains("BadUserAccessDenied"),
        "{}",
        wrong.stderr
    );
    assert_eq!(keyring.items(), []);
    let unasked = desk.measure(&keyring, Some(PASSWORD), &[]);
    assert!(is_accepted(&unasked), "{}", unasked.stderr);
    assert_eq!(keyring.items(), []);
    let kept = desk.measure(&keyring, Some(PASSWORD), &save);
    assert!(kept.stderr.contains("is in the keyring"), "{}", kept.stderr);
    assert!(is_accepted(&kept), "{}", kept.stderr);
    assert_eq!(keyring.items(), [desk.item(PASSWORD)]);
    let found = desk.measure(&keyring, None, &[]);
    assert!(is_accepted(&found), "{}", found.stderr);
    // That of the environment comes first.
    let given = desk.measure(&keyring, Some("wrong"), &[]);
    assert!(
        given.stderr.contains("BadUserAccessDenied"),
        "{}",
        given.stderr
    );
    assert!(!given.stderr.contains("keyring"), "{}", given.stderr);
    let forgotten = desk.measure(&keyring, None, &["--forget-password"]);
    let told = &forgotten.stderr;
    assert!(told.contains("no longer in the keyring"), "{told}");
    assert!(
        told.contains("needs a password: set TAUTLINE_PASSWORD"),
        "{told}"
    );
    assert_eq!(keyring.items(), []);
}

#[test]
fn a_kept_password_that_is_refused_can_be_forgotten_and_replaced() {
    let desk = Desk::new();
    let other = StoredItem {
        secret: "of another server".to_owned(),
        attributes: [(
            "service".to_owned(),
            "Tautline opc.tcp://plc:4840".to_owned(),
        )]
        .into(),
    };
    let keyring = SecretService::start(&[other.clone(), desk.item("former")], false);
    let refused = desk.measure(&keyring, None, &[]);
    let advice = "--forget-password removes it";
    assert!(refused.stderr.contains(advice), "{}", refused.stderr);
    assert!(!refused.stderr.contains("former"), "{}", refused.stderr);
    let both = ["--forget-password", "--save-password"];
    let replaced = desk.measure(&keyring, Some(PASSWORD), &both);
    assert!(is_accepted(&replaced), "{}", replaced.stderr);
    assert_eq!(keyring.items(), [other, desk.item(PASSWORD)]);
}

#[test]
fn a_desktop_without_a_keyring_is_a_sentence_and_no_hang() {
    let desk = Desk::new();
    // Its bus is gone.
    let absent = SecretService::start(&[], false).gone();
    let quiet = ["--quiet"];
    let told = desk.measure(&absent, None, &quiet);
    told.refused(&[
        "needs a password: set TAUTLINE_PASSWORD",
        "the keyring of the desktop cannot be used",
    ]);
    let told = desk.measure(&absent, Some(PASSWORD), &["--save-password", "--quiet"]);
    told.refused(&["--save-password: the keyring of the desktop cannot be used"]);
    let accepted = desk.measure(&absent, Some(PASSWORD), &[]);
    assert!(is_accepted(&accepted), "{}", accepted.stderr);
    let silent = SecretService::start(&[], true);
    let begun = Instant::now();
    let told = desk.measure(&silent, None, &quiet);
    told.refused(&["has not answered within 30 s: unlock it first"]);
    assert!(begun.elapsed() < Duration::from_secs(120));
}

#[test]
fn options_for_passwords_need_a_user_with_one() {
    let folder = Folder::new();
    let file = folder.join("s.json");
    for option in ["--save-password", "--forget-password"] {
        for controller in ["sim", "opc.tcp://plc"] {
            let words = [
                "measure",
                &file,
                "--robot",
                "mini",
                "--poses",
                "8",
                "--arm",
                "--controller",
                controller,
                option,
            ];
            let parts = [option, "expected opc.tcp://HOST?user=NAME"];
            program::tautline(&words).refused(&parts);
        }
    }
    assert!(!Path::new(&file).exists());
}
