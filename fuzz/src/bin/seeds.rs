//! Writes the seeds of every target into a folder, or prints the targets' names.

use std::path::Path;

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args().nth(1) else {
        fuzz::TARGETS
            .iter()
            .for_each(|target| println!("{}", target.name));
        return Ok(());
    };
    for target in &fuzz::TARGETS {
        let folder = Path::new(&folder).join(target.name);
        std::fs::create_dir_all(&folder)?;
        for (k, seed) in (target.seeds)().iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{k:03}")), seed)?;
        }
    }
    Ok(())
}
