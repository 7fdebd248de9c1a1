//! The diagnoser against other people's code on the same data.
//!
//! Data and reference values lie in `reference/`; `reference/generate.py` made them and names the
//! packages (`SIPPY-unipi` for ARX, `gmdh` for GMDH).

use drivescope_diagnoser::{Arx, Column, Data, Gmdh, GmdhOptions, NeuronOrders, Orders, residual};

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

#[test]
fn gmdh_predicts_no_worse_than_the_package() {
    /// Equations that `reference/generate.py` fits the package on; the rest is the test.
    const FITTED: usize = 1000;
    /// Of them, those that ours is estimated on; the others choose among neurons and layers.
    const ESTIMATED: usize = 700;
    let [u, y] = columns(include_str!("reference/open_loop.csv"));
    let n = y.len() - 2;
    let signals = [("y1", &y[1..]), ("y2", &y[..n]), ("u1", &u[1..]), ("u2", &u[..n])];
    let inputs = signals.map(|(name, values)| Column { name, values: &values[..n] });
    let all = Data::new(inputs.to_vec(), Column { name: "y", values: &y[2..] }).unwrap();
    let options = GmdhOptions {
        orders: NeuronOrders { n_a: 1, n_b: 0 },
        first_delay: 0,
        delays: 1,
        run_up: 20,
        ..GmdhOptions::default()
    };
    let (estimation, validation) = (all.span(0..ESTIMATED), all.span(ESTIMATED..FITTED));
    let (network, report) = Gmdh::synthesise(&[estimation], &[validation], &options).unwrap();
    let errors = residual(&mut network.run(), &all, drivescope_diagnoser::Start::Rest);
    let tested = &errors[FITTED..];
    let ours = (tested.iter().map(|e| e * e).sum::<f64>() / tested.len() as f64).sqrt();
    let reference = include_str!("reference/gmdh_pypi.csv").lines().skip(1);
    let best = reference
        .map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap())
        .fold(f64::INFINITY, f64::min);
    assert!(ours <= best, "ours {ours}, the package's best {best}; {report:?}");
}
