//! `init`: a first drive file that reads, simulates and says what to fill in.

use crate::{done, folder, put, refused};

#[test]
fn a_recording_becomes_a_drive_that_runs() {
    let here = folder();
    let input = "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))";
    done(
        here.path(),
        &["simulate", "dr300", "--duration", "8", "--input", input, "-o", "bench.csv"],
    );
    let answer =
        done(here.path(), &["init", "bench.csv", "-o", "first.toml", "--json", "-"]).json();
    assert_eq!((&answer["motion"], &answer["input"]), (&"rotary".into(), &"voltage".into()));
    let value = |name: &str| {
        let all = answer["parameters"].as_array().expect("a list");
        all.iter().find(|p| p["name"] == name).and_then(|p| p["value"].as_f64()).expect("a value")
    };
    assert!((value("R") / 3.13 - 1.0).abs() < 0.02, "{}", value("R"));
    assert!((value("J") / 8.2e-5 - 1.0).abs() < 0.05, "{}", value("J"));
    let replay = ["simulate", "first.toml", "--measured", "bench.csv", "-o", "model.csv"];
    let fit = done(here.path(), &[&replay[..], &["--json", "-"]].concat()).json();
    let omega = fit["fit"].as_array().expect("a list").iter().find(|fit| fit["signal"] == "omega");
    assert!(omega.and_then(|fit| fit["percent"].as_f64()).is_some_and(|p| p > 98.0), "{fit}");
    done(here.path(), &["export", "first.toml", "-o", "first.fmu"]);
}

#[test]
fn what_a_recording_does_not_tell_is_marked() {
    let here = folder();
    let rows: String = (0..200).map(|k| format!("{},{},{}\n", 0.01 * f64::from(k), 6, k)).collect();
    put(here.path(), "log.csv", format!("time [s],u [V],speed [rpm]\n{rows}"));
    let ran = done(here.path(), &["init", "log.csv", "-o", "first.toml"]);
    assert!(ran.out.contains("fill in R"), "{}", ran.out);
    let text = std::fs::read_to_string(here.path().join("first.toml")).expect("it was written");
    assert!(text.contains("FILL IN") && text.contains("kind = \"coulomb\""), "{text}");
    done(
        here.path(),
        &["simulate", "first.toml", "--input", "6", "--duration", "0.1", "-o", "a.csv"],
    );
}

#[test]
fn what_was_measured_decides_what_is_modelled() {
    let here = folder();
    let rows: String = (0..2000)
        .map(|k| {
            let t = 0.005 * f64::from(k);
            // J = 0.01, B_m = 0.02, T_c = 0.3 under a speed of two sines.
            let (speed, slope) = (20.0 + 15.0 * (3.0 * t).sin(), 45.0 * (3.0 * t).cos());
            format!("{t},{},{speed}\n", 0.01 * slope + 0.02 * speed + 0.3)
        })
        .collect();
    for (header, given, said) in [
        ("i [A]", "", "measured current"),
        ("torque [N m]", "", "recorded torque"),
        ("i [A]", "K_m=1", "measured current"),
    ] {
        put(here.path(), "log.csv", format!("time [s],{header},omega [rad/s]\n{rows}"));
        let mut line = vec!["init", "log.csv", "-o", "first.toml", "--json", "-"];
        if !given.is_empty() {
            line.extend(["--given", given]);
        }
        let answer = done(here.path(), &line).json();
        assert!(answer["choice"].as_str().is_some_and(|it| it.contains(said)), "{answer}");
        assert_eq!(answer["input"], "force");
        let value = |name: &str| {
            let all = answer["parameters"].as_array().expect("a list");
            all.iter().find(|p| p["name"] == name).expect("it is there")["value"].as_f64()
        };
        for (name, truth) in [("J", 0.01), ("B_m", 0.02), ("coulomb.T_c", 0.3)] {
            let found = value(name).expect("a number");
            assert!((found / truth - 1.0).abs() < 0.05, "{name} {found}: {answer}");
        }
        let share = answer["unexplained"]["torque"]["share"].as_f64();
        assert!(share.is_some_and(|share| share < 0.02), "{answer}");
        // Every later command takes the same file as it is.
        done(here.path(), &["fit", "first.toml", "log.csv", "-o", "fitted.toml"]);
        done(here.path(), &["compare", "fitted.toml", "log.csv"]);
        done(here.path(), &["simulate", "fitted.toml", "--measured", "log.csv", "-o", "model.csv"]);
    }
    let message = refused(here.path(), &["compare", "dr300", "log.csv"]);
    assert!(message.contains("torque balance") && message.contains("init"), "{message}");
    let message = refused(here.path(), &["init", "log.csv", "-o", "a.toml", "--given", "R=x"]);
    assert!(message.contains("--given") && message.contains("R=x"), "{message}");
}

#[test]
fn steady_speeds_give_friction_and_say_that_inertia_is_not_told() {
    let here = folder();
    let rows: String = (0..36)
        .map(|k| {
            let speed = 10.0 + 5.0 * f64::from(k / 3);
            format!("{k},{},{speed}\n", 0.5 + 0.01 * speed)
        })
        .collect();
    put(here.path(), "map.csv", format!("time [s],torque [N m],omega [rad/s]\n{rows}"));
    let ran = done(here.path(), &["init", "map.csv", "-o", "first.toml"]);
    assert!(ran.out.contains("fill in J") && ran.out.contains("kept"), "{}", ran.out);
    let text = std::fs::read_to_string(here.path().join("first.toml")).expect("it was written");
    assert!(text.contains("fixed = [\"K_m\", \"J\"]"), "{text}");
}

#[test]
fn what_is_no_recording_of_a_drive_is_refused() {
    let here = folder();
    for (text, said) in [
        ("time [s],u [V]\n0,1\n0.1,2\n0.2,1\n", "neither speed nor position"),
        ("time [s],omega [rad/s]\n0,1\n0.1,2\n0.2,1\n", "`u`"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n", "one sample"),
        ("time [s],u [V],omega [rad/s]\n0,1,2\n0.1,1,\n0.2,1,2\n", "log.csv:3"),
        ("", "log.csv"),
    ] {
        put(here.path(), "log.csv", text);
        let message = refused(here.path(), &["init", "log.csv", "-o", "first.toml"]);
        assert!(message.contains(said), "{text:?}: {message}");
    }
}

#[test]
fn a_control_signal_alone_drives() {
    let here = folder();
    let rows: String = (0..2000)
        .map(|k| {
            let t = 0.005 * f64::from(k);
            // In units of the command: R = 1, K = 0.5, J = 0.01, T_c = 0.3.
            let (speed, slope) = (20.0 + 15.0 * (3.0 * t).sin(), 45.0 * (3.0 * t).cos());
            let command = (0.01 * slope + 0.3) / 0.5 + 0.5 * speed;
            format!("{t},{command},{}\n", speed * 30.0 / std::f64::consts::PI)
        })
        .collect();
    put(here.path(), "log.csv", format!("time [s],C_m [1],T [rpm]\n{rows}"));
    let ask = |arguments: &[&str]| done(here.path(), &[arguments, &["--json", "-"]].concat());
    let answer = ask(&["init", "log.csv", "-o", "first.toml"]).json();
    assert_eq!(answer["input"], "voltage");
    let choice = answer["choice"].as_str().expect("a sentence");
    assert!(choice.contains("C_m") && choice.contains("gain 1"), "{choice}");
    let all = answer["parameters"].as_array().expect("a list");
    let k_e = all.iter().find(|it| it["name"] == "K_e").and_then(|it| it["value"].as_f64());
    assert!(k_e.is_some_and(|k_e| (k_e / 0.5 - 1.0).abs() < 0.05), "{answer}");
    let fitted = ask(&["fit", "first.toml", "log.csv", "-o", "second.toml"]);
    assert!(fitted.err.contains("control signal C_m"), "{}", fitted.err);
    let compared = ask(&["compare", "second.toml", "log.csv"]).json();
    let fit = compared["recordings"][0]["outputs"][0]["fit_percent"].as_f64();
    assert!(fit.is_some_and(|percent| percent > 95.0), "{compared}");
}

/// Speed and angle of a drive that swings, each times a factor, sampled at 1 kHz.
fn swinging(samples: u32, speed: f64, angle: f64) -> Vec<String> {
    let row = |k: u32| {
        let t = 1e-3 * f64::from(k);
        let (omega, theta) = (20.0 + 80.0 * (7.0 * t).sin(), 20.0 * t - 11.43 * (7.0 * t).cos());
        format!("{t:.3},{:.4},{:.5},{:.6}\n", 0.06 * omega, speed * omega, angle * theta)
    };
    (0..samples).map(row).collect()
}

#[test]
fn what_cannot_be_repaired_is_said_in_one_sentence_with_the_next_step() {
    let here = folder();
    let names = "time [s],u [V],omega [rad/s],theta [rad]";
    let table = |names: &str, rows: &[String]| format!("{names}\n{}", rows.concat());
    let backwards: Vec<String> = swinging(3000, 1.0, 1.0).into_iter().rev().collect();
    let degrees = 180.0 / std::f64::consts::PI;
    for (text, said) in [
        (
            table("time [s],u [V],u [V],theta [rad]", &swinging(3000, 1.0, 1.0)),
            ["columns 2 and 3 are both called `u`", "--columns u_unused=u#2"],
        ),
        (table(names, &swinging(3000, 60.0, 1.0)), ["times what theta says", "omega=omega:"]),
        (table(names, &swinging(3000, 1.0, degrees)), ["degrees", "theta_unused=theta"]),
        (table(names, &backwards), ["log.csv:3: time goes back", "sort the rows"]),
        (table(names, &swinging(900, 1.0, 1.0)), ["lasts 0.900 s", "record for longer"]),
        (table(names, &swinging(1, 1.0, 1.0)), ["log.csv: holds one sample", "at least two"]),
        (String::new(), ["log.csv: is empty", "header such as"]),
        ("%PDF-1.7\n".to_owned(), ["log.csv: is a document (PDF)", "export it as one"]),
    ] {
        put(here.path(), "log.csv", text);
        let message = refused(here.path(), &["init", "log.csv", "-o", "first.toml"]);
        // However wide the terminal is.
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.iter().all(|words| message.contains(words)), "{said:?}: {message}");
    }
    // What the sentence says to do helps.
    put(here.path(), "log.csv", table(names, &swinging(3000, 30.0 / std::f64::consts::PI, 1.0)));
    refused(here.path(), &["init", "log.csv", "-o", "first.toml"]);
    let line = ["init", "log.csv", "-o", "first.toml", "--columns", "omega=omega:rpm"];
    done(here.path(), &line);
}
