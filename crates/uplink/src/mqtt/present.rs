//! The plant as it is now, for births.

use std::collections::BTreeMap;

use fleet::alarm::{Alarm, AlarmFilter};
use fleet::{MotorId, MotorState, Store, StoreError};

use crate::sparkplug::{
    Group, Present, Update, Value, alarm_values, info_values, link_values, second_values,
};

/// Updates of the plant as a whole, and every declared motor.
///
/// # Errors
/// The store cannot be read.
pub fn present(store: &Store, now_ms: i64) -> Result<(Vec<Update>, Vec<Present>), StoreError> {
    let mut newest = newest_alarms(store.alarms(&AlarmFilter::default())?);
    let motors = store.motors()?;
    let motors = motors
        .into_iter()
        .map(|state| {
            let alarm = newest.remove(&Some(state.info.id.clone()));
            of_motor(state, alarm, now_ms)
        })
        .collect();
    let plant = newest.remove(&None).map(|alarm| of_alarm(&alarm));
    Ok((plant.into_iter().collect(), motors))
}

/// Of each motor the alarm that changed last.
fn newest_alarms(alarms: Vec<Alarm>) -> BTreeMap<Option<MotorId>, Alarm> {
    let mut newest: BTreeMap<Option<MotorId>, Alarm> = BTreeMap::new();
    for alarm in alarms {
        match newest.get(&alarm.motor) {
            Some(known) if known.changed_ms >= alarm.changed_ms => {}
            _ => _ = newest.insert(alarm.motor.clone(), alarm),
        }
    }
    newest
}

fn of_alarm(alarm: &Alarm) -> Update {
    Update {
        group: Group::Alarm,
        time_ms: alarm.changed_ms,
        values: alarm_values(alarm),
    }
}

fn of_motor(state: MotorState, alarm: Option<Alarm>, now_ms: i64) -> Present {
    let newest_ms = state.last.as_ref().map_or(now_ms, |second| second.time_ms);
    let mut values = vec![Update {
        group: Group::Info,
        time_ms: now_ms,
        values: info_values(&state.info),
    }];
    values.extend(state.last.as_ref().map(|second| Update {
        group: Group::Second,
        time_ms: second.time_ms,
        values: second_values(second),
    }));
    values.extend(state.link.as_ref().map(|link| Update {
        group: Group::Link,
        time_ms: link.time_ms,
        values: link_values(link),
    }));
    if state.last_event > 0 {
        values.push(event(state.last_event, newest_ms));
    }
    values.extend(alarm.as_ref().map(of_alarm));
    Present {
        device: state.info.id.to_string(),
        up: state
            .link
            .as_ref()
            .map(|link| link.up)
            .or(state.last.map(|_| true)),
        values,
    }
}

/// The store keeps a motor's newest event by its number; what it was stands in its entry.
fn event(number: u32, time_ms: i64) -> Update {
    let mut values = vec![None; Group::Event.metrics().len()];
    values[0] = Some(Value::Large(u64::from(number)));
    Update {
        group: Group::Event,
        time_ms,
        values,
    }
}
