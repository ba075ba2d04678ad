//! Words by which channels are recognised, in English and German.

use crate::recipe::QuantityKind as Kind;

/// Quantities with one channel for each cable.
pub(crate) const PER_CABLE: &[(Kind, &[&str])] = &[
    (
        Kind::Force,
        &[
            "force",
            "forces",
            "tension",
            "tensions",
            "kraft",
            "kräfte",
            "kraefte",
            "seilkraft",
            "seilkräfte",
            "zugkraft",
            "zugkräfte",
            "seilspannung",
            "loadcell",
            "loadcells",
            "lc",
            "kmd",
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
            "lens",
            "laenge",
            "laengen",
            "länge",
            "längen",
            "seillänge",
            "seillaenge",
            "seilweg",
            "payout",
            "lcable",
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
            "encoders",
            "geber",
            "drehgeber",
            "pos",
            "position",
            "positions",
            "angle",
            "angles",
            "winkel",
            "theta",
            "θ",
            "q",
        ],
    ),
];

/// Machines to which one channel for each cable can belong; alone, such a word denotes the position of the machine.
pub(crate) const MACHINES: &[&str] = &[
    "motor", "motors", "drum", "trommel", "winch", "winde", "spool", "axis", "achse",
];

/// Symbols of equations for quantities of cables, for names that contain nothing else.
pub(crate) const LETTERS: &[(Kind, &[&str])] = &[
    (Kind::Force, &["f", "tau", "τ"]),
    (Kind::Length, &["l", "rho", "ρ", "ℓ"]),
    (Kind::Revolutions, &["q", "theta", "θ", "phi", "φ"]),
];

/// Words of channels that are readings of neither position nor force.
pub(crate) const OTHER: &[&str] = &[
    "vel",
    "velocity",
    "velocities",
    "velo",
    "velos",
    "speed",
    "geschwindigkeit",
    "drehzahl",
    "acc",
    "accel",
    "acceleration",
    "beschleunigung",
    "jerk",
    "torque",
    "torques",
    "trq",
    "drehmoment",
    "moment",
    "current",
    "currents",
    "strom",
    "iq",
    "error",
    "errors",
    "err",
    "fehler",
    "lag",
    "schlepp",
    "schleppfehler",
    "schleppabstand",
    "diff",
    "following",
    "voltage",
    "volt",
    "spannung",
    "power",
    "leistung",
    "pwm",
    "duty",
    "temp",
    "temperature",
    "temperatures",
    "temperatur",
    "thermistor",
    "pressure",
    "druck",
    "marker",
    "id",
    "dot",
    "ddot",
    "rate",
    "rpm",
    "min",
    "max",
    "limit",
    "variance",
    "covariance",
    "std",
    "sd",
    "sigma",
    "noise",
    "gain",
    "offset",
    "radius",
    "diameter",
    "stiffness",
    "damping",
    "modulo",
    "mass",
    "masse",
];

/// Words of states, which may be groups of values.
pub(crate) const STATES: &[&str] = &[
    "status", "state", "states", "zustand", "mode", "enable", "enabled", "word",
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
    "sp",
    "soll",
    "sollwert",
    "sollposition",
    "sollpose",
    "sol",
    "target",
    "ref",
    "reference",
    "des",
    "desired",
    "nominal",
    "plan",
    "planned",
    "dest",
    "ziel",
    "zielposition",
];

/// Words of actual values: read from sensors, or computed from readings by the controller.
pub(crate) const ACTUAL: &[&str] = &[
    "act",
    "actual",
    "ist",
    "istwert",
    "istposition",
    "istpose",
    "meas",
    "measured",
    "gemessen",
    "mess",
    "messwert",
    "present",
    "real",
    "fbk",
    "feedback",
    "cur",
];

/// Words of instruments that measure poses from outside.
pub(crate) const EXTERNAL: &[&str] = &[
    "meas",
    "measured",
    "gemessen",
    "mocap",
    "rigid",
    "body",
    "rigidbody",
    "vicon",
    "vrpn",
    "optitrack",
    "qualisys",
    "apriltag",
    "aruco",
    "tracker",
    "lasertracker",
    "faro",
    "leica",
    "ext",
    "external",
    "camera",
    "kamera",
    "rotation",
];

/// Words of the platform's pose that leave open whether it is commanded or measured.
pub(crate) const POSE: &[&str] = &[
    "act",
    "actual",
    "ist",
    "istposition",
    "istpose",
    "cur",
    "p",
    "pos",
    "position",
    "translation",
    "platform",
    "plattform",
    "pf",
    "pose",
    "ee",
    "tcp",
    "effector",
    "end",
];

/// Words of a laser distance sensor.
pub(crate) const LASER: &[&str] = &[
    "laser",
    "lasers",
    "lds",
    "distance",
    "dist",
    "distanz",
    "entfernung",
    "abstand",
    "laserabstand",
    "lidar",
    "rangefinder",
    "tof",
];
/// Words of a distance that is travelled or left.
pub(crate) const TRAVEL: &[&str] = &[
    "go",
    "to",
    "travel",
    "traveled",
    "travelled",
    "delta",
    "rest",
    "creep",
    "gefahren",
];
/// Words that may accompany `range`.
pub(crate) const RANGE: &[&str] = &["range", "sensor", "sick", "value", "m", "mm"];
/// Words of a temperature.
pub(crate) const TEMPERATURE: &[&str] = &[
    "temp",
    "temperature",
    "temperatur",
    "raumtemperatur",
    "lufttemperatur",
    "umgebungstemperatur",
    "hallentemperatur",
];
/// Words of a temperature that is not that of the robot's surroundings.
pub(crate) const HOT: &[&str] = &[
    "motor",
    "drive",
    "antrieb",
    "umrichter",
    "cpu",
    "fet",
    "coil",
    "wicklung",
    "winding",
    "winch",
    "winde",
    "axis",
    "achse",
    "joint",
    "present",
    "thermistor",
    "gyro",
    "imu",
    "limit",
    "max",
    "min",
    "variance",
];
/// Words of a time.
pub(crate) const TIME: &[&str] = &[
    "time",
    "t",
    "zeit",
    "messzeit",
    "timestamp",
    "stamp",
    "zeitstempel",
    "uhrzeit",
    "datetime",
    "datum",
    "date",
    "tout",
    "elapsed",
];
/// Words that distinguish a time from a clock.
pub(crate) const NO_CLOCK: &[&str] = &[
    "cycle", "zyklus", "delay", "latency", "dt", "duration", "dauer", "settling", "step", "jitter",
];
/// Words of the name of a pose.
pub(crate) const LABEL: &[&str] = &[
    "pose",
    "point",
    "name",
    "label",
    "punkt",
    "pt",
    "nr",
    "no",
    "number",
    "nummer",
    "poseid",
    "messpunkt",
];
/// Words of a group.
pub(crate) const GROUP: &[&str] = &["group", "gruppe", "standstill"];
/// Roll, pitch and yaw.
pub(crate) const ANGLES: [&[&str]; 3] = [
    &["roll", "wank", "wanken", "rollwinkel"],
    &["pitch", "nick", "nickwinkel"],
    &["yaw", "gier", "gierwinkel", "heading"],
];

/// Words in compounds that do not identify the quantity.
pub(crate) const NEUTRAL: &[&str] = &[
    "cable",
    "cables",
    "seil",
    "rope",
    "wire",
    "line",
    "sensor",
    "value",
    "wert",
    "pulley",
    "rolle",
    "drive",
    "antrieb",
    "joint",
    "servo",
    "actuator",
    "platform",
    "plattform",
    "raum",
    "zug",
    "cell",
    "load",
    "mat",
    "raw",
    "gvl",
    "main",
    "plc",
    "data",
    "log",
];

/// Whether a word is in any of the lists.
fn is_known(word: &str) -> bool {
    let kinds = PER_CABLE.iter().map(|(_, words)| *words);
    let lists = [
        MACHINES,
        OTHER,
        STATES,
        WANTED,
        ACTUAL,
        EXTERNAL,
        POSE,
        LASER,
        RANGE,
        TEMPERATURE,
        HOT,
        TIME,
        NO_CLOCK,
        LABEL,
        GROUP,
        NEUTRAL,
    ];
    kinds
        .chain(lists)
        .chain(ANGLES)
        .any(|list| list.contains(&word))
}

/// Shortest word that a compound consists of.
const SHORTEST: usize = 3;

/// The words of a compound: `zugkraftsensor` is zugkraft, sensor, `xsoll` is x, soll; a word that is no compound of known words
/// stays itself.
pub(crate) fn split_compound(word: &str) -> Vec<&str> {
    if is_known(word) {
        return vec![word];
    }
    known_parts(word)
        .or_else(|| axis_and_word(word))
        .unwrap_or_else(|| vec![word])
}

/// The fewest known words that a word consists of, the longest ones first.
fn known_parts(word: &str) -> Option<Vec<&str>> {
    let ends = word.char_indices().map(|(at, _)| at).skip(1);
    let mut best: Option<Vec<&str>> = None;
    for end in ends.filter(|end| *end >= SHORTEST) {
        let (head, tail) = word.split_at(end);
        if tail.len() < SHORTEST || !is_known(head) {
            continue;
        }
        let rest = match is_known(tail) {
            true => Some(vec![tail]),
            false => known_parts(tail),
        };
        if let Some(rest) = rest
            && best.as_ref().is_none_or(|best| rest.len() < best.len())
        {
            best = Some([vec![head], rest].concat());
        }
    }
    best
}

/// An axis before or after a word of a pose: `xsoll`, `posx`, `px`.
fn axis_and_word(word: &str) -> Option<Vec<&str>> {
    let of_pose = |word: &str| {
        [WANTED, ACTUAL, POSE]
            .iter()
            .any(|list| list.contains(&word))
    };
    let is_axis = |part: &str| matches!(part, "x" | "y" | "z");
    let (head, tail) = word.split_at_checked(1)?;
    if is_axis(head) && of_pose(tail) {
        return Some(vec![head, tail]);
    }
    let (head, tail) = word.split_at_checked(word.len() - 1)?;
    (is_axis(tail) && of_pose(head)).then(|| vec![head, tail])
}
