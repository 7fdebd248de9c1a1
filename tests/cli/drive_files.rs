//! Drive files that are wrong: the message names file, line and column.

use crate::{done, folder, put, refused};

/// A drive that is right, one key a line.
const GOOD: &str = "\
schema = 1
[motor]
R = 3.0
L = 5.0e-3
K_e = 0.06
K_m = 0.06
J = 8.0e-5
B_m = 6.0e-5
[controller]
K_p = 0.04
K_i = 0.5
period = 0.005
limit = 10.0
[amplifier]
gain = 2.4
limit = 24.0
";

#[test]
fn every_wrong_value_is_named_with_its_place() {
    let here = folder();
    put(here.path(), "good.toml", GOOD);
    done(here.path(), &["simulate", "good.toml", "--duration", "0.1", "-o", "good.csv"]);
    for (right, wrong, place, said) in [
        ("R = 3.0", "R_a = 3.0", "3:1", "R_a"),
        ("R = 3.0", "R = \"three\"", "3:", "R"),
        ("R = 3.0", "R = nan", "3:", "R"),
        ("R = 3.0", "R = 0.0", "3:", "R"),
        ("L = 5.0e-3", "L = inf", "4:", "L"),
        ("L = 5.0e-3", "L = -1.0", "4:", "L"),
        ("J = 8.0e-5", "J = 0", "7:", "J"),
        ("J = 8.0e-5", "J = -inf", "7:", "J"),
        ("limit = 10.0", "limit = -10.0", "13:", "limit"),
        ("limit = 24.0", "limit = [24.0, -24.0]", "16:", "limit"),
        ("[amplifier]", "[amplifyer]", "14:", "amplifyer"),
        ("gain = 2.4", "gain = ", "15:", ""),
        ("schema = 1", "schema = 99", "1:", "99"),
    ] {
        assert!(GOOD.contains(right));
        put(here.path(), "bad.toml", GOOD.replacen(right, wrong, 1));
        for command in [
            &["simulate", "bad.toml", "-o", "out.csv"][..],
            &["export", "bad.toml", "-o", "out.fmu"],
        ] {
            let message = refused(here.path(), command);
            let place = format!("bad.toml:{place}");
            assert!(message.contains(&place), "{wrong}: no {place} in {message}");
            assert!(message.contains(said), "{wrong}: {message}");
        }
    }
}

#[test]
fn a_drive_that_is_not_there_is_named() {
    let here = folder();
    let message = refused(here.path(), &["simulate", "dr301", "-o", "a.csv"]);
    assert!(message.contains("`dr301`") && message.contains("dr300"), "{message}");
    let message = refused(here.path(), &["simulate", "none.toml", "-o", "a.csv"]);
    assert!(message.contains("none.toml"), "{message}");
    put(here.path(), "latin.toml", b"name = \"\xe9\"\n");
    let message = refused(here.path(), &["simulate", "latin.toml", "-o", "a.csv"]);
    assert!(message.contains("latin.toml"), "{message}");
}

#[test]
fn the_schema_knows_the_tables() {
    let here = folder();
    let schema = done(here.path(), &["schema", "drive"]).json();
    for table in ["motor", "effect", "controller", "noise"] {
        assert!(schema["properties"][table].is_object(), "{table}");
    }
}
