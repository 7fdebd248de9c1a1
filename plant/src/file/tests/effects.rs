//! Mistakes in numbers, effects and typed laws.

use super::{COEFFICIENTS, Drive, LAW, mistaken, refused};

#[test]
fn numbers_out_of_range() {
    let resistance = "armature resistance; it takes a finite number above 0 (ohm)";
    for (by, found) in
        [("nan", "NaN"), ("inf", "inf"), ("1e999", "inf"), ("0", "0.0"), ("-3.0", "-3.0")]
    {
        let line = format!("R = {by}");
        refused(&[("R = 3.0", &line, "6:5", by, &format!("`motor.R` = {found}: {resistance}"))]);
    }
    refused(&[
        ("L = 5.0e-3", "L = -inf", "7:5", "-inf", "`motor.L` = -inf: armature inductance; it "),
        (
            "J = 8.0e-5",
            "J = 0.0",
            "10:5",
            "0.0",
            "`motor.J` = 0.0: moment of inertia (linear: mass)",
        ),
        (
            "K_m = 0.06",
            "K_m = -1",
            "9:7",
            "-1",
            "`motor.K_m` = -1.0: torque constant (force-driven",
        ),
        (
            "B_m = 6.0e-5",
            "B_m = -1e-5",
            "11:7",
            "-1e-5",
            "`motor.B_m` = -1e-5: viscous friction; it",
        ),
        ("T_c = 0.016", "T_c = -0.1", "14:7", "-0.1", "`coulomb.T_c` = -0.1: Coulomb friction; it"),
        (
            "limit = 10",
            "limit = -10",
            "22:9",
            "-10",
            "`controller.limit` = -10.0: the control signal C_m is kept within -limit and +limit; \
             it takes a finite number above 0 (V)",
        ),
        (
            "K_i = 0.5",
            "K_i = 0.5\nperiod = 0",
            "22:10",
            "0",
            "`controller.period` = 0.0: sampling ti",
        ),
        (
            "omega = 0.1",
            "omega = -0.1",
            "26:9",
            "-0.1",
            "`noise.omega` = -0.1: standard deviation of",
        ),
        (
            COEFFICIENTS,
            "parameters.c = inf",
            "18:16",
            "inf",
            "`custom.c` = inf: coefficient of the t",
        ),
        (
            "T_c = 0.016",
            "T_c = 0.016\n[[effect]]\nkind = \"flexible_coupling\"\nk = 1\nd = 0\nratio = 1.2",
            "19:9",
            "1.2",
            "`flexible_coupling.ratio` = 1.2: share of J on the load's side; it takes a number from \
             0.01 to 0.99",
        ),
    ]);
}

#[test]
fn effects_of_the_library() {
    let coulomb = "kind = \"coulomb\"";
    refused(&[
        (
            coulomb,
            "kind = \"colomb\"",
            "13:8",
            "\"colomb\"",
            "unknown effect `colomb` (did you mean `",
        ),
        (
            coulomb,
            "kind = \"warp\"",
            "13:8",
            "\"warp\"",
            "unknown effect `warp`; known are viscous, ",
        ),
        (coulomb, "", "12:1", "[[effect]]", "`effect.kind` is missing: add it, one of viscous, "),
        (coulomb, "kind = 3", "13:8", "3", "`effect.kind` = 3: it takes a text in quotes"),
        (
            "T_c = 0.016",
            "",
            "12:1",
            "[[effect]]",
            "`coulomb.T_c` is missing: add it, Coulomb friction",
        ),
        ("T_c = 0.016", "T_c = \"a\"", "14:7", "\"a\"", "`coulomb.T_c` = \"a\": it takes a number"),
        (
            "T_c = 0.016",
            "T_c = true",
            "14:7",
            "true",
            "`effect.T_c` = true: it takes a number, a text",
        ),
        (
            "T_c = 0.016",
            "T_C = 1",
            "14:1",
            "T_C",
            "unknown key `coulomb.T_C` (did you mean `T_c`?); ",
        ),
        (
            "T_c = 0.016",
            "T_c = 0.016\n[[effect]]\nkind = \"coulomb\"\nT_c = 1",
            "16:8",
            "\"coulomb\"",
            "a second effect `coulomb` (the first is on line 12): give each its own `id`",
        ),
        (
            "kind = \"custom\"",
            "kind = \"custom\"\nid = \"coulomb\"",
            "17:6",
            "\"coulomb\"",
            "a second effect `coulomb` (the first is on line 12): give each its own `id`",
        ),
        (
            coulomb,
            "kind = \"coulomb\"\nid = \"a b\"",
            "14:6",
            "\"a b\"",
            "`effect.id`: `a b` is no name: it takes a letter or `_`, then letters, digits or `_`",
        ),
        (
            coulomb,
            "kind = \"coulomb\"\nid = \"noise\"",
            "14:6",
            "\"noise\"",
            "`effect.id`: `noise` is",
        ),
    ]);
}

#[test]
fn effects_that_the_drive_cannot_have() {
    let after = |effects: &str| format!("T_c = 0.016\n{effects}");
    let coupling = |id: &str| {
        format!("[[effect]]\nkind = \"flexible_coupling\"\n{id}k = 1\nd = 0\nratio = 0.5\n")
    };
    let two = after(&(coupling("") + &coupling("id = \"belt\"\n")));
    refused(&[(
        "T_c = 0.016",
        &two,
        "21:8",
        "\"flexible_coupling\"",
        "`belt` cannot stand beside `flexible_coupling` (on line 15): they are one part of the ",
    )]);
    refused(&[(
        "T_c = 0.016",
        &after("[[effect]]\nkind = \"delay\"\ntau = 1e-4"),
        "16:8",
        "\"delay\"",
        "`delay` cannot exist for this drive: the controller is continuous; remove it, or give",
    )]);
    let unbalance = after("[[effect]]\nkind = \"unbalance\"\na = 0\nb = 1");
    let (text, error) =
        mistaken(&[("T_c = 0.016", &unbalance), ("motion = \"rotary\"", "motion = \"linear\"")]);
    let place = error.place().expect("an error of the content");
    assert_eq!(&text[place.span.clone()], "\"unbalance\"");
    assert!(
        error.to_string().contains("16:8: `unbalance` cannot exist for this drive: it goes by")
    );
}

#[test]
fn typed_laws() {
    refused(&[
        (
            LAW,
            "torque = \"-c * omga * abs(omega)\"",
            "17:16",
            "o",
            "`custom.torque`: `omga` is unknown: variables are i, omega, v, theta, x, u, t, parameters c, ",
        ),
        (LAW, "torque = 'abs(omega'", "17:20", "'", "`custom.torque`: expected `)`, found the end"),
        (
            LAW,
            "torque = \"\"\"\n-c * omega\n  * $abs(omega)\"\"\"",
            "19:5",
            "$",
            "`custom.torque`: `$` means nothing in a law",
        ),
        (
            LAW,
            "",
            "15:1",
            "[[effect]]",
            "`custom` has no law: a custom effect gives exactly one of t",
        ),
        (
            LAW,
            "torque = \"1\"\nheat = \"2\"",
            "18:1",
            "heat",
            "`custom` has torque and heat: a custom",
        ),
        (LAW, "torque = 3", "17:10", "3", "`custom.torque` = 3: it takes a text in quotes"),
        (LAW, "v = \"omega\"", "17:1", "v", "unknown key `custom.v`"),
        (
            COEFFICIENTS,
            "parameters = 3",
            "18:14",
            "3",
            "`custom.parameters` = 3: it takes a table such ",
        ),
        (
            COEFFICIENTS,
            "parameters = { \"c d\" = 1 }",
            "18:16",
            "\"c d\"",
            "`custom.parameters`: `c d` ",
        ),
        (
            COEFFICIENTS,
            "parameters = { c = \"1\" }",
            "18:20",
            "\"1\"",
            "`effect.parameters.c` = \"1\": ",
        ),
    ]);
}

#[test]
fn learned_curves() {
    let right = "T_c = 0.016\n[[effect]]\nkind = \"learned\"\nbalance = \"torque\"\nover = \"omega\"\n\
                 knots = [-1, 0, 2]\nvalues = [0, 1, 0.5]";
    let (text, _) = mistaken(&[("T_c = 0.016", right), ("schema = 1", "schema = 2")]);
    assert!(Drive::parse(&text.replace("schema = 2", "schema = 1"), "right.toml").is_ok());
    for (line, by, place, underlined, message) in [
        (
            "\"omega\"",
            "\"omga\"",
            "18:8",
            "\"omga\"",
            "`learned.over` = \"omga\": it takes \"omega\" or ",
        ),
        ("\"omega\"", "\"v\"", "18:8", "\"v\"", "`learned.over` = \"v\": it takes \"omega\" or "),
        (
            "\"torque\"",
            "\"heat\"",
            "17:11",
            "\"heat\"",
            "`learned.balance` = \"heat\": it takes \"torque\" or ",
        ),
        (
            "balance = \"torque\"\n",
            "",
            "15:1",
            "[[effect]]",
            "`learned.balance` is missing: add it, \"torque\" or",
        ),
        (
            "[-1, 0, 2]",
            "[-1, 2, 2]",
            "19:17",
            "2",
            "`learned.knots`: 2 after 2: knots are finite and increase",
        ),
        ("[-1, 0, 2]", "[-1]", "19:9", "[-1]", "`learned.knots`: 1 knots: give 2 to 64"),
        ("[-1, 0, 2]", "3", "19:9", "3", "`learned.knots` = 3: it takes a list of numbers"),
        (
            "[-1, 0, 2]",
            "[-1, \"a\", 2]",
            "19:14",
            "\"a\"",
            "`effect.knots` = \"a\": it takes a number",
        ),
        (
            "[0, 1, 0.5]",
            "[0, 1]",
            "20:10",
            "[0, 1]",
            "`learned` has 3 knots and 2 values: give one",
        ),
        (
            "[0, 1, 0.5]",
            "[0, nan, 0.5]",
            "20:14",
            "nan",
            "`learned.v_1` = NaN: value of the learned curve",
        ),
        (
            "\"omega\"\nknots = [-1, 0, 2]",
            "\"theta\"\nknots = [-1, 0, 6]",
            "19:9",
            "[-1, 0, 6]",
            "`learned.knots`: the knots span 7 rad",
        ),
        (
            "\"omega\"\n",
            "\"omega\"\ntimes = \"theta\"\n",
            "19:9",
            "\"theta\"",
            "`learned.times` = \"theta\": it takes \"sign(omega)\" or \"i\"",
        ),
        (
            "\"torque\"\nover = \"omega\"\n",
            "\"flux\"\nover = \"abs(i)\"\ntimes = \"sign(omega)\"\n",
            "19:9",
            "\"sign(omega)\"",
            "`learned.times` = \"sign(omega)\": it takes \"i\", for the sign of the motion belongs",
        ),
    ] {
        let wrong = right.replacen(line, by, 1);
        assert_ne!(wrong, right, "{line}");
        refused(&[("T_c = 0.016", &wrong, place, underlined, message)]);
    }
    let dry = right.replace("\"omega\"\n", "\"abs(omega)\"\ntimes = \"sign(omega)\"\n");
    let (text, _) = mistaken(&[("T_c = 0.016", &dry), ("schema = 1", "schema = 2")]);
    assert!(Drive::parse(&text.replace("schema = 2", "schema = 1"), "right.toml").is_ok());
}
