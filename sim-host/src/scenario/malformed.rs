//! Malformed scenario files, each with the line, the key and the remedy that its error must name.

use super::Scenario;
use super::tests::folder;

/// `(text after the motor's line, line, key, remedy)`.
#[rustfmt::skip]
const CASES: [(&str, usize, &str, &str); 37] = [
    ("", 1, "duration_s", "is missing: add length of the experiment"),
    ("duration = 3", 2, "duration", "did you mean `duration_s`?"),
    ("duration_s = 0", 2, "duration_s", "above 0"),
    ("duration_s = \"3\"", 2, "duration_s", "remove the quotes"),
    ("duration_s = 80000", 2, "duration_s", "lower sample_rate_hz"),
    ("duration_s = 1\nplant = \"half\"", 3, "plant", "\"full\", \"linear\""),
    ("duration_s = 1\nstart = \"now\"", 3, "start", "\"standstill\", \"running\""),
    ("duration_s = 1\nsample_rate_hz = 0.0001", 3, "sample_rate_hz", "not the time between them"),
    ("duration_s = 1\nsample_rate_hz = 500", 3, "sample_rate_hz", "write at least 600"),
    ("duration_s = 1\nrecord_from_s = 2", 3, "record_from_s", "nothing would be recorded"),
    ("duration_s = 1\nseed = -1", 3, "seed", "at least 0"),
    ("duration_s = 1\nseed = 1.5", 3, "seed", "not a whole number"),
    ("duration_s = 1\n[supply]\nfrequency_hz = 0", 4, "supply.frequency_hz", "at least 1"),
    ("duration_s = 1\n[supply]\nvoltage = 230", 4, "supply.voltage", "did you mean `voltage_line_rms_volt`?"),
    ("duration_s = 1\n[supply]\nunbalance_percent = 80", 4, "supply.unbalance_percent", "at most 50 percent"),
    ("duration_s = 1\n[[supply.harmonics]]\norder = 1\npercent = 5", 4, "supply.harmonics[1].order", "unbalance has its own key"),
    ("duration_s = 1\n[[supply.harmonics]]\npercent = 5", 3, "supply.harmonics[1].order", "is missing"),
    ("duration_s = 1\n[[supply.steps]]\nat_s = 1", 4, "supply.steps[1].at_s", "add voltage_percent or frequency_hz"),
    ("duration_s = 1\n[[supply.steps]]\nat_s = 1\nvoltage_percent = 90\nramp_s = 2\n[[supply.steps]]\nat_s = 2\nvoltage_percent = 80", 3, "supply.steps", "sort them"),
    ("duration_s = 1\n[load]\nconstant_nm = 1\nconstant_percent = 5", 5, "load.constant_percent", "keep one of the two"),
    ("duration_s = 1\n[load]\nprofile = [{ at_s = 1, torque_nm = 1 }, { at_s = 1, torque_nm = 2 }]", 4, "load.profile", "sort the times"),
    ("duration_s = 1\n[load]\nprofile = [{ at_s = 1 }]", 4, "load.profile[1].torque_nm", "add torque_nm or torque_percent"),
    ("duration_s = 1\n[load]\nprofile = 3", 4, "load.profile", "is a number: write a list of sections"),
    ("duration_s = 1\n[load]\nquadratic_nm_s2 = -1", 4, "load.quadratic_nm_s2", "at least 0"),
    ("duration_s = 1\n[sensors]\nadc_bits = 32", 4, "sensors.adc_bits", "at most 16 bit"),
    ("duration_s = 1\n[sensors]\nspeed = \"resolver\"", 4, "sensors.speed", "\"tachometer\", \"encoder\", \"none\""),
    ("duration_s = 1\n[[faults]]\nfault = \"Rx\"\nchange_percent = 5", 4, "faults[1].fault", "\"Rx\" is not known: write one of \"Rs\""),
    ("duration_s = 1\n[[faults]]\nfault = \"Rs\"", 3, "faults[1].change_percent", "0 changes are given"),
    ("duration_s = 1\n[[faults]]\nfault = \"Rs\"\nchange_percent = 0", 5, "faults[1].change_percent", "changes nothing"),
    ("duration_s = 1\n[[faults]]\nfault = \"Rs\"\nchange_percent = -100", 5, "faults[1].change_percent", "above -100"),
    ("duration_s = 1\n[[faults]]\nfault = \"Rs\"\ndead = true", 5, "faults[1].dead", "is not a known key"),
    ("duration_s = 1\n[[faults]]\nfault = \"ia\"\ndead = true\ngain = 0.5", 3, "faults[1].change_percent", "2 changes are given"),
    ("duration_s = 1\n[[faults]]\nfault = \"Ls\"\nchange_percent = 50", 4, "faults[1].fault", "write \"Lls\" or \"Lm\""),
    ("duration_s = 1\n[[faults]]\nfault = \"Rs\"\nchange_percent = 50\nfrom_s = 2\nto_s = 1", 7, "faults[1].to_s", "write a later time"),
    ("duration_s = 1\nplant = \"linear\"\n[supply]\nunbalance_percent = 2", 4, "supply", "write plant = \"full\""),
    ("duration_s = 1\n[[effects]]\nname = \"core-lost\"", 4, "effects.core-lost.name", "use one of: "),
    ("duration_s = 1\n[[effects]]\nname = \"windage\"\nk = 1", 5, "effects.windage.k", "it has: "),
];

#[test]
fn each_malformed_scenario_is_refused_with_file_line_key_and_remedy() {
    for (text, line, key, remedy) in CASES {
        let text = format!("motor = \"../../motors/assumed-300w.toml\"\n{text}\n");
        let error = Scenario::parse(&text, "my.toml", &folder()).expect_err(&text);
        let message = error.to_string();
        let place = format!("my.toml:{line}: {key}: ");
        let named = message
            .lines()
            .any(|l| l.starts_with(&place) && l.contains(remedy));
        assert!(
            named,
            "wanted {place}..{remedy}, got:\n{message}\nfor\n{text}"
        );
        assert_eq!(error.problems().len(), 1, "one slip, one line:\n{message}");
    }
}

#[test]
fn a_motor_that_is_not_there_is_named() {
    let parse = |text: &str| {
        Scenario::parse(text, "my.toml", &folder())
            .expect_err(text)
            .to_string()
    };
    let missing = parse("duration_s = 1");
    assert!(
        missing.starts_with("my.toml:1: motor: is missing: add the path"),
        "{missing}"
    );
    let absent = parse("\nmotor = \"none.toml\"\nduration_s = 1");
    assert!(
        absent.starts_with("my.toml:2: motor: there is no file"),
        "{absent}"
    );
    assert!(absent.contains("none.toml"), "{absent}");
}

#[test]
fn a_problem_of_the_motor_file_is_its_own() {
    let text = "motor = \"paper-experiment.toml\"\nduration_s = 1";
    let error = Scenario::parse(text, "my.toml", &folder()).expect_err("no motor file");
    assert!(
        error.to_string().contains("paper-experiment.toml:"),
        "{error}"
    );
    assert!(
        error.to_string().contains("add the section [nameplate]"),
        "{error}"
    );
}
