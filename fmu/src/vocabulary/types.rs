//! Types of variables: the fifteen of FMI 3.0, of which FMI 2.0 has five under names of its own.

use super::Version;

/// The type of a variable's value. FMI 2.0's `Real` is `Float64` and its `Integer` is `Int32`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Type {
    Float64,
    Float32,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    Enumeration,
    String,
    Binary,
    Clock,
}

/// Every type with its name in FMI 3.0, and in FMI 2.0 where that has it.
const NAMES: [(Type, &str, Option<&str>); 15] = [
    (Type::Float64, "Float64", Some("Real")),
    (Type::Float32, "Float32", None),
    (Type::Int8, "Int8", None),
    (Type::UInt8, "UInt8", None),
    (Type::Int16, "Int16", None),
    (Type::UInt16, "UInt16", None),
    (Type::Int32, "Int32", Some("Integer")),
    (Type::UInt32, "UInt32", None),
    (Type::Int64, "Int64", None),
    (Type::UInt64, "UInt64", None),
    (Type::Boolean, "Boolean", Some("Boolean")),
    (Type::Enumeration, "Enumeration", Some("Enumeration")),
    (Type::String, "String", Some("String")),
    (Type::Binary, "Binary", None),
    (Type::Clock, "Clock", None),
];

impl Type {
    /// The name that FMI 3.0 gives it.
    pub fn name(self) -> &'static str {
        let found = NAMES.iter().find(|(it, ..)| *it == self);
        found.map_or("", |(_, three, _)| three)
    }

    /// Its name in that version, which is that of its XML element; `None` where it has none.
    pub fn name_in(self, version: Version) -> Option<&'static str> {
        let (_, three, two) = NAMES.iter().find(|(it, ..)| *it == self)?;
        match version {
            Version::Two => *two,
            Version::Three => Some(three),
        }
    }

    /// The type of that name in that version.
    #[cfg(feature = "import")]
    pub(crate) fn read(name: &str, version: Version) -> Option<Type> {
        NAMES.iter().map(|(it, ..)| *it).find(|it| it.name_in(version) == Some(name))
    }

    /// Whether it is a floating-point type.
    pub fn is_float(self) -> bool {
        matches!(self, Type::Float64 | Type::Float32)
    }

    /// Whether its values are numbers (Boolean: 0 and 1).
    pub fn is_numeric(self) -> bool {
        !matches!(self, Type::String | Type::Binary | Type::Clock)
    }
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_read_by_its_name_and_no_other() {
        let two: Vec<_> = NAMES.iter().filter_map(|(it, ..)| it.name_in(Version::Two)).collect();
        assert_eq!(two, ["Real", "Integer", "Boolean", "Enumeration", "String"]);
        for (it, three, _) in NAMES {
            assert_eq!((it.name(), Type::read(three, Version::Three)), (three, Some(it)));
        }
        assert_eq!(Type::read("Real", Version::Two), Some(Type::Float64));
        assert_eq!(Type::read("Real", Version::Three), None);
        assert_eq!(Type::read("Float64", Version::Two), None);
    }
}
