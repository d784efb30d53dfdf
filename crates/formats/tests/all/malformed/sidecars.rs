//! Malformed sidecars and load tables.

use super::{Case, case, with_sidecar};

/// Sidecars.
pub fn sidecars() -> Vec<Case> {
    vec![
        with_sidecar("", &["x.toml", "sidecar is empty", "remove it"]),
        with_sidecar(
            "volt = \"hold\"",
            &["x.toml:1: volt", "did you mean `voltage`"],
        ),
        with_sidecar(
            "voltage = \"rms\"",
            &["x.toml:1: voltage", "\"instantaneous\", \"hold\""],
        ),
        with_sidecar("voltage = 3", &["x.toml:1: voltage", "is a number"]),
        with_sidecar("voltage = hold", &["x.toml:1", "double quotes"]),
        with_sidecar(
            "\n[sensor]\nadc_bits = 12",
            &["x.toml:2: sensor", "did you mean `sensors`"],
        ),
        with_sidecar(
            "[sensors]\nadc_bit = 12",
            &["x.toml:2: sensors.adc_bit", "did you mean `adc_bits`"],
        ),
        with_sidecar(
            "[sensors]\nadc_bits = 12.5",
            &["x.toml:2: sensors.adc_bits", "whole number"],
        ),
        with_sidecar(
            "[sensors]\nadc_bits = 99",
            &["x.toml:2", "at least 4 and at most 32"],
        ),
        with_sidecar(
            "[sensors]\nvoltage_full_scale_volt = -600",
            &[
                "x.toml:2: sensors.voltage_full_scale_volt",
                "-600 is out of range",
            ],
        ),
        with_sidecar(
            "[sensors]\nnoise_sigma_fraction_of_full_scale = nan",
            &["x.toml:2", "not a finite number"],
        ),
        with_sidecar(
            "[sensors]\nencoder_edges_per_pulse = 3",
            &[
                "x.toml:2: sensors.encoder_edges_per_pulse",
                "write 1, 2 or 4",
            ],
        ),
        with_sidecar(
            "[columns]\nspead = \"n\"",
            &["x.toml:2: columns.spead", "did you mean `speed`"],
        ),
        with_sidecar(
            "[columns]\nia = \"i1\"",
            &["x.csv:1: i1", "does not have", "t ia ib ic"],
        ),
        with_sidecar(
            "[columns]\nia = { name = \"ia\", unit = \"rpm\" }",
            &[
                "x.toml:2: columns.ia.unit",
                "\"rpm\" is not a unit of ia",
                "A, mA, kA",
            ],
        ),
        with_sidecar(
            "[columns]\nia = { scale = 0 }",
            &["x.toml:2: columns.ia.scale", "other than 0"],
        ),
        with_sidecar(
            "[columns]\nia = { scal = 2 }",
            &["x.toml:2: columns.ia.scal", "did you mean `scale`"],
        ),
        with_sidecar(
            "[columns]\nia = 3",
            &["x.toml:2: columns.ia", "is a number"],
        ),
        with_sidecar(
            "[columns]\nspeed = { unit = \"rpm\" }",
            &[
                "x.csv:1: speed",
                "which the file does not have",
                "--column speed=NAME",
            ],
        ),
        with_sidecar(
            "[columns]\nia = \"ic\"\nib = \"ic\"",
            &["x.csv:1: ic", "mapped to two channels"],
        ),
        with_sidecar(
            "[columns]\nspeed = { name = \"ib\", unit = \"counts\" }",
            &[
                "speed",
                "encoder is not declared",
                "encoder_pulses_per_revolution",
            ],
        ),
        with_sidecar("delimiter = \"x\"", &["x.toml:1: delimiter", "`tab`"]),
        with_sidecar(
            "sample_rate_hz = 0",
            &["x.toml:1: sample_rate_hz", "out of range"],
        ),
        with_sidecar(
            "skip_missing = \"yes\"",
            &["x.toml:1: skip_missing", "true or false"],
        ),
        with_sidecar(
            "[nameplate]\npole_pairs = 2",
            &["x.toml:1: nameplate", "this is a motor file", "rename"],
        ),
    ]
}

/// Load tables.
pub fn tables() -> Vec<Case> {
    vec![
        case(
            "power_watt,current_rms_amp\n",
            &["0 operating point", "at least 2"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n",
            &["1 operating point", "at least 2"],
        ),
        case(
            "power_watt,speed_rpm\n1,2\n3,4\n",
            &[
                "x.csv:1: current_rms_amp",
                "missing",
                "add the line current",
            ],
        ),
        case(
            "current_rms_amp,efficiency\n1,0.5\n",
            &["how the motor was loaded", "torque_nm"],
        ),
        case(
            "power_watt,current_rms_amp,efficiency\n1,2,90.4\n3,4,91\n",
            &["x.csv:2: efficiency", "90.4 is above 1", "0.9 for 90 %"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n-3,4\n",
            &["x.csv:3: power_watt", "-3", "loads are positive"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n3,x\n",
            &["x.csv:3: current_rms_amp", "`x` is not a number"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n3,\n",
            &["x.csv:3: current_rms_amp", "no number"],
        ),
        case(
            "power_watts,current_rms_amp\n1,2\n3,4\n",
            &["x.csv:1: power_watts", "did you mean `power_watt`"],
        ),
    ]
}
