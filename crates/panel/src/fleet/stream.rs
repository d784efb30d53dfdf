//! The wall as server-sent events: all of it first, then what changes.

use std::convert::Infallible;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

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

/// A page that has taken nothing for so long does not read: there is a sign of life every second.
const UNREAD: Duration = Duration::from_secs(5);

/// One page's stream: when the page last made room for something.
struct Reading {
    plant: Arc<Plant>,
    last: Mutex<Instant>,
}

impl Reading {
    fn new(plant: Arc<Plant>) -> Reading {
        Reading {
            plant,
            last: Mutex::new(Instant::now()),
        }
    }

    fn goes_on(&self) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// What was missed is in the whole.
    fn fell_behind(&self, changes: u64) -> String {
        self.plant.slow.behind.fetch_add(1, Relaxed);
        self.plant.slow.skipped.fetch_add(changes, Relaxed);
        json(&*self.plant.wall())
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        let last = self.last.get_mut().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() > UNREAD {
            self.plant.slow.cut.fetch_add(1, Relaxed);
        }
    }
}

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
    Sse::new(events(plant, token).map(Ok))
}

/// What a page is sent, for as long as its visitor may see.
fn events(plant: Arc<Plant>, token: Option<String>) -> impl Stream<Item = Event> {
    let reading = Arc::new(Reading::new(plant.clone()));
    let behind = reading.clone();
    let from_now = BroadcastStream::new(plant.subscribe()).map(move |news| match news {
        Ok(news) => Some(named("news", &news)),
        Err(BroadcastStreamRecvError::Lagged(changes)) => {
            Some(named("wall", &behind.fell_behind(changes)))
        }
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
    allowed.filter_map(move |event| {
        reading.goes_on();
        event
    })
}

fn named(event: &str, json: &str) -> Event {
    Event::default().event(event).data(json)
}

#[cfg(test)]
mod tests {
    use std::pin::pin;

    use fleet::{Entry, Limits, MotorInfo, Second, Store};

    use super::*;
    use crate::fleet::plant::{DueRule, Settings};

    /// Changes of the wall that a page misses: more than are kept for it.
    const MISSED: u32 = 100;

    fn second(number: u32) -> (fleet::MotorId, Entry) {
        let second = Second {
            start: 1,
            number,
            time_ms: now_ms(),
            // FAULT comes and goes, so that every look finds a change.
            lamps: 1 | (number % 2) << 16,
            ..Second::default()
        };
        ("m".parse().expect("a name"), Entry::Second(second))
    }

    fn counts(plant: &Plant) -> [u64; 3] {
        let slow = &plant.slow;
        [&slow.behind, &slow.skipped, &slow.cut].map(|count| count.load(Relaxed))
    }

    /// A page that sleeps over a hundred changes gets the whole wall, one that never reads again is counted when it is cut, and the
    /// store has everything.
    #[tokio::test(flavor = "current_thread")]
    async fn a_page_that_does_not_read_is_counted_and_loses_nothing_that_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("plant.db");
        let store = Store::open(&path, &Limits::default()).expect("a store");
        let motor = MotorInfo::new("m".parse().expect("a name"));
        store.declare(&[motor]).expect("declared");
        let settings = Settings {
            stale_ms: 10_000,
            open: true,
            due: DueRule::default(),
        };
        let plant = Plant::open(&path, settings).expect("it is there");
        // This test looks itself.
        plant.end();
        let mut slow = pin!(events(plant.clone(), None));
        assert!(slow.next().await.is_some());
        for number in 1..=MISSED {
            store.append(&[second(number)]).expect("stored");
            plant.look().expect("read");
        }
        assert_eq!(counts(&plant), [0; 3], "nobody knows yet");
        let told = tokio::time::timeout(Duration::from_secs(5), async {
            while counts(&plant)[0] == 0 {
                assert!(slow.next().await.is_some());
            }
        });
        told.await.expect("it is told");
        let [behind, skipped, cut] = counts(&plant);
        assert_eq!((behind, cut), (1, 0));
        assert!(skipped > 0 && skipped < u64::from(MISSED), "{skipped}");
        assert_eq!(store.since(0, 1_000).expect("read").len(), MISSED as usize);
        let unread = Instant::now().checked_sub(2 * UNREAD).expect("a while ago");
        for (last, cut) in [(Instant::now(), 0), (unread, 1)] {
            let reading = Reading::new(plant.clone());
            *reading.last.lock().expect("free") = last;
            drop(reading);
            assert_eq!(counts(&plant)[2], cut);
        }
    }
}
