//! Cable and platform kinematics.
