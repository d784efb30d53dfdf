//! Users and their tokens. A token is shown once; what is kept is its hash.

use rusqlite::{OptionalExtension, params};
use sha2::{Digest, Sha256};

use super::{People, PeopleError, Role, User};

/// Bytes of a token. 128 random bits need neither salt nor a slow hash: nobody can try them all.
const TOKEN_BYTES: usize = 16;
/// Longest name, characters.
const LONGEST: usize = 60;

impl People {
    /// Adds a user; the token, which nobody can ask for again.
    ///
    /// # Errors
    /// An empty or a taken name, or writing failed.
    pub fn add_user(&self, user: &User, now_ms: i64) -> Result<String, PeopleError> {
        let User { name, role } = user;
        if !is_name(name) {
            return Err(PeopleError::Name(name.clone()));
        }
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(PeopleError::Random)?;
        let token = bytes.map(|byte| format!("{byte:02x}")).concat();
        let text = "INSERT OR IGNORE INTO user(name, role, hash, added_ms) VALUES (?1, ?2, ?3, ?4)";
        let hash = hash(&token);
        let values = params![name, *role as i64, hash, now_ms];
        match self.lock().execute(text, values)? {
            0 => Err(PeopleError::Taken(name.clone())),
            _ => Ok(token),
        }
    }

    /// Removes a user: the token is refused from now on.
    ///
    /// # Errors
    /// There is no such user, or writing failed.
    pub fn remove_user(&self, name: &str) -> Result<(), PeopleError> {
        let text = "DELETE FROM user WHERE name = ?1";
        match self.lock().execute(text, [name])? {
            0 => Err(PeopleError::Unknown(name.to_owned())),
            _ => Ok(()),
        }
    }

    /// All users, in the order of names.
    ///
    /// # Errors
    /// Reading failed.
    pub fn users(&self) -> Result<Vec<User>, PeopleError> {
        let connection = self.lock();
        let mut statement = connection.prepare("SELECT name, role FROM user ORDER BY name")?;
        let users = statement.query_map([], |row| user_of(row.get(0)?, row.get(1)?))?;
        Ok(users.collect::<Result<_, _>>()?)
    }

    /// Whose token this is; `None`: nobody's.
    ///
    /// # Errors
    /// Reading failed.
    pub fn user_of_token(&self, token: &str) -> Result<Option<User>, PeopleError> {
        // Searching by hash: how long it takes tells nothing of the token.
        let text = "SELECT name, role FROM user WHERE hash = ?1";
        let connection = self.lock();
        let mut statement = connection.prepare_cached(text)?;
        let row = statement.query_row([hash(token)], |row| user_of(row.get(0)?, row.get(1)?));
        Ok(row.optional()?)
    }
}

fn user_of(name: String, role: i64) -> rusqlite::Result<User> {
    let found = Role::ALL.into_iter().find(|known| *known as i64 == role);
    let role = found.ok_or(rusqlite::Error::IntegralValueOutOfRange(1, role))?;
    Ok(User { name, role })
}

fn hash(token: &str) -> Vec<u8> {
    Sha256::digest(token.as_bytes()).to_vec()
}

fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '.' | '_' | '-' | '@');
    (1..=LONGEST).contains(&name.chars().count()) && name.trim() == name && name.chars().all(fits)
}
