//! The wall as server-sent events: all of it first, then what changes.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Sse;
use axum::response::sse::Event;
use fleet::now_ms;
use fleet::people::Role;
use serde::Serialize;
use tokio_stream::wrappers::errors::BroadcastStreamRecvError;
use tokio_stream::wrappers::{BroadcastStream, IntervalStream};
use tokio_stream::{Stream, StreamExt};

use super::access::{Cookie, token};
use super::plant::{Plant, json};

/// Between two signs of life: a page that misses three takes what it shows for stale.
const ALIVE: Duration = Duration::from_secs(1);
/// A page whose connection broke tries again after this time.
const RETRY: Duration = Duration::from_millis(500);

/// A sign of life.
#[derive(Debug, Serialize)]
struct Alive {
    /// This computer's clock, Unix ms.
    now_ms: i64,
    /// Why the store cannot be read now; empty: it can.
    trouble: String,
}

/// Events `wall` (all), `news` (what changed) and `alive`. It ends when the visitor's token is withdrawn.
pub(super) async fn stream(
    State(plant): State<Arc<Plant>>,
    Extension(cookie): Extension<Cookie>,
    headers: HeaderMap,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let token = token(&headers, &cookie).map(str::to_owned);
    let behind = plant.clone();
    let from_now = BroadcastStream::new(plant.subscribe()).map(move |news| match news {
        Ok(news) => Some(named("news", &news)),
        // What was missed is in the whole.
        Err(BroadcastStreamRecvError::Lagged(_)) => Some(named("wall", &json(&*behind.wall()))),
    });
    let first = named("wall", &json(&*plant.wall())).retry(RETRY);
    let alive = IntervalStream::new(tokio::time::interval(ALIVE)).map(move |_| {
        let user = plant.visitor(token.as_deref()).ok().flatten();
        plant.allows(user.as_ref(), Role::See).then(|| {
            let (now_ms, trouble) = (now_ms(), plant.trouble());
            named("alive", &json(&Alive { now_ms, trouble }))
        })
    });
    let stream = tokio_stream::once(Some(first)).chain(from_now.merge(alive));
    let allowed = stream.take_while(Option::is_some);
    Sse::new(allowed.filter_map(|event| event.map(Ok)))
}

fn named(event: &str, json: &str) -> Event {
    Event::default().event(event).data(json)
}
