//! Columns whose foreign names are recognised.

use drivescope_units::is_counts;

use super::column::Taken;
use super::motion::rotary;
use super::naming::{Naming, uncounted};
use crate::canonical::Canonical;
use crate::error::Error;
use crate::guess::{self, Rank};

impl Naming<'_> {
    /// Names those columns. Of several for one signal one that moves wins, then the one nearest
    /// to a measurement.
    pub(super) fn take_guessed(&mut self) -> Result<(), Error> {
        let rotary = rotary(&self.given);
        let mut guesses: Vec<(bool, Rank, usize, &'static Canonical)> = Vec::new();
        for k in self.open() {
            let column = &self.given[k];
            let unit = column.unit.as_deref();
            let constant = self.looks.get(k).is_some_and(|look| look.constant);
            if let Some(guess) = guess::guess(&column.name, unit, rotary) {
                guesses.push((constant, guess.rank, k, guess.canonical));
            } else if unit.is_some_and(is_counts)
                && let Some(guess) = guess::guess(&column.name, None, rotary)
            {
                self.notes.push(uncounted(&column.name, guess.canonical.name));
            }
        }
        guesses.sort_by_key(|(constant, rank, k, _)| (*constant, *rank, *k));
        for (_, _, k, known) in guesses {
            if self.used.contains(&known.name) {
                continue;
            }
            self.used.push(known.name);
            let column = &self.given[k];
            let own = guess::unit_in_name(&column.name).filter(|unit| known.accepts(unit));
            let unit = column.unit.clone().or(own.map(str::to_owned));
            self.name(k, known.name, Some(known), unit.as_ref(), Taken::Guessed)?;
        }
        Ok(())
    }
}
