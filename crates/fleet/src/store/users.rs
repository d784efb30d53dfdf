//! Users and the trail in the store.

use rusqlite::{Connection, OptionalExtension, Row, params};

use super::{Store, StoreError, lock};
use crate::users::{AuditLine, Role, User, hash_of, new_token};

impl Store {
    /// Makes a user, or gives one a new token and role; the token, which is told only here.
    ///
    /// # Errors
    /// The name is empty or too long, the system has no random numbers, or writing failed.
    pub fn put_user(&self, name: &str, role: Role, now_ms: i64) -> Result<String, StoreError> {
        if !(1..=64).contains(&name.chars().count()) || name.chars().any(char::is_control) {
            return Err(StoreError::UserName(name.to_owned()));
        }
        let token = new_token().map_err(|e| StoreError::Random(e.to_string()))?;
        let hash = hash_of(&token);
        lock(&self.writer).change(|tx, _, _| {
            let text = "INSERT INTO user(name, role, token_sha256, made_ms) VALUES (?1, ?2, ?3, ?4)
                 ON CONFLICT(name) DO UPDATE SET role = ?2, token_sha256 = ?3, ended_ms = NULL";
            tx.execute(text, params![name, role.word(), &hash[..], now_ms])?;
            Ok(())
        })?;
        Ok(token)
    }

    /// Ends a user: the token no longer holds. `false`: there is no such user.
    ///
    /// # Errors
    /// Writing failed.
    pub fn end_user(&self, name: &str, now_ms: i64) -> Result<bool, StoreError> {
        lock(&self.writer).change(|tx, _, _| {
            let text = "UPDATE user SET ended_ms = ?2 WHERE name = ?1 AND ended_ms IS NULL";
            Ok(tx.execute(text, params![name, now_ms])? > 0)
        })
    }

    /// Whose token it is; `None`: nobody's, or one that ended.
    ///
    /// # Errors
    /// Reading failed.
    pub fn user_of(&self, token: &str) -> Result<Option<User>, StoreError> {
        // Found by its hash: how long that takes says nothing about the token.
        let hash = hash_of(token);
        self.reading(|c| {
            let text = "SELECT name, role, made_ms, ended_ms FROM user WHERE token_sha256 = ?1 AND ended_ms IS NULL";
            Ok(c.query_row(text, [&hash[..]], user_of_row).optional()?)
        })
    }

    /// All users, also those that ended, in the order of names.
    ///
    /// # Errors
    /// Reading failed.
    pub fn users(&self) -> Result<Vec<User>, StoreError> {
        self.reading(|c| {
            let mut statement =
                c.prepare("SELECT name, role, made_ms, ended_ms FROM user ORDER BY name")?;
            Ok(statement
                .query_map([], user_of_row)?
                .collect::<Result<_, _>>()?)
        })
    }

    /// Adds a line to the trail. No call takes one away.
    ///
    /// # Errors
    /// Writing failed.
    pub fn audit(&self, line: &AuditLine) -> Result<(), StoreError> {
        let text = "INSERT INTO audit(time_ms, user, action, subject, why, outcome, address) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
        let AuditLine {
            time_unix_ms,
            user,
            action,
            subject,
            why,
            outcome,
            address,
        } = line;
        lock(&self.writer).change(|tx, _, _| {
            tx.execute(
                text,
                params![time_unix_ms, user, action, subject, why, outcome, address],
            )?;
            Ok(())
        })
    }

    /// Lines of the trail from `from_ms` to before `to_ms`, newest first, at most `limit`.
    ///
    /// # Errors
    /// Reading failed.
    pub fn audit_trail(
        &self,
        from_ms: i64,
        to_ms: i64,
        limit: usize,
    ) -> Result<Vec<AuditLine>, StoreError> {
        self.reading(|c| trail(c, from_ms, to_ms, limit))
    }
}

fn trail(
    connection: &Connection,
    from_ms: i64,
    to_ms: i64,
    limit: usize,
) -> Result<Vec<AuditLine>, StoreError> {
    let text = "SELECT time_ms, user, action, subject, why, outcome, address FROM audit
         WHERE time_ms >= ?1 AND time_ms < ?2 ORDER BY time_ms DESC, id DESC LIMIT ?3";
    let mut statement = connection.prepare_cached(text)?;
    let rows = statement.query_map(params![from_ms, to_ms, limit as i64], |row| {
        Ok(AuditLine {
            time_unix_ms: row.get(0)?,
            user: row.get(1)?,
            action: row.get(2)?,
            subject: row.get(3)?,
            why: row.get(4)?,
            outcome: row.get(5)?,
            address: row.get(6)?,
        })
    })?;
    Ok(rows.collect::<Result<_, _>>()?)
}

fn user_of_row(row: &Row<'_>) -> rusqlite::Result<User> {
    let word: String = row.get(1)?;
    // A role that this program does not know may do the least.
    let role = word.parse().unwrap_or(Role::See);
    Ok(User {
        name: row.get(0)?,
        role,
        made_unix_ms: row.get(2)?,
        ended_unix_ms: row.get(3)?,
    })
}
