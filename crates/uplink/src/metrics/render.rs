//! The plant as text that Prometheus reads.

use board::LAMP_NAMES;
use fleet::alarm::Severity;
use fleet::{MotorState, Second, lamp};

use super::text::{Kind, Text, labels};
use crate::modbus::ModbusState;
use crate::mqtt::MqttState;

/// Age, ms, from which on a second is no longer shown: an old value looks like a present one there.
pub const STALE_MS: i64 = 30_000;

/// How far an output has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Its name, of letters, digits, `.`, `_` and `-`.
    pub name: String,
    /// Newest entry that it has delivered.
    pub delivered: u64,
    /// Age of the oldest entry that it has not delivered, s; 0: it has delivered everything.
    pub lag_s: f64,
}

/// What the page of a plant counts since it was started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PageState {
    /// Requests without a token, or with one that is not known.
    pub no_token: u64,
    /// Requests of a role that may not.
    pub wrong_role: u64,
    /// Requests of another site through a visitor's browser, or under a foreign name.
    pub foreign: u64,
    /// Times that a page which had fallen behind got the whole wall in the place of what it missed.
    pub behind: u64,
    /// Changes that such pages were not sent.
    pub skipped: u64,
    /// Streams that ended while their page had not read for some seconds.
    pub cut: u64,
}

/// What is rendered.
#[derive(Clone, Debug, Default)]
pub struct Plant<'p> {
    /// Every motor, in the order of names.
    pub motors: &'p [MotorState],
    /// Motors that have series of their own.
    pub shown: usize,
    /// Outputs with a cursor in the store.
    pub outputs: &'p [Output],
    /// The output to a broker.
    pub mqtt: Option<&'p MqttState>,
    /// The Modbus server.
    pub modbus: Option<&'p ModbusState>,
    /// The page, on its own listener.
    pub page: Option<&'p PageState>,
    /// Now, Unix ms.
    pub now_ms: i64,
}

/// The plant in the text format of Prometheus, version 0.0.4.
pub fn render(plant: &Plant<'_>) -> String {
    let mut text = Text::default();
    sums(plant, &mut text);
    motors(plant, &mut text);
    outputs(plant.outputs, &mut text);
    if let Some(state) = plant.mqtt {
        mqtt(state, &mut text);
    }
    if let Some(state) = plant.modbus {
        modbus(state, &mut text);
    }
    if let Some(state) = plant.page {
        page(state, &mut text);
    }
    text.finish()
}

type Samples = Vec<(String, f64)>;

fn one(value: f64) -> Samples {
    vec![(String::new(), value)]
}

fn count(motors: &[MotorState], wanted: impl Fn(&MotorState) -> bool) -> Samples {
    one(motors.iter().filter(|motor| wanted(motor)).count() as f64)
}

/// The newest second, unless it is too old to stand for the present.
fn fresh(state: &MotorState, now_ms: i64) -> Option<&Second> {
    let last = state.last.as_ref()?;
    (now_ms.saturating_sub(last.time_ms) < STALE_MS).then_some(last)
}

fn sums(plant: &Plant<'_>, text: &mut Text) {
    let (motors, now_ms) = (plant.motors, plant.now_ms);
    let lit = |state: &MotorState, lamp: u32| {
        fresh(state, now_ms).is_some_and(|second| second.is_on(lamp))
    };
    let hidden = motors.len().saturating_sub(plant.shown) as f64;
    let open: u64 = motors
        .iter()
        .map(|motor| u64::from(motor.open_alarms))
        .sum();
    let up = |motor: &MotorState| motor.link.as_ref().is_some_and(|link| link.up);
    let mut gauge = |name, help, samples| text.family(name, Kind::Gauge, help, samples);
    gauge(
        "drivemon_motors",
        "Motors that are declared.",
        count(motors, |_| true),
    );
    gauge(
        "drivemon_motors_hidden",
        "Motors without series of their own: beyond the limit of the configuration.",
        one(hidden),
    );
    gauge(
        "drivemon_motors_connected",
        "Motors whose board answers.",
        count(motors, up),
    );
    gauge(
        "drivemon_motors_current",
        "Motors with a second that is not older than 30 s.",
        count(motors, |m| fresh(m, now_ms).is_some()),
    );
    gauge(
        "drivemon_motors_with_fault",
        "Motors with FAULT on in their newest second.",
        count(motors, |m| lit(m, lamp::FAULT)),
    );
    gauge(
        "drivemon_motors_with_sensor_fault",
        "Motors with SENSOR on in their newest second.",
        count(motors, |m| lit(m, lamp::SENSOR)),
    );
    gauge(
        "drivemon_alarms_open",
        "Alarms that somebody has to look at, of all motors.",
        one(open as f64),
    );
}

/// Samples of the motors that are shown: one each where there is a value.
fn each(plant: &Plant<'_>, value: impl Fn(&MotorState) -> Option<f64>) -> Samples {
    let shown = plant.motors.iter().take(plant.shown);
    shown
        .filter_map(|state| Some((labels(&[("motor", state.info.id.as_str())]), value(state)?)))
        .collect()
}

/// Samples of several values of a motor's newest second, told apart by a label.
fn several(
    plant: &Plant<'_>,
    label: &str,
    names: &[&str],
    value: impl Fn(&Second, usize) -> Option<f64>,
) -> Samples {
    let mut samples = Vec::new();
    for state in plant.motors.iter().take(plant.shown) {
        let Some(second) = fresh(state, plant.now_ms) else {
            continue;
        };
        for (k, name) in names.iter().enumerate() {
            let labels = labels(&[("motor", state.info.id.as_str()), (label, name)]);
            samples.extend(value(second, k).map(|value| (labels, value)));
        }
    }
    samples
}

fn motors(plant: &Plant<'_>, text: &mut Text) {
    let now_ms = plant.now_ms;
    let measured = |value: fn(&Second) -> Option<f32>| {
        each(plant, move |m| {
            fresh(m, now_ms).and_then(value).map(f64::from)
        })
    };
    let up = each(plant, |m| {
        m.link.as_ref().map(|link| f64::from(u8::from(link.up)))
    });
    let age = each(plant, |m| {
        Some(now_ms.saturating_sub(m.last.as_ref()?.time_ms).max(0) as f64 / 1_000.0)
    });
    let lamps = several(plant, "lamp", &LAMP_NAMES, |second, k| {
        Some(f64::from(second.lamp(k as u32)))
    });
    let residuals = several(plant, "residual", &["r1", "r2", "r3", "r4"], |second, k| {
        Some(f64::from(*second.residuals.as_ref()?.get(k)?))
    });
    let mut gauge = |name, help, samples| text.family(name, Kind::Gauge, help, samples);
    gauge(
        "drivemon_motor_connected",
        "Whether the motor's board answers: 1, or 0.",
        up,
    );
    gauge(
        "drivemon_motor_age_seconds",
        "Age of the motor's newest second.",
        age,
    );
    gauge(
        "drivemon_motor_lamp",
        "Lamp in the newest second: 0 off, 1 on, 2 blinking.",
        lamps,
    );
    gauge(
        "drivemon_motor_residual_ratio",
        "Residual, mean of the newest second, share of its scale.",
        residuals,
    );
    gauge(
        "drivemon_motor_voltage_volts",
        "Phase voltage, RMS.",
        measured(|s| s.voltage_v),
    );
    gauge(
        "drivemon_motor_current_amperes",
        "Phase current, RMS.",
        measured(|s| s.current_a),
    );
    gauge(
        "drivemon_motor_supply_frequency_hertz",
        "Frequency of the supply.",
        measured(|s| s.frequency_hz),
    );
    gauge(
        "drivemon_motor_speed_rpm",
        "Speed of the shaft, revolutions per minute.",
        measured(|s| s.speed_rpm),
    );
    gauge(
        "drivemon_motor_likely_fault",
        "Number of the likely fault; 0: none of those known.",
        measured(|s| Some(f32::from(s.fault))),
    );
    gauge(
        "drivemon_motor_alarms_open",
        "Alarms that somebody has to look at.",
        each(plant, |m| Some(f64::from(m.open_alarms))),
    );
    gauge(
        "drivemon_motor_alarms_unacknowledged",
        "Those of them that nobody has acknowledged.",
        each(plant, |m| Some(f64::from(m.unacknowledged))),
    );
    gauge(
        "drivemon_motor_alarm_worst",
        "The worst of them: 0 none, 1 low, 2 medium, 3 high.",
        each(plant, |m| Some(worst(m.worst))),
    );
    gauge(
        "drivemon_motor_event_number",
        "Number of the board's newest event.",
        each(plant, |m| Some(f64::from(m.last_event))),
    );
}

fn worst(severity: Option<Severity>) -> f64 {
    match severity {
        None => 0.0,
        Some(Severity::Low) => 1.0,
        Some(Severity::Medium) => 2.0,
        Some(Severity::High) => 3.0,
    }
}

fn outputs(outputs: &[Output], text: &mut Text) {
    let of = |value: fn(&Output) -> f64| {
        let samples = outputs
            .iter()
            .map(|output| (labels(&[("output", &output.name)]), value(output)));
        samples.collect::<Samples>()
    };
    text.family(
        "drivemon_output_delivered_entry",
        Kind::Gauge,
        "Number of the newest entry that the output has delivered.",
        of(|o| o.delivered as f64),
    );
    text.family(
        "drivemon_output_lag_seconds",
        Kind::Gauge,
        "Age of the oldest entry that the output has not delivered.",
        of(|o| o.lag_s),
    );
}

fn mqtt(state: &MqttState, text: &mut Text) {
    let flag = |value: bool| one(f64::from(u8::from(value)));
    text.family(
        "drivemon_mqtt_connected",
        Kind::Gauge,
        "Whether the broker is connected: 1, or 0.",
        flag(state.connected),
    );
    text.family(
        "drivemon_mqtt_online",
        Kind::Gauge,
        "Whether data flow to the broker; 0 while connected: the primary host is away.",
        flag(state.online),
    );
    text.counter(
        "drivemon_mqtt_sessions_total",
        "Sessions with the broker.",
        state.sessions,
    );
    text.counter(
        "drivemon_mqtt_births_total",
        "Times that all births were told.",
        state.births,
    );
    text.counter(
        "drivemon_mqtt_messages_total",
        "Messages to the broker.",
        state.messages,
    );
    text.counter(
        "drivemon_mqtt_refused_commands_total",
        "Commands that were refused.",
        state.refused_commands,
    );
    text.counter(
        "drivemon_mqtt_foreign_births_total",
        "Births under this node's name that somebody else said.",
        state.foreign_births,
    );
}

fn modbus(state: &ModbusState, text: &mut Text) {
    text.counter(
        "drivemon_modbus_connections_total",
        "Masters that connected.",
        state.connections,
    );
    text.counter(
        "drivemon_modbus_refused_connections_total",
        "Masters that were turned away.",
        state.refused_connections,
    );
    text.counter(
        "drivemon_modbus_answers_total",
        "Requests that were answered with registers.",
        state.answered,
    );
    text.counter(
        "drivemon_modbus_exceptions_total",
        "Requests that were answered with an exception.",
        state.exceptions,
    );
    text.counter(
        "drivemon_modbus_broken_total",
        "Lines closed because what came was no Modbus TCP.",
        state.broken,
    );
    text.counter(
        "drivemon_modbus_slow_total",
        "Lines closed because a master was too slow.",
        state.slow,
    );
}

fn page(state: &PageState, text: &mut Text) {
    let refused = [
        ("no_token", state.no_token),
        ("wrong_role", state.wrong_role),
        ("foreign", state.foreign),
    ];
    let refused = refused.map(|(why, count)| (labels(&[("why", why)]), count as f64));
    text.family(
        "drivemon_page_refused_total",
        Kind::Counter,
        "Requests that the page refused.",
        refused.to_vec(),
    );
    text.counter(
        "drivemon_page_behind_total",
        "Times that a page which reads too slowly got the whole wall in the place of what it missed.",
        state.behind,
    );
    text.counter(
        "drivemon_page_skipped_total",
        "Changes that such pages were not sent; the store has them.",
        state.skipped,
    );
    text.counter(
        "drivemon_page_cut_total",
        "Streams that ended while their page had not read for 5 s.",
        state.cut,
    );
}
