//! Rows in groups, and how often each answer came.

use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

use crate::runs::row::Row;

/// An answer and how often it came.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "NamedCause")]
pub struct Named {
    /// Likeliest cause, with what is known about its phase.
    pub cause: String,
    /// Runs.
    pub runs: u64,
}

/// Rows in groups, in the order of their first appearance.
pub(crate) fn grouped<K: Ord + Clone>(
    rows: &[Row],
    key: impl Fn(&Row) -> Option<K>,
) -> Vec<Vec<&Row>> {
    let mut places = BTreeMap::new();
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let Some(key) = key(row) else {
            continue;
        };
        let place = *places.entry(key).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[place].push(row);
    }
    groups
}

/// How often each text came, the most frequent first.
pub(crate) fn counted(texts: impl Iterator<Item = String>) -> Vec<Named> {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for text in texts {
        *counts.entry(text).or_default() += 1;
    }
    let mut named: Vec<_> = counts
        .into_iter()
        .map(|(cause, runs)| Named { cause, runs })
        .collect();
    named.sort_by_key(|named| std::cmp::Reverse(named.runs));
    named
}
