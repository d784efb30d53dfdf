//! What a plant sets of its alarms.

use document::{Bounds, Section};
use fleet::alarm::Rules;

const DELAY_S: Bounds = Bounds::between(0.0, 3_600.0, "s");
const WINDOW_S: Bounds = Bounds::between(10.0, 86_400.0, "s");
const FLOOD: Bounds = Bounds::between(1.0, 10_000.0, "alarms");
const SHELF_H: Bounds = Bounds::between(0.1, 8_760.0, "h");

/// Reads section `alarms`; the usual rules where there is none.
pub(super) fn read(root: &Section<'_>) -> Option<Rules> {
    let usual = Rules::default();
    let Some(section) = root.optional_section("alarms")? else {
        return Some(usual);
    };
    let ms = |key, bounds: &Bounds, usual_ms: i64, unit_ms: f64| {
        let value = section.number_or(key, bounds, usual_ms as f64 / unit_ms);
        value.map(|value| (value * unit_ms).round() as i64)
    };
    let on = ms("on_delay_s", &DELAY_S, usual.on_delay_ms, 1e3);
    let off = ms("off_delay_s", &DELAY_S, usual.off_delay_ms, 1e3);
    let link = ms("link_delay_s", &DELAY_S, usual.link_delay_ms, 1e3);
    let window = ms("flood_window_s", &WINDOW_S, usual.flood_window_ms, 1e3);
    let update = ms("update_s", &DELAY_S, usual.update_ms, 1e3);
    let shelf = ms("longest_shelf_h", &SHELF_H, usual.longest_shelf_ms, 3.6e6);
    let latch = section.flag_or("latch", usual.latch);
    let flood = section.integer_or("flood_alarms", &FLOOD, usual.flood_alarms as u32);
    section.finish();
    Some(Rules {
        on_delay_ms: on?,
        off_delay_ms: off?,
        link_delay_ms: link?,
        latch: latch?,
        flood_alarms: flood? as usize,
        flood_window_ms: window?,
        longest_shelf_ms: shelf?,
        update_ms: update?,
    })
}
