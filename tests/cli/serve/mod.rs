//! The page's server: what it refuses, and the loop as a browser walks it.

mod client;
mod command_line;
mod mapping;
mod walk;

use client::Server;

use crate::{folder, refused};

#[test]
fn only_its_own_host_is_answered() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let cookie = format!("Cookie: {}", server.cookie);
    let port = server.host.rsplit_once(':').expect("a port").1;
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        "127.0.0.1".to_owned(),
        "127.0.0.1:1".to_owned(),
        format!("127.0.0.1.evil.example:{port}"),
    ] {
        let answer = server.send("GET", "/", &[&format!("Host: {host}"), &cookie], b"");
        assert_eq!(answer.status, 403, "{host}: {answer:?}");
    }
    let answer = server.send("GET", "/", &[&cookie], b"");
    assert!(answer.status == 403 || answer.status == 400, "no host: {answer:?}");
    let own = format!("Host: localhost:{port}");
    assert_eq!(server.send("GET", "/", &[&own, &cookie], b"").status, 303);
}

#[test]
fn only_its_own_page_may_ask() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    let (host, cookie) = (format!("Host: {}", server.host), format!("Cookie: {}", server.cookie));
    let path = format!("{session}do");
    let kind = "Content-Type: application/json";
    let ask = |origin: &[&str]| {
        let mut headers = vec![host.as_str(), cookie.as_str(), kind];
        headers.extend(origin);
        server.send("POST", &path, &headers, br#"{"do":"cancel"}"#).status
    };
    assert_eq!(ask(&["Origin: http://evil.example"]), 403);
    assert_eq!(ask(&["Origin: null"]), 403);
    assert_eq!(ask(&[&format!("Origin: https://{}", server.host)]), 403);
    let other_port = server.host.rsplit_once(':').map(|it| format!("Origin: http://{}:1", it.0));
    assert_eq!(ask(&[&other_port.expect("a port")]), 403);
    assert_eq!(ask(&[]), 403, "what changes something says where it comes from");
    assert_eq!(ask(&[&format!("Origin: http://{}", server.host)]), 204);
    let read = [&host, &cookie, "Origin: http://evil.example"];
    assert_eq!(server.send("GET", &session, &read, b"").status, 403);
}

#[test]
fn the_token_opens_once_and_the_cookie_afterwards() {
    let here = folder();
    let mut server = Server::start(here.path(), &[]);
    assert_eq!(server.get("/").status, 403, "nobody without a token");
    assert_eq!(server.get("/?token=").status, 403);
    assert_eq!(server.get(&format!("/?token={}", "0".repeat(32))).status, 403);
    let token = format!("/?token={}", server.token);
    assert_eq!(server.get(&format!("/assets/page.js?token={}", server.token)).status, 403);
    let answer = server.get(&token);
    assert_eq!((answer.status, answer.header("location")), (303, Some("/")));
    let cookie = answer.header("set-cookie").expect("a cookie").to_owned();
    assert!(cookie.contains("SameSite=Strict") && cookie.contains("HttpOnly"), "{cookie}");
    assert_eq!(server.get(&token).status, 403, "it was exchanged");
    server.cookie = cookie.split(';').next().expect("a value").to_owned();
    assert_eq!(server.get(&token).status, 303, "whoever has the cookie needs no token");
    server.cookie = format!("{}0", server.cookie);
    assert_eq!(server.get("/").status, 403, "another secret");
}

#[test]
fn nothing_foreign_or_inline_may_run() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let page = server.get(&server.session());
    assert_eq!(page.status, 200, "{page:?}");
    let policy = page.header("content-security-policy").expect("a policy");
    assert!(policy.starts_with("default-src 'self'; ") && !policy.contains("unsafe"), "{policy}");
    for (name, value) in [
        ("x-content-type-options", "nosniff"),
        ("x-frame-options", "DENY"),
        ("referrer-policy", "no-referrer"),
        ("cache-control", "no-store"),
    ] {
        assert_eq!(page.header(name), Some(value), "{name}");
    }
    let html = scraper::Html::parse_document(&page.body);
    assert!(html.errors.is_empty(), "{:?}", html.errors);
    let all = |selector: &str| {
        let selector = scraper::Selector::parse(selector).expect("a selector");
        html.select(&selector).map(|it| it.html()).collect::<Vec<_>>()
    };
    assert_eq!(all("[style], style, script:not([src]), [onclick], [onload]"), [""; 0]);
    for loaded in all("script, link, img") {
        assert!(loaded.contains("\"/assets/"), "{loaded}");
    }
    // A refusal carries the same headers.
    assert!(server.get("/nothing").header("content-security-policy").is_some());
}

#[test]
fn no_path_of_the_client_is_opened() {
    let here = folder();
    crate::put(here.path(), "secret.csv", "time [s],u [V]\n0,1\n");
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    let secret = here.path().join("secret.csv").display().to_string();
    for path in [
        "/assets/../Cargo.toml".to_owned(),
        "/assets/..%2f..%2fsecret.csv".to_owned(),
        format!("/assets/{}", secret.replace('/', "%2f")),
        format!("{session}take/..%2fsecret.csv"),
        format!("{session}take/{}", secret.replace('/', "%2f")),
    ] {
        let answer = server.get(&path);
        assert!([404, 422].contains(&answer.status), "{path}: {answer:?}");
        assert!(!answer.body.contains("time [s]"), "{path}");
    }
    // The name of an upload is shown and no more: the content counts, not the file of that name.
    let name = format!("{session}file?name={}", secret.replace('/', "%2f"));
    let answer = server.post(&name, b"nonsense");
    assert_eq!(answer.status, 422, "{answer:?}");
    let said = answer.json()["problem"].as_str().expect("words").to_owned();
    assert!(said.contains("secret.csv") && !said.contains('/'), "{said}");
}

#[test]
fn uploads_are_bounded() {
    let here = folder();
    let server = Server::open(here.path(), &["--largest-upload", "1"]);
    let session = server.session();
    let mut large = b"time [s],u [V],omega [rad/s]\n".to_vec();
    while large.len() <= 1_000_000 {
        large.extend(b"0.001,1.5,2.5\n");
    }
    let answer = server.post(&format!("{session}file?name=a.csv"), &large);
    assert_eq!(answer.status, 413, "{}", answer.head);
    assert!(answer.json()["problem"].as_str().is_some_and(|it| it.contains("1 MB")));
    let answer = server.post(&format!("{session}file?name=a.toml"), &large);
    assert_eq!(answer.status, 413, "{}", answer.head);
    let answer = server.post(&format!("{session}file?name=a.exe"), b"MZ");
    assert_eq!(answer.status, 422);
    let answer = server.post(&format!("{session}do"), &vec![b' '; 3_000_000]);
    assert_eq!(answer.status, 413, "a command is no file");
}

#[test]
fn names_are_text() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    let mut csv = "time [s],u [V],omega [rad/s],<b>x</b> [V]\n".to_owned();
    for k in 0..400 {
        let t = f64::from(k) * 1e-3;
        csv += &format!("{t},{},{},0\n", 5.0 * (20.0 * t).sin(), 60.0 * (20.0 * t - 0.4).sin());
    }
    let name = "%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E.csv";
    let answer = server.post(&format!("{session}file?name={name}"), csv.as_bytes());
    assert_eq!(answer.status, 204, "{answer:?}");
    let pieces = server.get(&format!("{session}pieces")).json();
    let data = pieces["pieces"]["data"].as_str().expect("HTML");
    assert!(data.contains("&lt;img src=x") && !data.contains("<img"), "{data}");
    assert!(!data.contains("<b>"), "{data}");
}

#[test]
fn sessions_of_others_and_wrong_commands_are_refused() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    assert_eq!(server.get("/b/0123456789abcdef0123456789abcdef/").status, 404);
    assert_eq!(server.get("/b/0123456789abcdef0123456789abcdef/pieces").status, 404);
    for command in [r#"{"do":"add","step":7,"effect":"cogging"}"#, r#"{"do":"example","id":"no"}"#]
    {
        let answer = server.post(&format!("{session}do"), command.as_bytes());
        assert_eq!(answer.status, 422, "{command}: {answer:?}");
    }
    assert_eq!(server.post(&format!("{session}do"), br#"{"do":"rm"}"#).status, 422);
    assert_eq!(server.get(&format!("{session}within?from=0&to=1")).status, 422);
}

#[test]
fn what_it_begins_with_must_be_usable() {
    let here = folder();
    let error = refused(here.path(), &["serve", "nothing"]);
    assert!(error.contains("`nothing`"), "{error}");
    let error = refused(here.path(), &["serve", "dr300", "none.csv"]);
    assert!(error.contains("none.csv"), "{error}");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("it listens").port().to_string();
    let error = refused(here.path(), &["serve", "--port", &port]);
    assert!(error.contains("--port"), "{error}");
}
