//! Equations as data: expressions, space vectors of them, and statements in their order.

mod body;
mod evaluate;
mod expr;
mod needed;
mod table;
mod vector;

pub use body::{Body, Statement};
pub use evaluate::Values;
pub use expr::{Compared, Condition, Expr, Function, TableOf, number};
pub use needed::{needed, parameters};
pub use table::Table;
pub use vector::{Vector, clarke, phases};
