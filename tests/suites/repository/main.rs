//! What holds for the repository as a whole.

mod files;
mod layout;
mod licences;
mod packaging;
mod readme;
mod safety;
