//! A report as one self-contained HTML file, without network access or scripts. All content from files is escaped.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::document::{Align, Block, Document, Section, Table};
use crate::wording::printable;

/// What a browser may load or run: nothing but the styles, pictures and fonts in the file.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; font-src data:";
const STYLE: &str = include_str!("report.css");

/// The content of the HTML file.
pub fn render(document: &Document) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (document.title) }
                style { (PreEscaped(STYLE)) (PreEscaped(foot(document.foot()))) }
            }
            body {
                @if !document.marking.is_empty() { p.marking { (document.marking) } }
                main {
                    @if !document.header.is_empty() { p.subtitle { (document.header) } }
                    h1 { (document.title) }
                    p.subtitle {
                        @for line in &document.subtitle { span { (line) } " " }
                    }
                    @for part in &document.sections { (section(part)) }
                }
            }
        }
    };
    // Escape sequences and marks of direction mean something to whoever prints the file, or reads its source.
    printable(&page.into_string()).into_owned()
}

/// Style of the foot of printed pages: name and page number.
fn foot(name: &str) -> String {
    // Characters other than letters and digits as escape sequences, which end neither the text nor the style.
    let escaped = name.chars().map(|one| match one.is_alphanumeric() {
        true => one.to_string(),
        false => format!("\\{:x} ", u32::from(one)),
    });
    let name: String = escaped.collect();
    format!(
        "@page {{ @bottom-left {{ content: \"{name}\"; }} @bottom-right {{ content: \"Page \" counter(page) \" of \" counter(pages); }} }}"
    )
}

fn section(section: &Section) -> Markup {
    html! {
        section {
            h2 { (section.title) }
            @for block in &section.blocks { (self::block(block)) }
        }
    }
}

fn block(block: &Block) -> Markup {
    html! {
        @match block {
            Block::Heading(text) => h3 { (text) },
            Block::Lead(text) => p.lead { (text) },
            Block::Paragraph(text) => p { (text) },
            Block::Note(text) => p.note { (text) },
            Block::List(lines) => ul { @for line in lines { li { (line) } } },
            Block::Facts(facts) => dl {
                @for (name, value) in facts { dt { (name) } dd { (value) } }
            },
            Block::Table(table) => (self::table(table)),
            Block::Plots(plots) => div.plots {
                @for plot in plots { (PreEscaped(plot.svg())) }
            },
            Block::Signatures(lines) => div.signatures {
                @for (what, who) in lines {
                    div {
                        p.line { (who) }
                        p.note { (what) ": name, date, signature" }
                    }
                }
            },
            Block::Picture { png, caption } => figure {
                img src=(data_uri(png)) alt=(caption);
                figcaption { (caption) }
            },
        }
    }
}

fn table(table: &Table) -> Markup {
    let class = |align: Align| match align {
        Align::Left => None,
        Align::Right => Some("number"),
    };
    html! {
        div.table {
            table {
                caption { (table.caption) }
                thead {
                    tr {
                        @for (text, align) in &table.columns {
                            th scope="col" class=[class(*align)] { (text) }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr {
                            @for (cell, (_, align)) in row.iter().zip(&table.columns) {
                                td class=[class(*align)] { (cell) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A PNG as a data URI.
fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}
