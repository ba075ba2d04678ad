//! Rules of the repository as a whole.

mod budget;
mod files;
mod formats;
mod layout;
mod licences;
mod packaging;
mod safety;
