//! Laser settings as text, for the command line.

use std::fmt::{self, Display, Write};
use std::str::FromStr;

use super::{LaserParity, LaserPort, LaserSettings, LaserUnit, LineLaserSettings};

const EXPECTED: &str = "controller, manual, tcp:HOST:PORT or serial:PORT:BAUD";

impl FromStr for LaserSettings {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (place, query) = text.split_once('?').unwrap_or((text, ""));
        let line = match place.split_once(':') {
            None if text == "controller" => return Ok(Self::Controller),
            None if text == "manual" => return Ok(Self::Manual),
            Some(("tcp", place)) => tcp(place)?,
            Some(("serial", place)) => serial(place),
            _ => return Err(format!("found {text:?}, expected {EXPECTED}")),
        };
        let mut line = LineLaserSettings::new(line);
        for setting in query.split('&').filter(|setting| !setting.is_empty()) {
            let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
            set(&mut line, key, &decoded(value)?)?;
        }
        let settings = Self::Line(line);
        match settings.check() {
            Ok(()) => Ok(settings),
            Err(error) => {
                let key = error.pointer.trim_start_matches('/').replace('/', " ");
                Err(format!("{key}: {}", error.message))
            }
        }
    }
}

fn tcp(place: &str) -> Result<LaserPort, String> {
    let (host, port) = place.rsplit_once(':').unwrap_or((place, ""));
    let port = port.parse().map_err(|_| {
        format!("found {place:?} after tcp:, expected HOST:PORT with a port from 1 to 65535")
    })?;
    Ok(LaserPort::Tcp {
        host: host.to_owned(),
        port,
    })
}

/// The text after the last colon is the baud rate if it is a number, as device names may contain colons.
fn serial(place: &str) -> LaserPort {
    let parts = place.rsplit_once(':');
    let parts = parts.and_then(|(device, baud)| Some((device, baud.parse::<u32>().ok()?)));
    let mut port = LaserPort::serial(parts.map_or(place, |(device, _)| device));
    if let (LaserPort::Serial { baud, .. }, Some((_, given))) = (&mut port, parts) {
        *baud = given;
    }
    port
}

fn number(key: &str, value: &str) -> Result<f64, String> {
    let wrong = |_| format!("{key}: found {value:?}, expected a number");
    value.parse().map_err(wrong)
}

fn set(line: &mut LineLaserSettings, key: &str, value: &str) -> Result<(), String> {
    let wrong = |expected: &str| Err(format!("{key}: found {value:?}, expected {expected}"));
    match (key, &mut line.port) {
        ("pattern", _) => line.pattern = Some(value.to_owned()),
        ("command", _) => line.command = Some(value.to_owned()),
        ("no_return", _) => line.no_return.push(value.to_owned()),
        ("scale", _) => line.scale = number(key, value)?,
        ("offset_m", _) => line.offset_m = number(key, value)?,
        ("fresh_s", _) => line.fresh_s = number(key, value)?,
        ("unit", _) => match value {
            "m" => line.unit = LaserUnit::M,
            "mm" => line.unit = LaserUnit::Mm,
            "um" => line.unit = LaserUnit::Um,
            _ => return wrong("m, mm or um"),
        },
        ("parity", LaserPort::Serial { parity, .. }) => match value {
            "none" => *parity = LaserParity::None,
            "odd" => *parity = LaserParity::Odd,
            "even" => *parity = LaserParity::Even,
            _ => return wrong("none, odd or even"),
        },
        ("stop_bits", LaserPort::Serial { stop_bits, .. }) => match value {
            "1" => *stop_bits = 1,
            "2" => *stop_bits = 2,
            _ => return wrong("1 or 2"),
        },
        _ => {
            return Err(format!(
                "found the key {key:?}, expected pattern, unit, scale, offset_m, no_return, command, fresh_s, \
                 or parity or stop_bits of a serial port"
            ));
        }
    }
    Ok(())
}

/// Decodes `%XX` to bytes.
fn decoded(text: &str) -> Result<String, String> {
    let wrong = || format!("found {text:?}, expected %XX with two hexadecimal digits for a byte");
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap_or("").as_bytes().to_vec();
    for part in parts {
        let (digits, rest) = part.split_at_checked(2).ok_or_else(wrong)?;
        let hexadecimal = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let byte = u8::from_str_radix(digits, 16).ok().filter(|_| hexadecimal);
        bytes.push(byte.ok_or_else(wrong)?);
        bytes.extend(rest.bytes());
    }
    String::from_utf8(bytes).map_err(|_| wrong())
}

/// Encodes the characters that separate settings.
fn encoded(text: &str) -> String {
    let mut safe = String::new();
    for letter in text.chars() {
        if matches!(letter, '%' | '&') || letter.is_ascii_control() {
            let _ = write!(safe, "%{:02X}", u32::from(letter));
        } else {
            safe.push(letter);
        }
    }
    safe
}

impl Display for LaserSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = match self {
            Self::Controller => return f.write_str("controller"),
            Self::Manual => return f.write_str("manual"),
            Self::Line(line) => line,
        };
        let mut settings: Vec<(&str, String)> = Vec::new();
        let usual = LineLaserSettings::new(line.port.clone());
        match &line.port {
            LaserPort::Tcp { host, port } => write!(f, "tcp:{host}:{port}")?,
            LaserPort::Serial {
                device,
                baud,
                parity,
                stop_bits,
            } => {
                write!(f, "serial:{device}:{baud}")?;
                match parity {
                    LaserParity::None => {}
                    LaserParity::Odd => settings.push(("parity", "odd".to_owned())),
                    LaserParity::Even => settings.push(("parity", "even".to_owned())),
                }
                if *stop_bits != 1 {
                    settings.push(("stop_bits", stop_bits.to_string()));
                }
            }
        }
        settings.extend(line.pattern.clone().map(|pattern| ("pattern", pattern)));
        if line.unit != usual.unit {
            settings.push(("unit", line.unit.name().to_owned()));
        }
        for (key, value, usual) in [
            ("scale", line.scale, usual.scale),
            ("offset_m", line.offset_m, usual.offset_m),
            ("fresh_s", line.fresh_s, usual.fresh_s),
        ] {
            if value != usual {
                settings.push((key, value.to_string()));
            }
        }
        settings.extend(line.no_return.iter().map(|t| ("no_return", t.clone())));
        settings.extend(line.command.clone().map(|command| ("command", command)));
        for (k, (key, value)) in settings.iter().enumerate() {
            let before = if k == 0 { '?' } else { '&' };
            write!(f, "{before}{key}={}", encoded(value))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_what_it_was_written_from() {
        for text in [
            "controller",
            "manual",
            "tcp:192.168.0.7:5000",
            "tcp:[::1]:5000?unit=um&scale=10&offset_m=-0.05&fresh_s=2",
            "serial:COM3:9600",
            "serial:/dev/serial/by-path/pci-0:1.0-port0:19200?parity=even&stop_bits=2",
            r"serial:/dev/ttyUSB0:115200?pattern=^g0g\+(?<distance>\d+)$&no_return=E255&no_return=E%26F&command=s0g%0D%0A",
        ] {
            let settings: LaserSettings = text.parse().unwrap();
            assert_eq!(settings.to_string(), text);
            let json = serde_json::to_string(&settings).unwrap();
            assert_eq!(
                serde_json::from_str::<LaserSettings>(&json).unwrap(),
                settings
            );
        }
        let settings = "serial:/dev/pci-0:1.0-port0".parse();
        let Ok(LaserSettings::Line(line)) = settings else {
            panic!("{settings:?}");
        };
        assert_eq!(line.port, LaserPort::serial("/dev/pci-0:1.0-port0"));
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        for (text, words) in [
            ("laser", "expected controller, manual"),
            ("tcp:host", "expected HOST:PORT"),
            ("tcp:host:0", "port tcp port: found 0"),
            ("tcp::5000", "port tcp host"),
            ("serial:", "port serial device"),
            ("serial:COM1:7", "port serial baud: found 7"),
            ("tcp:h:1?unit=inch", "unit: found \"inch\""),
            ("tcp:h:1?parity=odd", "found the key \"parity\""),
            ("tcp:h:1?pattern=(", "pattern: found \"(\""),
            ("tcp:h:1?pattern=[0-9]", "a group (?<distance>...)"),
            ("tcp:h:1?scale=0", "scale: found 0, expected a positive"),
            ("tcp:h:1?scale=NaN", "scale: found NaN"),
            ("tcp:h:1?offset_m=inf", "offset_m: found inf"),
            ("tcp:h:1?no_return=", "no_return 0"),
            ("tcp:h:1?command=", "command"),
            ("tcp:h:1?fresh_s=0", "fresh_s: found 0"),
            ("tcp:h:1?command=%0", "expected %XX"),
            ("tcp:h:1?command=%+1", "expected %XX"),
            (
                "tcp:h:1?pattern=(?<distance>(\\w{1000}){1000})",
                "a valid regular expression",
            ),
        ] {
            let told = text.parse::<LaserSettings>().unwrap_err();
            assert!(told.contains(words), "{text}: {told}");
        }
    }
}
