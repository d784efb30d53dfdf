//! Malformed motor files, each with the line, the key and the remedy that its error must name.

use super::MotorFile;
use super::malformed_cases::CASES;
use super::tests::SMALLEST;

#[test]
fn each_malformed_file_is_refused_with_file_line_key_and_remedy() {
    for case in &CASES {
        let (from, to) = case.edit;
        assert_eq!(
            SMALLEST.matches(from).count(),
            1,
            "{}: the edit must hit once",
            case.what
        );
        let text = SMALLEST.replace(from, to);
        let error = MotorFile::parse(&text, "my motor.toml").expect_err(case.what);
        let message = error.to_string();
        let place = format!("my motor.toml:{}: {}: ", case.line, case.key);
        let named = message
            .lines()
            .any(|line| line.starts_with(&place) && line.contains(case.remedy));
        assert!(
            named,
            "{}: wanted {place}..{}, got:\n{message}",
            case.what, case.remedy
        );
    }
}

/// A slip must not drown in follow-up complaints.
#[test]
fn one_slip_gives_one_line() {
    for case in &CASES {
        let text = SMALLEST.replace(case.edit.0, case.edit.1);
        let error = MotorFile::parse(&text, "m").expect_err(case.what);
        let most = if case.what == "section missing" {
            10
        } else {
            1
        };
        assert!(error.problems().len() <= most, "{}:\n{error}", case.what);
    }
}

#[test]
fn leakage_on_neither_side_is_refused_for_its_sigma() {
    let text = SMALLEST.replace("0.010735", "0.0");
    let error = MotorFile::parse(&text, "m")
        .expect_err("sigma = 0")
        .to_string();
    assert!(
        error.contains("m:13: parameters.stator_leakage_henry"),
        "{error}"
    );
    assert!(error.contains("above 0 and below 1"), "{error}");
}

#[test]
fn a_file_that_is_no_text_is_refused_for_what_it_is() {
    let folder = std::env::temp_dir().join(format!("motor-file-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let utf16: Vec<u8> = SMALLEST.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [&[0xFF, 0xFE], utf16.as_slice()].concat();
    let cases: [(&str, &[u8], &str); 5] = [
        ("empty.toml", b"", "is empty"),
        ("utf16.toml", &marked, "save it as UTF-8"),
        ("utf16-unmarked.toml", &utf16, "binary or UTF-16"),
        (
            "latin1.toml",
            b"name = \"M\xFCller\"\n",
            "line 1 is not UTF-8",
        ),
        ("huge.toml", &vec![b'#'; 2 << 20], "is this a recording?"),
    ];
    for (name, bytes, remedy) in cases {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("written");
        let message = MotorFile::read(&path).expect_err(name).to_string();
        assert!(
            message.contains(name) && message.contains(remedy),
            "{message}"
        );
    }
    let absent = MotorFile::read(folder.join("absent.toml")).expect_err("absent");
    assert!(absent.to_string().contains("absent.toml: cannot be read"));
    assert!(
        MotorFile::read(&folder)
            .expect_err("a folder")
            .to_string()
            .contains("is a folder")
    );
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn a_byte_order_mark_and_dos_line_ends_are_accepted() {
    let path = std::env::temp_dir().join(format!("motor-bom-{}.toml", std::process::id()));
    let text = format!("\u{FEFF}{}", SMALLEST.replace('\n', "\r\n"));
    std::fs::write(&path, text).expect("written");
    let motor = MotorFile::read(&path).expect("accepted");
    assert_eq!(motor.name, "2.2 kW laboratory motor");
    std::fs::remove_file(&path).expect("removed");
}
