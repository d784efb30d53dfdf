//! Physics that the library does not have, added by the formula that `docs/adding-an-effect.md` shows.

use serde_json::Value;

use crate::pieces;
use crate::workplace::Workplace;

const PAGE: &str = include_str!("../../../../docs/adding-an-effect.md");
/// What the scenario of the page puts on the shaft, N m.
const BRAKE_NM: f64 = 0.6;

fn json(workplace: &Workplace, command: &str) -> Value {
    let printed = workplace.run(&format!("$ drivemon {command} --json -"));
    serde_json::from_str(&printed.join("\n")).expect("JSON")
}

fn number(json: &Value, pointer: &str) -> f64 {
    json.pointer(pointer)
        .and_then(Value::as_f64)
        .expect(pointer)
}

#[test]
fn the_formula_of_the_page_is_found_and_the_error_falls_to_the_noise() {
    let workplace = Workplace::new("formula");
    let files = pieces::files(PAGE);
    files.iter().for_each(|file| workplace.write(file));
    workplace.run("$ drivemon simulate eddy-plant.toml -o eddy.csv.gz");
    let without = json(
        &workplace,
        "explain eddy.csv.gz --motor motors/peer-2k2.toml",
    );
    let with = json(&workplace, "explain eddy.csv.gz --motor eddy-motor.toml");
    assert_eq!(with["verdict"], "effect");
    assert_eq!(with["steps"][0]["effect"], "expression");
    // 1 is the noise; 2 % is the scatter that the discovery calls adequate.
    let adequate = 1.02;
    let best = "/final/held_out_error_over_noise";
    assert!(number(&with, best) < adequate && number(&without, best) > adequate);
    let adopt = "adopt expression eddy.csv.gz --motor eddy-motor.toml -o adopted.toml";
    let adopted = json(&workplace, adopt);
    assert_eq!(adopted["proven"], true);
    let before = number(&adopted, "/before/held_out_error_over_noise");
    assert!(before > 2.0 && number(&adopted, "/after/held_out_error_over_noise") < adequate);
    let (size, error) = ("/parameters/0/value", "/parameters/0/std_error");
    // Three standard errors.
    let off = number(&adopted, size) - BRAKE_NM;
    assert!(off.abs() < 3.0 * number(&adopted, error), "{off}");
    assert!(PAGE.contains(&format!("brake_nm = {BRAKE_NM}\n")));
}
