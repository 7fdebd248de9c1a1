//! The methods that can be asked for on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use drivescope_monitor::Method;

/// Reads a method by its name.
pub(super) fn parser() -> impl TypedValueParser<Value = Method> {
    let possible = Method::all().map(|it| PossibleValue::new(it.id()).help(it.about()));
    PossibleValuesParser::new(possible)
        .try_map(|id: String| Method::find(&id).ok_or("no such method"))
}
