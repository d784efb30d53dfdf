//! `drivemon board key`, `package` and `update`: from no key to a program on a board, on a pseudo-terminal as a real port would be.

mod firmware;
#[cfg(unix)]
mod slave;

use std::path::{Path, PathBuf};

use crate::common::{drivemon, scratch, stderr, stdout, text};
use firmware::{elf, program};

/// A folder with a key of its own and an ELF file.
struct Place {
    folder: PathBuf,
}

impl Place {
    fn new(name: &str) -> Self {
        let place = Place {
            folder: scratch(&format!("programs-{name}")),
        };
        let made = drivemon(&["board", "key", "new", text(&place.at("own"))]);
        assert_eq!(made.status.code(), Some(0), "{made:?}");
        let said = stdout(&made);
        for words in ["own.key", "own.pub", "Lost: ", "Leaked: "] {
            assert!(said.contains(words), "{said}");
        }
        std::fs::write(place.at("elf"), elf(&program("1.3.0"))).expect("written");
        place
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The exit code and everything that was said.
    fn package(&self, more: &[&str]) -> (Option<i32>, String) {
        let (elf, out) = (self.at("elf"), self.at("new.dmu"));
        let fixed = ["board", "package", text(&elf), "-o", text(&out)];
        let done = drivemon(&[&fixed, more].concat());
        (done.status.code(), stdout(&done) + &stderr(&done))
    }
}

fn demo_key() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../keys/demo.key")
}

#[test]
fn a_key_is_made_once() {
    let place = Place::new("key");
    let before = std::fs::read(place.at("own.key")).expect("there");
    let again = drivemon(&["board", "key", "new", text(&place.at("own"))]);
    assert_eq!(again.status.code(), Some(2), "{again:?}");
    assert!(
        stderr(&again).contains("own.key: exists already"),
        "{again:?}"
    );
    assert_eq!(std::fs::read(place.at("own.key")).expect("there"), before);
}

#[test]
fn a_package_says_what_it_holds_and_is_signed_with_the_key() {
    let place = Place::new("package");
    let (code, said) = place.package(&["--key", text(&place.at("own.key"))]);
    assert_eq!(code, Some(0), "{said}");
    let bytes = std::fs::read(place.at("new.dmu")).expect("written");
    let program = program("1.3.0");
    let words = [
        "1.3.0",
        "STM32G474RE",
        &format!("{} of program", program.len()),
    ];
    for word in words {
        assert!(said.contains(word), "{said}");
    }
    assert!(!said.contains("demo"), "{said}");
    assert_eq!(bytes[..program.len()], program);
    let package = program::Package::read(&place.at("new.dmu")).expect("a package");
    let key = program::KeyFile::read(&place.at("own.pub"), program::Half::Public);
    assert!(package.is_signed_with(&key.expect("a key").public()));
    assert!(
        said.contains(&format!("{:08x}", package.seal().checksum)),
        "{said}"
    );
}

#[test]
fn nobody_signs_with_the_demo_key_unawares() {
    let place = Place::new("demo");
    let demo = demo_key();
    let (code, said) = place.package(&[]);
    assert_eq!(code, Some(2), "{said}");
    let (code, said) = place.package(&["--key", text(&demo)]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("board key new") && said.contains("--demo-key"),
        "{said}"
    );
    // Nor under another name.
    let other = std::fs::read_to_string(&demo)
        .expect("there")
        .replace("demo", "own");
    std::fs::write(place.at("other.key"), other).expect("written");
    let (code, said) = place.package(&["--key", text(&place.at("other.key"))]);
    assert_eq!(code, Some(2), "{said}");
    assert!(!place.at("new.dmu").exists());
    let (code, said) = place.package(&["--demo-key"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("which everybody has"), "{said}");
}

#[test]
fn what_is_no_program_or_no_key_is_told_with_what_helps() {
    let place = Place::new("wrong");
    let (code, said) = place.package(&["--key", text(&place.at("own.pub"))]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("own.pub: is the public half"), "{said}");
    std::fs::write(place.at("elf"), b"MZ").expect("written");
    let (code, said) = place.package(&["--key", text(&place.at("own.key"))]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("elf: is no ELF file") && said.contains("; name the firmware's"),
        "{said}"
    );
}

#[test]
fn a_package_that_is_damaged_or_not_signed_with_the_key_is_told_before_the_port_is_opened() {
    let place = Place::new("before");
    let (code, said) = place.package(&["--key", text(&place.at("own.key"))]);
    assert_eq!(code, Some(0), "{said}");
    let package = place.at("new.dmu");
    let update = |more: &[&str]| {
        let fixed = [
            "board",
            "update",
            text(&package),
            "--serial",
            "/dev/no-such-port",
        ];
        let done = drivemon(&[&fixed, more].concat());
        assert_eq!(done.status.code(), Some(2), "{done:?}");
        stderr(&done)
    };
    let demo = demo_key().with_extension("pub");
    assert!(update(&["--public-key", text(&demo)]).contains("is not signed with the key demo"));
    assert!(update(&["--public-key", text(&place.at("own.pub"))]).contains("no-such-port"));
    let mut bytes = std::fs::read(&package).expect("there");
    bytes[900] ^= 1;
    std::fs::write(&package, bytes).expect("written");
    let said = update(&[]);
    assert!(
        said.contains("new.dmu: is damaged") && said.contains("copy it again"),
        "{said}"
    );
}
