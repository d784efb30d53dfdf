//! What no command can be given: faults of the board, frames, numbers that are none. What is seen, and the test that proves it.

use std::path::Path;

use crate::common::PROJECT;

/// One fault: what it is, what is seen, the test `file::name`.
pub struct Fault {
    /// What it is.
    pub what: String,
    /// What the user sees.
    pub seen: &'static str,
    /// The test that proves it.
    pub test: String,
}

/// What is seen of a fault, by the name of the patch that takes its handling out.
const SEEN: [(&str, &str); 59] = [
    (
        "block-overwritten",
        "the gap is logged; the lamps stay as they are; no reset",
    ),
    ("block-rate", "SENSOR and FAULT on within two seconds"),
    (
        "brown-out",
        "the board starts again, tells the cause, and shows what it showed",
    ),
    ("channel-dead", "SENSOR on, FAULT on"),
    (
        "configuration-torn",
        "the configuration that was confirmed before",
    ),
    (
        "configuration-unchecked",
        "refused with what is wrong; what held before holds on",
    ),
    (
        "configuration-unconfirmed",
        "what held before holds again after a minute",
    ),
    ("event-busy", "an exception for 22 ms; no sample is lost"),
    ("event-stalls", "no sample is lost"),
    ("channel-stuck", "SENSOR on, FAULT on"),
    ("clip-unseen", "the window is not judged: clipped"),
    (
        "clock-ratio",
        "SENSOR and FAULT on within three seconds; an oscillator that is merely hot or cold changes nothing",
    ),
    (
        "clock-stopped",
        "the watchdog starts the board again; with the clock back the lamps are as before",
    ),
    (
        "constants",
        "SENSOR and FAULT on, RUN dark; nothing is sampled or computed",
    ),
    (
        "crystal-dead",
        "SENSOR and FAULT on, nothing is judged; the relay is open",
    ),
    (
        "crystal-distrusted",
        "SENSOR and FAULT on, nothing is judged, until the next start",
    ),
    (
        "crystal-stops",
        "the board starts again at once and tells the cause; SENSOR and FAULT on",
    ),
    (
        "dma-overrun",
        "the gap is logged; the lamps stay as they are; no reset",
    ),
    ("doubt-returns", "SENSOR blinks again"),
    ("encoder-storm", "no sample is lost, no time either"),
    ("encoder-unplugged", "SENSOR on"),
    (
        "fault-record",
        "the board starts again and tells where and why",
    ),
    (
        "flash-nmi",
        "the old or the new calibration, never half of one",
    ),
    (
        "journal-nmi",
        "the old or the new program, and the exchange goes on",
    ),
    ("lamp-wires", "SENSOR blinks; nothing is learnt"),
    ("idle-conversion", "nothing: the supply reads right"),
    (
        "learn-doubted",
        "refused with the reason; the old values stay",
    ),
    (
        "loader-low-supply",
        "nothing is erased; the exchange goes on afterwards",
    ),
    ("loader-watchdog", "the new program is checked and runs"),
    ("low-supply", "nothing is written; learning says so"),
    ("mean-single", "nothing: the voltage reads right"),
    ("modbus-damaged", "no answer; nothing changes"),
    ("modbus-endless", "no answer; the next request is answered"),
    ("modbus-locked", "an exception; nothing changes"),
    ("modbus-locked-host", "an exception; nothing changes"),
    ("modbus-other-unit", "no answer; nothing changes"),
    (
        "option-bytes",
        "SENSOR blinks until they are written; nothing is learnt",
    ),
    (
        "panic-record",
        "the board starts again and tells file and line",
    ),
    (
        "processor",
        "the board starts again; then SENSOR and FAULT on, RUN dark, nothing is computed",
    ),
    (
        "program-checksum",
        "SENSOR and FAULT on within half a minute, and at every start",
    ),
    (
        "program-error",
        "the board starts again and tells the address; in stored data it is counted",
    ),
    (
        "ram-at-start",
        "SENSOR and FAULT on, RUN dark, no lamp test",
    ),
    ("ram-executed", "the board starts again and tells why"),
    ("ram-parity", "the board starts again and tells the cause"),
    (
        "ram-running",
        "SENSOR and FAULT on once the cell's turn has come, within twenty minutes",
    ),
    ("record-overwritten", "the old calibration"),
    ("record-torn", "the old calibration"),
    ("relay-pin", "the relay opens; SENSOR blinks"),
    (
        "restarts",
        "SENSOR and FAULT on, RUN dark, nothing is computed until somebody acknowledges",
    ),
    (
        "rings-misaligned",
        "the gap is logged; the lamps stay as they are; no reset",
    ),
    ("settings", "SENSOR and FAULT on within a second"),
    ("stack-deep", "SENSOR blinks within ten seconds"),
    (
        "stack-overflow",
        "the board starts again and tells the stack pointer",
    ),
    (
        "supply-uncorrected",
        "nothing: voltage and current read right",
    ),
    (
        "task-silent",
        "the watchdog starts the board again and names the task",
    ),
    ("unsealed", "SENSOR blinks; nothing is learnt"),
    (
        "vdda",
        "SENSOR and FAULT on; they go out when the supply is back",
    ),
    (
        "vdda-at-power-up",
        "SENSOR and FAULT on from the first sample",
    ),
    ("watchdog-window", "the watchdog starts the board again"),
];

/// What reaches the core or the wire besides.
const OTHERS: [(&str, &str, &str); 25] = [
    (
        "any sequence of samples: NaN, infinity, jumps, clipping, missing channels",
        "RUN and SENSOR blink, not judged; never FAULT from r1..r4, never NaN in place of a number",
        "fuzz/tests/short.rs::nothing_breaks_on_seeds_findings_and_mutations",
    ),
    (
        "samples that are not finite",
        "replaced by their predecessors and counted; the window is not judged",
        "crates/monitor/src/input/validity.rs::a_bad_number_is_replaced_by_its_predecessor_and_counted",
    ),
    (
        "a damaged frame on the COM port",
        "counted as damaged; the next frame is shown",
        "crates/live/src/decoder.rs::damage_and_loss_are_counted_and_a_restart_is_neither",
    ),
    (
        "a reader that comes in the middle of a frame",
        "waits for the next frame",
        "crates/live/src/decoder.rs::a_reader_may_come_in_the_middle",
    ),
    (
        "a configuration for a board of another version",
        "refused with what is wrong, exit code 2",
        "crates/board/src/configuration/tests.rs::what_is_refused_is_named",
    ),
    (
        "a line that is configured so that nobody reaches the board",
        "after a minute the board answers as before; with its button held at power-up as a new one",
        "crates/virtual-board/tests/configuration.rs::a_button_held_while_power_returns_gives_back_the_line_of_a_new_board",
    ),
    (
        "power that fails while an event is written",
        "that event alone is lost",
        "crates/virtual-board/tests/events.rs::power_that_fails_at_any_step_of_an_event_loses_no_other",
    ),
    (
        "the motor file of another motor with a live board",
        "refused, exit code 2",
        "crates/drivemon/tests/commands/live.rs::another_motors_file_is_refused",
    ),
    (
        "a motor file that the board cannot take",
        "refused before the build, exit code 2",
        "crates/drivemon/tests/commands/flash.rs::a_motor_file_that_the_board_cannot_take_is_refused_before_the_build",
    ),
    (
        "an output that would overwrite the scenario",
        "refused, exit code 2",
        "crates/drivemon/tests/commands/cli.rs::a_recording_whose_sidecar_would_overwrite_the_scenario_is_refused",
    ),
    (
        "learning from a motor that is faulty, moving or hardly judged",
        "refused with the reason; the old values stay",
        "crates/board/src/learn/tests.rs::a_moving_motor_is_refused_and_so_is_one_that_is_hardly_judged",
    ),
    (
        "calibrating on a recording of a faulty motor",
        "refused, exit code 3",
        "crates/drivemon/tests/commands/calibrate.rs::a_faulty_motor_is_refused_by_its_recording",
    ),
    (
        "calibrating with a dead sensor",
        "refused with its phase",
        "crates/drivemon/tests/commands/calibrate.rs::a_dead_sensor_is_refused_by_its_phase",
    ),
    (
        "a disk that is full while a recording is written",
        "refused with the file's name, exit code 2; the old file stays, nothing is left behind",
        "crates/drivemon/tests/commands/full_disk.rs::a_recording_is_written_whole_or_not_at_all",
    ),
    (
        "a disk that is full while a motor file, JSON or a page is written",
        "refused with the file's name, exit code 2; the old file stays, nothing is left behind",
        "crates/drivemon/tests/commands/full_disk.rs::results_and_motor_files_are_written_whole_or_not_at_all",
    ),
    (
        "a disk that fills up during a campaign",
        "refused with the file's name, exit code 2; with room again the same command goes on to the same bytes",
        "crates/drivemon/tests/commands/full_disk.rs::a_campaign_goes_on_when_there_is_room_again",
    ),
    (
        "a folder that takes no file",
        "refused with the file's name, exit code 2",
        "crates/drivemon/tests/commands/full_disk.rs::a_folder_that_takes_nothing_is_named",
    ),
    (
        "an output that is an input, its sidecar, its COMTRADE partner or another output",
        "refused before the work with both parts, exit code 2; all files stay as they were",
        "crates/drivemon/tests/commands/outputs.rs::nothing_that_is_read_is_written_and_nothing_is_written_twice",
    ),
    (
        "a sidecar in the place of a motor file",
        "refused, exit code 2",
        "crates/drivemon/tests/commands/outputs.rs::a_sidecar_is_written_over_a_sidecar_only",
    ),
    (
        "a terminal without room, `> /dev/full`",
        "`error: standard output: cannot be written`, exit code 2; the files are there",
        "crates/drivemon/tests/commands/outputs.rs::a_terminal_without_room_is_a_plain_error_and_the_files_are_there",
    ),
    (
        "a reader that ends early, `| head`",
        "silence; the exit code of the answer",
        "crates/drivemon/tests/commands/outputs.rs::a_reader_that_has_seen_enough_changes_nothing",
    ),
    (
        "one bad recording among several",
        "told by its name, exit code 2; the others have their answer",
        "crates/drivemon/tests/commands/outputs.rs::several_recordings_are_judged_each_by_itself",
    ),
    (
        "a wrong bit in a file with checksums",
        "refused, or nothing that is read changes",
        "crates/formats/tests/all/formats/parquet.rs::a_wrong_byte_in_a_file_of_ours_is_noticed_wherever_it_is",
    ),
    (
        "a configuration of 100 000 sections",
        "refused within a second or two; the first fifty problems",
        "crates/document/src/tests.rs::many_sections_take_linear_time",
    ),
    (
        "a day without a pause",
        "the same lamps and the same numbers, a fault found as fast as in the first minute",
        "crates/monitor/tests/long_run.rs::a_day_changes_nothing",
    ),
];

/// Every fault, those of the patches first.
pub fn faults() -> Vec<Fault> {
    let folder = Path::new(PROJECT).join("crates/virtual-board/mutations");
    let entries = std::fs::read_dir(&folder).expect("part of the source tree");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("readable").path())
        .collect();
    paths.sort();
    let others = OTHERS.iter().map(|(what, seen, test)| Fault {
        what: (*what).to_owned(),
        seen,
        test: (*test).to_owned(),
    });
    paths
        .iter()
        .map(|path| of_patch(path))
        .chain(others)
        .collect()
}

fn of_patch(path: &Path) -> Fault {
    let text = std::fs::read_to_string(path).expect("readable");
    let field = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("{}: {name}", path.display()))
            .to_owned()
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let seen = SEEN.iter().find(|(name, _)| *name == stem);
    let (_, seen) = seen.unwrap_or_else(|| panic!("what is seen of {stem}? Say it in board.rs"));
    let test = field("Test: ");
    let (place, name) = test.split_once(' ').expect("file and test");
    let file = match place {
        "board" | "monitor" => format!("crates/{place}"),
        "safety" | "update" => format!("crates/virtual-board/tests/{place}"),
        file => format!("crates/virtual-board/tests/{file}.rs"),
    };
    Fault {
        what: field("Fault: "),
        seen,
        test: format!("{file}::{name}"),
    }
}
