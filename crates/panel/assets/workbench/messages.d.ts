/** What the workbench's routes send; the Rust side is crates/panel/src/workbench. */
import type { Finding } from "../messages";

export type Kind = "compare" | "explain" | "adopt" | "check";

export interface Columns {
  column: Record<string, string>;
  unit: Record<string, string>;
  scale: Record<string, string>;
  offset: Record<string, string>;
  delay: Record<string, string>;
  sample_rate_hz: number | null;
  delimiter: string;
  decimal_comma: boolean;
  line_voltages: boolean;
  skip_missing: boolean;
  pulses_per_revolution: number | null;
}

export type Summary =
  | { kind: "recording"; samples: number; sample_rate_hz: number; duration_s: number; channels: string[]; notes: string[] }
  | { kind: "load-table"; points: number; columns: string[] };

export interface RecordingView {
  id: number;
  name: string;
  sidecar: string | null;
  preview: { columns: string[]; rows: string[][] } | null;
  columns: Columns;
  problem: string | null;
  summary: Summary | null;
  audit: { supported: boolean; findings: Finding[] } | null;
  blind: { unseen: string; needs: string }[] | null;
  read_s: number;
}

export interface MotorView { name: string; file: string; effects: string[]; adopted: string[]; frequency_hz: number }

export interface Job { id: number; kind: Kind | null; running: boolean; what: string; share: number; stopping: boolean; problem: string | null }

/** The motor of the first check. */
export interface CheckView { name: string; by_plate: boolean; calibrated: boolean; contradictions: string[]; typed: Record<string, string> }
/** A question of the plate's form. */
export interface Question { key: string; words: string; unit: string; range: string; missing: string; on: "every" | "iec" | "nema" | "elsewhere" }
export interface PlateRow { name: string; printed: number | null; circuit: number; low: number; high: number }
export interface Attempt { missing: string | null; contradictions: string[]; plate: PlateRow[] }

export interface View {
  recordings: (RecordingView | null)[];
  motor: MotorView | null;
  check: CheckView | null;
  shipped: string[];
  job: Job;
  results: Kind[];
  most_bytes: number;
}

export interface Traces { t: number[]; signals: unknown[] }
export interface Block {
  t: number;
  load_percent: number | null;
  voltage_percent: number;
  slip_percent: number | null;
  frequency_hz: number | null;
  current_error_amp: number[];
}
export interface Band { quantity: "load" | "voltage" | "slip" | "frequency"; from_percent: number; to_percent: number }
export interface Result {
  overlay: { close: Traces; blocks: Block[] } | null;
  regions?: { name: string; from_s: number; to_s: number }[];
  bands?: Band[];
  next?: { adopt: string | null };
  steps?: { effect: string; tied_with: string[] }[];
  ranking?: { effect: string }[];
}
export interface Answer { title: string; html: string; result: Result }

export interface Figures { count: number; redraw(path: string): void; remove(): void }

declare global {
  /** crates/report/assets/report.js */
  function drawFigures(root: ParentNode, result: Result): Figures;
}
