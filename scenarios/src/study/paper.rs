//! Figures of the reference paper (Patan, Witczak and Korbicz, 2008), Tables 1 and 3.

use crate::results::{ByMethod, Method, PaperFigures, PaperRow};

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

/// What stands in the paper's text and tables.
pub(super) fn figures() -> PaperFigures {
    let detection = TABLE_1.into_iter().flat_map(|(label, mem, constant)| {
        [(Method::Mem, mem), (Method::Constant, constant)].map(|(method, (per_cent, t_dt))| {
            PaperRow { label: label.to_owned(), method, r_td: per_cent / 100.0, t_dt }
        })
    });
    PaperFigures {
        detection: detection.collect(),
        r_fd: ByMethod { mem: 0.012, constant: 0.098 },
        arx_sse: 0.0117,
    }
}

/// The paper's S of a fault.
pub(super) fn symptom(label: &str) -> f64 {
    TABLE_3.iter().find(|(known, _)| *known == label).map_or(f64::NAN, |(_, s)| *s)
}
