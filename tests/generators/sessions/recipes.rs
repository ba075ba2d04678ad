//! Recipes of the sample sessions, with their hidden faults.

/// A pulley that was moved since the previous session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Index of its cable.
    pub cable: usize,
    /// Displacement of its entry point (m).
    pub by_m: [f64; 3],
}

/// A hidden effect: its identifier, its cable or none for all, its parameters.
pub type Hidden = (
    &'static str,
    Option<&'static str>,
    &'static [(&'static str, f64)],
);

/// Recipe of a sample session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Its file below `sessions/`.
    pub file: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Preset of the robot.
    pub preset: &'static str,
    /// Number of poses besides the home pose.
    pub poses: usize,
    /// Seed of the true robot.
    pub robot_seed: u64,
    /// Seed of the readings.
    pub seed: u64,
    /// Time at which the first pose was measured.
    pub begun: &'static str,
    /// Effects of the true robot that its description lacks.
    pub hidden: &'static [Hidden],
    /// A pulley that was moved before the poses were measured.
    pub moved: Option<Moved>,
    /// Whether the description states the weight of the cables.
    pub cable_weight_is_stated: bool,
    /// Whether an external instrument measures the platform at every pose.
    pub is_tracked: bool,
    /// Whether force sensors, home platform and elongation were calibrated on the bench before.
    pub has_bench: bool,
    /// Whether the winches were calibrated on the bench, too.
    pub has_winch_bench: bool,
    /// Whether the session has a diagnosis.
    pub is_diagnosed: bool,
    /// Whether the model of the session has the hidden effects.
    pub knows_hidden: bool,
}

/// MINI, as good as its description, measured on the bench.
const MINI: Recipe = Recipe {
    file: "clean-mini/session.json",
    name: "MINI, nothing wrong",
    preset: "mini",
    poses: 40,
    robot_seed: 1,
    seed: 1,
    begun: "2026-03-02T08:30:00Z",
    hidden: &[],
    moved: None,
    cable_weight_is_stated: true,
    is_tracked: false,
    has_bench: true,
    has_winch_bench: true,
    is_diagnosed: true,
    knows_hidden: false,
};

/// One of the sessions of a year of MINI.
const YEAR: Recipe = Recipe {
    poses: 25,
    robot_seed: 11,
    has_bench: false,
    has_winch_bench: false,
    is_diagnosed: false,
    knows_hidden: true,
    ..MINI
};

/// Moved before June, 13 mm in all.
const MOVED_IN_JUNE: Option<Moved> = Some(Moved {
    cable: 2,
    by_m: [0.008, -0.006, 0.0083],
});

/// A thicker cable pays out more for each turn of its drum.
const THICKER_CABLE: &[Hidden] = &[("winch_scale", Some("cable-6"), &[("scale", 0.012)])];

/// All sample sessions.
pub const RECIPES: [Recipe; 14] = [
    MINI,
    Recipe {
        file: "mini-winch-scale/session.json",
        name: "MINI, a winch that pays out too much",
        begun: "2026-03-03T08:30:00Z",
        hidden: &[("winch_scale", Some("cable-3"), &[("scale", 0.02)])],
        has_winch_bench: false,
        ..MINI
    },
    Recipe {
        file: "hall-creep-and-slip/session.json",
        name: "Hall robot, two faults at once",
        preset: "hall",
        begun: "2026-03-09T13:00:00Z",
        hidden: &[
            ("cable_creep", None, &[("c", 0.002)]),
            (
                "cable_slip",
                Some("cable-6"),
                &[("step", 0.02), ("pose", 22.0)],
            ),
        ],
        has_bench: false,
        has_winch_bench: false,
        ..MINI
    },
    Recipe {
        file: "suspended-sag/session.json",
        name: "Suspended robot, cables that sag",
        preset: "suspended",
        begun: "2026-03-16T09:00:00Z",
        hidden: &[("cable_sag", None, &[("weight", 3.0)])],
        cable_weight_is_stated: false,
        has_bench: false,
        has_winch_bench: false,
        ..MINI
    },
    Recipe {
        file: "tracker-touched/session.json",
        name: "MINI, the laser tracker was touched",
        begun: "2026-03-23T08:30:00Z",
        hidden: &[(
            "tracker_moved",
            None,
            &[
                ("shift_x", 0.003),
                ("shift_y", -0.002),
                ("turn_z", 0.005),
                ("pose", 24.0),
            ],
        )],
        is_tracked: true,
        has_winch_bench: false,
        ..MINI
    },
    Recipe {
        file: "before-after/before.json",
        name: "One pulley was moved, before",
        begun: "2026-04-13T08:30:00Z",
        robot_seed: 7,
        seed: 7,
        is_diagnosed: false,
        ..MINI
    },
    Recipe {
        file: "before-after/after.json",
        name: "One pulley was moved, after",
        begun: "2026-05-11T08:30:00Z",
        robot_seed: 7,
        seed: 8,
        // 12 mm in all.
        moved: Some(Moved {
            cable: 5,
            by_m: [-0.008, 0.004, 0.008],
        }),
        is_diagnosed: false,
        ..MINI
    },
    Recipe {
        file: "year-of-mini/2025-12.json",
        name: "MINI, 2025-12",
        begun: "2025-12-04T08:30:00Z",
        seed: 101,

        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-02.json",
        name: "MINI, 2026-02",
        begun: "2026-02-05T08:30:00Z",
        seed: 102,

        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-04.json",
        name: "MINI, 2026-04",
        begun: "2026-04-02T08:30:00Z",
        seed: 103,

        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-06.json",
        name: "MINI, 2026-06",
        begun: "2026-06-18T08:30:00Z",
        seed: 104,
        moved: MOVED_IN_JUNE,
        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-08.json",
        name: "MINI, 2026-08",
        begun: "2026-08-06T08:30:00Z",
        seed: 105,
        moved: MOVED_IN_JUNE,
        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-09.json",
        name: "MINI, 2026-09",
        begun: "2026-09-10T08:30:00Z",
        seed: 106,
        moved: MOVED_IN_JUNE,
        hidden: THICKER_CABLE,
        ..YEAR
    },
    Recipe {
        file: "year-of-mini/2026-11.json",
        name: "MINI, 2026-11",
        begun: "2026-11-05T08:30:00Z",
        seed: 107,
        moved: MOVED_IN_JUNE,
        hidden: THICKER_CABLE,
        ..YEAR
    },
];
