//! Slips in a motor file. `crates/drivemon/tests/bad_input` reads this file too.

/// One slip.
pub struct Case {
    /// What it is.
    pub what: &'static str,
    /// Text to replace in the smallest valid file, and what to put there.
    pub edit: (&'static str, &'static str),
    /// Line that the error names.
    pub line: usize,
    /// Key that it names.
    pub key: &'static str,
    /// Words of the remedy.
    pub remedy: &'static str,
}

const fn case(
    what: &'static str,
    edit: (&'static str, &'static str),
    line: usize,
    key: &'static str,
    remedy: &'static str,
) -> Case {
    Case {
        what,
        edit,
        line,
        key,
        remedy,
    }
}

const R_S: &str = "stator_resistance_ohm = 3.7";
const L_LS: &str = "stator_leakage_henry = 0.010735";
const LAST: &str = "load_friction_nm_s = 0.0\n";

/// Each of them is refused.
#[rustfmt::skip]
pub const CASES: [Case; 64] = [
    case("delay of another front end", (LAST, "load_friction_nm_s = 0.0\n[sensors]\nvoltage_delay_us = [900, 900, 900]"), 20, "sensors.voltage_delay_us", "at most 200 us"),
    case("delay of one phase only", (LAST, "load_friction_nm_s = 0.0\n[sensors]\ncurrent_delay_us = [85.7]"), 20, "sensors.current_delay_us", "3"),
    case("negative roll-off", (LAST, "load_friction_nm_s = 0.0\n[sensors]\nroll_off_us = -78.5"), 20, "sensors.roll_off_us", "300 us"),
    case("negative resistance", (R_S, "stator_resistance_ohm = -3.7"), 11, "parameters.stator_resistance_ohm", "above 0 and at most 100000 ohm"),
    case("zero resistance", (R_S, "stator_resistance_ohm = 0"), 11, "parameters.stator_resistance_ohm", "0 is out of range: write above 0"),
    case("not a number", (R_S, "stator_resistance_ohm = nan"), 11, "parameters.stator_resistance_ohm", "not a finite number: write above 0"),
    case("infinity", (R_S, "stator_resistance_ohm = inf"), 11, "parameters.stator_resistance_ohm", "not a finite number"),
    case("overflow", (R_S, "stator_resistance_ohm = 1e999"), 11, "parameters.stator_resistance_ohm", "not a finite number"),
    case("number in quotes", (R_S, "stator_resistance_ohm = \"3.7\""), 11, "parameters.stator_resistance_ohm", "remove the quotes"),
    case("text for a number", (R_S, "stator_resistance_ohm = \"low\""), 11, "parameters.stator_resistance_ohm", "is text: write above 0"),
    case("list for a number", (R_S, "stator_resistance_ohm = [3.7]"), 11, "parameters.stator_resistance_ohm", "is a list: write above 0"),
    case("date for a number", (R_S, "stator_resistance_ohm = 2024-01-01"), 11, "parameters.stator_resistance_ohm", "is a date: write above 0"),
    case("decimal comma", (R_S, "stator_resistance_ohm = 3,7"), 11, "stator_resistance_ohm", "decimals with a point"),
    case("unit behind the number", (R_S, "stator_resistance_ohm = 3.7 ohm"), 11, "stator_resistance_ohm", "number alone"),
    case("value missing", (R_S, "stator_resistance_ohm ="), 11, "stator_resistance_ohm", "value is missing"),
    case("equals sign missing", (R_S, "stator_resistance_ohm 3.7"), 11, "stator_resistance_ohm", "key = value"),
    case("misspelt key", (R_S, "stator_resistence_ohm = 3.7"), 11, "parameters.stator_resistence_ohm", "did you mean `stator_resistance_ohm`?"),
    case("unit left off the key", (R_S, "stator_resistance = 3.7"), 11, "parameters.stator_resistance", "did you mean `stator_resistance_ohm`?"),
    case("unknown key", (LAST, "load_friction_nm_s = 0.0\ncolour = 3\n"), 19, "parameters.colour", "remove it, or use one of stator_resistance_ohm"),
    case("missing key", ("rotor_resistance_ohm = 2.297\n", ""), 10, "parameters.rotor_resistance_ohm", "is missing: add rotor resistance"),
    case("duplicate key", (R_S, "stator_resistance_ohm = 3.7\nstator_resistance_ohm = 3.8"), 12, "stator_resistance_ohm", "remove one of the two"),
    case("duplicate section", ("[parameters]", "[nameplate]"), 10, "nameplate", "remove one of the two"),
    case("negative leakage", (L_LS, "stator_leakage_henry = -0.01"), 13, "parameters.stator_leakage_henry", "at least 0 and at most 100 H"),
    case("leakage in millihenry", (L_LS, "stator_leakage_henry = 10.735"), 13, "parameters.stator_leakage_henry", "write both in henry"),
    case("leakage as reactance", (L_LS, "stator_leakage_henry = 337"), 13, "parameters.stator_leakage_henry", "not millihenry, not the reactance"),
    case("magnetizing inductance zero", ("= 0.23426", "= 0.0"), 15, "parameters.magnetizing_inductance_henry", "above 0 and at most 1000 H"),
    case("inertia zero", ("= 0.015", "= 0.0"), 16, "parameters.inertia_kg_m2", "above 0"),
    case("friction negative", ("friction_nm_s = 0.0\nload", "friction_nm_s = -0.1\nload"), 17, "parameters.friction_nm_s", "at least 0"),
    case("temperature in kelvin", (LAST, "load_friction_nm_s = 0\ntemperature_degc = 500"), 19, "parameters.temperature_degc", "at most 400 degC"),
    case("no pole pairs", ("pole_pairs = 2", "pole_pairs = 0"), 3, "nameplate.pole_pairs", "at least 1 and at most 50"),
    case("half a pole pair", ("pole_pairs = 2", "pole_pairs = 2.5"), 3, "nameplate.pole_pairs", "not a whole number"),
    case("too many pole pairs", ("pole_pairs = 2", "pole_pairs = 51"), 3, "nameplate.pole_pairs", "a 4-pole motor has 2"),
    case("power in kilowatt", ("power_watt = 2200.0", "power_watt = 2.2"), 8, "nameplate.torque_nm", "power_watt is 2.2"),
    case("power beyond the current", ("power_watt = 2200.0", "power_watt = 9200.0"), 4, "nameplate.power_watt", "check power_watt"),
    case("frequency in rad/s", ("frequency_hz = 50.0", "frequency_hz = 3141.0"), 7, "nameplate.frequency_hz", "at least 1 and at most 1000 Hz"),
    case("speed above synchronous", ("torque_nm = 14.6", "torque_nm = 14.6\nspeed_rpm = 1740"), 9, "nameplate.speed_rpm", "below 1500 rpm"),
    case("unknown connection", ("\"star\"", "\"wye\""), 9, "nameplate.connection", "write one of \"star\", \"delta\""),
    case("connection not quoted", ("\"star\"", "star"), 9, "connection", "double quotes"),
    case("section missing", ("[parameters]\n", ""), 1, "parameters", "add the section [parameters]"),
    case("section misspelt", ("[parameters]", "[paramters]"), 10, "paramters", "did you mean `parameters`?"),
    case("section not closed", ("[nameplate]", "[nameplate"), 2, "[nameplate", "section header"),
    case("section as a value", ("[nameplate]\n", "load = 3\n[nameplate]\n"), 2, "load", "is a number: write a section, [load]"),
    case("blank name", ("name = \"2.2 kW laboratory motor\"", "name = \" \""), 1, "name", "is blank"),
    case("unknown load", (LAST, "load_friction_nm_s = 0\n[load]\nkind = \"fan\""), 20, "load.kind", "\"friction\", \"measured\", \"free\""),
    case("unknown frame", (LAST, "load_friction_nm_s = 0\n[monitor]\nframe = \"rotor\""), 20, "monitor.frame", "\"rotor-flux\", \"voltage\""),
    case("three thresholds", (LAST, "load_friction_nm_s = 0\n[monitor]\nthreshold_percent = [1, 2, 3]"), 20, "monitor.threshold_percent", "has 3 values: write 4"),
    case("threshold zero", (LAST, "load_friction_nm_s = 0\n[monitor]\nthreshold_percent = [1, 2, 3, 0]"), 20, "monitor.threshold_percent", "above 0"),
    case("hysteresis above one", (LAST, "load_friction_nm_s = 0\n[monitor]\nhysteresis = 1.5"), 20, "monitor.hysteresis", "0.1"),
    case("current range below the rated amplitude", (LAST, "load_friction_nm_s = 0\n[sensors]\ncurrent_full_scale_amp = 5.0"), 20, "sensors.current_full_scale_amp", "an amplitude and not an rms value"),
    case("effect without a name", (LAST, "load_friction_nm_s = 0\n[[effects]]\nk = 1.0"), 19, "effects[1].name", "add the name of the effect"),
    case("effect parameter not finite", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"core-loss\"\nk = nan"), 21, "effects[1].k", "not a finite number"),
    case("unknown effect", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"core-los\""), 20, "effects.core-los.name", "core-loss, stator-heating"),
    case("unknown number of an effect", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 1e-5\nk = 1.0"), 22, "effects.windage.k", "it has: windage_nm_s2"),
    case("unknown text of an effect", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 1e-5\nnote = \"x\""), 22, "effects.windage.note", "it has: windage_nm_s2"),
    case("effect size in quotes", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"windage\"\nwindage_nm_s2 = \"1e-5\""), 21, "effects.windage.windage_nm_s2", "without quotes"),
    case("effect size missing", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"windage\""), 20, "effects.windage.windage_nm_s2", "needs `windage_nm_s2` (N m s2)"),
    case("effect size out of range", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 9.0"), 21, "effects.windage.windage_nm_s2", "must lie in"),
    case("form of an effect as a number", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"deep-bar\"\nform = 2\nresistance_rise = 0.5\nleakage_drop = 0.2"), 21, "effects.deep-bar.form", "in double quotes"),
    case("unknown text of a formula", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"expression\"\nformula = \"k * omega\"\nadds_to = \"torque\"\nk = 1.0\nunit = \"N m\""), 24, "effects.expression.unit", "formula, adds_to"),
    case("formula that hides a variable", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"expression\"\nformula = \"omega\"\nadds_to = \"torque\"\nomega = 1.0"), 21, "effects.expression.formula", "is a variable"),
    case("formula that is no number", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"expression\"\nformula = \"k/(omega-omega)\"\nadds_to = \"torque\"\nk = 1.0"), 21, "effects.expression.formula", "it is no finite number at omega = "),
    case("formula that is no number at rest", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"expression\"\nformula = \"k/omega\"\nadds_to = \"torque\"\nk = 1.0"), 21, "effects.expression.formula", "it is no finite number at omega = 0"),
    case("size of no parameter", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"expression\"\nformula = \"k * omega\"\nadds_to = \"torque\"\nk = 1.0\nj_typical = 1.0"), 21, "effects.expression.formula", "add `j = 0.0`"),
    case("effects of too many states", (LAST, "load_friction_nm_s = 0\n[[effects]]\nname = \"series-inductance\"\nform = \"lc-filter\"\nseries_inductance_henry = 0.001\nfilter_resonance_hz = 1000.0\n[[effects]]\nname = \"series-inductance\"\nform = \"lc-filter\"\nseries_inductance_henry = 0.001\nfilter_resonance_hz = 1000.0\n[[effects]]\nname = \"series-inductance\"\nform = \"lc-filter\"\nseries_inductance_henry = 0.001\nfilter_resonance_hz = 1000.0"), 30, "effects.series-inductance.name", "remove one"),
];
