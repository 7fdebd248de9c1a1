//! A study as tables for the terminal: what was found, beside the paper's figures.
//!
//! Plain text of at most 80 columns, without colours, so that it reads the same in a log.

use comfy_table::{Cell, CellAlignment, ContentLineStyle, LineStyle, Table, TableStyle};
use drivescope_scenarios::results::{DetectorKind, IN_PAPER, StudyResults};
use drivescope_scenarios::trials::{Detectable, HiddenEffect};

use crate::report::words::{
    count, difference, fault, given, greatest, number, p_value, paper_delay, paper_row, percent,
    rows_of, si_units, torque, verdict,
};

/// What the study found, as text that ends in a line break: a table of detections a method, the
/// false detection rates, the models, the sizes, the agreement of the FMU, and the verdict last,
/// where the eye is when the program ends.
pub fn study(study: &StudyResults) -> String {
    let mut text = setting(study);
    for method in IN_PAPER {
        let title = format!("Table 1, {}", method.label());
        text += &section(&title, &detection(study, method));
    }
    text += &format!(
        "t_dt and delay in samples of {} ms; in brackets: after a false alarm\n",
        given(1e3 * study.drive.period_s)
    );
    if !study.further.is_empty() {
        text += &section("Beside the twelve: delay in samples, share outside [%]", &further(study));
    }
    let healthy = &study.healthy;
    let title = format!("{}, {} samples", count(healthy.runs, "healthy run"), healthy.samples);
    text += &section(&title, &rates(study));
    text += &section("All methods and levels", &levels(study));
    text += &section("Models and residual", &models(study));
    text += &section(
        "Isolation, lowest share of right answers (QDA: quadratic discriminant)",
        &isolation(study),
    );
    text += &section("Size of the symptom, S of (27)", &identification(study));
    if let Some(hidden) = &study.hidden_effect {
        let title = format!("Smallest detectable size, %, {} hidden and added", hidden.effect);
        text += &section(&title, &hidden_effect(hidden));
    }
    text += &section("FMU against other runs, greatest relative difference", &fmu(study));
    if study.fmu.fmpy.is_empty() {
        text += "fmpy was not run: tools/compare_fmpy adds its rows\n";
    }
    text.push('\n');
    for method in DetectorKind::ALL {
        text += &verdict(study, method);
        text.push('\n');
    }
    text
}

fn hidden_effect(hidden: &HiddenEffect) -> Table {
    let mut table = table(["mechanism", "before", "after"], 1);
    let size = |of: &Detectable| of.size.map_or("none".to_owned(), |size| percent(size, 2));
    for (before, after) in hidden.before.mechanisms.iter().zip(&hidden.after.mechanisms) {
        table.add_row([before.mechanism.replace('_', " "), size(before), size(after)]);
    }
    table
}

fn setting(study: &StudyResults) -> String {
    let (drive, noise) = (&study.drive, &study.noise);
    let (speed, force) = si_units(&drive.tacho_unit);
    format!(
        "{} at {} {}, sampled every {} ms, seed {}\n\
         noise sd: reference {} {speed}, tachometer {} {speed}, current {} A, load {} {force}\n\
         torque fault read as {}; faults act over samples {} to {} ({})\n\
         process model: {}\n",
        // A name must not steer the terminal.
        drive.name.replace(char::is_control, "?"),
        given(drive.set_point),
        drive.tacho_unit,
        given(1e3 * drive.period_s),
        study.seed,
        given(noise.reference),
        given(noise.omega),
        given(noise.i),
        given(noise.torque),
        torque(study.torque),
        study.fault_span.from,
        study.fault_span.to,
        study.profile,
        study.model.process_model,
    )
}

fn section(title: &str, table: &Table) -> String {
    format!("\n{title}\n{table}\n")
}

/// Rules above and below, and one under the headings: rows need none.
const RULES: TableStyle = TableStyle::new()
    .top_border(RULE)
    .header_lines(ContentLineStyle::none())
    .header_separator(RULE)
    .content_lines(ContentLineStyle::none())
    .bottom_border(RULE);
const RULE: LineStyle = LineStyle::new('─', '─', '─', '─');

/// A table with these headings, the first `names` columns flush left, numbers flush right.
fn table<const N: usize>(headings: [&str; N], names: usize) -> Table {
    let mut table = Table::new();
    table.load_style(RULES);
    table.set_header(headings.map(Cell::new));
    for (place, column) in table.column_iter_mut().enumerate() {
        let alignment = if place < names { CellAlignment::Left } else { CellAlignment::Right };
        column.set_cell_alignment(alignment);
    }
    table
}

/// Runs with other kinds of faults, or several at once.
fn further(study: &StudyResults) -> Table {
    let mut table = table(["faults", "method", "delay", "r_td [%]", "false alarms"], 2);
    for row in study.further.iter().flat_map(|run| &run.detection) {
        table.add_row([
            // As it was typed: it must not steer the terminal.
            row.fault.label.replace(char::is_control, "?"),
            row.method.label().to_owned(),
            row.delay.map_or_else(|| "none".to_owned(), |delay| delay.to_string()),
            percent(row.r_td, 1),
            row.false_alarms.to_string(),
        ]);
    }
    table
}

fn detection(study: &StudyResults, method: DetectorKind) -> Table {
    let headings = ["fault", "paper's", "r_td [%]", "paper", "t_dt", "paper", "delay", "paper"];
    let mut table = table(headings, 2);
    for row in rows_of(&study.detection, method) {
        let paper = paper_row(study, &row.fault.label, method);
        let none = || "-".to_owned();
        let ours = match (row.t_dt, row.delay) {
            (Some(t_dt), Some(delay)) if row.detected() => [t_dt.to_string(), delay.to_string()],
            (Some(t_dt), _) => [format!("({t_dt})"), none()],
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
    for method in DetectorKind::ALL {
        table.add_row([
            method.label().to_owned(),
            percent(study.r_fd.of(method), 2),
            study.paper.r_fd.of(method).map_or_else(|| "-".into(), |rate| percent(rate, 1)),
            method.info().instead_of_level.map_or_else(|| percent(study.beta, 0), Into::into),
            study.healthy.alarms.of(method).to_string(),
        ]);
    }
    table
}

fn levels(study: &StudyResults) -> Table {
    let headings = ["method", "beta", "detected", "least r_td [%]", "delay", "r_fd [%]"];
    let mut table = table(headings, 1);
    let own = (study.beta, &study.detection, study.r_fd);
    let others = study.levels.iter().map(|level| (level.beta, &level.detection, level.r_fd));
    for (beta, detection, r_fd) in std::iter::once(own).chain(others) {
        for method in DetectorKind::ALL {
            let rows = rows_of(detection, method);
            let found = rows.iter().filter(|row| row.detected()).count();
            let lowest = rows.iter().map(|row| row.r_td).reduce(f64::min);
            let longest = rows.iter().filter_map(|row| row.delay).max();
            let none = || "-".to_owned();
            table.add_row([
                method.label().to_owned(),
                given(beta),
                format!("{found} of {}", rows.len()),
                lowest.map_or_else(none, |lowest| percent(lowest, 1)),
                longest.map_or_else(none, |longest| longest.to_string()),
                percent(r_fd.of(method), 2),
            ]);
        }
    }
    table
}

fn isolation(study: &StudyResults) -> Table {
    let headings = ["classes", "right [%]", "mean [%]", "unknown [%]", "QDA [%]"];
    let mut table = table(headings, 1);
    let tables = [
        ("the paper's ten", &study.isolation_paper),
        ("those of our test", &study.isolation_merged),
        ("every fault its own", &study.isolation),
    ];
    for (name, of) in tables {
        let right: Vec<f64> = (0..of.faults.len()).map(|fault| of.right(fault)).collect();
        let unknown = of.matrix.iter().filter_map(|row| row.last());
        let rows = right.len().max(1) as f64;
        table.add_row([
            format!("{name} ({})", of.classes.len()),
            percent(right.iter().copied().fold(1.0, f64::min), 1),
            percent(right.iter().sum::<f64>() / rows, 1),
            percent(unknown.sum::<f64>() / rows, 1),
            percent(of.discriminant.iter().copied().fold(1.0, f64::min), 1),
        ]);
    }
    table
}

fn models(study: &StudyResults) -> Table {
    let (model, unit) = (&study.model, &study.drive.tacho_unit);
    let mut table = table(["quantity", "value"], 2);
    let rows = [
        ("sd of its free-run error in training", format!("{} {unit}", number(model.training_sd))),
        (
            "residual on healthy design data, mean",
            format!("{} {unit}", number(model.residual_mean)),
        ),
        ("residual on healthy design data, sd", format!("{} {unit}", number(model.residual_sd))),
        ("error model: past outputs, past inputs", format!("{}, {}", model.n_a, model.n_b)),
        ("its SSE, one step, in set points squared", number(model.error_model_sse)),
        ("samples of that sum", model.error_model_samples.to_string()),
        ("the paper's, over 3000 samples", number(study.paper.arx_sse)),
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
    let all = rows_of(&study.detection, DetectorKind::Mem).len().to_string();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{fmpy, study as synthetic};

    /// Columns of a plain terminal.
    const WIDTH: usize = 80;

    #[test]
    fn tables_fit_a_plain_terminal() {
        let mut found = synthetic();
        found.fmu.fmpy = fmpy();
        // What the drive and the models are called is not ours to shorten.
        found.drive.name = "DR300".into();
        for line in study(&found).lines().filter(|line| line.starts_with([' ', '\u{2500}'])) {
            assert!(line.chars().count() <= WIDTH, "{line}");
        }
    }

    #[test]
    fn ours_stand_beside_the_papers() {
        let mut found = synthetic();
        found.detection[0].t_dt = None;
        found.detection[0].delay = None;
        found.detection[1].false_alarms = 1;
        let text = study(&found);
        let words = |start: &str| -> Vec<Vec<String>> {
            let rows = text.lines().filter(|line| line.trim_start().starts_with(start));
            rows.map(|row| row.split_whitespace().map(str::to_owned).collect()).collect()
        };
        let five = words("tacho +5 %");
        assert_eq!(five[0][3..], ["f_1^1", "99.9", "97.9", "none", "4074", "-", "74"]);
        assert_eq!(five[1][3..], ["f_1^1", "99.3", "98.1", "4054", "4072", "54", "72"]);
        assert_eq!(five[2][3..], ["f_1^1", "9.00", "2.45"]);
        assert_eq!(words("tacho -5 %")[0][6..], ["(4056)", "4055", "-", "55"]);
        assert_eq!(words("flux -5 %")[1][6..], ["4055", "(3132)", "55", "-"]);
        assert!(text.contains("10 of 12 faults detected by model error modelling, 0 false alarms"));
        assert!(text.contains("fmpy was not run"));
    }

    #[test]
    fn a_difference_that_is_no_number_is_not_hidden() {
        let mut found = synthetic();
        found.fmu.fmpy = fmpy();
        found.fmu.fmpy[4].max_relative_difference = f64::NAN;
        let text = study(&found);
        let row = text.lines().find(|line| line.contains("FMI 2.0 CS")).unwrap();
        assert!(row.contains("NaN"), "{row}");
    }

    #[test]
    fn a_name_does_not_steer_the_terminal() {
        let mut found = synthetic();
        found.drive.name = "a\u{1b}[2Jb\n".into();
        assert!(study(&found).starts_with("a?[2Jb? at 2000 rpm"));
    }
}
