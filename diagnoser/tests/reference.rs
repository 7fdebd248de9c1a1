//! The diagnoser against other people's code on the same data.
//!
//! Data and reference values lie in `reference/`; `reference/generate.py` made them and names the
//! packages (`SIPPY-unipi` for ARX, `gmdh` for GMDH).

use drivescope_diagnoser::{Arx, Column, Data, Orders};

/// Columns of a reference file, read at compile time.
fn columns(text: &str) -> [Vec<f64>; 2] {
    let field = |line: &str, k: usize| line.split(',').nth(k).unwrap().parse().unwrap();
    [0, 1].map(|k| text.lines().skip(1).map(|line| field(line, k)).collect())
}

fn data([u, y]: &[Vec<f64>; 2]) -> Data<'_> {
    Data::new(vec![Column { name: "u", values: u }], Column { name: "y", values: y }).unwrap()
}

#[test]
fn arx_equals_sippy() {
    /// The bar; both solve the same least-squares problem of condition 1e4.
    const BAR: f64 = 1e-8;
    let run = columns(include_str!("reference/closed_loop.csv"));
    let [a, b] = columns(include_str!("reference/arx_sippy.csv"));
    let orders = Orders { n_a: a.len(), n_b: b.len(), constant: false };
    let fit = Arx::fit(&data(&run), orders).unwrap();
    assert_eq!((a.len(), fit.rows), (20, 2980));
    let ours = fit.model.a.iter().chain(&fit.model.b[0]);
    for (k, (ours, reference)) in ours.zip(a.iter().chain(&b)).enumerate() {
        assert!((ours - reference).abs() < BAR, "parameter {k}: {ours} against {reference}");
    }
}
