//! Keys for tests, made once.

use std::sync::{Arc, LazyLock};

use super::certificate::ServerCertificate;
use super::identity::ClientIdentity;

static CLIENT: LazyLock<Arc<ClientIdentity>> = LazyLock::new(made);
static SERVER: LazyLock<Arc<ClientIdentity>> = LazyLock::new(made);

fn made() -> Arc<ClientIdentity> {
    Arc::new(ClientIdentity::create().expect("a key"))
}

pub fn client() -> Arc<ClientIdentity> {
    Arc::clone(&CLIENT)
}

pub fn server() -> Arc<ClientIdentity> {
    Arc::clone(&SERVER)
}

/// The certificate of an identity as the other end sees it.
pub fn certificate_of(identity: &ClientIdentity) -> ServerCertificate {
    ServerCertificate::read(identity.certificate()).expect("a certificate")
}
