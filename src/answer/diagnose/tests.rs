//! A diagnosis in every medium.

use drivescope_diagnoser::DetectorKind;
use drivescope_monitor::{Declaration, Declared, Fault, Found, Method};
use std::collections::BTreeMap;

use super::{BaselineAnswer, DiagnoseAnswer};
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;

fn declaration() -> Declaration {
    Declaration {
        mechanism: "tacho".to_owned(),
        set: vec!["tacho".to_owned(), "flux".to_owned()],
        size: Some(0.050_12),
        interval: Some([0.041, 0.0592]),
        unit: Some("1".to_owned()),
        to: Some(9.995),
        ..Declaration::unknown(8.012, 8.123)
    }
}

fn found(method: Method, declarations: Vec<Declaration>) -> Found {
    let at = |it: &Declaration| Declared { sample: 1603, time: it.noticed, fault: None };
    Found {
        method,
        verdict: if declarations.is_empty() { "healthy" } else { "fault" },
        beta: Some(0.05),
        judged: 2345,
        outside: 321,
        exceedance_rate: Some(321.0 / 2345.0),
        declared: declarations.iter().map(at).collect(),
        declarations,
        dropped: 0,
    }
}

fn answer() -> DiagnoseAnswer {
    let learned = BaselineAnswer {
        recording: "calm.csv".to_owned(),
        samples: 800,
        machine: BTreeMap::from([("J".to_owned(), -0.0123)]),
    };
    DiagnoseAnswer {
        diagnoser: None,
        recording: "ill.csv".to_owned(),
        samples: 2400,
        stream: None,
        run_up: 55,
        beyond_range: 0,
        verdict: "fault",
        why: None,
        method: Method::Bank,
        declarations: vec![declaration()],
        share_outside: Some(0.1),
        fault: Some(Fault {
            class: "tacho".to_owned(),
            samples: 400,
            share: 0.97,
            s: 2.345,
            group: drivescope_diagnoser::Size::Small,
        }),
        baseline: Some(learned),
        methods: vec![
            found(Method::Bank, vec![declaration()]),
            found(Method::Residual(DetectorKind::Constant), Vec::new()),
        ],
    }
}

#[test]
fn text_and_page_tell_the_same_numbers() {
    let answer = answer();
    let (stated, shown) = (answer.blocks(), answer.with_figure(None));
    let page = on_page(&shown);
    // How long the recording is stands beside it there.
    holds(&stated[1..], &page);
    holds(&shown, &in_report(&stated));
    let said = text(&stated);
    let fault = "ault since 8.012 s: tacho +5.01 % (+4.10 to +5.92); it cannot be told from flux";
    assert!(said.contains(fault) && page.contains(fault), "{said}\n{page}");
    for number in ["13.69 %", "5.00 %", "8.123 s (sample 1603)", "J -1.2 %", "S = 2.35"] {
        assert!(said.contains(number), "{number} is not in: {said}");
    }
}

#[test]
fn what_is_healthy_or_not_judged_is_said_with_its_reason() {
    let none =
        DiagnoseAnswer { verdict: "healthy", declarations: Vec::new(), fault: None, ..answer() };
    assert!(text(&none.blocks()).contains("verdict (bank"), "{}", text(&none.blocks()));
    assert!(on_page(&none.with_figure(None)).contains("Healthy."));
    let why = Some("the recording is too short".to_owned());
    let short = DiagnoseAnswer { verdict: "not_judged", why, ..none };
    assert!(text(&short.blocks()).ends_with("not judged\nthe recording is too short\n"));
    assert!(on_page(&short.with_figure(None)).contains("the recording is too short"));
}
