//! What a column of a recording is said to be.

use drivescope_recording::{Choice, Mapping, ReadOptions, choices};

use super::Taken;

impl Taken {
    /// Takes the column as that signal in that unit (as none where the signal has no name; in the
    /// unit of its header where none is given).
    ///
    /// # Errors
    /// Why the recording cannot be read so; it stays as it was.
    pub(in crate::page) fn map(
        &mut self,
        column: &str,
        signal: &str,
        unit: &str,
    ) -> Result<(), String> {
        let unknown = || format!("{}: it has no column `{column}`", self.name);
        let preview = self.preview.as_ref().ok_or_else(unknown)?;
        let there = preview.find(column).ok_or_else(unknown)?;
        let is =
            |map: &Mapping, key: &str| preview.find(&map.foreign).is_some_and(|it| it.key == key);
        let mut columns = self.options.columns.clone();
        columns.retain(|it| !is(it, &there.key) && it.canonical != signal);
        if signal.is_empty() {
            columns.push(Mapping::unused(&there.key));
        } else {
            let choice = choices().find(|it| it.signal == signal);
            let choice = choice.ok_or_else(|| format!("there is no signal `{signal}`"))?;
            // Another column of that very name gives way.
            let others =
                preview.columns.iter().filter(|it| it.name == signal && it.key != there.key);
            let free: Vec<Mapping> = others
                .filter(|it| !columns.iter().any(|map| is(map, &it.key)))
                .map(|it| Mapping::unused(&it.key))
                .collect();
            columns.extend(free);
            let now = self.signal_of(&there.key);
            let unit = unit_for(&choice, there.unit.as_deref(), unit, now == Some(signal));
            let (canonical, foreign) = (signal.to_owned(), there.key.clone());
            columns.push(Mapping { canonical, foreign, unit });
        }
        let key = there.key.clone();
        self.re_read(ReadOptions { columns, ..self.options.clone() }, Some(&key))
    }

    /// The signal that a column stands for at present, or would.
    fn signal_of(&self, key: &str) -> Option<&str> {
        let mapped = self.options.columns.iter().find(|it| it.foreign == key);
        let note = || self.report.as_ref()?.columns.iter().find(|it| it.column == key);
        let guess = || self.preview.as_ref()?.find(key)?.guess;
        let mapped = mapped.map(|it| it.canonical.as_str());
        mapped.or_else(|| Some(note()?.signal.as_str())).or_else(guess)
    }
}

/// The unit to map with: the one that was said where it can be; that of the header where it fits;
/// else the signal's own, to be corrected.
fn unit_for(choice: &Choice, header: Option<&str>, said: &str, same: bool) -> Option<String> {
    let said = Some(said).filter(|it| !it.is_empty() && (same || choice.accepts(it)));
    let own = || Some(choice.bare_unit).filter(|_| header.is_some_and(|it| !choice.accepts(it)));
    said.or_else(own).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use drivescope_recording::ReadOptions;

    use crate::page::recordings::tests::{range, rows, taken};

    #[test]
    fn a_unit_of_another_quantity_changes_nothing() {
        let mut taken = taken(&rows("time [ms],u [V],omega [rad/s]", |k| format!("{k},{k},{k}")));
        let said = taken.map("omega", "omega", "V").expect_err("no speed");
        assert!(said.contains("bench.csv") && !said.contains("tmp"), "{said}");
        assert_eq!(taken.options, ReadOptions::default());
        assert!(taken.map("omega", "power", "").is_err(), "no such signal");
    }

    #[test]
    fn a_column_changes_its_meaning_and_others_give_way() {
        let header = "time [ms],u [V],omega [rad/s],enc [counts],speed2";
        let mut taken = taken(&rows(header, |k| format!("{k},1,{k},{},{}", 2.0 * k, 3.0 * k)));
        taken.map("enc", "theta", "").expect("counts are taken as rad first");
        assert_eq!(range(&taken, "theta"), (0.0, 1998.0));
        taken.map("enc", "theta", "counts/999").expect("a unit");
        assert!((range(&taken, "theta").1 - 2.0 * std::f64::consts::TAU).abs() < 1e-12);
        // The column called omega is not used then; it can be again.
        taken.map("speed2", "omega", "rpm").expect("a unit");
        assert!((range(&taken, "omega").1 - 2997.0 * std::f64::consts::PI / 30.0).abs() < 1e-9);
        taken.map("omega", "omega", "").expect("its own name");
        assert_eq!(range(&taken, "omega").1, 999.0);
        taken.map("enc", "", "").expect("any column may be left out");
        assert!(taken.recording.as_ref().is_some_and(|it| it.signal("theta").is_none()));
    }
}
