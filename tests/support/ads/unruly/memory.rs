//! Memory of a controller: symbols with their types, and the bytes of their values.

use serde_json::Value;

/// Index group of the values.
pub const GROUP: u32 = 0x4040;
/// Longest text (bytes).
const TEXT: usize = 81;
/// Gap between two symbols (bytes), so that the address behind one is not that of the next.
const GAP: u32 = 8;

/// A symbol.
#[derive(Debug, Clone)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Name of the type of its elements.
    kind: String,
    /// Number of its elements.
    count: usize,
    /// Its first byte.
    pub offset: u32,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl Variable {
    /// Bytes of an element and the number of its type.
    fn shape(kind: &str) -> (usize, u32) {
        match kind {
            "BOOL" => (1, 33),
            "INT" => (2, 2),
            "UDINT" => (4, 19),
            "REAL" => (4, 4),
            "LREAL" => (8, 5),
            "STRING" => (TEXT, 30),
            other => panic!("the server has no type {other}"),
        }
    }

    fn new(name: &str, kind: &str, count: usize, offset: u32) -> Self {
        let bytes = vec![0; Self::shape(kind).0 * count];
        Self {
            name: name.to_owned(),
            kind: kind.to_owned(),
            count,
            offset,
            bytes,
        }
    }

    /// Sets its values.
    pub fn set(&mut self, values: &[Value]) {
        let size = Self::shape(&self.kind).0;
        for (bytes, value) in self.bytes.chunks_exact_mut(size).zip(values) {
            let number = match value {
                Value::Bool(on) => f64::from(u8::from(*on)),
                // JSON writes NaN as null.
                Value::Null => f64::NAN,
                value => value.as_f64().unwrap_or(0.0),
            };
            match self.kind.as_str() {
                "BOOL" => bytes[0] = u8::from(number != 0.0),
                "INT" => bytes.copy_from_slice(&(number as i16).to_le_bytes()),
                "UDINT" => bytes.copy_from_slice(&(number as u32).to_le_bytes()),
                "REAL" => bytes.copy_from_slice(&(number as f32).to_le_bytes()),
                "LREAL" => bytes.copy_from_slice(&number.to_le_bytes()),
                _ => {
                    bytes.fill(0);
                    let text = value.as_str().unwrap_or_default().as_bytes();
                    let length = text.len().min(TEXT - 1);
                    bytes[..length].copy_from_slice(&text[..length]);
                }
            }
        }
    }

    /// Its values; none of a text.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        let elements = self.bytes.chunks_exact(Self::shape(&self.kind).0);
        let number = |bytes: &[u8]| match self.kind.as_str() {
            "BOOL" => Some(f64::from(bytes[0])),
            "INT" => Some(f64::from(i16::from_le_bytes(bytes.try_into().ok()?))),
            "UDINT" => Some(f64::from(u32::from_le_bytes(bytes.try_into().ok()?))),
            "REAL" => Some(f64::from(f32::from_le_bytes(bytes.try_into().ok()?))),
            "LREAL" => Some(f64::from_le_bytes(bytes.try_into().ok()?)),
            _ => None,
        };
        elements.filter_map(number).collect()
    }

    /// Its description as the protocol has it.
    fn entry(&self) -> Vec<u8> {
        let (_, base) = Self::shape(&self.kind);
        let type_name = match (self.kind.as_str(), self.count) {
            ("STRING", _) => format!("STRING({})", TEXT - 1),
            (kind, 1) => kind.to_owned(),
            (kind, count) => format!("ARRAY [1..{count}] OF {kind}"),
        };
        let whole = 30 + self.name.len() + 1 + type_name.len() + 1 + 1;
        let mut entry = Vec::new();
        for word in [
            whole as u32,
            GROUP,
            self.offset,
            self.bytes.len() as u32,
            base,
            0,
        ] {
            entry.extend_from_slice(&word.to_le_bytes());
        }
        for half in [self.name.len() as u16, type_name.len() as u16, 0] {
            entry.extend_from_slice(&half.to_le_bytes());
        }
        for text in [self.name.as_str(), &type_name, ""] {
            entry.extend_from_slice(text.as_bytes());
            entry.push(0);
        }
        entry
    }
}

/// All symbols.
#[derive(Debug, Default)]
pub struct Memory {
    variables: Vec<Variable>,
    next: u32,
    /// Changes with the program.
    pub version: u8,
}

impl Memory {
    /// Adds or replaces a symbol: `[name, type, count, values]`.
    pub fn declare(&mut self, declaration: &Value) {
        let name = declaration[0].as_str().expect("a name");
        let kind = declaration[1].as_str().expect("a type");
        let count = declaration[2].as_u64().expect("a number of elements") as usize;
        self.variables.retain(|known| known.name != name);
        let mut variable = Variable::new(name, kind, count, 0x100 + self.next);
        self.next += variable.bytes.len() as u32 + GAP;
        variable.set(declaration[3].as_array().map_or(&[][..], Vec::as_slice));
        self.variables.push(variable);
    }

    /// A symbol.
    ///
    /// # Panics
    /// If there is none of this name.
    pub fn variable(&mut self, name: &str) -> &mut Variable {
        let mut found = self.variables.iter_mut();
        let found = found.find(|known| known.name == name);
        found.unwrap_or_else(|| panic!("the server has no symbol {name}"))
    }

    /// The description of a symbol.
    #[must_use]
    pub fn description(&self, name: &str) -> Option<Vec<u8>> {
        let found = self.variables.iter().find(|known| known.name == name);
        found.map(Variable::entry)
    }

    fn place(&mut self, group: u32, offset: u32) -> Option<(&mut Variable, usize)> {
        let within = |known: &&mut Variable| {
            let start = offset.checked_sub(known.offset);
            group == GROUP && start.is_some_and(|start| (start as usize) < known.bytes.len())
        };
        let found = self.variables.iter_mut().find(within)?;
        let start = (offset - found.offset) as usize;
        Some((found, start))
    }

    /// Name of the symbol at a place.
    pub fn name_at(&mut self, group: u32, offset: u32) -> Option<String> {
        let (found, _) = self.place(group, offset)?;
        Some(found.name.clone())
    }

    /// Bytes at a place.
    pub fn read(&mut self, group: u32, offset: u32, size: usize) -> Option<Vec<u8>> {
        let (found, start) = self.place(group, offset)?;
        found.bytes.get(start..start + size).map(<[u8]>::to_vec)
    }

    /// Changes bytes at a place; the symbol with its values.
    pub fn write(&mut self, group: u32, offset: u32, bytes: &[u8]) -> Option<&Variable> {
        let (found, start) = self.place(group, offset)?;
        let place = found.bytes.get_mut(start..start + bytes.len())?;
        place.copy_from_slice(bytes);
        Some(found)
    }
}
