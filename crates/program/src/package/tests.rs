use super::*;
use crate::crafted::program;
use update::SEAL_OFFSET;

fn key() -> SecretKey {
    SecretKey::from_seed([7; 32])
}

fn told(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("new.dmu");
    std::fs::write(&file, bytes).expect("written");
    match Package::read(&file) {
        Ok(_) => "read".into(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_package_is_the_program_and_its_signature_and_nothing_else() {
    let program = program(5_003);
    let package = Package::sign(program.clone(), &key()).expect("a program");
    assert_eq!(package.bytes()[..program.len()], program);
    assert_eq!(package.bytes().len(), program.len() + SIGNATURE_BYTES);
    assert!(package.is_signed_with(&key().public()));
    assert!(!package.is_signed_with(&SecretKey::from_seed([8; 32]).public()));
    assert!(!package.is_demo());
    // What the board and its loader ask.
    update::package::check(package.bytes(), None, &key().public()).expect("taken");
    assert_eq!(told(package.bytes()), "read");
    let demo = KeyFile::demo(Half::Secret)
        .secret()
        .expect("the secret half");
    let package = Package::sign(program, &demo).expect("a program");
    assert!(package.is_demo());
}

#[test]
fn damage_at_any_place_is_told_and_so_is_what_is_no_package() {
    let program = program(3_000);
    let package = Package::sign(program, &key()).expect("a program");
    let whole = package.bytes();
    for at in [0, 1, SEAL_OFFSET - 1, SEAL_OFFSET + 20, 1_234, 2_999] {
        let mut damaged = whole.to_vec();
        damaged[at] ^= 1;
        let told = told(&damaged);
        assert!(
            told.contains("is damaged") && told.contains("copy it again"),
            "{at}: {told}"
        );
    }
    for length in [whole.len() - 1, whole.len() - SIGNATURE_BYTES, 1_000] {
        assert!(
            told(&whole[..length]).contains("is damaged: the transfer is incomplete"),
            "{length}"
        );
    }
    assert!(told(&[whole, &[0]].concat()).contains("is damaged"));
    for length in [0, 1, SEAL_OFFSET + 3] {
        assert!(told(&whole[..length]).contains("is no package"), "{length}");
    }
    assert!(told(b"\x7fELF").contains("is no package"));
    // A signature that does not hold is the loader's to tell: only it has the key.
    let mut other = whole.to_vec();
    other[3_010] ^= 1;
    assert_eq!(told(&other), "read");
}

#[test]
fn a_program_for_another_board_is_not_signed_and_not_read() {
    let mut program = program(3_000);
    program[SEAL_OFFSET + 16] ^= 2;
    assert_eq!(Package::sign(program.clone(), &key()), Err(Refusal::Board));
    program.extend([0; SIGNATURE_BYTES]);
    assert!(told(&program).contains("another board"));
}
