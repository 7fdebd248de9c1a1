//! The columns of a campaign: names, units, what they mean.

use drivescope_recording::dataset::{Column, Values};

use super::plan::{Method, Plan};

/// Name of the column that numbers the scenarios.
const SCENARIO: &str = "scenario";
/// Name of the column that says how they ended.
pub(super) const STATUS: &str = "status";

/// Name of the column that says why a foreign FMU gave no result.
const FAILURE: &str = "failure";

/// Columns of the campaign of that plan, without rows.
pub(super) fn columns(plan: &Plan) -> Vec<Column> {
    let speed = if plan.experiment.tacho_unit() == "m/s" { "m/s" } else { "rad/s" };
    let mut made = vec![
        integers(SCENARIO, "number of the scenario, from 0"),
        texts(STATUS, "done, not_finite (its state grew without bound) or aborted"),
        numbers("set_point", speed, "speed that the controller follows"),
    ];
    if plan.foreign.is_some() {
        made.insert(2, texts(FAILURE, "why an aborted scenario has no result, none of others"));
    }
    if plan.has_noise_seed() {
        made.push(integers("noise_seed", "number of the noise"));
    }
    for parameter in plan.parameters() {
        let (name, unit) = (parameter.name.as_str(), parameter.unit.as_str());
        made.push(numbers(name, unit, parameter.description));
    }
    for number in 1..=plan.most_faults() {
        let name = |what: &str| match number {
            1 => format!("fault_{what}"),
            _ => format!("fault_{number}_{what}"),
        };
        made.push(texts(&name("kind"), "what fails, none for health"));
        made.push(numbers(&name("size"), "1", "its size, in the unit of the mechanism"));
        made.push(numbers(&name("onset"), "s", "when it begins"));
        made.push(numbers(&name("end"), "s", "when it ends"));
        made.push(texts(&name("profile"), "how it goes with time"));
    }
    made.push(numbers(
        "beta",
        "1",
        "share of healthy samples expected outside thresholds and bands",
    ));
    made.push(integers("window", "exceedances in a row that declare a fault"));
    made.push(numbers(
        "arl_0",
        "1",
        match plan.methods.contains(&Method::Bank) {
            false => "mean samples between false alarms the CUSUM is designed for",
            true => "mean samples between false alarms CUSUM and bank are designed for",
        },
    ));
    made.push(numbers("kappa", "1", "drift of the CUSUM, in standard deviations"));
    made.push(numbers("healthy_time", "s", "judged time before the first fault"));
    if plan.tests_residual() {
        made.push(numbers(
            "residual",
            plan.experiment.tacho_unit(),
            "mean residual of the process model over the fault, 0 without one",
        ));
    }
    for method in &plan.methods {
        let name = |what: &str| format!("{}_{what}", method.id());
        made.push(flags(&name("detected"), "whether the fault was declared"));
        made.push(numbers(&name("detection_time"), "s", "when it was declared, t_dt"));
        made.push(numbers(&name("delay"), "s", "from its onset to its declaration"));
        made.push(numbers(&name("false_alarms"), "1", "declarations before that"));
        let [healthy, faulty] = match method {
            Method::Bank => [
                "share of innovations outside their 95 % band before the first fault",
                "share of innovations outside their 95 % band in it",
            ],
            _ => {
                ["share of healthy samples outside, r_fd", "share of faulty samples outside, r_td"]
            }
        };
        made.push(numbers(&name("outside_healthy"), "1", healthy));
        made.push(numbers(&name("outside_fault"), "1", faulty));
        if *method == Method::Bank {
            made.extend(of_bank());
        }
    }
    made
}

/// What a bank says beside.
fn of_bank() -> [Column; 7] {
    [
        texts(
            "bank_baseline",
            "learned, or why the run-up showed no healthy machine: too_short, nothing_measured, \
             at_rest, out_of_tolerance, not_this_machine, changes",
        ),
        texts(
            "bank_mechanism",
            "what was named, unknown where no mechanism explains it, none without an alarm, retracted \
             where all were taken back, undecided where the run ended before, not_learned without a \
             machine",
        ),
        texts("bank_set", "confusion set: what was named and all that it may be, parted by blanks"),
        flags("bank_in_set", "whether a fault that acted until then is in the confusion set"),
        numbers("bank_size", "1", "estimated size, in the unit of the mechanism that was named"),
        numbers("bank_size_low", "1", "lower end of its 95 % interval"),
        numbers("bank_size_high", "1", "upper end of its 95 % interval"),
    ]
}

fn column(name: &str, unit: &str, description: &str, values: Values) -> Column {
    let [name, unit, description] = [name, unit, description].map(str::to_owned);
    Column { name, unit, description, values }
}

fn integers(name: &str, description: &str) -> Column {
    column(name, "", description, Values::Integers(Vec::new()))
}

fn numbers(name: &str, unit: &str, description: &str) -> Column {
    column(name, unit, description, Values::Numbers(Vec::new()))
}

fn flags(name: &str, description: &str) -> Column {
    column(name, "", description, Values::Flags(Vec::new()))
}

fn texts(name: &str, description: &str) -> Column {
    column(name, "", description, Values::Texts(Vec::new()))
}
