//! Explains a load-test table: `cargo run --release -p studies --example table -- MOTOR TABLE`.

use discovery::explain;
use formats::read_any;
use motor::MotorFile;
use recording::Source;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let motor = MotorFile::read(arguments.next().ok_or("which motor file?")?)?;
    let table = arguments.next().ok_or("which table?")?;
    let source: Source = read_any(table.as_ref(), &Default::default(), &mut |_| {})?;
    let report = explain(&[source], &motor, &mut |_, _| {})?;
    println!("{report:#?}");
    Ok(())
}
