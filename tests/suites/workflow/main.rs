//! The program as a user runs it.

mod ads;
mod bad_input;
mod commands;
#[cfg(target_os = "linux")]
mod damaged_files;
mod headless;
mod markers;
mod pipeline;
mod samples;
mod schemas;
#[cfg(unix)]
mod study;
#[cfg(unix)]
mod unruly;
