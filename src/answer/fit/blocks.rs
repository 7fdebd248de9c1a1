//! A fit in blocks: what it rests on, the values, the errors before and after, and what it leaves open.

use drivescope_discovery::Estimate;

use super::FitAnswer;
use crate::answer::block::{Align, Block, Cell, Column, Fact, TERMINAL, Table};
use crate::answer::{named, noise, not_told, parameters, run, unusable};
use crate::report::words::{balances, error, fit_percent, in_units_of_noise, number, percent};

/// Standard error over value from which on the recordings hardly tell a parameter.
const HARDLY_TOLD: f64 = 0.5;

impl FitAnswer {
    /// The answer in blocks.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let mut blocks = unusable(&self.signals);
        let fitted_to = self.recordings.iter().filter(|it| !it.held_out);
        let files: Vec<&str> = fitted_to.map(|it| it.file.as_str()).collect();
        blocks.push(Block::Verdict {
            about: named(&self.drive),
            words: format!("fitted to {}", files.join(", ")),
            remark: self.split.clone(),
        });
        let each = self.recordings.iter();
        let noises = each.flat_map(|it| it.noise.iter().map(|known| noise(known, &it.file)));
        let floor = format!("the noise floor of the error is {}", error(self.noise_floor));
        let run = run(self.observer_hz).note(floor);
        blocks.push(Block::Facts(noises.chain([run]).collect()));
        blocks.push(self.parameters());
        blocks.push(self.errors());
        blocks.extend(self.doubtful());
        blocks.extend(self.output.as_ref().map(|path| {
            Block::Facts(vec![Fact::new(TERMINAL, "written", path.display().to_string())])
        }));
        blocks
    }

    /// Of the machine, then of each recording alone.
    fn parameters(&self) -> Block {
        let machine = self.order.iter().map(|name| (&self.parameters[name], String::new()));
        let own = self.recordings.iter().flat_map(|it| {
            let of = format!("in {}", it.file);
            it.own.iter().map(move |own| (own, of.clone()))
        });
        parameters(machine.chain(own))
    }

    /// What people know first, what is left of torque, voltage and force; then errors in units of
    /// the noise, where those say something.
    fn errors(&self) -> Block {
        let columns = vec![
            Column::new(Align::Name, "Of"),
            Column::new(Align::Number, "Before"),
            Column::new(Align::Number, "After"),
        ];
        let mut table = Table::new("Before and after the fit", columns);
        let mut push = |what: String, before: String, after: String| {
            table.push([what, before, after].map(Cell::from).into());
        };
        let mut stated = false;
        let it = &self.unexplained;
        let all = [it.before, it.after, it.validation_before, it.validation_after];
        let [before, after, validation_before, validation_after] =
            all.map(|it| balances(self.motion, &it));
        for place in 0..before.len() {
            for (data, before, after) in [
                ("estimation", before[place], after[place]),
                ("validation", validation_before[place], validation_after[place]),
            ] {
                let Some((was, is)) = before.1.zip(after.1) else { continue };
                let share = |share: f64| format!("{} %", percent(share, 1));
                let what = format!("unexplained {}, {data}", before.0);
                push(what, share(was.share), share(is.share));
                stated = true;
            }
        }
        let it = &self.fit_percent;
        for (data, before, after) in [
            ("estimation", &it.before, &it.after),
            ("validation", &it.validation_before, &it.validation_after),
        ] {
            for (name, after) in after.iter().filter_map(|(name, fit)| Some((name, (*fit)?))) {
                let before = before.get(name).copied().flatten().unwrap_or(f64::NEG_INFINITY);
                push(format!("fit of {name}, {data}"), fit_percent(before), fit_percent(after));
                stated = true;
            }
        }
        let was = |before: Option<f64>| before.map_or("overflow".to_owned(), error);
        if let Some(force) = &self.relative_force_error {
            let what = |of: &str| format!("relative force error below {} Hz, {of}", force.band_hz);
            push(what("estimation"), was(force.before), error(force.after));
            if let Some(after) = force.validation_after {
                push(what("validation"), was(force.validation_before), error(after));
            }
            stated = true;
        }
        let in_reach = in_units_of_noise(self.error) && in_units_of_noise(self.validation_error);
        if !stated || in_reach {
            let what = |of: &str| format!("error in units of the noise, {of}");
            push(what("estimation"), was(self.before.error), error(self.error));
            let before = was(self.before.validation_error);
            push(what("validation"), before, error(self.validation_error));
        }
        Block::Table(table)
    }

    /// What the values do not rest on.
    fn doubtful(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut note = |words: String| blocks.push(Block::Note(words));
        if self.by_balances {
            note(
                "the values are those of least squares on the balances: the least error of the \
                 observed motion would leave more torque unexplained"
                    .to_owned(),
            );
        }
        for (name, share) in self.hardly_told() {
            let share = percent(share, 0);
            note(format!("{name} is hardly told: its standard error is {share} % of its value"));
        }
        for (a, b, rho) in &self.correlation.strong {
            note(format!("{a} and {b} are hardly told apart: correlation {}", number(*rho)));
        }
        let kept: Vec<&str> = self.kept.iter().map(|it| it.parameter.as_str()).collect();
        if !kept.is_empty() {
            let are = if kept.len() == 1 { "is" } else { "are" };
            note(format!(
                "all other values and standard errors hold only if the kept {} {are} right",
                kept.join(", ")
            ));
        }
        not_told(&self.kept).into_iter().chain(blocks).collect()
    }

    /// Parameters of the motor, which are positive, whose standard errors are that large a share
    /// of them.
    fn hardly_told(&self) -> impl Iterator<Item = (&str, f64)> {
        let of_motor = self.order.iter().filter(|name| !name.contains('.'));
        of_motor.filter_map(|name| {
            let Estimate { value, std_error, .. } = self.parameters.get(name)?;
            let share = std_error / value.abs();
            (share >= HARDLY_TOLD).then_some((name.as_str(), share))
        })
    }
}
