//! A study as tables for the terminal: what was found, beside the paper's figures.
//!
//! Plain text of at most 80 columns, without colours, so that it reads the same in a log.

use comfy_table::{Cell, CellAlignment, Table, presets};
use drivescope_scenarios::results::{Method, StudyResults};

use crate::report::words::{
    count, difference, fault, greatest, number, p_value, paper_delay, paper_row, percent, rows_of,
    si_units, torque, verdict,
};

/// What the study found, as text that ends in a line break: a table of detections a method, the
/// false detection rates, the models, the sizes, the agreement of the FMU, and the verdict last,
/// where the eye is when the program ends.
pub fn study(study: &StudyResults) -> String {
    let mut text = setting(study);
    for method in Method::ALL {
        let title = format!("Table 1, {}", method.label());
        text += &section(&title, &detection(study, method));
    }
    text += "t_dt and delay in samples; in brackets: declared before the fault began\n";
    text += &section("Healthy runs", &rates(study));
    text += &section("Models and residual", &models(study));
    text += &section("Size of the symptom, S of (27)", &identification(study));
    text += &section("FMU against other runs, greatest relative difference", &fmu(study));
    if study.fmu.fmpy.is_empty() {
        text += "fmpy was not run: tools/compare_fmpy adds its rows\n";
    }
    text.push('\n');
    for method in Method::ALL {
        text += &verdict(study, method);
        text.push('\n');
    }
    text
}

fn setting(study: &StudyResults) -> String {
    let (drive, noise) = (&study.drive, &study.noise);
    let (speed, force) = si_units(&drive.tacho_unit);
    format!(
        "{} at {} {}, sampled every {} ms, seed {}\n\
         noise sd: reference {} {speed}, tachometer {} {speed}, current {} A, load {} {force}\n\
         torque fault read as {}; faults act over samples {} to {}\n",
        drive.name,
        number(drive.set_point),
        drive.tacho_unit,
        number(1e3 * drive.period_s),
        study.seed,
        number(noise.reference),
        number(noise.omega),
        number(noise.i),
        number(noise.torque),
        torque(study.torque),
        study.fault_span.from,
        study.fault_span.to,
    )
}

fn section(title: &str, table: &Table) -> String {
    format!("\n{title}\n{table}\n")
}

/// A table with these headings, the first `names` columns flush left, numbers flush right.
fn table<const N: usize>(headings: [&str; N], names: usize) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY);
    table.set_header(headings.map(|heading| Cell::new(heading)));
    for (place, column) in table.column_iter_mut().enumerate() {
        let alignment = if place < names { CellAlignment::Left } else { CellAlignment::Right };
        column.set_cell_alignment(alignment);
    }
    table
}

fn detection(study: &StudyResults, method: Method) -> Table {
    let headings = ["fault", "paper's", "r_td [%]", "paper", "t_dt", "paper", "delay", "paper"];
    let mut table = table(headings, 2);
    for row in rows_of(&study.detection, method) {
        let paper = paper_row(study, &row.fault.label, method);
        let none = || "-".to_owned();
        let ours = match (row.t_dt, row.delay) {
            (Some(t_dt), Some(delay)) => [t_dt.to_string(), delay.to_string()],
            (Some(t_dt), None) => [format!("({t_dt})"), none()],
            (None, _) => ["none".to_owned(), none()],
        };
        let [t_dt, delay] = ours;
        let [paper_t_dt, paper_delay] = paper.map_or_else(
            || [none(), none()],
            |row| match paper_delay(study, row) {
                early if early < 0 => [format!("({})", row.t_dt), none()],
                delay => [row.t_dt.to_string(), delay.to_string()],
            },
        );
        table.add_row([
            fault(&row.fault),
            row.fault.label.clone(),
            percent(row.r_td, 1),
            paper.map_or_else(none, |row| percent(row.r_td, 1)),
            t_dt,
            paper_t_dt,
            delay,
            paper_delay,
        ]);
    }
    table
}

fn rates(study: &StudyResults) -> Table {
    let mut table = table(["method", "r_fd [%]", "paper [%]", "designed [%]", "false alarms"], 1);
    for method in Method::ALL {
        table.add_row([
            method.label().to_owned(),
            percent(*study.r_fd.of(method), 2),
            percent(*study.paper.r_fd.of(method), 1),
            percent(study.beta, 0),
            study.healthy.alarms.of(method).to_string(),
        ]);
    }
    table.add_row([format!(
        "{} samples of {}",
        study.healthy.samples,
        count(study.healthy.runs, "run")
    )]);
    table
}

fn models(study: &StudyResults) -> Table {
    let (model, unit) = (&study.model, &study.drive.tacho_unit);
    let mut table = table(["", ""], 1);
    table.set_header(["quantity", "value"]);
    let rows = [
        ("process model", model.process_model.clone()),
        ("sd of its free-run error in training", format!("{} {unit}", number(model.training_sd))),
        (
            "residual on healthy design data, mean",
            format!("{} {unit}", number(model.residual_mean)),
        ),
        ("residual on healthy design data, sd", format!("{} {unit}", number(model.residual_sd))),
        ("error model: past outputs, past inputs", format!("{}, {}", model.n_a, model.n_b)),
        (
            "its SSE, one step, scaled signals",
            format!(
                "{} over {} samples (paper {} over 3000)",
                number(model.error_model_sse),
                model.error_model_samples,
                number(study.paper.arx_sse)
            ),
        ),
        ("v, sd of r - y_e", format!("{} {unit}", number(model.v))),
        (
            "constant thresholds",
            format!("{} to {} {unit}", number(model.constant.0), number(model.constant.1)),
        ),
        ("r - y_e white? p value", p_value(model.whiteness_p)),
        ("r - y_e normal? p value", p_value(model.normality_p)),
    ];
    for (quantity, value) in rows {
        table.add_row([quantity.to_owned(), value]);
    }
    table
}

fn identification(study: &StudyResults) -> Table {
    let mut table = table(["fault", "paper's", "S [-]", "paper [-]"], 2);
    for row in &study.identification {
        table.add_row([
            fault(&row.fault),
            row.fault.label.clone(),
            format!("{:.2}", row.s),
            format!("{:.2}", row.s_paper),
        ]);
    }
    table
}

fn fmu(study: &StudyResults) -> Table {
    let mut table = table(["against", "runs", "difference [-]"], 1);
    let native = study.fmu.max_relative_difference_native;
    let all = rows_of(&study.detection, Method::Mem).len().to_string();
    table.add_row(["native runs".to_owned(), all, difference(native)]);
    for (fmi, kind) in [(2, "CS"), (2, "ME"), (3, "CS"), (3, "ME")] {
        let found = study.fmu.fmpy.iter().filter(|row| row.fmi == fmi && row.kind == kind);
        let differences: Vec<f64> = found.map(|row| row.max_relative_difference).collect();
        if !differences.is_empty() {
            let runs = differences.len().to_string();
            table.add_row([
                format!("fmpy, FMI {fmi}.0 {kind}"),
                runs,
                difference(greatest(differences)),
            ]);
        }
    }
    table
}
