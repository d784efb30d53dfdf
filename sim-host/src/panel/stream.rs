//! Windows as server-sent events: a page that cannot follow loses windows, and is told how many.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use tokio_stream::wrappers::BroadcastStream;
use tokio_stream::wrappers::errors::BroadcastStreamRecvError;
use tokio_stream::{Stream, StreamExt};

use super::session::{Broadcast, Session};

/// Between two signs of life while nothing happens.
const ALIVE: Duration = Duration::from_secs(2);
/// A page whose connection broke tries again after this time.
const RETRY: Duration = Duration::from_millis(500);

/// Everything from now on; the status and the events so far come first.
pub async fn stream(
    State(session): State<Arc<Session>>,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let from_now = BroadcastStream::new(session.subscribe()).map(|message| Ok(event(message)));
    let first = [
        Event::default()
            .retry(RETRY)
            .event("status")
            .data(json(&session.status())),
        Event::default()
            .event("events")
            .data(json(&session.events())),
    ];
    let stream = tokio_stream::iter(first.map(Ok)).chain(from_now);
    Sse::new(stream).keep_alive(KeepAlive::new().interval(ALIVE))
}

fn json<T: serde::Serialize>(message: &T) -> String {
    serde_json::to_string(message).unwrap_or_default()
}

fn event(message: Result<Broadcast, BroadcastStreamRecvError>) -> Event {
    match message {
        Ok(Broadcast { event, json }) => Event::default().event(event).data(&*json),
        Err(BroadcastStreamRecvError::Lagged(messages)) => {
            Event::default().event("lost").data(messages.to_string())
        }
    }
}
