//! The methods that can be asked for on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use drivescope_monitor::Method;

/// What a method is, for the help.
fn about(method: Method) -> &'static str {
    match method {
        Method::Bank => {
            "The bank of hypotheses over the drive's equations; the default where the diagnoser \
             has one"
        }
        Method::Windows => {
            "Windows of the residual against a baseline; the default where one is given and there \
             is no bank"
        }
        Method::Mem => "Bands by model error modelling, ARX error model; else the default",
        Method::MemRecurrent => "The same with the recurrent error model",
        Method::Constant => "Constant thresholds",
        Method::Gmdh => "Intervals of the GMDH network",
    }
}

/// Reads a method by its name.
pub(super) fn parser() -> impl TypedValueParser<Value = Method> {
    let possible = Method::ALL.map(|it| PossibleValue::new(it.id()).help(about(it)));
    PossibleValuesParser::new(possible).map(|id: String| {
        let named = Method::ALL.into_iter().find(|method| method.id() == id);
        named.unwrap_or(Method::Mem)
    })
}
