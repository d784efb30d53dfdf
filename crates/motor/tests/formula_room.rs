//! Formulas live as long as the program: a server that reads motor files of strangers must not fill up with them. In a
//! process of its own, because the room is one for all.
#![cfg(feature = "file")]

use motor::effect::expression::expression;

fn read(formula: &str, k: f64) -> Result<(), String> {
    let numbers = [("k".to_owned(), k), ("k_typical".to_owned(), 1e-3)];
    let read = expression(Some(formula), Some("torque"), &numbers);
    read.map(drop).map_err(|error| error.to_string())
}

#[test]
fn there_is_room_for_a_thousand_formulas_of_a_thousand_characters() {
    let long = format!("k*omega{}", "+omega".repeat(200));
    let refusal = read(&long, 1.0).expect_err("a program, not a formula");
    assert!(
        refusal.contains("at most 1000") && refusal.len() < 300,
        "{refusal}"
    );
    // Other values are no other formula.
    for k in 0..5_000 {
        assert_eq!(read("k*omega", f64::from(k)), Ok(()));
    }
    for k in 1..1_000 {
        assert_eq!(read(&format!("k*omega+{k}"), 1.0), Ok(()), "{k}");
    }
    let refusal = read("k*omega+1000", 1.0).expect_err("no room");
    assert!(refusal.contains("start it again"), "{refusal}");
    // What is known is found again.
    assert_eq!(read("k*omega+7", 2.0), Ok(()));
}
