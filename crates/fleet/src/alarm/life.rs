//! One alarm from state to state.

use super::change::{Alarm, AlarmChange, AlarmState, Change, Who};

impl Alarm {
    /// The state that follows from what is known of it.
    pub(super) fn derived(&self) -> AlarmState {
        if self.suppressed {
            return AlarmState::Suppressed;
        }
        if self.shelved_until_ms.is_some() {
            return AlarmState::Shelved;
        }
        match (self.present, self.acknowledged) {
            (true, false) => AlarmState::Unacknowledged,
            (true, true) => AlarmState::Acknowledged,
            (false, false) => AlarmState::ReturnedUnacknowledged,
            (false, true) => AlarmState::Normal,
        }
    }

    /// Changes it and tells the change.
    pub(super) fn step(
        &mut self,
        change: Change,
        who: Who,
        why: &str,
        time_ms: i64,
        work: impl FnOnce(&mut Self),
    ) -> AlarmChange {
        let before = self.state;
        work(self);
        self.state = self.derived();
        self.changed_ms = time_ms;
        AlarmChange {
            change,
            before,
            alarm: self.clone(),
            who,
            time_ms,
            why: why.to_owned(),
        }
    }
}
