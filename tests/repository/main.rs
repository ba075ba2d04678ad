//! What holds for the repository as a whole.

mod licences;
mod readme;
