//! Who may talk to the page: this machine's own browser, which was given the token of this run.
//!
//! A name that resolves to the loopback address (DNS rebinding) fails by its `Host`, a page of
//! another origin by its `Origin`, another user of this machine for want of the cookie, for which
//! the token in the printed address is exchanged once.

use std::sync::{Arc, Mutex, PoisonError};

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderName, HeaderValue};
use axum::http::{HeaderMap, Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use rand::RngExt;

/// Nothing but what this server sends is loaded or run, nothing inline, and nobody frames the page.
const POLICY: &str = "default-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'; object-src 'none'";

/// What every answer carries.
const HEADERS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// The secrets of a run, and where it listens.
#[derive(Debug)]
pub(super) struct Guard {
    port: u16,
    /// What the printed address carries, until it is exchanged.
    token: Mutex<Option<String>>,
    /// What it is exchanged for.
    secret: String,
}

/// Why a request was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refused {
    Host,
    Origin,
    Token,
}

impl Refused {
    fn words(self) -> &'static str {
        match self {
            Self::Host => "refused: this server answers under its own address only\n",
            Self::Origin => "refused: the request comes from another page\n",
            Self::Token => {
                "refused: open the address that `drivescope serve` printed; it works once, and \
                 afterwards in the same browser without its token\n"
            }
        }
    }
}

impl Guard {
    pub(super) fn new(port: u16) -> Self {
        Self { port, token: Mutex::new(Some(secret())), secret: secret() }
    }

    /// The token to print.
    pub(super) fn first_token(&self) -> String {
        self.token.lock().unwrap_or_else(PoisonError::into_inner).clone().unwrap_or_default()
    }

    /// Cookies of one host are shared by its ports: the name tells servers apart.
    fn cookie_name(&self) -> String {
        format!("drivescope_{}", self.port)
    }

    /// The cookie for this token, if it is the one that nobody has used.
    fn exchange(&self, given: &str) -> Option<String> {
        let mut token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        if !token.as_deref().is_some_and(|token| same(token, given)) {
            return None;
        }
        *token = None;
        let (name, secret) = (self.cookie_name(), &self.secret);
        Some(format!("{name}={secret}; Path=/; HttpOnly; SameSite=Strict"))
    }

    fn is_own_host(&self, host: &str) -> bool {
        ["127.0.0.1", "localhost"].iter().any(|name| host == format!("{name}:{}", self.port))
    }

    fn check(&self, method: &Method, headers: &HeaderMap) -> Result<(), Refused> {
        let text = |name: HeaderName| headers.get(name).map(|it| it.to_str().unwrap_or_default());
        let host = text(header::HOST).filter(|host| self.is_own_host(host)).ok_or(Refused::Host)?;
        match text(header::ORIGIN) {
            Some(origin) if origin == format!("http://{host}") => {}
            // Navigation and the page's own reading carry none.
            None if *method == Method::GET || *method == Method::HEAD => {}
            _ => return Err(Refused::Origin),
        }
        Ok(())
    }

    fn knows(&self, headers: &HeaderMap) -> bool {
        let wanted = self.cookie_name();
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(|it| it.to_str().ok());
        cookies
            .flat_map(|all| all.split(';'))
            .filter_map(|one| one.trim().split_once('='))
            .any(|(name, value)| name == wanted && same(value, &self.secret))
    }
}

/// 128 random bits.
pub(super) fn secret() -> String {
    format!("{:032x}", rand::rng().random::<u128>())
}

/// Whether two secrets are equal, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |all, (a, b)| all | (a ^ b)) == 0
}

/// The token of an address like `/?token=...`.
fn token_of(uri: &Uri) -> Option<&str> {
    let pairs = uri.query().filter(|_| uri.path() == "/")?.split('&');
    pairs.filter_map(|pair| pair.split_once('=')).find(|pair| pair.0 == "token").map(|pair| pair.1)
}

/// Lets a request through or refuses it; every answer gets its headers.
pub(super) async fn guard(
    State(guard): State<Arc<Guard>>,
    request: Request,
    next: Next,
) -> Response {
    let mut response = match guard.check(request.method(), request.headers()) {
        Err(refused) => (StatusCode::FORBIDDEN, refused.words()).into_response(),
        Ok(()) if guard.knows(request.headers()) => next.run(request).await,
        Ok(()) => match token_of(request.uri()).and_then(|token| guard.exchange(token)) {
            Some(cookie) => {
                let headers = [(header::SET_COOKIE, cookie), (header::LOCATION, "/".to_owned())];
                (StatusCode::SEE_OTHER, headers).into_response()
            }
            None => (StatusCode::FORBIDDEN, Refused::Token.words()).into_response(),
        },
    };
    for (name, value) in HEADERS {
        response.headers_mut().entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_exchanged_once() {
        let guard = Guard::new(4711);
        let token = guard.first_token();
        assert_eq!(guard.exchange("0".repeat(32).as_str()), None);
        let cookie = guard.exchange(&token).expect("it is right");
        assert!(cookie.contains("SameSite=Strict") && cookie.contains("HttpOnly"), "{cookie}");
        assert!(!cookie.contains(&token));
        assert_eq!(guard.exchange(&token), None);
        assert_eq!(guard.first_token(), "");
        assert_eq!(guard.exchange(""), None);
    }

    #[test]
    fn secrets_differ() {
        assert_ne!(secret(), secret());
        assert!(same("abc", "abc") && !same("abc", "abd") && !same("abc", "ab"));
    }
}
