//! Which laws are differentiated together, and where their columns stand.

use drivescope_plant::drive::Drive;

use super::share::A_PASS;
use crate::discover::Candidate;

/// A law in one of its shapes, or a curve, with its columns.
#[derive(Debug, Clone)]
pub(super) struct LawColumns {
    pub(super) candidate: usize,
    pub(super) variant: usize,
    pub(super) columns: Vec<usize>,
}

/// Laws at their nulls that share a pass, under names of their own.
pub(super) struct Passes {
    pub(super) laws: Vec<Vec<(usize, usize)>>,
    pub(super) names: Vec<Vec<String>>,
}

fn law_name(place: usize) -> String {
    format!("law {place}")
}

impl Passes {
    /// Stiff laws, laws of sensors and typed ones, which may overflow, keep to themselves, so that
    /// the rest needs no whole steps ([`passes`]).
    pub(super) fn of(candidates: &[Candidate]) -> Self {
        let mut laws: Vec<Vec<(usize, usize)>> = Vec::new();
        let (mut room, mut company) = (0, usize::MAX);
        for (number, candidate) in candidates.iter().enumerate().filter(|it| it.1.is_linear()) {
            let k = candidate.coefficients.len();
            let info = candidate.info;
            let alone = info.stiff || info.senses() || info.delays || candidate.is_typed();
            let own = if alone { number } else { usize::MAX };
            for variant in 0..candidate.variants.len() {
                if room < k || own != company {
                    laws.push(Vec::new());
                    room = A_PASS;
                }
                if let Some(pass) = laws.last_mut() {
                    pass.push((number, variant));
                }
                (room, company) = (room - k, own);
            }
        }
        let of = |pass: &Vec<(usize, usize)>| {
            let one = |(place, (candidate, _)): (usize, &(usize, usize))| {
                let names = candidates[*candidate].coefficients.iter();
                names.map(move |name| format!("{}.{name}", law_name(place))).collect::<Vec<_>>()
            };
            pass.iter().enumerate().flat_map(one).collect()
        };
        let names = laws.iter().map(of).collect();
        Self { laws, names }
    }

    /// The drive with the laws of that pass.
    pub(super) fn drive(&self, pass: usize, drive: &Drive, candidates: &[Candidate]) -> Drive {
        let mut with = drive.clone();
        for (place, (candidate, variant)) in self.laws[pass].iter().enumerate() {
            let mut effect = candidates[*candidate].variants[*variant].effect.clone();
            effect.id = law_name(place);
            with.effects.push(effect);
        }
        with
    }
}
