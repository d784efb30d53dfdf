/** What the server sends; the Rust side is crates/panel/src/{message,session,events,wave,history}.rs. */
export type LampState = "off" | "on" | "blink";
export type LampName = "run" | "r1" | "r2" | "r3" | "r4" | "sensor" | "line" | "load" | "fault";
export type Lamps = Record<LampName, LampState>;

export interface Cause {
  name: string;
  words: string;
  phase: string | null;
  probability_percent: number;
  size_percent: number | null;
  /** With the likeliest, from which it cannot be told apart. */
  tied: boolean;
}

export interface Operation {
  voltage_rms_volt: number | null;
  current_rms_amp: number | null;
  frequency_hz: number | null;
  speed_rad_s: number | null;
  slip_percent: number | null;
  torque_nm: number | null;
  load_percent: number | null;
  current_unbalance_percent: number | null;
  voltage_unbalance_percent: number | null;
}

export type Pair = [number, number];

export interface Vectors {
  frame: "rotor-flux" | "voltage";
  u_dq_volt: Pair;
  i_dq_amp: Pair;
  psi_r_dq_volt_second: Pair;
}

export interface WindowMessage {
  sequence: number;
  t_s: number;
  lamps: Lamps;
  not_judged: string | null;
  motion: string | null;
  findings: string[];
  r_percent: number[] | null;
  r_over_threshold: (number | null)[] | null;
  significance_sigma: number | null;
  resistance_rise_percent: number | null;
  causes: Cause[];
  todo: string[];
  operation: Operation;
  vectors: Vectors | null;
}

export interface WaveMessage {
  t_ms: number[];
  u_abc_volt: number[][];
  i_abc_amp: number[][];
  u_dq_volt: number[][];
  i_dq_amp: number[][];
}

/** Twice a second, whatever happens. */
export interface Alive { rests: boolean }

export interface SwitchedFault { name: string; change_percent: number }
export interface FaultSwitch { name: string; words: string; table_1: boolean[] | null; least_percent: number }
export interface Field { key: string; label: string; symbol: string; unit: string; value: string }
export interface Finding { code: string; channel: string; value: number; unit: string; detail: string; refuses: boolean }

export interface Status {
  session: number;
  source: {
    kind: "simulation" | "recording" | "board";
    name: string;
    sample_rate_hz: number;
    span_s: Pair | null;
    can: { faults: boolean; pace: boolean; seek: boolean; parameters: boolean };
    audit: Finding[];
  };
  motor: string | null;
  fields: Field[];
  threshold_percent: number[] | null;
  calibrated: boolean;
  rated: Pair | null;
  switches: FaultSwitch[];
  faults: SwitchedFault[];
  speed: number;
  paused: boolean;
  ended: boolean;
  failure: string | null;
  behind_s: number;
}

export interface EventMessage {
  id: number;
  t_s: number;
  cleared_s: number | null;
  unix_s: number;
  lit: LampName[];
  causes: Cause[];
  findings: string[];
  acknowledged: { by: string; unix_s: number; comment: string } | null;
  samples: number;
}

export interface HistoryRow extends Record<string, number | string | boolean | null> { t_s: number }
export interface Refusal { message: string; problems: { key: string; message: string }[] }
