//! How each mistake in a drive file is refused: the place, what is underlined, and the message.

mod effects;
mod round_trip;

use super::*;

/// A small drive; each mistake below replaces one of its lines.
const BASE: &str = r#"schema = 1
name = "test"
motion = "rotary"
[motor]
input = "voltage"
R = 3.0
L = 5.0e-3
K_e = 0.06
K_m = 0.06
J = 8.0e-5
B_m = 6.0e-5
[[effect]]
kind = "coulomb"
T_c = 0.016
[[effect]]
kind = "custom"
torque = "-c * omega * abs(omega)"
parameters = { c = 3.0e-7 }
[controller]
K_p = 0.04
K_i = 0.5
limit = 10
[sensors]
tacho_unit = "rpm"
[noise]
omega = 0.1
torque = 0.001
torque_time = 0.05
[fit]
fixed = ["K_m", "custom.c"]
per_recording = ["coulomb.T_c"]
[origin]
R = "measured"
"#;

const LAW: &str = r#"torque = "-c * omega * abs(omega)""#;
const COEFFICIENTS: &str = "parameters = { c = 3.0e-7 }";
const FIXED: &str = r#"fixed = ["K_m", "custom.c"]"#;

/// The error after replacing lines of the small drive.
fn mistaken(changes: &[(&str, &str)]) -> (String, DriveFileError) {
    let mut text = BASE.to_owned();
    for (line, by) in changes {
        let changed = text.replacen(&format!("{line}\n"), &format!("{by}\n"), 1);
        assert_ne!(changed, text, "{line}");
        text = changed;
    }
    let error = Drive::parse(&text, "test.toml").map(|_| ()).expect_err(changes[0].1);
    (text, error)
}

/// Line replaced, by what; the place; what is underlined; how the message goes on.
type Mistake<'a> = (&'a str, &'a str, &'a str, &'a str, &'a str);

fn refused(mistakes: &[Mistake<'_>]) {
    assert!(Drive::parse(BASE, "test.toml").is_ok());
    for (line, by, place, underlined, message) in mistakes {
        let (text, error) = mistaken(&[(line, by)]);
        let shown = error.to_string();
        let expected = format!("test.toml:{place}: {message}");
        assert!(shown.starts_with(&expected), "{by}:\n  {shown}\n  {expected}");
        let span = error.place().map(|place| place.span.clone()).expect("an error of the content");
        assert_eq!(&text[span], *underlined, "{by}");
    }
}

#[test]
fn structure() {
    refused(&[
        ("schema = 1", "schema = = 1", "1:10", "=", "not TOML: extra `=`"),
        ("R = 3.0", "R = 3\nR = 4", "7:1", "R", "not TOML: duplicate key"),
        ("schema = 1", "schema = 2", "1:10", "2", "`schema` = 2 is unknown: this program reads 1"),
        (
            "schema = 1",
            "shema = 1",
            "1:1",
            "shema",
            "unknown key `shema` (did you mean `schema`?); ",
        ),
        (
            "[motor]",
            "[moter]",
            "4:2",
            "moter",
            "unknown key `moter` (did you mean `motor`?); here ",
        ),
        (
            "R = 3.0",
            "r = 3.0",
            "6:1",
            "r",
            "unknown key `motor.r` (did you mean `R`?); here may stand input, R, L, K_e, K_m, J, ",
        ),
        ("R = 3.0", "warp = 3.0", "6:1", "warp", "unknown key `motor.warp`; here may stand input,"),
        ("K_m = 0.06", "", "4:1", "[motor]", "`motor.K_m` is missing: add it, torque constant ("),
        (
            "R = 3.0",
            "",
            "4:1",
            "[motor]",
            "`motor.R` is missing: add it, or set `input = \"force\"",
        ),
        ("K_p = 0.04", "", "19:1", "[controller]", "`controller.K_p` is missing: add it, prop"),
        ("torque_time = 0.05", "", "27:1", "torque", "`noise.torque_time` is missing: add it, a c"),
    ]);
    let error = Drive::parse("name = \"empty\"\n", "test.toml").expect_err("no motor");
    assert_eq!(error.to_string(), "test.toml:1:1: `motor` is missing: add it");
}

#[test]
fn types() {
    refused(&[
        (
            "schema = 1",
            "schema = \"1\"",
            "1:10",
            "\"1\"",
            "`schema` = \"1\": it takes a whole number",
        ),
        ("R = 3.0", "R = \"3\"", "6:5", "\"3\"", "`motor.R` = \"3\": it takes a number"),
        ("R = 3.0", "R = [\n1]", "6:5", "[\n1]", "`motor.R` = a list: it takes a number"),
        ("R = 3.0", "R = { a = 1 }", "6:5", "{ a = 1 }", "`motor.R` = a table: it takes a number"),
        (
            "R = 3.0",
            "R = 1979-05-27",
            "6:5",
            "1979-05-27",
            "`motor.R` = 1979-05-27: it takes a num",
        ),
        (
            "R = 3.0",
            "R = 99999999999999999999",
            "6:5",
            "99999999999999999999",
            "`motor.R` = 99999999999999999999: it takes a whole number of at most 63 bits",
        ),
        (
            "input = \"voltage\"",
            "tie_K = 1",
            "5:9",
            "1",
            "`motor.tie_K` = 1: it takes true or false",
        ),
        (
            "input = \"voltage\"",
            "input = 3",
            "5:9",
            "3",
            "`motor.input` = 3: it takes \"voltage\" or",
        ),
        (
            "motion = \"rotary\"",
            "motion = \"Rotary\"",
            "3:10",
            "\"Rotary\"",
            "`motion` = \"Rotary\": it takes \"rotary\" or \"linear\"",
        ),
        (FIXED, "fixed = \"K_m\"", "30:9", "\"K_m\"", "`fit.fixed` = \"K_m\": it takes a list"),
        (FIXED, "fixed = [\"R\", 3]", "30:15", "3", "`fit.fixed` = 3: it takes a text in quotes"),
        ("R = \"measured\"", "R = 3", "33:5", "3", "`origin.R` = 3: it takes a text in quotes"),
    ]);
}

#[test]
fn lists_of_names() {
    refused(&[
        (
            FIXED,
            "fixed = [\"K_m\", \"custm.c\"]",
            "30:17",
            "\"custm.c\"",
            "`fit.fixed`: the drive has no parameter `custm.c` (did you mean `custom.c`?); it has R, L, ",
        ),
        (
            FIXED,
            "fixed = [\"noise.omega\"]",
            "30:10",
            "\"noise.omega\"",
            "`fit.fixed`: the drive has no ",
        ),
        (
            FIXED,
            "fixed = [\"coulomb.T_c\"]",
            "31:18",
            "\"coulomb.T_c\"",
            "`coulomb.T_c` stands in `fit.fixed` and in `fit.per_recording`: keep one of them",
        ),
        (
            "R = \"measured\"",
            "r = \"\"",
            "33:1",
            "r",
            "`origin`: the drive has no parameter `r` (did you",
        ),
        (
            "R = \"measured\"",
            "coulomb.t_c = \"\"",
            "33:9",
            "t_c",
            "`origin`: the drive has no parameter `",
        ),
        (
            "R = \"measured\"",
            "amplifier.gain = \"\"",
            "33:11",
            "gain",
            "`origin`: the drive has no param",
        ),
    ]);
}

#[test]
fn keys_that_do_not_fit_the_drive() {
    refused(&[
        (
            "input = \"voltage\"",
            "input = \"force\"",
            "6:1",
            "R",
            "`motor.R` has no meaning here: with `in",
        ),
        (
            "motion = \"rotary\"",
            "motion = \"linear\"",
            "24:14",
            "\"rpm\"",
            "`sensors.tacho_unit` = \"rpm\": it takes \"m/s\" (`motion = \"linear\"`)",
        ),
        (
            "tacho_unit = \"rpm\"",
            "tacho_unit = \"m/s\"",
            "24:14",
            "\"m/s\"",
            "`sensors.tacho_unit` = \"m/s",
        ),
        (
            "omega = 0.1",
            "v = 0.1",
            "26:1",
            "v",
            "`noise.v` has no meaning here: it belongs to a linear",
        ),
    ]);
    let force =
        [("input = \"voltage\"\n", "input = \"force\"\n"), ("R = 3.0\n", ""), ("L = 5.0e-3\n", "")];
    let force = force.iter().fold(BASE.to_owned(), |text, (line, by)| text.replace(line, by));
    let force = force.replace("K_e = 0.06\n", "").replace("R = \"measured\"\n", "");
    assert!(Drive::parse(&force, "force.toml").is_ok(), "the base of what follows");
    let heating = "kind = \"winding_heating\"\nalpha = 0.004\nR_th = 5\nC_th = 10";
    for (text, place, name) in [
        (force.replace("torque = \"", "voltage = \""), "14:11", "custom"),
        (force.replace("torque = \"", "heat = \""), "14:8", "custom"),
        (force.replace("kind = \"coulomb\"\nT_c = 0.016", heating), "10:8", "winding_heating"),
    ] {
        let shown = Drive::parse(&text, "force.toml").expect_err(name).to_string();
        let expected =
            format!("force.toml:{place}: `{name}` cannot exist for this drive: it needs");
        assert!(shown.starts_with(&expected), "{shown}");
    }
    let tied = force.replace("K_m = 0.06\n", "K_m = 0.06\ntie_K = true\n");
    let shown = Drive::parse(&tied, "force.toml").expect_err("tied").to_string();
    assert!(shown.starts_with("force.toml:7:1: `motor.tie_K` has no meaning here"), "{shown}");
}

#[test]
fn columns_are_counted_in_characters() {
    let (_, error) = mistaken(&[("R = 3.0", "\"Wärme\" = 3.0 # Ω"), (LAW, "torque = \"1\"")]);
    let place = error.place().expect("in the content");
    assert_eq!((place.line, place.column, place.span.len()), (6, 1, 8));
    let (_, error) = mistaken(&[("name = \"test\"", "name = \"ΩΩ\" 3")]);
    assert_eq!(error.place().map(|place| (place.line, place.column)), Some((2, 13)));
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Drive::read("absent/drive.toml").expect_err("there is none");
    assert!(matches!(&error, DriveFileError::Read { file, .. } if file == "absent/drive.toml"));
    assert!(error.place().is_none() && error.to_string().contains("absent/drive.toml"));
}
