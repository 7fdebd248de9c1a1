//! Powers of the SI base units, in the order of [`BaseUnit::NAMES`](crate::BaseUnit::NAMES).

pub(crate) type Powers = [i32; 8];

pub(crate) const KG: usize = 0;
pub(crate) const M: usize = 1;
pub(crate) const S: usize = 2;
pub(crate) const A: usize = 3;
pub(crate) const K: usize = 4;
pub(crate) const RAD: usize = 7;

/// The powers of those named, 0 of all others.
pub(crate) fn powers(named: &[(usize, i32)]) -> Powers {
    let mut all = [0; 8];
    for (index, power) in named {
        all[*index] = *power;
    }
    all
}
