//! Fields of the connection dialog, and their errors.

/// Field that can have an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FieldId {
    Folder,
    Speed,
    Host,
    Port,
    NetId,
    AmsPort,
    Timeout,
    /// Address of an OPC UA controller.
    Url,
    Policy,
    User,
    UserCertificate,
    UserKey,
    UrlTimeout,
    Symbol(usize),
    /// All symbols.
    Symbols,
    LaserHost,
    LaserPort,
    Device,
    Baud,
    Pattern,
    NoReturn,
    /// Other settings of the laser.
    Laser,
}

impl FieldId {
    /// Name and hint of the field.
    #[must_use]
    pub fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Folder => ("Folder", "Path of the dataset"),
            Self::Speed => ("Speed", "1"),
            Self::Host => ("Host", "192.168.0.5"),
            Self::Port => ("Port", "48898"),
            Self::NetId => ("AMS Net ID", "192.168.0.5.1.1"),
            Self::AmsPort => ("AMS port", "851"),
            Self::Timeout | Self::UrlTimeout => ("Timeout (s)", "1"),
            Self::Url => ("Address", "opc.tcp://192.168.0.5:4840"),
            Self::User => ("User", "name at the controller"),
            Self::UserCertificate => ("User certificate", "DER or PEM"),
            Self::UserKey => ("Private key", "without a password"),
            Self::LaserHost => ("Laser host", "192.168.0.7"),
            Self::LaserPort => ("Laser port", "4001"),
            Self::Device => ("Serial port", "/dev/ttyUSB0"),
            Self::Baud => ("Baud rate", "9600"),
            Self::Pattern => ("Line pattern", "The first number that stands alone"),
            Self::NoReturn => ("Text without a return", "None"),
            Self::Laser => ("Request command", "None: it sends by itself"),
            Self::Policy | Self::Symbol(_) | Self::Symbols => ("", ""),
        }
    }

    #[must_use]
    pub fn part(self) -> DialogTab {
        match self {
            Self::Symbol(_) | Self::Symbols => DialogTab::Symbols,
            Self::LaserHost
            | Self::LaserPort
            | Self::Device
            | Self::Baud
            | Self::Pattern
            | Self::NoReturn
            | Self::Laser => DialogTab::Laser,
            _ => DialogTab::Controller,
        }
    }
}

/// Tab of the dialog.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DialogTab {
    /// Kind and address of the controller.
    #[default]
    Controller,
    Symbols,
    Laser,
}

impl DialogTab {
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Controller => "Controller",
            Self::Symbols => "Symbols",
            Self::Laser => "Laser source",
        }
    }
}

/// Errors of fields, one sentence each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Problems(Vec<(FieldId, String)>);

impl Problems {
    pub fn add(&mut self, field: FieldId, text: impl Into<String>) {
        self.0.push((field, text.into()));
    }

    /// Whether there is no error.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Error of a field.
    #[must_use]
    pub fn of(&self, field: FieldId) -> Option<&str> {
        let mut all = self.0.iter();
        let found = all.find(|(wrong, _)| *wrong == field);
        found.map(|(_, text)| text.as_str())
    }

    /// First error.
    #[must_use]
    pub fn first(&self) -> Option<(FieldId, &str)> {
        self.0.first().map(|(field, text)| (*field, text.as_str()))
    }

    /// Value of a result; its error is added for a field.
    pub fn take<T>(&mut self, field: FieldId, answer: Result<T, String>) -> Option<T> {
        answer.map_err(|text| self.add(field, text)).ok()
    }
}
