//! Windows as server-sent events: a page that cannot follow loses windows, and is told how many.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::Event;
use tokio_stream::wrappers::errors::BroadcastStreamRecvError;
use tokio_stream::wrappers::{BroadcastStream, IntervalStream};
use tokio_stream::{Stream, StreamExt};

use crate::running::session::Session;
use crate::running::shared::Broadcast;

/// Between two signs of life: a page that misses four takes what it shows for stale.
const ALIVE: Duration = Duration::from_millis(500);
/// A page whose connection broke tries again after this time.
const RETRY: Duration = Duration::from_millis(500);

/// Everything from now on; the status, the events so far and what a resting source showed last come first.
pub async fn stream(
    State(session): State<Arc<Session>>,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let from_now = BroadcastStream::new(session.subscribe()).map(event);
    let mut first = vec![
        named("status", &json(&session.status())).retry(RETRY),
        named("events", &json(&session.events())),
    ];
    let shown = session.shown_at_rest();
    first.extend(shown.map(|Broadcast { event, json }| named(event, &json)));
    let alive = IntervalStream::new(tokio::time::interval(ALIVE)).map(move |_| {
        let rests = session.status_now(|status| status.rests());
        named("alive", &format!("{{\"rests\":{rests}}}"))
    });
    let stream = tokio_stream::iter(first).chain(from_now.merge(alive));
    Sse::new(stream.map(Ok))
}

fn named(event: &str, json: &str) -> Event {
    Event::default().event(event).data(json)
}

fn json<T: serde::Serialize>(message: &T) -> String {
    serde_json::to_string(message).unwrap_or_default()
}

fn event(message: Result<Broadcast, BroadcastStreamRecvError>) -> Event {
    match message {
        Ok(Broadcast { event, json }) => named(event, &json),
        Err(BroadcastStreamRecvError::Lagged(messages)) => named("lost", &messages.to_string()),
    }
}
