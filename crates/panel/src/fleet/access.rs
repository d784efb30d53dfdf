//! Who asks, and whether they may.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, COOKIE, SET_COOKIE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use fleet::now_ms;
use fleet::people::{Outcome, Role, User};
use schemars::JsonSchema;
use serde::Deserialize;

use super::answers::{Me, Problem};
use super::plant::Plant;
use crate::http::guard::secure;

/// Who asks; `None`: nobody who is known.
#[derive(Clone, Debug)]
pub(super) struct Visitor(pub Option<User>);

/// The answer passed the check of tokens: what is refused before it came from a foreign page.
#[derive(Clone, Copy, Debug)]
struct Judged;

/// A cookie is kept for a year: a wall that loses its power comes back by itself.
const COOKIE_S: u32 = 365 * 86_400;

/// Cookies are shared by all ports of a computer: each server has its own.
#[derive(Clone, Debug)]
pub(super) struct Cookie {
    pub name: String,
    /// Whether it travels encrypted alone.
    pub encrypted: bool,
}

/// What a route asks for.
#[derive(Clone)]
pub(super) struct Gate {
    pub plant: Arc<Plant>,
    pub role: Role,
    pub cookie: Cookie,
}

/// Why a question is refused: status and words.
#[derive(Debug)]
pub(super) struct Refusal(pub StatusCode, pub String);

/// An answer that refuses.
pub(super) fn refuse(status: StatusCode, message: impl Into<String>) -> Response {
    let message = message.into();
    (status, Json(Problem { message })).into_response()
}

/// The token of a request: as a bearer, as programs send it, or in the page's cookie.
pub(super) fn token<'a>(headers: &'a HeaderMap, cookie: &Cookie) -> Option<&'a str> {
    let bearer = headers.get(AUTHORIZATION).and_then(|v| v.to_str().ok());
    if let Some(token) = bearer.and_then(|value| value.strip_prefix("Bearer ")) {
        return Some(token.trim());
    }
    let texts = headers.get_all(COOKIE).into_iter();
    let texts = texts.filter_map(|value| value.to_str().ok());
    let mut cookies = texts
        .flat_map(|text| text.split(';'))
        .filter_map(|one| one.trim().split_once('='));
    let found = cookies.find(|(name, _)| *name == cookie.name);
    found.map(|(_, value)| value)
}

/// Lets through who may; the others are counted, and those who are known stand in the audit trail.
pub(super) async fn check(State(gate): State<Gate>, mut request: Request, next: Next) -> Response {
    let Gate {
        plant,
        role,
        cookie,
    } = gate;
    let user = match plant.visitor(token(request.headers(), &cookie)) {
        Ok(user) => user,
        Err(error) => return refuse(StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    };
    let mut response = if plant.allows(user.as_ref(), role) {
        request.extensions_mut().insert(Visitor(user));
        next.run(request).await
    } else if let Some(user) = user {
        plant.refused.wrong_role.fetch_add(1, Relaxed);
        let words = format!(
            "this needs the role {role}, and {} has {}",
            user.name, user.role
        );
        let what = format!("{} {}", request.method(), request.uri().path());
        let outcome = Outcome {
            done: false,
            words: words.clone(),
        };
        // The refusal holds whether or not it can be written down.
        let _ = plant.people.note(&user.name, &what, &outcome, now_ms());
        refuse(StatusCode::FORBIDDEN, words)
    } else {
        plant.refused.no_token.fetch_add(1, Relaxed);
        refuse(StatusCode::UNAUTHORIZED, NO_TOKEN)
    };
    response.extensions_mut().insert(Judged);
    response
}

const NO_TOKEN: &str = "sign in with a token, which is made beside the store with `drivemon fleet user add NAME --role ROLE`";

/// Counts what the guard refuses: foreign pages and names.
pub(super) async fn count_foreign(
    State(plant): State<Arc<Plant>>,
    request: Request,
    next: Next,
) -> Response {
    let response = next.run(request).await;
    let refused = matches!(
        response.status(),
        StatusCode::FORBIDDEN | StatusCode::MISDIRECTED_REQUEST
    );
    if refused && response.extensions().get::<Judged>().is_none() {
        plant.refused.foreign.fetch_add(1, Relaxed);
    }
    response
}

/// A token that somebody signs in with.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SignIn {
    /// The token that `drivemon fleet user add` printed.
    token: String,
}

/// Signs in: the browser keeps the token as a cookie that no script reads and no other site sends.
pub(super) async fn sign_in(
    State(plant): State<Arc<Plant>>,
    Extension(cookie): Extension<Cookie>,
    Json(SignIn { token }): Json<SignIn>,
) -> Response {
    let token = token.trim();
    match plant.visitor(Some(token)) {
        Ok(Some(user)) => {
            let me = Me::of(Some(&user), plant.settings.open);
            with_cookie(&cookie, token, COOKIE_S, me)
        }
        Ok(None) => {
            plant.refused.no_token.fetch_add(1, Relaxed);
            let mut response = refuse(StatusCode::UNAUTHORIZED, "this token is not known");
            response.extensions_mut().insert(Judged);
            response
        }
        Err(error) => refuse(StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    }
}

/// Signs out.
pub(super) async fn sign_out(
    State(plant): State<Arc<Plant>>,
    Extension(cookie): Extension<Cookie>,
) -> Response {
    with_cookie(&cookie, "", 0, Me::of(None, plant.settings.open))
}

/// Who asks.
pub(super) async fn me(
    State(plant): State<Arc<Plant>>,
    Extension(cookie): Extension<Cookie>,
    headers: HeaderMap,
) -> Response {
    match plant.visitor(token(&headers, &cookie)) {
        Ok(user) => Json(Me::of(user.as_ref(), plant.settings.open)).into_response(),
        Err(error) => refuse(StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    }
}

fn with_cookie(cookie: &Cookie, token: &str, age_s: u32, me: Me) -> Response {
    let text = format!(
        "{}={token}; Path=/; Max-Age={age_s}; HttpOnly; SameSite=Strict{}",
        cookie.name,
        secure(cookie.encrypted)
    );
    let mut response = Json(me).into_response();
    // A known token has hexadecimal digits alone.
    if let Ok(value) = HeaderValue::from_str(&text) {
        response.headers_mut().insert(SET_COOKIE, value);
    }
    response
}
