//! Figures of the reference paper (Patan, Witczak and Korbicz, 2008), Tables 1 to 3.

use crate::results::{DetectorKind, PaperFigures, PaperRates, PaperRow, SizeGroup};

/// Label, then r_td in per cent and t_dt by model error modelling and by constant thresholds.
type Row = (&'static str, (f64, usize), (f64, usize));

/// Table 1.
const TABLE_1: [Row; 12] = [
    ("f_1^1", (97.9, 4074), (98.1, 4072)),
    ("f_2^1", (99.6, 4055), (99.4, 4067)),
    ("f_3^1", (98.8, 4077), (98.8, 4064)),
    ("f_4^1", (99.7, 4053), (99.4, 3147)),
    ("f_5^1", (99.6, 4058), (98.9, 4063)),
    ("f_6^1", (99.5, 4075), (100.0, 4018)),
    ("f_1^2", (99.2, 4058), (99.5, 4056)),
    ("f_2^2", (99.3, 4100), (99.7, 4059)),
    ("f_3^2", (99.2, 4060), (99.3, 4057)),
    ("f_4^2", (98.8, 4061), (99.1, 4059)),
    ("f_5^2", (99.1, 4060), (99.9, 3726)),
    ("f_6^2", (81.0, 4357), (98.4, 3132)),
];

/// Table 3: label and size S of the symptom.
const TABLE_3: [(&str, f64); 12] = [
    ("f_1^1", 2.45),
    ("f_2^1", 3.32),
    ("f_3^1", 5.34),
    ("f_4^1", 6.19),
    ("f_5^1", 10.9),
    ("f_6^1", 11.64),
    ("f_1^2", 17.39),
    ("f_2^2", 8.27),
    ("f_3^2", 8.61),
    ("f_4^2", 8.65),
    ("f_5^2", 2.28),
    ("f_6^2", 1.73),
];

/// Table 2, per cent: (class, share) of every fault, classes from 0.
const TABLE_2: [&[(usize, f64)]; 12] = [
    &[(0, 100.0)],
    &[(0, 0.3), (1, 99.7)],
    &[(0, 0.2), (1, 0.5), (2, 99.3)],
    &[(1, 5.7), (2, 0.7), (3, 93.6)],
    &[(0, 0.9), (3, 0.9), (4, 94.1), (6, 0.5), (9, 3.4)],
    &[(1, 0.2), (4, 1.1), (5, 95.9), (8, 2.1), (9, 0.7)],
    &[(4, 0.4), (5, 1.4), (6, 97.5), (8, 0.7)],
    &[(6, 1.6), (7, 98.4)],
    &[(2, 0.2), (3, 3.9), (7, 1.8), (8, 94.1)],
    &[(0, 0.2), (1, 0.7), (2, 3.0), (8, 2.1), (9, 94.1)],
    &[(1, 97.7), (9, 2.3)],
    &[(0, 97.5), (1, 2.5)],
];
/// Classes of Table 2.
const CLASSES: usize = 10;

/// Labels of the faults that the paper calls small and large; the others are medium.
const SMALL: [&str; 4] = ["f_1^1", "f_2^1", "f_5^2", "f_6^2"];
const LARGE: [&str; 3] = ["f_5^1", "f_6^1", "f_1^2"];

/// The paper's group of a fault.
pub(super) fn group(label: &str) -> SizeGroup {
    if SMALL.contains(&label) {
        SizeGroup::Small
    } else if LARGE.contains(&label) {
        SizeGroup::Large
    } else {
        SizeGroup::Medium
    }
}

/// What stands in the paper's text and tables.
pub(super) fn figures() -> PaperFigures {
    let row = |shares: &[(usize, f64)]| {
        let mut row = vec![0.0; CLASSES];
        shares.iter().for_each(|(class, per_cent)| row[*class] = per_cent / 100.0);
        row
    };
    let detection = TABLE_1.into_iter().flat_map(|(label, mem, constant)| {
        [(DetectorKind::Mem, mem), (DetectorKind::Constant, constant)].map(
            |(method, (per_cent, t_dt))| PaperRow {
                label: label.to_owned(),
                method,
                r_td: per_cent / 100.0,
                t_dt,
            },
        )
    });
    PaperFigures {
        detection: detection.collect(),
        r_fd: PaperRates { mem: 0.012, constant: 0.098 },
        arx_sse: 0.0117,
        isolation: TABLE_2.map(row).into(),
    }
}

/// The paper's S of a fault.
pub(super) fn symptom(label: &str) -> f64 {
    TABLE_3.iter().find(|(known, _)| *known == label).map_or(f64::NAN, |(_, s)| *s)
}
