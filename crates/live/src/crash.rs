//! What a board tells of its last crash, in words.

/// Marks that the watchdog missed, in words.
pub fn missing_marks(missing: u32) -> String {
    let names = ["blocks of samples", "the Modbus task", "the self-test"];
    let named = names
        .into_iter()
        .enumerate()
        .filter(|(k, _)| missing >> k & 1 == 1);
    let named: Vec<&str> = named.map(|(_, name)| name).collect();
    match named.len() {
        0 => "nothing that was noted".into(),
        3 => format!("{}: the program stood", named.join(", ")),
        _ => named.join(", "),
    }
}

/// Bits of the fault status register in words (ARMv7-M, B3.2.15).
pub fn fault_status(cfsr: u32) -> Vec<&'static str> {
    let bits = [
        (0, "executed where memory protection forbids it"),
        (1, "reached where memory protection forbids it"),
        (4, "stack beyond its memory (protection)"),
        (8, "fetched an instruction from where nothing is"),
        (9, "reached an address where nothing is"),
        (
            10,
            "reached an address where nothing is, some instructions before",
        ),
        (12, "stack beyond its memory"),
        (16, "undefined instruction"),
        (17, "branched to an address of another instruction set"),
        (18, "wrong return from an exception"),
        (19, "no coprocessor"),
        (24, "unaligned access"),
        (25, "division by zero"),
    ];
    let set = bits.into_iter().filter(|(bit, _)| cfsr >> bit & 1 == 1);
    set.map(|(_, words)| words).collect()
}
