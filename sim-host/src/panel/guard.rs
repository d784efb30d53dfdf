//! Who may talk to the server: nobody but the page that it serves itself.
//!
//! A page of another site must not reach it through the visitor's browser: neither by a request (`Origin`) nor under a
//! name that was pointed at this computer (DNS rebinding, `Host`).

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{CONTENT_TYPE, HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Nothing but what this server delivers; no script and no style in the page itself.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// What goes with every answer.
const HEADERS: [(&str, &str); 6] = [
    ("content-security-policy", POLICY),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// The names under which this server answers.
#[derive(Clone, Debug)]
pub struct Guard {
    port: u16,
    bound: IpAddr,
    names: Vec<String>,
}

impl Guard {
    /// For a server bound to `address`; `names` are further host names that it may be called by.
    pub fn new(address: SocketAddr, names: &[String]) -> Guard {
        Guard {
            port: address.port(),
            bound: address.ip(),
            names: names.iter().map(|name| name.to_ascii_lowercase()).collect(),
        }
    }

    /// Whether `host`, a `Host` header or what follows `http://` in an origin, means this server.
    pub fn knows(&self, host: &str) -> bool {
        let Ok(uri) = host.parse::<axum::http::uri::Authority>() else {
            return false;
        };
        // A name and nothing else: no user before it.
        if uri.as_str().contains('@') || uri.port_u16().unwrap_or(80) != self.port {
            return false;
        }
        let name = uri.host().to_ascii_lowercase();
        let address = name
            .trim_start_matches('[')
            .trim_end_matches(']')
            .parse::<IpAddr>();
        let by_address = address.is_ok_and(|address| self.is_bound_to(address));
        by_address || name == "localhost" || self.names.contains(&name)
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
        let own = |value: &HeaderValue| {
            let origin = value
                .to_str()
                .ok()
                .and_then(|origin| origin.strip_prefix("http://"));
            origin.is_some_and(|host| self.knows(host))
        };
        if !of(ORIGIN).into_iter().all(own) {
            return Some((StatusCode::FORBIDDEN, FOREIGN_ORIGIN));
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

const FOREIGN_HOST: &str = "this panel is not called by that name: open the address that it printed, or start it with --allow-host NAME\n";
const FOREIGN_ORIGIN: &str =
    "another site asked through your browser; only the panel's own page may\n";
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
    let mut response = match refusal {
        Some((status, why)) => (status, why).into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
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
        Guard::new(address.parse().expect("an address"), &names)
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
        assert!(!open.knows("other.example"));
        assert!(!guard("192.168.1.7:80", &[]).knows("192.168.1.8"));
    }
}
