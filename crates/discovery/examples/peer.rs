//! One table over recordings with a known hidden effect: fit a prove b, and fit b prove a.
use std::path::Path;
fn main() {
    let root = std::env::args().nth(1).unwrap();
    for set in std::env::args().skip(2) {
        let dir = Path::new(&root).join(&set);
        let file = motor::MotorFile::read(dir.join("motor.toml")).unwrap();
        let read = |n: &str| {
            recording::read_recording(&dir.join(n), &Default::default(), &mut |_| {}).unwrap()
        };
        let (a, b) = (read("recording.csv.gz"), read("recording_b.csv.gz"));
        println!("{set}");
        discovery::probe::explain(&[a.clone(), b.clone()], &file);
        discovery::probe::explain(&[b, a], &file);
    }
}
