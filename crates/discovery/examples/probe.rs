//! probe
use std::path::Path;
fn main() {
    let root = std::env::args().nth(1).unwrap();
    let sets: Vec<String> = std::env::args().skip(2).collect();
    for set in sets {
        let dir = Path::new(&root).join(&set);
        let file = motor::MotorFile::read(dir.join("motor.toml")).unwrap();
        let read = |n: &str| {
            recording::read_recording(&dir.join(n), &Default::default(), &mut |_| {}).unwrap()
        };
        let t = std::time::Instant::now();
        let (a, b) = (read("recording.csv.gz"), read("recording_b.csv.gz"));
        println!("{set}: read {:.2}s", t.elapsed().as_secs_f64());
        discovery::probe::probe(&[a.clone(), b.clone()], &file);
        discovery::probe::probe(&[b, a], &file);
    }
}
