//! Masters that are programs of their own, on the board's line as a serial port of this computer.

mod common;

use common::wire::Wire;

#[test]
fn drivemon_tells_what_ended_the_program_and_where() {
    let wire = Wire::new(|board| {
        // `ldr r5, [r4]` of the test of the RAM, reading where nothing is.
        let init = board.symbol("__pre_init").expect("a function") & !1;
        let is_load = |board: &mut virtual_board::VirtualBoard, at: u32| {
            (board.word(at & !3).expect("flash") >> (8 * (at & 2))) as u16 == 0x6825
        };
        let load = (init..init + 0x80)
            .step_by(2)
            .find(|at| is_load(board, *at))
            .expect("ldr r5, [r4]");
        board
            .go_astray(load, &[0, 0, 0, 0, 0x6000_0000])
            .expect("a processor");
        board.run(common::LAMP_TEST_S + 0.8).expect("a run");
    });
    let (output, text) = wire.drivemon(&["record"]);
    assert_eq!(output.status.code(), Some(1), "{text}");
    for part in [
        "hard fault after 2.2 s",
        "reached an address where nothing is",
        "0x60000000",
        "doubts     none",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let elf = common::elf_path();
    let elf = elf.to_str().expect("a path");
    let (_, text) = wire.drivemon(&["record", "--elf", elf]);
    assert!(text.contains("__pre_init"), "{text}");
    // Another program's addresses would name the wrong lines.
    let other = std::env::temp_dir().join(format!("other-{}.elf", std::process::id()));
    let mut bytes = common::firmware();
    let seal = bytes
        .windows(4)
        .position(|bytes| bytes == b"SEAL")
        .expect("a seal");
    bytes[seal + 8] ^= 1;
    std::fs::write(&other, bytes).expect("a temporary file");
    let (output, text) = wire.drivemon(&["record", "--elf", other.to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("not the program on the board"), "{text}");
    std::fs::remove_file(other).expect("the temporary file");
}

#[test]
fn drivemon_reads_the_map_and_prepares_a_board_as_shipped() {
    let wire = Wire::new(|board| {
        board
            .set_options(virtual_board::SHIPPED_OPTIONS)
            .expect("options");
        board.run(common::LAMP_TEST_S + 0.8).expect("a run");
    });
    let (output, text) = wire.drivemon(&["read"]);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let line = |name: &str| {
        let found = text.lines().find(|line| line.starts_with(name));
        found.unwrap_or_else(|| panic!("{name}: {text}")).to_owned()
    };
    assert!(line("Doubts").ends_with("option bytes"), "{text}");
    assert!(line("Lamps").contains("run, sensor blinks"), "{text}");
    assert!(line("SupplyFrequency").contains("60.0"), "{text}");
    let (output, text) = wire.drivemon(&["prepare"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    // It starts again meanwhile.
    std::thread::sleep(std::time::Duration::from_secs_f64(
        common::LAMP_TEST_S + 1.0,
    ));
    let (output, text) = wire.drivemon(&["record"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let (output, text) = wire.drivemon(&["read", "--unit", "2"]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("no answer from unit 2"), "{text}");
}
