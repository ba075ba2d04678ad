//! Words by which channels are recognised, in English and German.

use crate::recipe::Kind;

/// Kinds that one channel for each cable can be.
pub(crate) const PER_CABLE: &[(Kind, &[&str])] = &[
    (
        Kind::Force,
        &[
            "force",
            "forces",
            "tension",
            "tensions",
            "kraft",
            "seilkraft",
            "loadcell",
            "load",
            "zugkraft",
            "fcable",
            "effort",
        ],
    ),
    (
        Kind::Swivel,
        &["swivel", "swivels", "schwenk", "schwenkwinkel", "azimuth"],
    ),
    (
        Kind::Length,
        &[
            "length",
            "lengths",
            "len",
            "laenge",
            "länge",
            "seillänge",
            "seillaenge",
        ],
    ),
    (
        Kind::Revolutions,
        &[
            "rev",
            "revs",
            "revolution",
            "revolutions",
            "turns",
            "umdrehung",
            "umdrehungen",
            "enc",
            "encoder",
            "pos",
            "position",
            "angle",
            "winkel",
            "motor",
            "drum",
            "trommel",
            "winch",
            "winde",
            "axis",
            "achse",
            "q",
        ],
    ),
];

/// Words of channels that are readings of neither position nor force.
pub(crate) const OTHER: &[&str] = &[
    "vel",
    "velocity",
    "velo",
    "speed",
    "geschwindigkeit",
    "drehzahl",
    "acc",
    "acceleration",
    "torque",
    "drehmoment",
    "moment",
    "current",
    "strom",
    "status",
    "state",
    "error",
    "fehler",
    "lag",
    "voltage",
    "power",
    "temp",
    "temperature",
    "temperatur",
    "marker",
    "id",
    "dot",
    "ddot",
    "rate",
    "rpm",
];

/// Words of commanded values.
pub(crate) const WANTED: &[&str] = &[
    "cmd",
    "command",
    "commanded",
    "commands",
    "goal",
    "set",
    "setpoint",
    "soll",
    "target",
    "ref",
    "reference",
    "des",
    "desired",
    "nominal",
    "plan",
    "planned",
];

/// Words of measured values.
pub(crate) const ACTUAL: &[&str] = &[
    "act", "actual", "ist", "meas", "measured", "real", "fbk", "feedback",
];

/// Words of instruments that measure poses from outside.
pub(crate) const EXTERNAL: &[&str] = &[
    "meas",
    "measured",
    "mocap",
    "rigid",
    "body",
    "rigidbody",
    "vicon",
    "optitrack",
    "tracker",
    "faro",
    "leica",
    "ext",
    "external",
    "camera",
    "act",
    "actual",
    "ist",
    "position",
    "rotation",
    "platform",
    "pose",
    "ee",
];

/// Words of a laser distance sensor.
pub(crate) const LASER: &[&str] = &["laser", "distance", "dist", "abstand", "lidar"];
/// Words of a temperature.
pub(crate) const TEMPERATURE: &[&str] = &["temp", "temperature", "temperatur"];
/// Words of a time.
pub(crate) const TIME: &[&str] = &[
    "time",
    "t",
    "zeit",
    "timestamp",
    "uhrzeit",
    "datetime",
    "tout",
];
/// Words of the name of a pose.
pub(crate) const LABEL: &[&str] = &[
    "pose", "point", "name", "label", "punkt", "pt", "nr", "no", "number", "nummer", "poseid",
];
/// Words of a group.
pub(crate) const GROUP: &[&str] = &["group", "gruppe", "standstill"];
/// Roll, pitch and yaw.
pub(crate) const ANGLES: [&[&str]; 3] =
    [&["roll"], &["pitch", "nick"], &["yaw", "gier", "heading"]];
