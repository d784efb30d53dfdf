//! `[sensors]`: full scales, noise, the encoder, and what the plates of sensors say.

use crate::data::channel::{Channel, Quantity};
use crate::data::metadata::Sensors;
use crate::mapping::flags::all_of;
use crate::mapping::sensor::{Sensor, WAYS};
use crate::mapping::{Mapping, Origin, Said, Target};
use document::{Bounds, Section};

const VOLT: Bounds = Bounds::above(0.0, 1e6, "V");
const AMP: Bounds = Bounds::above(0.0, 1e6, "A");
const RAD_S: Bounds = Bounds::above(0.0, 1e5, "rad/s");
const NM: Bounds = Bounds::above(0.0, 1e7, "N m");
const NOISE: Bounds = Bounds::between(0.0, 0.5, "of full scale").hint("0.2 % is 0.002");
const BITS: Bounds = Bounds::between(4.0, 32.0, "bits");
const PULSES: Bounds = Bounds::between(1.0, 1e6, "per revolution");
const EDGES: [(f64, u32); 3] = [(1.0, 1), (2.0, 2), (4.0, 4)];

/// `ia = "100 mV/A"` in `[sensors]`; `i` and `v` mean all currents and all voltages.
fn scales(section: &Section<'_>, mapping: &mut Mapping) -> Option<()> {
    let groups = ["v", "i"]
        .into_iter()
        .filter_map(|name| Some((name, all_of(name)?)));
    for (name, quantity) in groups {
        if let Some(sensor) = sensor(section, name, quantity)? {
            let origin = Origin::Sidecar;
            mapping.sensors.insert(
                quantity,
                Said {
                    what: sensor,
                    origin,
                },
            );
        }
    }
    for channel in Channel::all() {
        if let Some(sensor) = sensor(section, &channel.to_string(), channel.quantity())? {
            let map = mapping.entry(Target::Channel(channel));
            map.sensor = Some(sensor);
            map.origin = Origin::Sidecar;
        }
    }
    Some(())
}

fn sensor(section: &Section<'_>, key: &str, quantity: Quantity) -> Option<Option<Sensor>> {
    let Some(text) = section.optional_text(key)? else {
        return Some(None);
    };
    let sensor = Sensor::parse(quantity, &text);
    if let Err(why) = &sensor {
        section.report(key, format!("{why}: {}", WAYS));
    }
    sensor.ok().map(Some)
}

pub(super) fn sensors(section: Section<'_>, mapping: &mut Mapping) -> Option<Sensors> {
    let scales = scales(&section, mapping);
    let number = |key, bounds| section.optional_number(key, bounds);
    let voltage = number("voltage_full_scale_volt", &VOLT);
    let current = number("current_full_scale_amp", &AMP);
    let speed = number("speed_full_scale_rad_s", &RAD_S);
    let torque = number("torque_full_scale_nm", &NM);
    let noise = number("noise_sigma_fraction_of_full_scale", &NOISE);
    let adc_bits = whole(&section, "adc_bits", &BITS);
    let pulses = whole(&section, "encoder_pulses_per_revolution", &PULSES);
    let counter_bits = whole(&section, "encoder_counter_bits", &BITS);
    let edges = edges(&section);
    section.finish();
    scales?;
    Some(Sensors {
        voltage_full_scale_volt: voltage?,
        current_full_scale_amp: current?,
        speed_full_scale_rad_s: speed?,
        torque_full_scale_nm: torque?,
        noise_sigma_fraction_of_full_scale: noise?,
        adc_bits: adc_bits?,
        encoder_pulses_per_revolution: pulses?,
        encoder_counter_bits: counter_bits?,
        encoder_edges_per_pulse: edges?,
    })
}

fn whole(section: &Section<'_>, key: &str, bounds: &Bounds) -> Option<Option<u32>> {
    if !section.has(key) {
        // Asking makes the key known, so that a misspelt one finds it.
        return section.optional_number(key, bounds).map(|_| None);
    }
    section.integer(key, bounds, "").map(Some)
}

fn edges(section: &Section<'_>) -> Option<Option<u32>> {
    let key = "encoder_edges_per_pulse";
    let Some(number) = section.optional_number(key, &Bounds::between(1.0, 4.0, ""))? else {
        return Some(None);
    };
    let found = EDGES.iter().find(|(edges, _)| *edges == number);
    if found.is_none() {
        section.report(key, format!("{number} edges per pulse: write 1, 2 or 4"));
    }
    found.map(|(_, edges)| Some(*edges))
}
