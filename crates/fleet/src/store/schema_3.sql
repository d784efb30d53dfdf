-- The samples around alarms as boards have them; `body` is NULL where there are none, with the reason in the entry.
CREATE TABLE recording(
    name TEXT PRIMARY KEY, motor INTEGER NOT NULL REFERENCES motor(key), time_ms INTEGER NOT NULL, constants INTEGER NOT NULL, body BLOB
) STRICT;
CREATE INDEX recording_motor ON recording(motor, time_ms);
