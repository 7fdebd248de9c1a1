//! Columns of one name that nobody asks for: channels that a device exports without having any.

use super::naming::Naming;
use super::which::is_known;
use crate::place::Counted;
use crate::stretches::Stretches;

impl Naming<'_> {
    /// Leaves out, of columns called alike, those that stand still beside one that moves; where the
    /// name is no signal's, all but the first that moves.
    pub(super) fn leave_out_twins(&mut self) {
        // A stream does not know its values yet.
        if self.looks.len() != self.given.len() {
            return;
        }
        let open = self.open();
        for (at, first) in open.iter().enumerate() {
            let name = &self.given[*first].name;
            let alike = |k: &&usize| self.given[**k].name == *name;
            if open[..at].iter().any(|k| alike(&k)) {
                continue;
            }
            let twins: Vec<usize> = open.iter().filter(alike).copied().collect();
            let moves = |k: &&usize| !self.looks[**k].constant;
            let is_signal = is_known(&self.given[*first].text, &[]);
            let kept = match (twins.iter().find(moves), is_signal) {
                (Some(moving), _) => Some(*moving),
                (None, true) => Some(*first),
                (None, false) => None,
            };
            let stays = |k: &usize| Some(*k) == kept || is_signal && moves(&k);
            let out: Vec<usize> = twins.iter().filter(|k| !stays(k)).copied().collect();
            if twins.len() < 2 || out.is_empty() {
                continue;
            }
            self.left_out.said.push(self.said(name, &out, kept));
            self.left_out.columns.extend(out);
        }
        self.left_out.columns.sort_unstable();
    }

    fn said(&self, name: &str, out: &[usize], kept: Option<usize>) -> String {
        let number = |k: usize| 1 + (0..k).filter(|it| self.given[*it].name == name).count();
        let mut places = Stretches::default();
        out.iter().for_each(|k| places.add(*k, *k as u64 + 1));
        let places = places.text(Counted::Rows).replace("row", "column");
        let constant = match out.iter().all(|k| self.looks[*k].constant) {
            true => ", and constant",
            false => "",
        };
        let as_kept = kept.map_or(String::new(), |k| format!(" as column {} is", k + 1));
        format!(
            "{places}, called `{name}`{as_kept}{constant}; take one with --columns \
             SIGNAL={name}#{}:UNIT",
            number(out[0])
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::resolve;
    use crate::look::Look;
    use crate::mapping::{Mapping, ReadOptions};

    /// Names of the signals and what is said, of columns that move or not.
    fn stated(texts: &[(&str, bool)], maps: &str) -> (Vec<String>, Vec<String>) {
        let names: Vec<String> = texts.iter().map(|it| it.0.to_owned()).collect();
        let look = |moves: &bool| Look { constant: !moves, ..Look::default() };
        let looks: Vec<Look> = texts.iter().map(|it| look(&it.1)).collect();
        let columns = Mapping::parse_list(maps).unwrap();
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let header = resolve("a.csv", &names, &options, &looks).unwrap();
        let signals = header.columns.iter().map(|it| it.note.signal.clone()).collect();
        (signals, header.left_out.said)
    }

    #[test]
    fn channels_that_are_none_are_left_out_with_one_word() {
        let export = [
            ("time [s]", true),
            ("u", true),
            ("Not used", false),
            ("Not used", false),
            ("i", true),
            ("Not used", false),
        ];
        let (signals, said) = stated(&export, "");
        assert_eq!(signals, ["time", "u", "i"]);
        assert_eq!(said.len(), 1);
        assert!(said[0].starts_with("columns 3 to 4, column 6, called `Not used`"), "{said:?}");
        // What the user names is there.
        let (signals, _) = stated(&export, "mode=Not used#2");
        assert_eq!(signals, ["time", "u", "mode", "i"]);
    }

    #[test]
    fn of_two_that_nobody_reads_the_first_that_moves_stays() {
        let (signals, said) = stated(&[("t", true), ("a", false), ("a", true), ("a", true)], "");
        assert_eq!(signals, ["time", "a"]);
        assert!(said[0].contains("--columns SIGNAL=a#1:UNIT"), "{said:?}");
        let still = stated(&[("t", true), ("u", false), ("u", true)], "").0;
        assert_eq!(still, ["time", "u"]);
    }

    #[test]
    fn a_signal_that_moves_twice_is_refused_with_all_that_is_to_say() {
        let names = ["t", "u", "u", "u"].map(str::to_owned);
        let said = resolve("a.csv", &names, &ReadOptions::default(), &[Look::default(); 4])
            .unwrap_err()
            .to_string();
        assert!(said.contains("--columns u_unused=u#2,u_unused_3=u#3"), "{said}");
        let columns = Mapping::parse_list("u_unused=u#2").unwrap();
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let said =
            resolve("a.csv", &names, &options, &[Look::default(); 4]).unwrap_err().to_string();
        assert!(said.contains("--columns u_unused_3=u#3"), "{said}");
    }
}
