//! What every link works with, and what it says of a motor.

use std::collections::HashMap;
use std::sync::Arc;

use fleet::{Entry, Link, MotorId, Second, Store, now_ms};
use tokio::sync::watch;

use super::clock::Clock;
use super::motor::Watched;
use super::tally::{Post, Posts, Tally};
use crate::config::Patience;

/// Hears what a person at the terminal should know.
pub(crate) type Say = Arc<dyn Fn(String) + Send + Sync>;

/// What every link works with.
#[derive(Clone)]
pub(crate) struct Context {
    pub store: Arc<Store>,
    /// Newest second of each motor when the gateway began.
    pub last: Arc<HashMap<MotorId, Second>>,
    pub posts: Posts,
    pub tally: Arc<Tally>,
    pub patience: Patience,
    pub say: Say,
    /// `true` once the gateway ends.
    pub ended: watch::Receiver<bool>,
}

impl Context {
    /// What is stored of a motor.
    pub(super) fn recall(&self, motor: &mut Watched) {
        motor.second = self.store.last_second(&motor.id).unwrap_or_default();
        motor.event = self.store.last_event(&motor.id).unwrap_or_default();
    }

    /// When the stored seconds were: a run that goes on keeps its times.
    pub(super) fn recall_time(&self, motor: &mut Watched) {
        let (Some(last), Some((start, _))) = (self.last.get(&motor.id), motor.second) else {
            return;
        };
        if last.start == start {
            motor.run = Some(start);
            motor.clock = Clock::of_stored(last.number, last.time_ms);
        }
    }

    /// A motor answers; stored where that is news.
    pub(super) async fn is_up(&self, motor: &mut Watched) {
        Tally::add(&self.tally.visits, 1);
        if motor.health.answered(std::time::Instant::now()) {
            Tally::add(&self.tally.up, 1);
            (self.say)(format!("motor {}: answers", motor.id));
            self.tell(motor, true, String::new()).await;
        }
    }

    /// A motor does not answer, or not as it should; stored once it counts as lost.
    pub(super) async fn is_down(&self, motor: &mut Watched, why: &str, at_once: bool) {
        let (now, patience) = (std::time::Instant::now(), self.patience);
        let lost_after = match at_once {
            true => std::time::Duration::ZERO,
            false => patience.lost_after,
        };
        Tally::add(&self.tally.failures, 1);
        let was_up = motor.health.is_up();
        if motor.health.failed(now, lost_after, patience.retry_most) {
            if was_up {
                self.tally
                    .up
                    .fetch_sub(1, std::sync::atomic::Ordering::Relaxed);
            }
            (self.say)(format!("motor {}: lost: {why}", motor.id));
            self.tell(motor, false, why.to_owned()).await;
        }
    }

    async fn tell(&self, motor: &Watched, up: bool, why: String) {
        let link = Link {
            up,
            time_ms: now_ms(),
            why,
        };
        let post = Post {
            motor: motor.id.clone(),
            entries: vec![Entry::Link(link)],
            durable: None,
        };
        // Where nobody takes posts any more the gateway ends.
        let _ = self.posts.send(post).await;
    }
}
