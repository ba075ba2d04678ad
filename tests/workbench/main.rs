//! The workbench, driven by accessible names.

mod adjustment;
mod compare;
mod connect;
mod controller;
mod crash;
mod demo;
mod doctor;
mod gl;
mod identification;
mod layout;
mod measured;
mod measuring;
mod modeling;
mod plots;
mod precalibration;
mod report;
mod robot_3d;
mod session_file;
mod start;
mod support;
mod tables;
mod timeline;
mod undo;
mod unruly;
mod walk;
