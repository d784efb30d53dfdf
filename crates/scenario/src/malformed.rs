//! Malformed scenario files, each with the line, the key and the remedy that its error must name.

use super::Scenario;
use super::malformed_cases::CASES;
use super::tests::folder;

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
