//! Healthy motors under noise and sampling rates that are no fault of theirs, on ramps of supply, frequency and load, forwards
//! and backwards: FAULT stays dark, and what is not judged says why. A cut of `campaigns/noise-and-ramps.toml`.

use std::path::Path;

use campaign::{Plan, Row, Run};

/// Every so manieth run: prime, so that motors, blocks and draws all come by.
const EVERY: usize = 11;

#[test]
fn healthy_motors_stay_dark_in_every_operation() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../campaigns/noise-and-ramps.toml");
    let plan = Plan::read(path).unwrap_or_else(|error| panic!("{error}"));
    let (mut judged, mut backwards) = (0, 0);
    for index in (0..plan.runs()).step_by(EVERY) {
        let row = Row::of(&Run::new(&plan, index).expect("a run"));
        assert!(row.not_run.is_empty(), "run {index}: {}", row.not_run);
        assert_eq!(row.healthy_fault_windows, 0, "run {index}: {row:?}");
        let passed_over = row.windows - row.judged_windows;
        assert!(
            passed_over == 0 || !row.not_judged.is_empty(),
            "run {index}: {passed_over} windows without a reason"
        );
        judged += row.healthy_judged_windows;
        backwards += u32::from(row.backwards > 0.0);
    }
    // Measured: the whole plan judges 251 589 windows in 1600 runs.
    assert!(judged > 20_000, "{judged} windows judged");
    assert!(backwards > 40, "{backwards} runs backwards");
}
