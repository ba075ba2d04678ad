//! `tautline certificate`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_link::opcua::KeyStore;
use tautline_session::{Folders, write_bytes};
use tautline_workflow::controllers::UserKeys;

use crate::examples::examples;
use crate::live::link_error;
use crate::output::say;
use crate::replace::Replace;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What to compare at the server", "tautline certificate"),
    ("A file for the server's list of trusted clients", "tautline certificate -o tautline.der"),
]))]
pub struct Arguments {
    /// File to write the certificate to, in the binary form (DER) that servers read
    #[arg(short, long, value_name = "FILE.der")]
    out: Option<PathBuf>,
    #[command(flatten)]
    replace: Replace,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(out) = &arguments.out {
        arguments.replace.permit(&[Some(out)], None)?;
    }
    let folders = Folders::of_user()?;
    let place = folders.opcua_key();
    let identity = UserKeys::of(folders).identity().map_err(link_error)?;
    say!("kept in {} with its private key", place.display());
    say!("application: {}", identity.uri());
    say!("valid until: {}", identity.last_day());
    say!("SHA-256:     {}", identity.fingerprint());
    say!("SHA-1:       {}", identity.thumbprint_in_words());
    if let Some(out) = &arguments.out {
        write_bytes(out, identity.certificate())?;
        say!("written to {}", out.display());
    }
    Ok(())
}
