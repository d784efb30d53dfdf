//! What was told of a motor, or of the gateway, in this session; births and data follow from it.

use std::collections::BTreeMap;

use super::metrics::{ALIASES, Group};
use super::payload::Metric;
use super::update::Update;
use super::value::{Value, metric};

/// Values of a group as they were told last.
#[derive(Clone, Debug, PartialEq)]
struct Told {
    time_ms: i64,
    values: Vec<Option<Value>>,
}

/// A motor, or the gateway, as its last birth and the data since then told it.
#[derive(Clone, Debug, PartialEq)]
pub struct Teller {
    groups: &'static [Group],
    block: u64,
    told: BTreeMap<Group, Told>,
    /// What the births told, for what is older than it.
    horizon: BTreeMap<Group, Told>,
    renewed_ms: i64,
}

/// Unix time of a message; before 1970 there is none.
pub(super) fn stamp(time_ms: i64) -> u64 {
    u64::try_from(time_ms).unwrap_or(0)
}

impl Teller {
    /// One of which nothing was told yet; its aliases are those of block `block`.
    pub fn new(groups: &'static [Group], block: u64) -> Teller {
        Teller {
            groups,
            block,
            told: BTreeMap::new(),
            horizon: BTreeMap::new(),
            renewed_ms: i64::MIN,
        }
    }

    /// Takes the present values of all births of a session: what happened before is the past.
    pub fn renew(&mut self, now_ms: i64, present: Vec<Update>) {
        self.told.clear();
        present.into_iter().for_each(|update| self.keep(update));
        self.horizon = self.told.clone();
        self.renewed_ms = now_ms;
    }

    /// Every metric with its present value.
    pub fn birth(&self, now_ms: i64) -> Vec<Metric> {
        let mut metrics = Vec::new();
        for group in self.groups {
            let told = self.told.get(group);
            let at_ms = stamp(told.map_or(now_ms, |told| told.time_ms));
            for (k, definition) in group.metrics().iter().enumerate() {
                let value = told.and_then(|told| told.values.get(k)?.as_ref());
                metrics.push(definition.born(Some(self.alias(*group, k)), at_ms, value));
            }
        }
        metrics
    }

    /// Whether an update is older than what the births told: it belongs to the past then.
    pub fn is_past(&self, update: &Update) -> bool {
        let Some(told) = self.horizon.get(&update.group) else {
            // They told no value of it.
            return update.time_ms < self.renewed_ms;
        };
        match (update.group, told.values.first(), update.values.first()) {
            // A board numbers its events over its life; their times are not known where only the number is.
            (Group::Event, Some(Some(Value::Large(told))), Some(Some(Value::Large(new)))) => {
                new <= told
            }
            _ => update.time_ms <= told.time_ms,
        }
    }

    /// All values of an update that belongs to the past. It changes nothing of the present.
    pub fn past(&self, update: &Update) -> Vec<Metric> {
        let metrics = self.metrics(update, |_, _| true);
        let historical = |metric| Metric {
            is_historical: Some(true),
            ..metric
        };
        metrics.into_iter().map(historical).collect()
    }

    /// The values of an update that changed; of what happens seldom all of them.
    pub fn data(&mut self, update: Update) -> Vec<Metric> {
        let told = self.told.get(&update.group);
        let seldom = update.group != Group::Second;
        let metrics = self.metrics(&update, |k, value| {
            seldom || told.is_none_or(|told| told.values.get(k) != Some(value))
        });
        self.keep(update);
        metrics
    }

    fn metrics(
        &self,
        update: &Update,
        wanted: impl Fn(usize, &Option<Value>) -> bool,
    ) -> Vec<Metric> {
        let values = update.values.iter().enumerate();
        let at_ms = stamp(update.time_ms);
        values
            .filter(|(k, value)| wanted(*k, value))
            .map(|(k, value)| metric(Some(self.alias(update.group, k)), at_ms, value.as_ref()))
            .collect()
    }

    /// Takes an update as the present.
    pub fn keep(&mut self, update: Update) {
        if update.group == Group::Board {
            // The new board numbers its events from 1.
            self.told.remove(&Group::Event);
            self.horizon.remove(&Group::Event);
        }
        let told = Told {
            time_ms: update.time_ms,
            values: update.values,
        };
        self.told.insert(update.group, told);
    }

    /// The value of one metric as it was told last.
    pub fn value(&self, group: Group, k: usize) -> Option<&Value> {
        self.told.get(&group)?.values.get(k)?.as_ref()
    }

    /// One metric of a group changed: the metric for a data message.
    pub fn change(&mut self, group: Group, k: usize, now_ms: i64, value: Value) -> Metric {
        let changed = metric(Some(self.alias(group, k)), stamp(now_ms), Some(&value));
        let told = self.told.get_mut(&group);
        if let Some(place) = told.and_then(|told| told.values.get_mut(k)) {
            *place = Some(value);
        }
        changed
    }

    fn alias(&self, group: Group, k: usize) -> u64 {
        self.block * ALIASES + group.first_alias() + k as u64
    }
}
