//! The Python package `drivemon`, its part in Rust: motors, recordings, and the questions of the commands.
//!
//! `python/drivemon` wraps it into objects with names, units and tables; `docs/python.md` shows it from outside. Answers come from
//! the functions that the commands call (`report::study`), so that both say the same, bit for bit. Each question runs on a thread
//! of its own without Python's lock (`work`); numbers of other libraries are lent, not copied (`lend`).

mod answer;
mod batch;
mod campaign;
mod errors;
mod lend;
mod motor;
mod questions;
mod source;
mod table;
mod work;

use pyo3::prelude::*;

#[pymodule]
fn _drivemon(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<motor::Motor>()?;
    module.add_class::<source::Recording>()?;
    module.add_class::<answer::Answer>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<batch::Batch>()?;
    module.add_class::<campaign::Plan>()?;
    module.add_function(wrap_pyfunction!(campaign::merge, module)?)?;
    questions::add(module)
}
