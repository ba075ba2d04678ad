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
#[path = "../ads/names.rs"]
#[allow(dead_code, reason = "the tests of ADS use all of it")]
mod names;
#[path = "../ads/plant.rs"]
#[allow(dead_code, reason = "the tests of ADS use all of it")]
mod plant;
mod plots;
mod precalibration;
mod report;
mod robot_3d;
#[path = "../ads/server.rs"]
#[allow(dead_code, reason = "the tests of ADS use all of it")]
mod server;
mod session_file;
mod start;
mod support;
mod tables;
mod timeline;
mod undo;
mod walk;
