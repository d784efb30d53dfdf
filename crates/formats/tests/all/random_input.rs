//! Whatever the bytes: an error or a recording, never a panic, and no finding without a number.

use crate::common::{Folder, gzip, quiet};
use audit::{Expectation, audit};
use formats::read_any;
use proptest::prelude::*;
use recording::{Mapping, Source};

/// Reads bytes as a file of a name with a sidecar and audits what comes out.
fn survive(name: &str, bytes: &[u8], sidecar: &[u8]) {
    let folder = Folder::new("survive");
    let path = folder.file(name, bytes);
    if !sidecar.is_empty() {
        folder.file("x.toml", sidecar);
    }
    match read_any(&path, &Mapping::default(), &mut quiet()) {
        Ok(Source::Recording(recording)) => {
            let audit = audit(&recording, &Expectation::default());
            assert!(
                audit
                    .findings
                    .iter()
                    .all(|finding| finding.value.is_finite())
            );
        }
        Ok(Source::LoadTable(table)) => assert_eq!(table.points().len(), table.len()),
        Err(error) => assert!(matches!(error.exit_code(), 2 | 3) && !error.to_string().is_empty()),
    }
}

fn cell() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => any::<f64>().prop_map(|x| x.to_string()),
        8 => (-400.0..400.0).prop_map(|x: f64| format!("{x:.2}")),
        1 => "[ -~]{0,12}",
    ]
}

fn table() -> impl Strategy<Value = String> {
    let names = "t|va|vb|vc|ia|ib|ic|ic2|speed|torque|vab|vbc|power_watt|current_rms_amp|x";
    let header = prop::collection::vec(names, 1..9);
    let rows = prop::collection::vec(prop::collection::vec(cell(), 1..9), 0..40);
    (header, rows).prop_map(|(header, rows)| {
        let width = header.len();
        let lines = rows.into_iter().enumerate().map(|(k, mut row)| {
            row.resize(width, k.to_string());
            row[0] = k.to_string();
            row.join(",")
        });
        std::iter::once(header.join(","))
            .chain(lines)
            .collect::<Vec<_>>()
            .join("\n")
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn random_bytes_never_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..400),
        sidecar in prop::collection::vec(any::<u8>(), 0..80),
        packed in any::<bool>(),
    ) {
        match packed {
            true => survive("x.csv.gz", &gzip(&bytes), &sidecar),
            false => survive("x.csv", &bytes, &sidecar),
        }
    }

    #[test]
    fn random_tables_never_panic(text in table()) {
        survive("x.csv", text.as_bytes(), b"");
    }

    #[test]
    fn random_signals_never_panic(
        amplitude in prop::sample::select(vec![0.0, 1e-300, 1e-9, 1.0, 1e9, 1e150]),
        step in prop::sample::select(vec![1e-9, 1e-4, 1.0, 1e6]),
        seed in prop::collection::vec(-1.0..1.0f64, 16),
        n in 2..600usize,
    ) {
        let mut text = String::from("t,va,vb,vc,ia,ib,ic,speed\n");
        for k in 0..n {
            let x = |j: usize| amplitude * seed[(k * (j + 1)) % 16];
            let t = k as f64 * step;
            let row: Vec<String> = (0..7).map(|j| x(j).to_string()).collect();
            text.push_str(&format!("{t},{}\n", row.join(",")));
        }
        survive("x.csv", text.as_bytes(), b"supply = \"grid\"");
    }
}
