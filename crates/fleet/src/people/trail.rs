//! The audit trail: who asked for what, when and why, and how it ended.

use rusqlite::{OptionalExtension, Row, params};
use serde::{Deserialize, Serialize};

use super::{People, PeopleError, User};
use crate::alarm::Action;

/// What a person asked for and the gateway has not done yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Its number in the trail.
    pub id: u64,
    /// When, Unix ms: what happened to the alarm later the person did not know.
    pub time_ms: i64,
    /// Who.
    pub who: String,
    /// Number of the alarm.
    pub alarm: u64,
    /// What.
    pub action: Action,
    /// Why.
    pub why: String,
}

/// How it ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// Whether it was done.
    pub done: bool,
    /// In words; empty where it was done and nothing is to be said.
    pub words: String,
}

/// A line of the trail.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trail {
    /// Its number, from 1.
    pub id: u64,
    /// When, Unix ms.
    pub time_ms: i64,
    /// Who.
    pub who: String,
    /// What, in words.
    pub what: String,
    /// Number of the alarm, where it is about one.
    pub alarm: Option<u64>,
    /// Why, in the person's words.
    pub why: String,
    /// How it ended; `None`: the gateway has not done it yet.
    pub outcome: Option<Outcome>,
}

impl People {
    /// Writes down what a person asks for; its number. The gateway does it.
    ///
    /// # Errors
    /// Writing failed.
    pub fn ask(
        &self,
        user: &User,
        alarm: u64,
        action: &Action,
        why: &str,
        now_ms: i64,
    ) -> Result<u64, PeopleError> {
        let text = "INSERT INTO trail(time_ms, who, what, alarm, action, why) VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
        let action_text = serde_json::to_string(action)?;
        let connection = self.lock();
        let values = params![
            now_ms,
            user.name,
            word(action),
            alarm as i64,
            action_text,
            why
        ];
        connection.execute(text, values)?;
        Ok(connection.last_insert_rowid() as u64)
    }

    /// Writes down what needs no gateway: a user was added, an action was refused.
    ///
    /// # Errors
    /// Writing failed.
    pub fn note(
        &self,
        who: &str,
        what: &str,
        outcome: &Outcome,
        now_ms: i64,
    ) -> Result<(), PeopleError> {
        let text = "INSERT INTO trail(time_ms, who, what, why, done, outcome) VALUES (?1, ?2, ?3, '', ?4, ?5)";
        let values = params![now_ms, who, what, outcome.done, outcome.words];
        self.lock().execute(text, values)?;
        Ok(())
    }

    /// What the gateway has to do, the oldest first.
    ///
    /// # Errors
    /// Reading failed.
    pub fn asked(&self) -> Result<Vec<Asked>, PeopleError> {
        let text = "SELECT id, time_ms, who, alarm, why, action FROM trail WHERE outcome IS NULL ORDER BY id";
        let connection = self.lock();
        let mut statement = connection.prepare_cached(text)?;
        let mut rows = statement.query([])?;
        let mut found = Vec::new();
        while let Some(row) = rows.next()? {
            found.push(Asked {
                id: row.get::<_, i64>(0)? as u64,
                time_ms: row.get(1)?,
                who: row.get(2)?,
                alarm: row.get::<_, i64>(3)? as u64,
                why: row.get(4)?,
                action: serde_json::from_str(&row.get::<_, String>(5)?)?,
            });
        }
        Ok(found)
    }

    /// The gateway writes down how it ended.
    ///
    /// # Errors
    /// Writing failed: it is done once more, which changes nothing.
    pub fn ended(&self, id: u64, outcome: &Outcome) -> Result<(), PeopleError> {
        let text = "UPDATE trail SET done = ?2, outcome = ?3 WHERE id = ?1 AND outcome IS NULL";
        let values = params![id as i64, outcome.done, outcome.words];
        self.lock().execute(text, values)?;
        Ok(())
    }

    /// How it ended; `None`: not yet.
    ///
    /// # Errors
    /// Reading failed.
    pub fn outcome(&self, id: u64) -> Result<Option<Outcome>, PeopleError> {
        let connection = self.lock();
        let mut statement =
            connection.prepare_cached("SELECT done, outcome FROM trail WHERE id = ?1")?;
        let found = statement.query_row([id as i64], |row| outcome_of(row, 0));
        Ok(found.optional()?.flatten())
    }

    /// The trail, the newest first, before number `before`, at most `limit` lines.
    ///
    /// # Errors
    /// Reading failed.
    pub fn trail(&self, before: Option<u64>, limit: usize) -> Result<Vec<Trail>, PeopleError> {
        let text = "SELECT id, time_ms, who, what, alarm, why, done, outcome FROM trail WHERE id < ?1 ORDER BY id DESC LIMIT ?2";
        let connection = self.lock();
        let mut statement = connection.prepare_cached(text)?;
        let before = before.map_or(i64::MAX, |id| id as i64);
        let lines = statement.query_map([before, limit as i64], |row| {
            Ok(Trail {
                id: row.get::<_, i64>(0)? as u64,
                time_ms: row.get(1)?,
                who: row.get(2)?,
                what: row.get(3)?,
                alarm: row.get::<_, Option<i64>>(4)?.map(|number| number as u64),
                why: row.get(5)?,
                outcome: outcome_of(row, 6)?,
            })
        })?;
        Ok(lines.collect::<Result<_, _>>()?)
    }
}

fn outcome_of(row: &Row<'_>, at: usize) -> rusqlite::Result<Option<Outcome>> {
    let words: Option<String> = row.get(at + 1)?;
    let done: Option<bool> = row.get(at)?;
    Ok(words.map(|words| Outcome {
        done: done.unwrap_or(false),
        words,
    }))
}

fn word(action: &Action) -> &'static str {
    match action {
        Action::Acknowledge => "acknowledge",
        Action::Shelve { .. } => "shelve",
        Action::Unshelve => "unshelve",
        Action::Suppress => "take out of service",
        Action::Unsuppress => "return to service",
    }
}

#[cfg(test)]
mod tests {
    use super::super::Role;
    use super::*;

    fn people() -> (tempfile::TempDir, People) {
        let folder = tempfile::tempdir().expect("a folder");
        let people = People::open(&folder.path().join("plant.db")).expect("people");
        (folder, people)
    }

    fn user(name: &str, role: Role) -> User {
        User {
            name: name.to_owned(),
            role,
        }
    }

    #[test]
    fn a_token_is_known_by_its_hash_alone_until_its_user_is_removed() {
        let (folder, people) = people();
        let anna = user("Anna B.", Role::Acknowledge);
        let token = people.add_user(&anna, 1).expect("added");
        assert_eq!(
            people.user_of_token(&token).expect("read"),
            Some(anna.clone())
        );
        for other in ["", &token[1..], &token.to_uppercase(), "Anna B."] {
            assert_eq!(people.user_of_token(other).expect("read"), None, "{other}");
        }
        let taken = people.add_user(&user("Anna B.", Role::See), 2);
        assert!(matches!(taken, Err(PeopleError::Taken(_))));
        // Neither the file nor its log holds the token.
        for file in std::fs::read_dir(folder.path()).expect("a folder") {
            let bytes = std::fs::read(file.expect("a file").path()).expect("read");
            let mut windows = bytes.windows(token.len());
            assert!(!windows.any(|window| window == token.as_bytes()));
        }
        people.remove_user("Anna B.").expect("removed");
        assert_eq!(people.user_of_token(&token).expect("read"), None);
        assert!(matches!(
            people.remove_user("Anna B."),
            Err(PeopleError::Unknown(_))
        ));
        for name in ["", " a", "a\nb", "<b>", &"n".repeat(61)] {
            let refused = people.add_user(&user(name, Role::See), 3);
            assert!(matches!(refused, Err(PeopleError::Name(_))), "{name:?}");
        }
    }

    #[test]
    fn what_is_asked_waits_for_the_gateway_across_a_restart() {
        let (folder, people) = people();
        let anna = user("Anna", Role::Acknowledge);
        let shelve = Action::Shelve { until_ms: 99 };
        let first = people
            .ask(&anna, 7, &Action::Acknowledge, "seen", 5)
            .expect("asked");
        let second = people.ask(&anna, 8, &shelve, "service", 6).expect("asked");
        drop(people);
        let people = People::open(&folder.path().join("plant.db")).expect("people");
        let asked = people.asked().expect("read");
        assert_eq!(
            asked.iter().map(|a| a.id).collect::<Vec<_>>(),
            [first, second]
        );
        assert_eq!(
            (asked[1].alarm, &asked[1].action, asked[1].time_ms),
            (8, &shelve, 6)
        );
        let outcome = |words: &str| Outcome {
            done: words.is_empty(),
            words: words.to_owned(),
        };
        people.ended(first, &outcome("")).expect("written");
        // What has ended once does not end in another way.
        people.ended(first, &outcome("no")).expect("written");
        assert_eq!(people.outcome(first).expect("read"), Some(outcome("")));
        assert_eq!(people.outcome(second).expect("read"), None);
        people
            .note("somebody", "sign in", &outcome("no such token"), 9)
            .expect("written");
        let trail = people.trail(None, 10).expect("read");
        let what: Vec<_> = trail.iter().map(|line| line.what.as_str()).collect();
        assert_eq!(what, ["sign in", "shelve", "acknowledge"]);
        assert_eq!(people.asked().expect("read").len(), 1);
    }
}
