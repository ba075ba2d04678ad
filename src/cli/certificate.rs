//! `tautline certificate`.

use anyhow::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_link::opcua::KeyStore;
use tautline_session::{Folders, VersionedFile};
use tautline_workflow::controllers::UserKeys;

use crate::examples::examples;
use crate::live::link_error;
use crate::output::{JsonOutput, confirm, say, write_file};
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What to compare at the server", "tautline certificate"),
    ("A file for the server's list of trusted clients", "tautline certificate -o tautline.der"),
]))]
pub struct Arguments {
    /// File to write the certificate to, in the binary form (DER) that servers read
    #[arg(short, long, value_name = "FILE.der")]
    out: Option<OutputFile>,
    #[command(flatten)]
    json: JsonOutput<CertificateDocument>,
}

/// The certificate with which this computer connects to OPC UA servers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CertificateDocument {
    /// File that keeps it with its private key.
    pub kept_in: String,
    /// Address of the application.
    pub application: String,
    /// Last day on which it is valid.
    pub valid_until: String,
    /// SHA-256 fingerprint.
    pub sha256: String,
    /// SHA-1 fingerprint, in the form that servers show.
    pub sha1: String,
}

impl VersionedFile for CertificateDocument {
    const FORMAT: &'static str = "tautline-certificate";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 16;
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let out = arguments.out.as_deref();
    let folders = Folders::of_user()?;
    let place = folders.opcua_key();
    let identity = UserKeys::of(folders).identity().map_err(link_error)?;
    let document = CertificateDocument {
        kept_in: place.display().to_string(),
        application: identity.uri().to_owned(),
        valid_until: identity.last_day().to_string(),
        sha256: identity.fingerprint().to_string(),
        sha1: identity.thumbprint_in_words(),
    };
    arguments.json.deliver(&document, || {
        say!("kept in {} with its private key", document.kept_in);
        say!("application: {}", document.application);
        say!("valid until: {}", document.valid_until);
        say!("SHA-256:     {}", document.sha256);
        say!("SHA-1:       {}", document.sha1);
    })?;
    if let Some(out) = out {
        write_file(out, identity.certificate())?;
        if arguments.json.is_text() {
            confirm!("written to {}", out.display());
        }
    }
    Ok(())
}
