//! Columns that carry the very name of a signal.

use drivescope_units::{Quantity, Unit, is_counts};

use super::capital_t::capital_t;
use super::column::Taken;
use super::naming::{Naming, uncounted};
use crate::canonical;
use crate::error::Error;
use crate::given::Given;
use crate::guess;

impl Naming<'_> {
    /// Names those columns; a unit that the signal cannot have leaves them to a guess, or to themselves where
    /// they are those of any model.
    pub(super) fn take_exact(&mut self, of_model: bool) -> Result<(), Error> {
        for k in self.open() {
            let column = self.given[k].clone();
            let Given { name, unit, .. } = &column;
            let Some(known) = canonical::exact(name) else { continue };
            let text = unit.as_deref();
            let says = text.is_some_and(|unit| known.accepts(unit));
            if of_model && !says && name != "time" {
                self.name(k, name, None, unit.as_ref(), Taken::Kept)?;
                self.used.push(known.name);
                continue;
            }
            if name == "T" && unit.is_none() {
                let look = self.looks.get(k);
                let (capital, note) = capital_t(self.file, &self.given, k, look, &self.used)?;
                // Whatever it is, another column must not get its name.
                let is_warm = capital.note.signal == "temperature";
                self.used.push(if is_warm { "temperature" } else { "T" });
                self.columns[k] = Some(capital);
                self.notes.extend(note);
            } else if text.is_some_and(is_counts) {
                self.name(k, &format!("{}_counts", known.name), None, unit.as_ref(), Taken::Kept)?;
                self.notes.push(uncounted(name, known.name));
            } else if text.is_some_and(|unit| is_share(unit) && !known.accepts(unit)) {
                let (kept, share) = (format!("{}_share", known.name), text.unwrap_or_default());
                self.name(k, &kept, None, unit.as_ref(), Taken::Kept)?;
                self.notes.push(format!(
                    "column `{name}` [{share}] is kept as `{kept}`: a share is no {0}; say its \
                     unit with --columns {0}={name}:UNIT where it has one",
                    known.name
                ));
            } else if text.is_none_or(|unit| known.accepts(unit))
                || guess::guess(name, text, None).is_none()
            {
                self.name(k, known.name, Some(known), unit.as_ref(), Taken::Named)?;
                self.used.push(known.name);
            }
        }
        Ok(())
    }
}

/// Whether a unit is a share of something rated, as drives give torques in.
fn is_share(unit: &str) -> bool {
    Unit::parse(unit).is_some_and(|unit| unit.quantity == Quantity::Dimensionless)
}
