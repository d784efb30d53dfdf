//! probe
use std::path::Path;
fn main() {
    let root = std::env::args().nth(1).unwrap();
    for set in std::env::args().skip(2) {
        let dir = Path::new(&root).join(&set);
        let file = motor::MotorFile::read(dir.join("motor.toml")).unwrap();
        let read = |n: &str| {
            recording::read_recording(&dir.join(n), &Default::default(), &mut |_| {}).unwrap()
        };
        discovery::probe::dead(
            &[read("recording.csv.gz"), read("recording_b.csv.gz")],
            &file,
        );
    }
}
