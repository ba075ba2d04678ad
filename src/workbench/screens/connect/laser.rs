//! Laser: source of its distance, and live test.

use egui::{ComboBox, Ui};
use tautline_link::laser::serial_ports;
use tautline_session::{LaserPort, LaserSettings, LaserUnit, LineLaserSettings};

use super::draft::port;
use super::field::{labelled, line};
use super::problems::{FieldId, Problems};
use super::test_line::{LaserTest, TestLine};
use crate::theme::GRID;
use crate::widgets::{UiExt, choice, combo_box, form};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaserFrom {
    Controller,
    Manual,
    /// Device in the network.
    Network,
    /// Device at a serial port.
    Serial,
}

/// Input for the laser.
#[derive(Debug)]
pub struct LaserDraft {
    pub from: LaserFrom,
    host: String,
    port: String,
    device: String,
    baud: String,
    pattern: String,
    no_return: String,
    command: String,
    /// All settings of a line-based device, including those not shown.
    base: LineLaserSettings,
    /// Serial ports of this computer, once looked up.
    ports: Option<Vec<String>>,
    test: Option<TestLine>,
}

impl LaserDraft {
    /// Settings of a session; for a device that it lacks, those used last.
    #[must_use]
    pub fn of(settings: &LaserSettings, last: &LaserSettings) -> Self {
        let usual = LineLaserSettings::new(LaserPort::serial(String::new()));
        let base = match (settings, last) {
            (LaserSettings::Line(line), _) | (_, LaserSettings::Line(line)) => line.clone(),
            _ => usual,
        };
        let mut draft = Self {
            from: LaserFrom::Controller,
            host: String::new(),
            port: String::new(),
            device: String::new(),
            baud: "9600".into(),
            pattern: base.pattern.clone().unwrap_or_default(),
            no_return: base.no_return.join(" | "),
            command: escaped(base.command.as_deref().unwrap_or_default()),
            base,
            ports: None,
            test: None,
        };
        let from = match &draft.base.port {
            LaserPort::Tcp { host, port } => {
                (draft.host, draft.port) = (host.clone(), port.to_string());
                LaserFrom::Network
            }
            LaserPort::Serial { device, baud, .. } => {
                (draft.device, draft.baud) = (device.clone(), baud.to_string());
                LaserFrom::Serial
            }
        };
        draft.from = match settings {
            LaserSettings::Controller => LaserFrom::Controller,
            LaserSettings::Manual => LaserFrom::Manual,
            LaserSettings::Line(_) => from,
        };
        draft
    }

    /// Ends the test, so that the laser is free for a connection.
    pub fn release(&mut self) {
        self.test = None;
    }

    /// Settings made from the input.
    pub fn settings(&self, problems: &mut Problems) -> Option<LaserSettings> {
        let port = match self.from {
            LaserFrom::Controller => return Some(LaserSettings::Controller),
            LaserFrom::Manual => return Some(LaserSettings::Manual),
            LaserFrom::Network => {
                if self.host.trim().is_empty() {
                    let text = "found nothing, expected the name or address of the laser";
                    problems.add(FieldId::LaserHost, text);
                }
                let port = problems.take(FieldId::LaserPort, port(&self.port));
                LaserPort::Tcp {
                    host: self.host.trim().to_owned(),
                    port: port?,
                }
            }
            LaserFrom::Serial => self.serial(problems)?,
        };
        let typed = |text: &String| Some(text.clone()).filter(|text| !text.trim().is_empty());
        let marks = self.no_return.split('|').map(str::trim);
        let settings = LaserSettings::Line(LineLaserSettings {
            port,
            pattern: typed(&self.pattern),
            no_return: marks.filter(|m| !m.is_empty()).map(str::to_owned).collect(),
            command: typed(&self.command).map(|text| unescaped(&text)),
            ..self.base.clone()
        });
        match settings.check() {
            Ok(()) => Some(settings),
            Err(error) => {
                let field = match error.pointer.as_str() {
                    "/pattern" => FieldId::Pattern,
                    "/port/tcp/host" => FieldId::LaserHost,
                    "/port/serial/device" => FieldId::Device,
                    "/port/serial/baud" => FieldId::Baud,
                    _ => FieldId::Laser,
                };
                if problems.of(field).is_none() {
                    problems.add(field, error.message);
                }
                None
            }
        }
    }

    fn serial(&self, problems: &mut Problems) -> Option<LaserPort> {
        let baud = self.baud.trim().parse::<u32>();
        let baud =
            baud.map_err(|_| format!("found \"{}\", expected a number such as 9600", self.baud));
        let baud = problems.take(FieldId::Baud, baud);
        if self.device.trim().is_empty() {
            let text = "found nothing, expected a serial port such as /dev/ttyUSB0 or COM3";
            problems.add(FieldId::Device, text);
        }
        let mut port = match &self.base.port {
            port @ LaserPort::Serial { .. } => port.clone(),
            LaserPort::Tcp { .. } => LaserPort::serial(String::new()),
        };
        if let LaserPort::Serial {
            device, baud: bits, ..
        } = &mut port
        {
            *device = self.device.trim().to_owned();
            *bits = baud?;
        }
        Some(port)
    }

    /// Draws the choice and its fields; `busy` tells that a connection is using the laser.
    pub fn show(&mut self, ui: &mut Ui, problems: &Problems, busy: bool) {
        for (from, text) in [
            (
                LaserFrom::Controller,
                "From the controller, with its other readings",
            ),
            (LaserFrom::Manual, "Typed by the operator at every pose"),
            (LaserFrom::Network, "From a device in the network"),
            (LaserFrom::Serial, "From a device at a serial port"),
        ] {
            choice(ui, &mut self.from, from, text);
        }
        if matches!(self.from, LaserFrom::Controller | LaserFrom::Manual) {
            self.test = None;
            return;
        }
        ui.add_space(GRID);
        form("laser").show(ui, |ui| {
            if self.from == LaserFrom::Network {
                line(ui, problems, FieldId::LaserHost, &mut self.host);
                line(ui, problems, FieldId::LaserPort, &mut self.port);
            } else {
                self.device(ui);
                line(ui, problems, FieldId::Device, &mut self.device);
                line(ui, problems, FieldId::Baud, &mut self.baud);
            }
            unit(ui, &mut self.base.unit);
            line(ui, problems, FieldId::Pattern, &mut self.pattern);
            line(ui, problems, FieldId::NoReturn, &mut self.no_return);
            line(ui, problems, FieldId::Laser, &mut self.command);
        });
        self.test(ui, busy);
    }

    /// Field for the serial port.
    fn device(&mut self, ui: &mut Ui) {
        let ports = self.ports.get_or_insert_with(serial_ports);
        ui.label("Ports of this computer");
        let list = ComboBox::from_id_salt("serial ports").width(200.0);
        let selected = match ports.is_empty() {
            true => "None found",
            false => "Choose",
        };
        combo_box(ui, list, "Ports of this computer", selected, |ui| {
            for port in ports.iter() {
                ui.selectable_value(&mut self.device, port.clone(), port);
            }
        });
        ui.end_row();
    }

    /// Received lines and the distances parsed from them.
    fn test(&mut self, ui: &mut Ui, busy: bool) {
        ui.section("Received lines");
        let settings = self.settings(&mut Problems::default());
        let Some(LaserSettings::Line(settings)) = settings.filter(|_| !busy) else {
            self.test = None;
            let text = if busy {
                "The laser is in use by the connection: disconnect to try other settings."
            } else {
                "Its lines are shown here once the fields above are filled in."
            };
            ui.muted(text);
            return;
        };
        if self
            .test
            .as_ref()
            .is_none_or(|test| test.settings != settings)
        {
            self.test = None;
            if ui.button("Try these settings").clicked() {
                self.test = Some(TestLine::start(settings, ui.ctx().clone()));
            }
            return;
        }
        let Some(test) = &self.test else { return };
        let LaserTest { last_line, parsed } = test.result();
        match last_line {
            Some(line) => labelled(ui, "Last line", &line),
            None => {
                ui.muted("Nothing has arrived yet.");
            }
        }
        match parsed {
            Some(Ok(distance_m)) => {
                ui.good(&format!("Distance: {:.2} mm.", distance_m * 1e3));
            }
            Some(Err(why)) => {
                ui.doubtful(&format!("{}.", tautline_workflow::wording::sentence(&why)));
            }
            None => {}
        }
    }
}

fn unit(ui: &mut Ui, unit: &mut LaserUnit) {
    ui.label("Unit of the laser");
    let list = ComboBox::from_id_salt("unit of the laser").width(72.0);
    combo_box(ui, list, "Unit of the laser", unit.name(), |ui| {
        for offered in [LaserUnit::Mm, LaserUnit::M, LaserUnit::Um] {
            ui.selectable_value(unit, offered, offered.name());
        }
    });
    ui.end_row();
}

/// Line ends in their typed form.
fn escaped(text: &str) -> String {
    text.replace('\r', "\\r").replace('\n', "\\n")
}

fn unescaped(text: &str) -> String {
    text.replace("\\r", "\r").replace("\\n", "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_source_makes_its_settings() {
        for text in [
            "controller",
            "manual",
            "tcp:laser:4001?pattern=^(?<distance>.*)$&unit=um&no_return=E1&no_return=E2",
            "serial:/dev/ttyUSB0:19200?parity=even&stop_bits=2&command=D%0D%0A",
        ] {
            let settings: LaserSettings = text.parse().expect(text);
            let mut problems = Problems::default();
            let made =
                LaserDraft::of(&settings, &LaserSettings::Controller).settings(&mut problems);
            assert_eq!(made, Some(settings), "{text}: {problems:?}");
        }
    }

    #[test]
    fn what_is_missing_is_told_beside_its_field() {
        let mut draft = LaserDraft::of(&LaserSettings::Controller, &LaserSettings::Manual);
        let problem = |draft: &LaserDraft, field| {
            let mut problems = Problems::default();
            assert_eq!(draft.settings(&mut problems), None);
            problems.of(field).expect("a problem").to_owned()
        };
        draft.from = LaserFrom::Network;
        assert!(problem(&draft, FieldId::LaserHost).contains("expected"));
        assert!(problem(&draft, FieldId::LaserPort).contains("1 to 65535"));
        draft.from = LaserFrom::Serial;
        assert!(problem(&draft, FieldId::Device).contains("COM3"));
        draft.device = "COM3".into();
        draft.baud = "7".into();
        assert!(problem(&draft, FieldId::Baud).contains("bits per second"));
        draft.baud = "9600".into();
        draft.pattern = "(".into();
        assert!(problem(&draft, FieldId::Pattern).contains("regular expression"));
    }
}
