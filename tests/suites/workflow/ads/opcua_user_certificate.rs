//! Users of OPC UA who sign in with a certificate, against asyncua; the certificates are those of the package cryptography.

use std::path::Path;

use serde_json::{Value, json};
use tautline_link::opcua::{Credentials, OpcUaAddress};
use tautline_link::{Controller, LinkError, LinkProtection};
use tautline_session::{OpcUaPolicy, OpcUaSecurity, UserCertificateFiles, read_session};
use tautline_validation::support::ads::{Server, TestKeys, user_certificates};
use tautline_validation::support::program::{self, Folder};

use super::opcua_security::{POLICIES, client, measuring, refused, server};

/// Certificates and keys of users.
struct Users(Folder);

impl Users {
    fn new() -> Self {
        let folder = Folder::new();
        user_certificates(folder.path());
        Self(folder)
    }

    fn files(&self, certificate: &str, key: &str) -> UserCertificateFiles {
        UserCertificateFiles {
            certificate: self.0.join(certificate),
            key: self.0.join(key),
        }
    }

    /// A server that knows Anna and the user with the long key by their certificates.
    fn server(&self, mut security: Value) -> Server {
        security["certified"] = json!([self.0.join("anna.der"), self.0.join("long.der")]);
        server(security)
    }
}

fn address(server: &Server, user: UserCertificateFiles) -> OpcUaAddress {
    OpcUaAddress {
        user: None,
        user_certificate: Some(user),
        ..server.url()
    }
}

/// Keys and trust without a password.
fn keys(server: &Server) -> Credentials {
    Credentials {
        password: None,
        ..server.credentials()
    }
}

#[test]
fn a_certificate_signs_in_under_every_policy() {
    let users = Users::new();
    let server = users.server(json!({ "policies": POLICIES }));
    for policy in OpcUaPolicy::ALL {
        for security in [OpcUaSecurity::Sign, OpcUaSecurity::SignAndEncrypt] {
            for user in [
                users.files("anna.der", "pkcs8.pem"),
                users.files("long.pem", "long.key"),
            ] {
                let address = OpcUaAddress {
                    security: Some(security),
                    policy: Some(policy),
                    ..address(&server, user)
                };
                let mut client = client(address, keys(&server), 20.0);
                client.connect().expect("connected");
                client.sample().expect("a sample");
            }
        }
    }
}

#[test]
fn certificates_and_keys_are_taken_in_their_usual_forms() {
    let users = Users::new();
    let server = users.server(json!({"policies": ["Basic256Sha256_SignAndEncrypt"]}));
    for certificate in ["anna.der", "anna.pem"] {
        for key in ["pkcs8.der", "pkcs8.pem", "pkcs1.der", "pkcs1.pem"] {
            let address = address(&server, users.files(certificate, key));
            let mut client = client(address, keys(&server), 20.0);
            client.connect().expect("connected");
            client.sample().expect("a sample");
        }
    }
}

#[test]
fn without_a_channel_security_the_policy_of_the_token_decides() {
    let users = Users::new();
    let open = |server: &Server| OpcUaAddress {
        security: Some(OpcUaSecurity::None),
        ..address(server, users.files("anna.der", "anna.key"))
    };
    // The token has a policy of its own: the signature is made under it, for the trusted certificate of the server alone.
    let both = users.server(json!({"policies": ["NoSecurity", "Basic256Sha256_SignAndEncrypt"]}));
    let mut client = client(open(&both), keys(&both), 20.0);
    client.connect().expect("connected");
    assert_eq!(client.protection(), Some(LinkProtection::Open));
    let unknown = Credentials {
        password: None,
        ..TestKeys::default().with_password("")
    };
    let error = refused(open(&both), unknown);
    assert!(matches!(error, LinkError::Untrusted(_)), "{error}");
    // Without one nothing would prove that the key belongs to the user.
    for policy in ["", "http://opcfoundation.org/UA/SecurityPolicy#None"] {
        let bare = users.server(json!({
            "policies": ["NoSecurity", "Basic256Sha256_SignAndEncrypt"],
            "token_policy": policy,
        }));
        let told = refused(open(&bare), keys(&bare)).to_string();
        assert!(told.contains("without a signature"), "{told}");
    }
    // asyncua does not offer such a token where it has no policy for it.
    let none = users.server(json!({"policies": ["NoSecurity"]}));
    let told = refused(open(&none), keys(&none)).to_string();
    assert!(told.contains("takes no users with a certificate"), "{told}");
}

#[test]
fn what_a_token_without_a_policy_means_is_that_of_the_channel() {
    let users = Users::new();
    let server = users.server(json!({
        "policies": ["Aes256Sha256RsaPss_SignAndEncrypt"],
        "token_policy": "",
    }));
    let address = address(&server, users.files("anna.der", "anna.key"));
    let mut client = client(address, keys(&server), 20.0);
    client.connect().expect("connected");
}

#[test]
fn a_user_that_cannot_sign_in_is_told_why() {
    let users = Users::new();
    let server = users.server(json!({"policies": ["Basic256Sha256_SignAndEncrypt"]}));
    for (certificate, key, parts) in [
        ("missing.der", "anna.key", &["missing.der", "not found"][..]),
        ("anna.der", "missing.key", &["missing.key", "not found"]),
        ("anna.key", "anna.key", &["anna.key", "no certificate"]),
        ("anna.der", "otto.pem", &["otto.pem", "no private key"]),
        (
            "anna.der",
            "otto.key",
            &["otto.key", "does not belong to the certificate", "anna.der"],
        ),
        ("anna.der", "curve.key", &["curve.key", "one of RSA"]),
        (
            "curve.der",
            "anna.key",
            &["curve.der", "of another kind than RSA"],
        ),
        (
            "short.der",
            "short.key",
            &["short.der", "1024 bits, expected 2048 to 4096"],
        ),
        (
            "expired.der",
            "expired.key",
            &["expired.der", "expired on 2021-01-01"],
        ),
        (
            "anna.der",
            "encrypted.pem",
            &["encrypted.pem", "without a password", "openssl pkey -in"],
        ),
        ("anna.der", "encrypted.der", &["openssl pkey -in"]),
        ("anna.der", "old.pem", &["openssl pkey -in"]),
        (
            "otto.der",
            "otto.key",
            &[
                "does not know the user of the certificate",
                "otto.der",
                "BadUserAccessDenied",
            ],
        ),
    ] {
        let told = refused(
            address(&server, users.files(certificate, key)),
            keys(&server),
        )
        .to_string();
        for part in parts {
            assert!(told.contains(part), "{told} lacks {part}");
        }
        assert!(!told.contains("-----BEGIN"), "{told}");
    }
    let named = super::opcua_security::server(json!({
        "policies": ["Basic256Sha256_SignAndEncrypt"]
    }));
    let told = refused(
        address(&named, users.files("anna.der", "anna.key")),
        keys(&named),
    );
    let told = told.to_string();
    assert!(told.contains("takes no users with a certificate"), "{told}");
}

#[test]
fn a_session_keeps_the_paths_of_a_user_and_never_the_key() {
    let users = Users::new();
    let server = users.server(json!({"policies": ["Basic256Sha256_SignAndEncrypt"]}));
    let folder = Folder::new();
    let fingerprint = server.fingerprint.expect("a certificate").to_string();
    // Relative to the folder of the command, which is not that of the session.
    let address = OpcUaAddress {
        user: None,
        ..server.url()
    };
    let controller = format!("{address}?user-certificate=anna.pem&user-key=anna.key");
    let trusting = ["--trust-server", &fingerprint];
    let mut command = measuring(&folder, &controller, None, &trusting);
    command.current_dir(users.0.path());
    let answer = program::run(&mut command);
    // The variables exist, but no program that takes part in arming.
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("its time changed"),
        "{}",
        answer.stderr
    );
    #[cfg(unix)]
    assert!(
        answer
            .stderr
            .contains("anna.key can be read by other users"),
        "{}",
        answer.stderr
    );
    let file = folder.join("s.json");
    let session = read_session(Path::new(&file)).expect("a session").value;
    let place = session.connection.opcua.expect("an address");
    let expected = users.files("anna.pem", "anna.key");
    assert_eq!(place.user_certificate, Some(expected));
    let secret = std::fs::read_to_string(users.0.join("anna.key")).expect("a key");
    let line = secret.lines().nth(1).expect("a line");
    let saved = std::fs::read_to_string(&file).expect("a session");
    assert!(!saved.contains(line) && !answer.stderr.contains(line));
}
