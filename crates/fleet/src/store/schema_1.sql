-- Times are Unix milliseconds of the gateway's clock. Ids rise over `queue` and `entry` together.
CREATE TABLE migration(schema INTEGER PRIMARY KEY, applied TEXT NOT NULL) STRICT;

-- Single values: who writes, next id, what is sealed.
CREATE TABLE meta(key TEXT PRIMARY KEY, value ANY NOT NULL) STRICT, WITHOUT ROWID;

CREATE TABLE motor(
    key INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, title TEXT NOT NULL, nameplate TEXT NOT NULL, place TEXT NOT NULL,
    link TEXT NOT NULL, motor_file TEXT, in_force INTEGER NOT NULL DEFAULT 1
) STRICT;

-- Newest of each motor. `event`, `mark_start` and `mark_number` are what is durable: what is not above them was stored before
-- or told as a gap. The other columns are the newest second.
CREATE TABLE state(
    motor INTEGER PRIMARY KEY REFERENCES motor(key), board INTEGER NOT NULL DEFAULT 0, serial TEXT NOT NULL DEFAULT '',
    event INTEGER NOT NULL DEFAULT 0, mark_start INTEGER, mark_number INTEGER,
    link_up INTEGER, link_ms INTEGER, link_why TEXT,
    start INTEGER, number INTEGER, time_ms INTEGER, lamps INTEGER, windows INTEGER, judged INTEGER, not_judged INTEGER, fault INTEGER,
    r1 INTEGER, r2 INTEGER, r3 INTEGER, r4 INTEGER, voltage_v REAL, current_a REAL, frequency_hz REAL, speed_rpm REAL
) STRICT;

-- Seconds in the order in which they came, until they are in the history and every output has taken them. r1..r4 in 1e-4.
CREATE TABLE queue(
    id INTEGER PRIMARY KEY, motor INTEGER NOT NULL, start INTEGER NOT NULL, number INTEGER NOT NULL,
    time_ms INTEGER NOT NULL, lamps INTEGER NOT NULL, windows INTEGER NOT NULL, judged INTEGER NOT NULL,
    not_judged INTEGER NOT NULL, fault INTEGER NOT NULL,
    r1 INTEGER, r2 INTEGER, r3 INTEGER, r4 INTEGER, voltage_v REAL, current_a REAL, frequency_hz REAL, speed_rpm REAL
) STRICT;

-- Everything but seconds; `body` is JSON. `number` is an event's or an alarm's.
CREATE TABLE entry(
    id INTEGER PRIMARY KEY, motor INTEGER REFERENCES motor(key), kind TEXT NOT NULL, time_ms INTEGER NOT NULL,
    board INTEGER, number INTEGER, body TEXT NOT NULL
) STRICT;
CREATE UNIQUE INDEX entry_event ON entry(motor, board, number) WHERE kind = 'event';
CREATE INDEX entry_motor ON entry(motor, time_ms);

-- History: level 0 seconds, 1 minutes; some minutes or an hour of one motor in a block of bytes.
CREATE TABLE block(
    motor INTEGER NOT NULL, level INTEGER NOT NULL, from_ms INTEGER NOT NULL, first INTEGER NOT NULL,
    to_ms INTEGER NOT NULL, count INTEGER NOT NULL, body BLOB NOT NULL,
    PRIMARY KEY(motor, level, from_ms, first)
) STRICT, WITHOUT ROWID;

-- History: minima, means and maxima of hours, written with the seconds.
CREATE TABLE hour(
    motor INTEGER NOT NULL, hour INTEGER NOT NULL, body BLOB NOT NULL, PRIMARY KEY(motor, hour)
) STRICT, WITHOUT ROWID;

-- How far each output has delivered.
CREATE TABLE sink(name TEXT PRIMARY KEY, cursor INTEGER NOT NULL, memory TEXT NOT NULL DEFAULT '') STRICT, WITHOUT ROWID;

-- Alarms as they are now; their changes are entries. `open`: neither normal nor set aside.
CREATE TABLE alarm(
    number INTEGER PRIMARY KEY, motor INTEGER REFERENCES motor(key), cause TEXT NOT NULL, state TEXT NOT NULL,
    severity INTEGER NOT NULL, open INTEGER NOT NULL, raised_ms INTEGER NOT NULL, changed_ms INTEGER NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE INDEX alarm_motor ON alarm(motor);
CREATE INDEX alarm_changed ON alarm(changed_ms);
CREATE INDEX alarm_open ON alarm(open) WHERE open = 1;
CREATE INDEX alarm_state ON alarm(state) WHERE state <> 'normal';
