//! Message definitions in a recording: the text of a `.msg` file, followed by those of its nested types.

/// The type of a message and its nested types; the message itself comes first.
pub(super) struct Definitions(Vec<Definition>);

pub(super) struct Definition {
    /// Package and type, `geometry_msgs/Pose`.
    pub name: String,
    pub fields: Vec<Field>,
}

pub(super) struct Field {
    pub name: String,
    pub kind: FieldType,
    pub count: Count,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FieldType {
    Number(Number),
    Text,
    /// Seconds and nanoseconds, stored as these.
    Time([Number; 2]),
    /// A nested type, by its index.
    Nested(usize),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// ROS version: some type names differ in meaning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Version {
    Ros1,
    Ros2,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    /// A sequence whose length is stored in the message.
    Sequence,
}

impl Definitions {
    /// Parses the definition of a type; the error names what is not understood.
    pub fn parse(version: Version, name: &str, text: &str) -> Result<Self, String> {
        let mut sections = vec![(normal(name), Vec::new())];
        let mut begins = false;
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.len() > 2 && line.bytes().all(|byte| byte == b'=') {
                begins = true;
            } else if begins && let Some(name) = line.strip_prefix("MSG:") {
                sections.push((normal(name.trim()), Vec::new()));
                begins = false;
            } else if !line.is_empty()
                && let Some((_, lines)) = sections.last_mut()
            {
                lines.push(line);
            }
        }
        let names: Vec<&str> = sections.iter().map(|(name, _)| name.as_str()).collect();
        let definition = |(name, lines): &(String, Vec<&str>)| {
            let kind = |base: &str| kind_of(version, base, name, &names);
            let fields = lines.iter().filter_map(|line| field(line, kind));
            Ok(Definition {
                name: name.clone(),
                fields: fields.collect::<Result<_, String>>()?,
            })
        };
        let parsed: Result<_, String> = sections.iter().map(definition).collect();
        parsed.map(Self)
    }

    /// The type of the message.
    pub fn message(&self) -> &Definition {
        &self.0[0]
    }

    pub fn get(&self, place: usize) -> &Definition {
        &self.0[place]
    }

    /// Whether a type is `std_msgs/MultiArrayLayout`.
    pub fn is_array_layout(&self, kind: FieldType) -> bool {
        matches!(kind, FieldType::Nested(place) if self.get(place).name == "std_msgs/MultiArrayLayout")
    }

    /// Whether the message has no field but `data`, so that the topic is the better name.
    pub fn is_only_data(&self) -> bool {
        let fields = self.message().fields.iter();
        let mut others = fields.filter(|field| !self.is_array_layout(field.kind));
        others.next().is_some_and(|field| field.name == "data") && others.next().is_none()
    }

    /// The type of the transforms of which the message is a list.
    pub fn transforms(&self) -> Option<FieldType> {
        match &self.message().fields[..] {
            [field] if is_transforms(&self.message().name) => {
                Some(field.kind).filter(|_| field.count == Count::Sequence)
            }
            _ => None,
        }
    }
}

/// Whether a message type is a list of transforms; early versions of ROS 1 called it `tf/tfMessage`.
fn is_transforms(name: &str) -> bool {
    name.ends_with("/TFMessage") || name == "tf/tfMessage"
}

/// The name of a type without the `msg` folder that ROS 2 inserts between package and type.
fn normal(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// The field of a line; `None` for a constant.
fn field(line: &str, kind_of: impl Fn(&str) -> Option<FieldType>) -> Option<Result<Field, String>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim_start();
    let end = rest
        .find(|letter: char| letter.is_whitespace() || letter == '=')
        .unwrap_or(rest.len());
    // A default value may follow the name; with an equals sign the field is a constant.
    if rest[end..].trim_start().starts_with('=') {
        return None;
    }
    let unknown = || format!("its type contains {kind}");
    let (base, count) = match kind.split_once('[') {
        None => (kind, Some(Count::One)),
        Some((base, length)) => (base, length.strip_suffix(']').and_then(count_of)),
    };
    let base = base.split("<=").next().unwrap_or_default();
    let field = count.zip(kind_of(base));
    let field = field.map(|(count, kind)| Field {
        name: rest[..end].to_owned(),
        kind,
        count,
    });
    Some(field.ok_or_else(unknown))
}

/// The length in the brackets of an array: none, fixed, or an upper bound.
fn count_of(length: &str) -> Option<Count> {
    if length.is_empty() || length.starts_with("<=") {
        return Some(Count::Sequence);
    }
    length
        .parse()
        .ok()
        .filter(|count| *count > 0)
        .map(Count::Fixed)
}

fn kind_of(version: Version, base: &str, owner: &str, names: &[&str]) -> Option<FieldType> {
    let number = match base {
        "bool" => Number::Bool,
        "byte" if version == Version::Ros1 => Number::I8,
        "time" if version == Version::Ros1 => return Some(FieldType::Time([Number::U32; 2])),
        "duration" if version == Version::Ros1 => return Some(FieldType::Time([Number::I32; 2])),
        "int8" => Number::I8,
        "uint8" | "byte" | "char" => Number::U8,
        "int16" => Number::I16,
        "uint16" => Number::U16,
        "int32" => Number::I32,
        "uint32" => Number::U32,
        "int64" => Number::I64,
        "uint64" => Number::U64,
        "float32" => Number::F32,
        "float64" => Number::F64,
        "string" => return Some(FieldType::Text),
        _ => return nested(base, owner, names),
    };
    Some(FieldType::Number(number))
}

/// A type by its name, in the package of its owner if it states none.
fn nested(base: &str, owner: &str, names: &[&str]) -> Option<FieldType> {
    let package = owner.split('/').next().unwrap_or_default();
    let candidates = match base.contains('/') {
        true => [normal(base), String::new()],
        false => [format!("{package}/{base}"), format!("std_msgs/{base}")],
    };
    if ["builtin_interfaces/Time", "builtin_interfaces/Duration"].contains(&&*candidates[0]) {
        return Some(FieldType::Time([Number::I32, Number::U32]));
    }
    let place = |name: &String| names.iter().position(|known| known == name);
    candidates.iter().find_map(place).map(FieldType::Nested)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_fields_without_constants_comments_and_defaults() {
        let text = "# a comment\n\
            uint8 ON=1\nstring WORD = \"a # b\"\n\
            std_msgs/Header header  # stamped\n\
            float64[3] a\nint16[<=4] b [1, 2]\nstring<=10[] names\nchar c 65\nOwn own\n\
            ================================================================================\n\
            MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
            ===\nMSG: p/msg/Own\nbyte x\n";
        let parsed = Definitions::parse(Version::Ros2, "p/msg/Kind", text).unwrap();
        let fields: Vec<(&str, FieldType, Count)> = parsed
            .message()
            .fields
            .iter()
            .map(|field| (field.name.as_str(), field.kind, field.count))
            .collect();
        assert_eq!(
            fields,
            [
                ("header", FieldType::Nested(1), Count::One),
                ("a", FieldType::Number(Number::F64), Count::Fixed(3)),
                ("b", FieldType::Number(Number::I16), Count::Sequence),
                ("names", FieldType::Text, Count::Sequence),
                ("c", FieldType::Number(Number::U8), Count::One),
                ("own", FieldType::Nested(2), Count::One),
            ]
        );
        assert_eq!(
            parsed.get(1).fields[0].kind,
            FieldType::Time([Number::I32, Number::U32])
        );
        assert_eq!(parsed.get(2).name, "p/Own");
    }

    #[test]
    fn what_is_not_understood_is_named() {
        for (line, kind) in [
            ("wstring a", "wstring"),
            ("other/Type b", "other/Type"),
            ("int32[0] c", "int32[0]"),
            ("int32[-1] c", "int32[-1]"),
        ] {
            let error = Definitions::parse(Version::Ros2, "p/Kind", line).err();
            assert_eq!(error, Some(format!("its type contains {kind}")));
        }
    }

    #[test]
    fn words_of_ros_1_have_other_meanings() {
        let text = "Header header\nbyte a\nchar b\ntime c\nduration[2] d\n===\n\
            MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
        let parsed = Definitions::parse(Version::Ros1, "p/Kind", text).unwrap();
        let fields = parsed.message().fields.iter();
        let kinds: Vec<FieldType> = fields.map(|field| field.kind).collect();
        assert_eq!(
            kinds,
            [
                FieldType::Nested(1),
                FieldType::Number(Number::I8),
                FieldType::Number(Number::U8),
                FieldType::Time([Number::U32; 2]),
                FieldType::Time([Number::I32; 2]),
            ]
        );
        let error = Definitions::parse(Version::Ros2, "p/Kind", "time a").err();
        assert_eq!(error.as_deref(), Some("its type contains time"));
    }
}
