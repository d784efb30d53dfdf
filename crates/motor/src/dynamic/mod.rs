//! The five-state dynamic model: stationary-frame flux linkages, speed and shaft angle.
//!
//! Equations (theory, section 2), amplitude-invariant space vectors:
//!
//! ```text
//! d psi_s/dt = u_s - R_s i_s
//! d psi_r/dt = -R_r i_r + j w_el psi_r
//! tau_em     = (3/2) n_p Im(conj(psi_s) i_s)
//! J d w/dt   = tau_em - B w - tau_load(t, w)
//! ```
//!
//! The model itself knows no physical effect. [`Hooks`] lets one in at every place where physics can
//! differ; [`NoEffects`] compiles to nothing.

mod hooks;
mod linear;
mod model;
mod settled;
mod state;
mod supply;

pub use hooks::{Hooks, NoEffects, Terminal, Winding};
pub use linear::Linear;
pub use model::{Dynamic, Flow, Shaft};
pub use settled::{Rotating, cycle_components};
pub use state::{DynamicState, Extra};
pub use supply::{Harmonic, clarke, phases};
