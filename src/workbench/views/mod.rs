//! What is drawn beside the panels: the robot in 3D, plots.

pub mod plots;
pub mod robot_3d;

/// What the views remember.
#[derive(Default)]
pub struct Views {
    /// Of the robot in 3D.
    pub robot_3d: robot_3d::Robot3d,
    /// Of the two robots in 3D that are compared.
    pub compared_3d: robot_3d::Robot3d,
    /// Of the plots.
    pub plots: plots::Remembered,
}

impl Views {
    /// Frees what lies on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.robot_3d.destroy();
        self.compared_3d.destroy();
    }
}
