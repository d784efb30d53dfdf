-- Changes of an alarm are found by its number.
UPDATE entry SET number = json_extract(body, '$.alarm.alarm.number') WHERE kind = 'alarm';
CREATE INDEX entry_alarm ON entry(number) WHERE kind = 'alarm';

-- Who may do what. Of a token only its SHA-256 is kept.
CREATE TABLE user(
    name TEXT PRIMARY KEY, role TEXT NOT NULL, token_sha256 BLOB NOT NULL UNIQUE, made_ms INTEGER NOT NULL, ended_ms INTEGER
) STRICT, WITHOUT ROWID;

-- Who did or tried what.
CREATE TABLE audit(
    id INTEGER PRIMARY KEY, time_ms INTEGER NOT NULL, user TEXT NOT NULL, action TEXT NOT NULL, subject TEXT NOT NULL,
    why TEXT NOT NULL, outcome TEXT NOT NULL, address TEXT NOT NULL
) STRICT;
CREATE INDEX audit_time ON audit(time_ms);
