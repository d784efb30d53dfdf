//! What people ask for on pages: written down beside the store, done here, because the store has one writer.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use fleet::alarm::{Watch, WatchError};
use fleet::people::{Asked, Outcome, People, PeopleError};
use fleet::{Store, StoreError, now_ms};
use tokio::sync::watch;

/// Between two looks at what people ask for.
const PAUSE: Duration = Duration::from_millis(150);
/// After a failure.
const BREATH: Duration = Duration::from_secs(1);

/// What it works with.
pub(super) struct Requests {
    pub store: Arc<Store>,
    pub watch: Arc<Watch>,
    pub people: People,
    pub say: Arc<dyn Fn(String) + Send + Sync>,
    pub ended: watch::Receiver<bool>,
}

/// Why it could not be done.
#[derive(Debug, thiserror::Error)]
enum Trouble {
    #[error(transparent)]
    Watch(#[from] WatchError),
    #[error(transparent)]
    People(#[from] PeopleError),
}

impl Trouble {
    /// Another gateway does it now.
    fn is_final(&self) -> bool {
        let Trouble::Watch(WatchError::Store(error)) = self else {
            return false;
        };
        matches!(error, StoreError::OtherWriter)
    }
}

impl Requests {
    /// Works until the gateway ends. A failure is told once, until it works again.
    pub fn run(self) {
        let mut failed = false;
        while self.goes_on() {
            let done = self.turn();
            if let (Err(error), false) = (&done, failed) {
                (self.say)(format!("what people ask for: {error}; it is tried again"));
            }
            if done.as_ref().is_err_and(Trouble::is_final) {
                return;
            }
            failed = done.is_err();
            sleep(if failed { BREATH } else { PAUSE });
        }
    }

    /// Without a sender the gateway was dropped.
    fn goes_on(&self) -> bool {
        !*self.ended.borrow() && self.ended.has_changed().is_ok()
    }

    fn turn(&self) -> Result<(), Trouble> {
        for asked in self.people.asked()? {
            let outcome = self.act(&asked)?;
            self.people.ended(asked.id, &outcome)?;
        }
        Ok(())
    }

    /// Does what a person asked for. After a crash in between it is done once more, which changes nothing.
    fn act(&self, asked: &Asked) -> Result<Outcome, Trouble> {
        let alarms = self.watch.alarms(&self.store)?;
        let alarm = alarms.iter().find(|alarm| alarm.number == asked.alarm);
        if alarm.is_some_and(|alarm| alarm.raised_ms > asked.time_ms) {
            let words = "the alarm rose again after that: look at it once more".to_owned();
            return Ok(Outcome { done: false, words });
        }
        let Asked {
            alarm,
            action,
            who,
            why,
            ..
        } = asked;
        let done = self
            .watch
            .act(&self.store, *alarm, action, who, why, now_ms());
        let refused = match done {
            Ok(_) => None,
            Err(WatchError::Action(refused)) => Some(refused.to_string()),
            Err(error) => return Err(error.into()),
        };
        Ok(Outcome {
            done: refused.is_none(),
            words: refused.unwrap_or_default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::super::alarms::Alarms;
    use super::*;
    use fleet::alarm::{Action, AlarmFilter, AlarmState, Rules};
    use fleet::people::{Role, User};
    use fleet::{Entry, Limits, MotorId, MotorInfo, Second};

    /// Longest wait for anything.
    const PATIENCE: Duration = Duration::from_secs(20);
    /// FAULT and RUN on.
    const FAULT: u32 = 1 << 16 | 1;

    struct Bench {
        folder: tempfile::TempDir,
        store: Arc<Store>,
        motor: MotorId,
        stored: watch::Sender<u64>,
    }

    impl Bench {
        fn new() -> Bench {
            let folder = tempfile::tempdir().expect("a folder");
            let store = Store::open(&folder.path().join("plant.db"), &Limits::default());
            let store = Arc::new(store.expect("a store"));
            let motor: MotorId = "pump".parse().expect("a name");
            store
                .declare(&[MotorInfo::new(motor.clone())])
                .expect("declared");
            let (stored, _) = watch::channel(0);
            Bench {
                folder,
                store,
                motor,
                stored,
            }
        }

        fn people(&self) -> People {
            People::open(&self.folder.path().join("plant.db")).expect("people")
        }

        fn second(&self, number: u32, time_ms: i64, lamps: u32) {
            let second = Second {
                start: 1,
                number,
                time_ms,
                lamps,
                windows: 1,
                judged: 1,
                fault: 2,
                ..Second::default()
            };
            let batch = [(self.motor.clone(), Entry::Second(second))];
            self.store.append(&batch).expect("stored");
            self.stored.send_modify(|count| *count += 1);
        }

        /// Runs the alarms while something is done.
        fn while_running<T>(&self, work: impl FnOnce() -> T) -> T {
            let (end, ended) = watch::channel(false);
            let alarms = Alarms {
                store: self.store.clone(),
                watch: Arc::new(Watch::new(Rules::default())),
                stored: self.stored.subscribe(),
                say: Arc::new(|_| {}),
                ended: ended.clone(),
            };
            let requests = Requests {
                store: self.store.clone(),
                watch: alarms.watch.clone(),
                people: self.people(),
                say: Arc::new(|_| {}),
                ended,
            };
            let threads = [
                std::thread::spawn(move || alarms.run()),
                std::thread::spawn(move || requests.run()),
            ];
            let done = work();
            end.send(true).expect("it runs");
            for thread in threads {
                thread.join().expect("it ends");
            }
            done
        }

        fn state(&self) -> Option<AlarmState> {
            let alarms = self.store.alarms(&AlarmFilter::default()).expect("read");
            alarms.first().map(|alarm| alarm.state)
        }
    }

    fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
        let begin = Instant::now();
        loop {
            if let Some(found) = look() {
                return found;
            }
            assert!(begin.elapsed() < PATIENCE, "{what} did not come about");
            sleep(Duration::from_millis(10));
        }
    }

    #[test]
    fn a_fault_is_acknowledged_by_name_and_stays_so_after_a_restart() {
        let bench = Bench::new();
        let people = bench.people();
        let anna = User {
            name: "Anna".to_owned(),
            role: Role::Acknowledge,
        };
        let now = now_ms();
        // Asked for while no gateway runs.
        bench.second(1, now - 1_000, FAULT);
        bench.while_running(|| until("an alarm", || bench.state()));
        let ask = |at| {
            people
                .ask(&anna, 1, &Action::Acknowledge, "seen", at)
                .expect("asked")
        };
        let asked = ask(now);
        assert_eq!(people.outcome(asked).expect("read"), None);
        let outcome =
            bench.while_running(|| until("its end", || people.outcome(asked).expect("read")));
        assert_eq!(
            outcome,
            Outcome {
                done: true,
                words: String::new()
            }
        );
        assert_eq!(bench.state(), Some(AlarmState::Acknowledged));
        // Once more after another restart: nothing new, no error.
        bench.while_running(|| sleep(Duration::from_millis(300)));
        assert_eq!(bench.state(), Some(AlarmState::Acknowledged));
    }

    #[test]
    fn what_rose_after_it_was_asked_for_is_not_acknowledged() {
        let bench = Bench::new();
        let people = bench.people();
        let anna = User {
            name: "Anna".to_owned(),
            role: Role::Acknowledge,
        };
        let now = now_ms();
        bench.second(1, now, FAULT);
        bench.while_running(|| until("an alarm", || bench.state()));
        let asked = people
            .ask(&anna, 1, &Action::Acknowledge, "", now - 500)
            .expect("asked");
        let none = people
            .ask(&anna, 9, &Action::Acknowledge, "", now)
            .expect("asked");
        let outcome = bench.while_running(|| {
            until("its end", || people.outcome(none).expect("read"));
            people.outcome(asked).expect("read").expect("it came first")
        });
        assert!(
            !outcome.done && outcome.words.contains("rose again"),
            "{outcome:?}"
        );
        assert_eq!(bench.state(), Some(AlarmState::Unacknowledged));
        let outcome = people.outcome(none).expect("read").expect("ended");
        assert!(
            !outcome.done && outcome.words.contains("no alarm 9"),
            "{outcome:?}"
        );
    }
}
