//! Whether the FMU computes what the drive computes, here and in another program.

use drivescope_scenarios::results::{FaultName, FmuSummary, StudyResults};
use maud::{Markup, PreEscaped, html};

use crate::report::page::{self, minus, table};
use crate::report::words::{difference, fault};

/// Version of FMI, interface, and the greatest relative difference that is taken for agreement:
/// rounding for Co-Simulation, the integrator's tolerance of 1e-9 for Model Exchange.
const RUNS: [(u8, &str, f64); 4] =
    [(2, "CS", 1e-12), (2, "ME", 1e-7), (3, "CS", 1e-12), (3, "ME", 1e-7)];

/// The section.
pub(super) fn section(study: &StudyResults) -> Markup {
    let fmu = &study.fmu;
    let native = fmu.max_relative_difference_native;
    page::section(
        "fmu",
        "The FMU against other runs",
        &html! {
            p {
                "Every run above is a run of the exported FMU. Greatest difference from the native "
                "runs of the same drive with the same noise, relative to the greatest magnitude of "
                "each signal: "
                strong { (minus(&difference(native))) } "."
            }
            // The comparison with fmpy puts its table between these two.
            (PreEscaped("<!-- fmpy -->"))
            @if fmu.fmpy.is_empty() {
                p.note {
                    "fmpy was not run for this report. "
                    code { "tools/compare_fmpy DIR" }
                    " runs the same faults in it, FMI 2.0 and 3.0, and adds the comparison here."
                }
            } @else {
                (comparison(fmu))
            }
            (PreEscaped("<!-- /fmpy -->"))
        },
    )
}

fn comparison(fmu: &FmuSummary) -> Markup {
    let mut faults: Vec<&FaultName> = Vec::new();
    for row in &fmu.fmpy {
        if !faults.contains(&&row.fault) {
            faults.push(&row.fault);
        }
    }
    let head = html! {
        tr {
            th.name scope="col" { "Fault" }
            @for (fmi, kind, limit) in RUNS {
                th scope="col" {
                    "FMI " (fmi) ".0 " (kind) br; "limit " (minus(&format!("{limit:.0e}")))
                }
            }
        }
    };
    let body = html! {
        @for name in faults {
            tr {
                th scope="row" { (minus(&fault(name))) }
                @for (fmi, kind, limit) in RUNS {
                    @let row = fmu.fmpy.iter().find(|row| {
                        row.fault == *name && row.fmi == fmi && row.kind == kind
                    });
                    td {
                        @match row.map(|row| row.max_relative_difference) {
                            // A difference that is no number is none within the limit.
                            Some(found) => {
                                span.alert[!matches!(found.partial_cmp(&limit),
                                    Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal))] {
                                    (minus(&difference(found)))
                                }
                            }
                            None => { "not run" }
                        }
                    }
                }
            }
        }
    };
    html! {
        (table("Greatest relative difference between fmpy and this program", &head, &body))
        p.note {
            "Numbers above their limit are set in bold. CS: Co-Simulation, the FMU's own "
            "integration. ME: Model Exchange, integrated by fmpy with CVode at a tolerance of 1e\u{2212}9."
        }
    }
}
