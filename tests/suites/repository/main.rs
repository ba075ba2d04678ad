//! What holds for the repository as a whole.

mod files;
mod licences;
mod packaging;
mod readme;
mod safety;
