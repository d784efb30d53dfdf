//! Metrics: what is shown, what is left out, how many there are; the page lists every family.

use fleet::alarm::Severity;
use fleet::{Link, MotorInfo, MotorState, Second};
use uplink::metrics::{Output, PageState, Plant, STALE_MS, render};
use uplink::modbus::ModbusState;
use uplink::mqtt::MqttState;

const NOW_MS: i64 = 1_790_000_000_000;

fn motor(name: &str, age_ms: i64) -> MotorState {
    MotorState {
        info: MotorInfo::new(name.parse().expect("a name")),
        last: Some(Second {
            time_ms: NOW_MS - age_ms,
            number: 7,
            // RUN on, FAULT blinking.
            lamps: 1 | 2 << 16,
            fault: 12,
            residuals: Some([0.25, f32::NAN, 0.0, -0.5]),
            voltage_v: Some(230.5),
            ..Second::default()
        }),
        last_event: 41,
        link: Some(Link {
            up: true,
            time_ms: NOW_MS,
            why: String::new(),
        }),
        open_alarms: 2,
        unacknowledged: 1,
        worst: Some(Severity::High),
    }
}

fn text(motors: &[MotorState], shown: usize) -> String {
    let outputs = [Output {
        name: "mqtt".to_owned(),
        delivered: 99,
        lag_s: 1.5,
    }];
    let plant = Plant {
        motors,
        shown,
        outputs: &outputs,
        mqtt: Some(&MqttState::default()),
        modbus: Some(&ModbusState::default()),
        page: Some(&PageState {
            cut: 3,
            ..PageState::default()
        }),
        now_ms: NOW_MS,
    };
    render(&plant)
}

#[test]
fn values_have_their_names_and_units() {
    let text = text(&[motor("pump-7", 1_500)], 10);
    for line in [
        "drivemon_motor_voltage_volts{motor=\"pump-7\"} 230.5",
        "drivemon_motor_residual_ratio{motor=\"pump-7\",residual=\"r1\"} 0.25",
        "drivemon_motor_residual_ratio{motor=\"pump-7\",residual=\"r4\"} -0.5",
        "drivemon_motor_lamp{motor=\"pump-7\",lamp=\"run\"} 1",
        "drivemon_motor_lamp{motor=\"pump-7\",lamp=\"fault\"} 2",
        "drivemon_motor_age_seconds{motor=\"pump-7\"} 1.5",
        "drivemon_motor_alarm_worst{motor=\"pump-7\"} 3",
        // It blinks: somebody is waited for, no fault was found.
        "drivemon_motors_with_fault 0",
        "drivemon_output_lag_seconds{output=\"mqtt\"} 1.5",
        "drivemon_page_refused_total{why=\"wrong_role\"} 0",
        "drivemon_page_cut_total 3",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
    // What is not known is not shown.
    assert!(
        !text.contains("residual=\"r2\"") && !text.contains("amperes") && !text.contains("NaN")
    );
}

#[test]
fn what_is_old_is_not_shown_as_present() {
    let faulty = |name, age_ms| {
        let mut state = motor(name, age_ms);
        state.last.as_mut().expect("a second").lamps = 1 | 1 << 16;
        state
    };
    let text = text(&[faulty("a", STALE_MS), faulty("b", STALE_MS - 1)], 10);
    assert!(!text.contains("volts{motor=\"a\"}") && text.contains("volts{motor=\"b\"}"));
    assert!(text.contains("drivemon_motor_age_seconds{motor=\"a\"} 30\n"));
    assert!(
        text.contains("drivemon_motors_current 1\n")
            && text.contains("drivemon_motors_with_fault 1\n")
    );
}

/// As many series as docs/fleet/metrics.md says, however many motors there are.
#[test]
fn series_are_bounded() {
    let motors: Vec<_> = (0..50)
        .map(|k| {
            let mut motor = motor(&format!("m{k}"), 0);
            if let Some(second) = &mut motor.last {
                second.residuals = Some([0.0; 4]);
                (second.current_a, second.frequency_hz, second.speed_rpm) =
                    (Some(1.0), Some(50.0), Some(1.0));
            }
            motor
        })
        .collect();
    let series = |text: &str| text.lines().filter(|line| !line.starts_with('#')).count();
    assert_eq!(series(&text(&motors, 0)), 7 + 2 + 7 + 6 + 6);
    assert_eq!(series(&text(&motors, 20)), 7 + 2 + 7 + 6 + 6 + 20 * 24);
    assert!(text(&motors, 20).contains("drivemon_motors_hidden 30\n"));
}

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/fleet/metrics.md");
const BEGIN: &str = "<!-- from the code: families -->\n";
const END: &str = "<!-- end -->";

fn families() -> String {
    let mut full = motor("m", 0);
    if let Some(second) = &mut full.last {
        (second.current_a, second.frequency_hz, second.speed_rpm) =
            (Some(1.0), Some(50.0), Some(1.0));
    }
    let text = text(&[full], 1);
    let mut lines = text.lines().filter_map(|line| line.strip_prefix("# "));
    let mut rows = "| family | kind | what |\n|---|---|---|\n".to_owned();
    while let (Some(help), Some(kind)) = (lines.next(), lines.next()) {
        let (name, help) = help
            .strip_prefix("HELP ")
            .and_then(|rest| rest.split_once(' '))
            .expect("help");
        let kind = kind.rsplit(' ').next().expect("a kind");
        rows += &format!("| `{name}` | {kind} | {help} |\n");
    }
    rows
}

/// `UPDATE_DOCS=1 cargo test -p uplink --test metrics` writes the families there.
#[test]
fn the_document_shows_the_families() {
    let text = std::fs::read_to_string(PATH).expect("part of the source tree");
    let (before, rest) = text.split_once(BEGIN).expect("the mark of the table");
    let (shown, after) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let text = format!("{before}{BEGIN}{}{END}{after}", families());
        return std::fs::write(PATH, text).expect("a writable source tree");
    }
    assert_eq!(
        shown,
        families(),
        "write it with UPDATE_DOCS=1 cargo test -p uplink --test metrics"
    );
}
