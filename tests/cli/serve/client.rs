//! A client that says exactly what it is told to, right or wrong.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::program;

/// How long an answer may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running server.
pub(super) struct Server {
    child: Child,
    /// Its host and port.
    pub(super) host: String,
    /// The token that it printed.
    pub(super) token: String,
    /// The cookie, once it was given.
    pub(super) cookie: String,
}

/// An answer.
#[derive(Debug)]
pub(super) struct Response {
    pub(super) status: u16,
    pub(super) head: String,
    pub(super) body: String,
}

impl Response {
    /// A header of the answer.
    pub(super) fn header(&self, name: &str) -> Option<&str> {
        let pairs = self.head.lines().filter_map(|line| line.split_once(": "));
        pairs.filter(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, value)| value).next()
    }

    /// The body as JSON.
    pub(super) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

impl Server {
    /// A server that was started with these arguments.
    pub(super) fn start(folder: &std::path::Path, arguments: &[&str]) -> Self {
        let mut child = program(folder)
            .arg("serve")
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let out = child.stdout.take().expect("it is piped");
        BufReader::new(out).read_line(&mut line).expect("it says where it listens");
        let address = line.trim().strip_prefix("http://").expect("an address").to_owned();
        let (host, token) = address.split_once("/?token=").expect("with a token");
        let (host, token) = (host.to_owned(), token.to_owned());
        Self { child, host, token, cookie: String::new() }
    }

    /// The same, with the token exchanged for the cookie.
    pub(super) fn open(folder: &std::path::Path, arguments: &[&str]) -> Self {
        let mut server = Self::start(folder, arguments);
        let answer = server.get(&format!("/?token={}", server.token));
        assert_eq!(answer.status, 303, "{answer:?}");
        let cookie = answer.header("set-cookie").expect("a cookie");
        server.cookie = cookie.split(';').next().expect("a value").to_owned();
        server
    }

    /// Sends a request with these headers, and no others.
    pub(super) fn send(&self, method: &str, path: &str, headers: &[&str], body: &[u8]) -> Response {
        let mut stream = TcpStream::connect(&self.host).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time");
        let mut text = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
        headers.iter().for_each(|header| text += &format!("{header}\r\n"));
        if !body.is_empty() {
            text += &format!("Content-Length: {}\r\n", body.len());
        }
        stream.write_all(format!("{text}\r\n").as_bytes()).expect("it listens");
        // A server that refuses need not read to the end.
        let _ = stream.write_all(body);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
        let status = head.split(' ').nth(1).and_then(|it| it.parse().ok()).unwrap_or(0);
        Response { status, head: head.to_owned(), body: body.to_owned() }
    }

    /// Reads, as the page does.
    pub(super) fn get(&self, path: &str) -> Response {
        let (host, cookie) = (format!("Host: {}", self.host), format!("Cookie: {}", self.cookie));
        self.send("GET", path, &[&host, &cookie], b"")
    }

    /// Sends, as the page does.
    pub(super) fn post(&self, path: &str, body: &[u8]) -> Response {
        let (host, cookie) = (format!("Host: {}", self.host), format!("Cookie: {}", self.cookie));
        let origin = format!("Origin: http://{}", self.host);
        let kind = "Content-Type: application/json";
        self.send("POST", path, &[&host, &cookie, &origin, kind], body)
    }

    /// The address of a new session.
    pub(super) fn session(&self) -> String {
        let answer = self.get("/");
        assert_eq!(answer.status, 303, "{answer:?}");
        answer.header("location").expect("a session").to_owned()
    }

    /// Waits until nothing is being done in the session, and gives its last event.
    pub(super) fn settled(&self, session: &str) -> serde_json::Value {
        let stream = TcpStream::connect(&self.host).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time");
        let (host, cookie) = (&self.host, &self.cookie);
        let ask =
            format!("GET {session}events HTTP/1.1\r\nHost: {host}\r\nCookie: {cookie}\r\n\r\n");
        (&stream).write_all(ask.as_bytes()).expect("it listens");
        for line in BufReader::new(&stream).lines() {
            let line = line.expect("an event");
            let Some(data) = line.strip_prefix("data: ") else { continue };
            let event: serde_json::Value = serde_json::from_str(data).expect("JSON");
            if event["job"].is_null() {
                return event;
            }
        }
        panic!("the events ended");
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
