//! The gallery as a document: HTML, or PDF.

use std::path::Path;

use tautline_session::Timestamp;

use super::gallery::{Gallery, Signature};
use crate::report::document::{Block, Document, Section};
use crate::report::{ReportError, signature_plot, write_document};
use crate::wording::count;

/// The gallery as a document.
#[must_use]
pub fn gallery_document(gallery: &Gallery) -> Document {
    let robot = &gallery.robot.name;
    let poses = count(gallery.poses, "pose");
    let mut about = Section::new("How to read it");
    about.lead("Compare the residuals of your own identification with these pictures.");
    about.paragraph(format!(
        "Each effect is simulated on {robot} at {poses}, at a typical size and without noise, and identified by a model that does not know it. What \
         is drawn is what remains: prediction minus reading, in standard deviations of the reading. Inside of the grey band residuals are as \
         large as noise alone makes them. Where no picture is, readings do not depend on the effect, or the identification takes it for geometry."
    ));
    let mut sections = vec![about];
    sections.extend(gallery.signatures.iter().map(section));
    Document {
        title: format!("Gallery of effects: {robot}"),
        subtitle: vec![format!(
            "{} and what they leave in the residuals.",
            count(gallery.signatures.len(), "effect")
        )],
        sections,
        ..Document::default()
    }
}

fn section(signature: &Signature) -> Section {
    let effect = signature.effect;
    let mut section = Section::new(effect.title());
    section.paragraph(signature.cause.as_str());
    match &signature.images {
        Ok(images) => {
            let plots = images
                .iter()
                .map(|image| signature_plot(effect.title(), &image.name, &image.figure));
            section.blocks.push(Block::Plots(plots.collect()));
        }
        Err(why) => section.note(why.as_str()),
    }
    let mut facts = vec![("Workshop".to_owned(), signature.workshop.clone())];
    facts.extend(
        effect
            .check()
            .map(|check| ("Check".to_owned(), check.to_owned())),
    );
    if !signature.size.is_empty() {
        facts.push(("Size here".to_owned(), signature.size.clone()));
    }
    let source = match effect.is_hypothesis() {
        true => format!("{}, a hypothesis", effect.id()),
        false => effect.id().to_owned(),
    };
    facts.push(("Identifier".to_owned(), source));
    section.facts(facts);
    section
}

/// Writes the gallery in the format of the file extension, atomically.
///
/// # Errors
/// If the name ends with neither .html nor .pdf, or the file cannot be written.
pub fn write_gallery(path: &Path, gallery: &Gallery, now: Timestamp) -> Result<(), ReportError> {
    write_document(path, &gallery_document(gallery), now)
}
