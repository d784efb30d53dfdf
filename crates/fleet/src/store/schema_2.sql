-- Changes of an alarm are found by its number.
UPDATE entry SET number = json_extract(body, '$.alarm.alarm.number') WHERE kind = 'alarm';
CREATE INDEX entry_alarm ON entry(number) WHERE kind = 'alarm';
