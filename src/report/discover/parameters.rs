//! Parameters with their standard errors.

use drivescope_discovery::Estimate;
use maud::{Markup, html};

use crate::report::page::{math, minus, table};
use crate::report::words::number;

/// The table; `value` shows the value of a parameter.
pub(crate) fn parameters(all: &[Estimate], value: &dyn Fn(&Estimate) -> Markup) -> Markup {
    let head = html! {
        tr {
            th.name scope="col" { "Parameter" }
            th scope="col" { "Value" }
            th scope="col" { "Standard error" }
            th.name scope="col" { "Unit" }
            th scope="col" { "Before" }
            th.name scope="col" { "Remark" }
        }
    };
    let body = html! {
        @for it in all {
            tr {
                th scope="row" { (math(&it.name)) }
                td { (value(it)) }
                td { @if it.std_error.is_finite() { (minus(&number(it.std_error))) } @else { "\u{2013}" } }
                td.name { (it.unit) }
                td { @if it.before.is_finite() { (minus(&number(it.before))) } @else { "\u{2013}" } }
                td.name { @if it.at_bound { "at its bound" } }
            }
        }
    };
    table("Values in SI units, one standard error", &head, &body)
}
