/** What the server sends; the Rust side is crates/panel/src/fleet/{answers,plant,stream}.rs, described in /api/fleet/openapi.json. */
export type Condition = "fault" | "sensor" | "supply" | "overload" | "stale" | "never" | "not_judged" | "off" | "healthy";
export type AlarmState = "normal" | "unacknowledged" | "acknowledged" | "returned_unacknowledged" | "shelved" | "suppressed";
export type Severity = "high" | "medium" | "low";
export type Role = "see" | "acknowledge" | "configure";
export type Maybe = number | null;

export interface Counts {
  motors: number;
  fault: number;
  attention: number;
  stale: number;
  not_judged: number;
  off: number;
  healthy: number;
  unacknowledged: number;
  set_aside: number;
}

export interface TileAlarm { number: number; state: AlarmState; severity: Severity; words: string; raised_ms: number }

export interface Latest {
  time_ms: number;
  lamps: number[];
  residuals_percent: Maybe[];
  voltage_v: Maybe;
  current_a: Maybe;
  frequency_hz: Maybe;
  speed_rpm: Maybe;
}

export interface Tile {
  id: string;
  title: string;
  place: string;
  rank: number;
  condition: Condition;
  words: string;
  alarm: TileAlarm | null;
  open_alarms: number;
  last: Latest | null;
}

export interface Wall { now_ms: number; counts: Counts; motors: Tile[] }
export interface News extends Wall { gone: string[] }
export interface Alive { now_ms: number; trouble: string }

export interface Alarm {
  number: number;
  motor: string | null;
  cause: string;
  words: string;
  state: AlarmState;
  severity: Severity;
  present: boolean;
  size_percent: Maybe;
  evidence: string;
  residuals_percent: Maybe[];
  recording: string | null;
  no_recording: string | null;
  raised_ms: number;
  changed_ms: number;
  times: number;
  shelved_until_ms: Maybe;
}

export interface Motor {
  now_ms: number;
  tile: Tile;
  nameplate: string;
  link: string;
  answers: boolean | null;
  why: string;
  motor_file: string | null;
  alarms: Alarm[];
}

export interface Model {
  id: string;
  title: string;
  place: string;
  file: string | null;
  name: string;
  effects: string[];
  calibrated: boolean | null;
  file_constants: string | null;
  board_constants: string | null;
  learnt: string | null;
  calibrated_ms: Maybe;
  calibrated_on: string | null;
  calibrated_by: "board" | "file" | "";
  due_ms: Maybe;
  drift_percent: Maybe;
  due: boolean;
  why: string;
}

export interface Models { now_ms: number; due_after_days: number; due_drift_percent: number; models: Model[] }

export interface Event { id: number; motor: string | null; time_ms: number; kind: string; words: string; who: string | null; why: string | null }
export interface Band { min: Maybe[]; mean: Maybe[]; max: Maybe[] }

export interface Trend {
  step_ms: number;
  time_ms: number[];
  lamps: number[];
  seconds: number[];
  residuals_percent: [Band, Band, Band, Band];
  voltage_v: Band;
  current_a: Band;
  frequency_hz: Band;
  speed_rpm: Band;
}

export interface Me { name: string | null; role: Role | null }
export interface Done { action: number; done: boolean; message: string }
