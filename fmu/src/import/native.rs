//! The types that values have in C, and how the importer's numbers (`f64`) become them and back.

use super::boolean::Boolean2;
use super::functions::{Functions, Instance, Refs};

/// A function that reads values. FMI 3.0 also passes the number of values, for arrays.
pub(super) enum Getter<T> {
    Two(Option<unsafe extern "C" fn(Instance, Refs, usize, *mut T) -> i32>),
    Three(Option<unsafe extern "C" fn(Instance, Refs, usize, *mut T, usize) -> i32>),
}

/// A function that writes values.
pub(super) enum Setter<T> {
    Two(Option<unsafe extern "C" fn(Instance, Refs, usize, *const T) -> i32>),
    Three(Option<unsafe extern "C" fn(Instance, Refs, usize, *const T, usize) -> i32>),
}

/// A type that values have in C.
pub(super) trait Native: Copy + Default {
    fn getter(functions: &Functions) -> Getter<Self>;
    fn setter(functions: &Functions) -> Setter<Self>;
    /// The value as this type; `None` if it cannot hold it exactly (a float is rounded).
    fn from_number(value: f64) -> Option<Self>;
    fn number(self) -> f64;
}

macro_rules! native {
    ($kind:ty, $two_get:expr, $two_set:expr, $three_get:expr, $three_set:expr, $from:expr, $to:expr) => {
        impl Native for $kind {
            fn getter(functions: &Functions) -> Getter<Self> {
                match functions {
                    Functions::Two(f) => Getter::Two($two_get(f)),
                    Functions::Three(f) => Getter::Three($three_get(f)),
                }
            }
            fn setter(functions: &Functions) -> Setter<Self> {
                match functions {
                    Functions::Two(f) => Setter::Two($two_set(f)),
                    Functions::Three(f) => Setter::Three($three_set(f)),
                }
            }
            fn from_number(value: f64) -> Option<Self> {
                $from(value)
            }
            fn number(self) -> f64 {
                $to(self)
            }
        }
    };
}

use super::functions::{Three, Two};

/// FMI 2.0 or FMI 3.0 lacks the type.
macro_rules! only_three {
    ($($kind:ty, $get:ident, $set:ident;)*) => {$(
        native!($kind, |_: &Two| None, |_: &Two| None, |f: &Three| f.$get, |f: &Three| f.$set,
            integer, |value| value as f64);
    )*};
}

/// A whole number within the type's range. The comparison goes through the type and back, so that
/// 2^63 is not taken for the largest `i64`.
fn integer<T: TryFrom<i128>>(value: f64) -> Option<T> {
    (value.fract() == 0.0).then(|| T::try_from(value as i128).ok()).flatten()
}

fn boolean(value: f64) -> Option<bool> {
    (value == 0.0 || value == 1.0).then_some(value == 1.0)
}

native!(
    f64,
    |f: &Two| f.get_real,
    |f: &Two| f.set_real,
    |f: &Three| f.get_float64,
    |f: &Three| f.set_float64,
    Some,
    |v| v
);
native!(
    f32,
    |_: &Two| None,
    |_: &Two| None,
    |f: &Three| f.get_float32,
    |f: &Three| f.set_float32,
    |v: f64| Some(v as f32),
    f64::from
);
native!(
    i32,
    |f: &Two| f.get_integer,
    |f: &Two| f.set_integer,
    |f: &Three| f.get_int32,
    |f: &Three| f.set_int32,
    integer,
    f64::from
);
native!(
    bool,
    |_: &Two| None,
    |_: &Two| None,
    |f: &Three| f.get_boolean,
    |f: &Three| f.set_boolean,
    boolean,
    |v: bool| f64::from(u8::from(v))
);
native!(
    Boolean2,
    |f: &Two| f.get_boolean,
    |f: &Two| f.set_boolean,
    |_: &Three| None,
    |_: &Three| None,
    |v| boolean(v).map(|v| Boolean2(i32::from(v))),
    |v: Boolean2| f64::from(u8::from(v.0 != 0))
);
only_three! {
    i8, get_int8, set_int8;
    u8, get_uint8, set_uint8;
    i16, get_int16, set_int16;
    u16, get_uint16, set_uint16;
    u32, get_uint32, set_uint32;
    i64, get_int64, set_int64;
    u64, get_uint64, set_uint64;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_a_type_cannot_hold_are_refused() {
        assert_eq!(i8::from_number(-128.0), Some(-128));
        assert_eq!(i8::from_number(128.0), None);
        assert_eq!(u8::from_number(-1.0), None);
        assert_eq!(i32::from_number(0.5), None);
        assert_eq!(i32::from_number(f64::NAN), None);
        assert_eq!(i64::from_number(9_223_372_036_854_775_808.0), None);
        assert_eq!(u64::from_number(9_223_372_036_854_775_808.0), Some(1 << 63));
        assert_eq!(bool::from_number(2.0), None);
        assert_eq!(Boolean2::from_number(1.0), Some(Boolean2(1)));
        assert_eq!(Boolean2(7).number(), 1.0);
    }
}
