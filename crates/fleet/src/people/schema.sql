-- Times are Unix milliseconds.
CREATE TABLE user(name TEXT PRIMARY KEY, role INTEGER NOT NULL, hash BLOB NOT NULL UNIQUE, added_ms INTEGER NOT NULL) STRICT;

-- Who did what, when and why. `outcome` is NULL while the gateway has not yet done what was asked.
CREATE TABLE trail(
    id INTEGER PRIMARY KEY AUTOINCREMENT, time_ms INTEGER NOT NULL, who TEXT NOT NULL, what TEXT NOT NULL,
    alarm INTEGER, action TEXT, why TEXT NOT NULL, done INTEGER, outcome TEXT
) STRICT;
CREATE INDEX trail_open ON trail(id) WHERE outcome IS NULL;
