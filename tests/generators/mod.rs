//! Writes generated files of the repository that tests compare: sample sessions, pictures, pages with the output of commands.

pub mod gallery;
pub mod hypotheses;
pub mod random_runs;
pub mod screenshots;
pub mod sessions;
pub mod your_data;
