use super::*;

fn bytes<const N: usize>(digits: &str) -> [u8; N] {
    let (pairs, _) = digits.as_bytes().as_chunks::<2>();
    assert_eq!(pairs.len(), N);
    std::array::from_fn(|k| {
        let pair = std::str::from_utf8(&pairs[k]).expect("digits");
        u8::from_str_radix(pair, 16).expect("a digit")
    })
}

/// RFC 8032, section 7.1, TEST 3: what every implementation of Ed25519 must give.
#[test]
fn a_key_file_signs_as_the_standard_says() {
    let text = "# drive-monitor, secret key rfc: x\n\
                c5aa8df43f9f837bedb7442f31dcb7b166d38535076f094b85ce3a2e0b4458f7\n";
    let key = parse(text).expect("a key");
    let public = "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025";
    assert_eq!(key.public().0, bytes::<32>(public));
    let signature = "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac\
                     18ff9b538d16f290ae67f760984dc6594a7c15e9716ed28dc027beceea1ec40a";
    let made = key.secret().expect("the secret half").sign(&[0xAF, 0x82]);
    assert_eq!(made, bytes::<64>(signature));
    key.public().verify(&[0xAF, 0x82], &made).expect("holds");
    key.public()
        .verify(&[0xAF, 0x83], &made)
        .expect_err("another message");
}

#[test]
fn a_new_key_is_read_back_and_its_halves_belong_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let [secret, public] = new_key(&folder.path().join("plant-7.north")).expect("a key");
    assert_eq!(secret, folder.path().join("plant-7.north.key"));
    let key = KeyFile::read(&secret, Half::Secret).expect("the secret half");
    let half = KeyFile::read(&public, Half::Public).expect("the public half");
    assert_eq!(
        (key.name(), half.name()),
        ("plant-7.north", "plant-7.north")
    );
    assert_eq!(key.public(), half.public());
    assert!(!key.is_demo() && !half.is_demo());
    assert!(half.secret().is_none());
    let text = std::fs::read_to_string(&secret).expect("text");
    assert!(
        text.starts_with("# drive-monitor, secret key plant-7.north: keep it"),
        "{text}"
    );
    assert_eq!(text.lines().nth(1).map(str::len), Some(64));
    let [other, _] = new_key(&folder.path().join("b")).expect("a key");
    let other = KeyFile::read(&other, Half::Secret).expect("a key");
    assert_ne!(other.public(), key.public(), "random");
}

#[cfg(unix)]
#[test]
fn nobody_but_its_owner_reads_a_secret_half() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let [secret, _] = new_key(&folder.path().join("a")).expect("a key");
    let mode = std::fs::metadata(secret)
        .expect("there")
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
}

#[test]
fn no_key_is_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    let [secret, public] = new_key(&path).expect("a key");
    let before = std::fs::read(&secret).expect("there");
    let told = new_key(&path).expect_err("exists").to_string();
    assert!(told.contains("a.key: exists already"), "{told}");
    assert_eq!(std::fs::read(&secret).expect("there"), before);
    // The public half alone: no secret half is left that belongs to nothing.
    std::fs::remove_file(&secret).expect("removed");
    let told = new_key(&path).expect_err("exists").to_string();
    assert!(told.contains("a.pub: exists already"), "{told}");
    assert!(!secret.exists() && public.exists());
}

#[test]
fn the_other_half_damaged_text_and_strange_names_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let [secret, public] = new_key(&folder.path().join("a")).expect("a key");
    let told = |file: &Path, half| match KeyFile::read(file, half) {
        Ok(_) => "read".to_owned(),
        Err(error) => error.to_string(),
    };
    assert!(told(&public, Half::Secret).contains("a.pub: is the public half"));
    assert!(told(&secret, Half::Public).contains("a.key: is the secret half"));
    assert!(told(&folder.path().join("none"), Half::Secret).contains("board key new"));
    let whole = std::fs::read_to_string(&secret).expect("text");
    for damaged in [
        "",
        "\n",
        &whole[..whole.len() - 2],
        &whole.replacen("# ", "", 1),
        &format!("{}00\n", whole.trim_end()),
        &whole.replacen("secret", "third", 1),
        &format!("{}g\n", &whole[..whole.len() - 2]),
        "# drive-monitor, secret key a: x\n\u{fffd}\u{fffd}",
    ] {
        std::fs::write(&public, damaged).expect("written");
        assert!(
            told(&public, Half::Secret).contains("is no key"),
            "{damaged:?}"
        );
    }
    for name in ["..", "a b", "a:b", "a\nb"] {
        assert!(new_key(&folder.path().join(name)).is_err(), "{name:?}");
    }
    assert!(new_key(Path::new("")).is_err());
}

#[test]
fn the_demo_key_is_whole_and_says_so() {
    for (half, label) in [(Half::Secret, "secret"), (Half::Public, "public")] {
        let demo = KeyFile::demo(half);
        assert!(demo.is_demo() && demo.digits != [0; 32]);
        assert_eq!(demo.public(), KeyFile::demo(Half::Secret).public());
        let first =
            format!("# drive-monitor, {label} demo key demo: for trying only, everybody has it\n");
        assert!(demo.text().starts_with(&first), "{}", demo.text());
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../keys/demo");
        let file = beside(&file, if half == Half::Secret { "key" } else { "pub" });
        assert_eq!(std::fs::read_to_string(file).expect("there"), demo.text());
    }
    // Under another name it is the demo key all the same.
    let text = KeyFile::demo(Half::Secret)
        .text()
        .replace("demo key demo", "key mine");
    assert!(parse(&text).expect("a key").is_demo());
}
