//! Physics that the library does not have, added by the formula that `docs/adding-an-effect.md` shows.

use serde_json::Value;

use crate::workplace::Workplace;

const PAGE: &str = include_str!("../../../../docs/adding-an-effect.md");
/// What the scenario of the page puts on the shaft, N m.
const BRAKE_NM: f64 = 0.6;

fn number(json: &Value, pointer: &str) -> f64 {
    json.pointer(pointer)
        .and_then(Value::as_f64)
        .expect(pointer)
}

/// Where the commands of the page were run: the formula is found, and the error falls to the noise.
pub fn is_found(workplace: &Workplace) {
    let without = workplace.json("explain eddy.csv.gz --motor motors/peer-2k2.toml");
    let with = workplace.json("explain eddy.csv.gz --motor eddy-motor.toml");
    assert_eq!(with["verdict"], "effect");
    assert_eq!(with["steps"][0]["effect"], "expression");
    // 1 is the noise; 2 % is the scatter that the discovery calls adequate.
    let adequate = 1.02;
    let best = "/final/held_out_error_over_noise";
    assert!(number(&with, best) < adequate && number(&without, best) > adequate);
    let adopted =
        workplace.json("adopt expression eddy.csv.gz --motor eddy-motor.toml -o eddy-adopted.toml");
    assert_eq!(adopted["proven"], true);
    let before = number(&adopted, "/before/held_out_error_over_noise");
    assert!(before > 2.0 && number(&adopted, "/after/held_out_error_over_noise") < adequate);
    let (size, error) = ("/parameters/0/value", "/parameters/0/std_error");
    // Three standard errors.
    let off = number(&adopted, size) - BRAKE_NM;
    assert!(off.abs() < 3.0 * number(&adopted, error), "{off}");
    assert!(PAGE.contains(&format!("brake_nm = {BRAKE_NM}\n")));
}
