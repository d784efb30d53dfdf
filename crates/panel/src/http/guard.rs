//! Who may talk to the server: only the page that it serves itself, and on a network only with the token.
//!
//! A page of another site must not reach it through the visitor's browser: neither by a request (`Origin`) nor under a
//! name that was pointed at this computer (DNS rebinding, `Host`).

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{CONTENT_TYPE, COOKIE, HOST, ORIGIN, SET_COOKIE};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::http::connections::Connection;

/// Nothing but what this server delivers; no script and no style in the page itself.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Name of the token in the link.
const TOKEN: &str = "token";

/// What goes with every answer.
const HEADERS: [(&str, &str); 6] = [
    ("content-security-policy", POLICY),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// What a browser must show when others can reach the panel: 128 random bits, new with every start.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// # Errors
    /// A system without random numbers.
    pub fn random() -> Result<Token, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Token(bytes.map(|byte| format!("{byte:02x}")).concat()))
    }

    /// Whether this is the token; the time that it takes says nothing about how much of it is right.
    fn is(&self, shown: &str) -> bool {
        let pairs = self.0.bytes().zip(shown.bytes());
        let differences = pairs.fold(0, |all, (a, b)| all | (a ^ b));
        self.0.len() == shown.len() && std::hint::black_box(differences) == 0
    }
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token(not shown)")
    }
}

/// The names under which this server answers, and the token that it asks for.
#[derive(Clone, Debug)]
pub struct Guard {
    port: u16,
    bound: IpAddr,
    names: Vec<String>,
    token: Option<Token>,
    encrypted: bool,
}

impl Guard {
    /// For a server bound to `address`; `names` are further host names that it may be called by.
    pub fn new(address: SocketAddr, names: &[String], token: Option<Token>) -> Guard {
        Guard {
            token,
            port: address.port(),
            bound: address.ip(),
            names: names.iter().map(|name| name.to_ascii_lowercase()).collect(),
            encrypted: false,
        }
    }

    /// The same for a server that speaks TLS itself, or does not.
    #[must_use]
    pub fn encrypted(self, encrypted: bool) -> Guard {
        Guard { encrypted, ..self }
    }

    /// The part of the printed link behind the address.
    pub fn query(&self) -> String {
        let token = self.token.as_ref();
        token.map_or(String::new(), |Token(token)| format!("?{TOKEN}={token}"))
    }

    /// Cookies are shared by all ports of a computer: each panel has its own.
    fn cookie_name(&self) -> String {
        format!("drivemon-{}", self.port)
    }

    /// Whether a request shows the token, as a cookie or in the link.
    fn admits(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let Some(token) = &self.token else {
            return true;
        };
        let name = self.cookie_name();
        let texts = headers
            .get_all(COOKIE)
            .into_iter()
            .filter_map(|value| value.to_str().ok());
        let mut cookies = texts
            .flat_map(|text| text.split(';'))
            .filter_map(|cookie| cookie.trim().split_once('='));
        cookies.any(|(known, value)| known == name && token.is(value)) || self.is_link(uri)
    }

    /// Whether this is the link that was printed.
    fn is_link(&self, uri: &Uri) -> bool {
        let query = uri.query().unwrap_or_default();
        let mut shown = query.split('&').filter_map(|pair| pair.split_once('='));
        let token = self.token.as_ref();
        let right =
            token.is_some_and(|token| shown.any(|(key, value)| key == TOKEN && token.is(value)));
        right && uri.path() == "/"
    }

    /// The cookie that the link is exchanged for; no script reads it and no other site sends it.
    fn cookie(&self) -> Option<HeaderValue> {
        let Token(token) = self.token.as_ref()?;
        let cookie = format!(
            "{}={token}; Path=/; HttpOnly; SameSite=Strict{}",
            self.cookie_name(),
            secure(self.encrypted)
        );
        HeaderValue::from_str(&cookie).ok()
    }

    /// Whether `host`, a `Host` header or what follows `http://` in an origin, means this server.
    pub fn knows(&self, host: &str) -> bool {
        let Ok(uri) = host.parse::<axum::http::uri::Authority>() else {
            return false;
        };
        // A name and nothing else: no user before it.
        if uri.as_str().contains('@') {
            return false;
        }
        let name = uri.host().to_ascii_lowercase();
        if self.names.contains(&name) {
            // A proxy has a port of its own.
            return true;
        }
        let address = name
            .trim_start_matches('[')
            .trim_end_matches(']')
            .parse::<IpAddr>();
        let by_address = address.is_ok_and(|address| self.is_bound_to(address));
        let usual_port = if self.encrypted { 443 } else { 80 };
        uri.port_u16().unwrap_or(usual_port) == self.port && (by_address || name == "localhost")
    }

    /// Whether an `Origin` is this server's page: of its own scheme, or behind a proxy with TLS under a further name.
    fn is_origin(&self, origin: &str) -> bool {
        let plain = origin.strip_prefix("http://").filter(|_| !self.encrypted);
        let secure = origin.strip_prefix("https://").filter(|host| {
            let name = host.split(':').next().unwrap_or_default();
            self.encrypted || self.names.contains(&name.to_ascii_lowercase())
        });
        plain.or(secure).is_some_and(|host| self.knows(host))
    }

    /// An address is no name that somebody could point elsewhere.
    fn is_bound_to(&self, address: IpAddr) -> bool {
        address == self.bound || address.is_loopback() || self.bound.is_unspecified()
    }

    fn refusal(
        &self,
        method: &Method,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Option<(StatusCode, &'static str)> {
        let of = |name: HeaderName| headers.get_all(name).into_iter().collect::<Vec<_>>();
        let known = |value: &HeaderValue| value.to_str().is_ok_and(|host| self.knows(host));
        let hosts = of(HOST);
        let whole = uri
            .authority()
            .is_none_or(|authority| self.knows(authority.as_str()));
        if hosts.len() != 1 || !hosts.into_iter().all(known) || !whole {
            return Some((StatusCode::MISDIRECTED_REQUEST, FOREIGN_HOST));
        }
        let own = |value: &HeaderValue| value.to_str().is_ok_and(|origin| self.is_origin(origin));
        if !of(ORIGIN).into_iter().all(own) {
            return Some((StatusCode::FORBIDDEN, FOREIGN_ORIGIN));
        }
        if !self.admits(uri, headers) {
            return Some((StatusCode::UNAUTHORIZED, NO_TOKEN));
        }
        let crossing = headers
            .get("sec-fetch-site")
            .is_some_and(|site| site == "cross-site");
        let changes = method != Method::GET && method != Method::HEAD;
        if crossing && changes {
            return Some((StatusCode::FORBIDDEN, FOREIGN_ORIGIN));
        }
        // What a form of another site can send without asking is refused.
        let plain = headers
            .get(CONTENT_TYPE)
            .and_then(|kind| kind.to_str().ok())
            .is_none_or(is_plain);
        (changes && plain).then_some((StatusCode::UNSUPPORTED_MEDIA_TYPE, PLAIN_BODY))
    }
}

/// What a cookie says where it may travel encrypted alone.
pub fn secure(encrypted: bool) -> &'static str {
    if encrypted { "; Secure" } else { "" }
}

const FOREIGN_HOST: &str = "this panel is not called by that name: open the address that it printed, or start it with --allow-host NAME\n";
const FOREIGN_ORIGIN: &str =
    "another site asked through your browser; only the panel's own page may\n";
const NO_TOKEN: &str = "this panel asks for a token: open the whole link that it printed when it was started, with ?token=...\n";
const PLAIN_BODY: &str = "send application/json or application/octet-stream\n";

fn is_plain(kind: &str) -> bool {
    let kind = kind
        .split(';')
        .next()
        .unwrap_or_default()
        .trim()
        .to_ascii_lowercase();
    !matches!(
        kind.as_str(),
        "application/json" | "application/octet-stream"
    )
}

/// Refuses strangers, and puts the policy on every answer.
pub async fn check(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let refusal = guard.refusal(request.method(), request.uri(), request.headers());
    let cookie = guard.cookie().filter(|_| guard.is_link(request.uri()));
    let mut response = match refusal {
        Some((status, why)) => (status, why).into_response(),
        None => {
            if let Some(connection) = request.extensions().get::<Connection>() {
                connection.is_known();
            }
            next.run(request).await
        }
    };
    let headers = response.headers_mut();
    if let Some(cookie) = cookie.filter(|_| refusal.is_none()) {
        headers.insert(SET_COOKIE, cookie);
    }
    for (name, value) in HEADERS {
        headers.insert(
            HeaderName::from_static(name),
            HeaderValue::from_static(value),
        );
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str, names: &[&str]) -> Guard {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        Guard::new(address.parse().expect("an address"), &names, None)
    }

    #[test]
    fn only_its_own_names_are_known() {
        let guard = guard("127.0.0.1:8080", &[]);
        for host in [
            "127.0.0.1:8080",
            "localhost:8080",
            "LOCALHOST:8080",
            "[::1]:8080",
        ] {
            assert!(guard.knows(host), "{host}");
        }
        let foreign = [
            "",
            "127.0.0.1",
            "127.0.0.1:81",
            "localhost",
            "evil.example:8080",
            "localhost.evil.example:8080",
            "127.0.0.1.evil.example:8080",
            "a@localhost:8080",
            "192.168.1.7:8080",
            "localhost:8080/x",
            "local host:8080",
            "0.0.0.0:8080",
            "localhost:8080:8080",
        ];
        for host in foreign {
            assert!(!guard.knows(host), "{host}");
        }
    }

    #[test]
    fn a_token_is_long_random_and_compared_whole() {
        let (one, another) = (
            Token::random().expect("random"),
            Token::random().expect("random"),
        );
        assert!(one.0.len() == 32 && one.0 != another.0);
        assert!(one.is(&one.0) && !one.is(&another.0));
        assert!(!one.is("") && !one.is(&one.0[..31]) && !one.is(&format!("{}0", one.0)));
        assert!(!format!("{one:?}").contains(&one.0), "logs do not show it");
    }

    #[test]
    fn with_tls_its_page_is_encrypted() {
        let guard = guard("192.168.1.7:443", &[]).encrypted(true);
        assert!(guard.knows("192.168.1.7") && guard.is_origin("https://192.168.1.7"));
        assert!(!guard.is_origin("http://192.168.1.7") && !guard.knows("192.168.1.7:80"));
        assert!(!guard.is_origin("https://other.example"));
    }

    #[test]
    fn further_names_and_addresses_must_be_told() {
        let open = guard("0.0.0.0:80", &["Bench.example"]);
        for host in [
            "bench.example",
            "bench.example:80",
            "192.168.1.7",
            "[fe80::1]:80",
        ] {
            assert!(open.knows(host), "{host}");
        }
        // Behind a proxy with TLS: its port, and its scheme, under its name alone.
        assert!(open.knows("bench.example:8443") && open.is_origin("https://bench.example:8443"));
        assert!(open.is_origin("http://bench.example") && !open.is_origin("https://192.168.1.7"));
        assert!(!open.is_origin("https://other.example") && !open.is_origin("ftp://bench.example"));
        assert!(!open.knows("other.example"));
        assert!(!guard("192.168.1.7:80", &[]).knows("192.168.1.8"));
    }
}
