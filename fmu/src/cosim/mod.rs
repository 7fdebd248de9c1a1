//! The co-simulation algorithm (also called the master): components that are connected output to
//! input and step together with one fixed communication step size.
//!
//! A [`Component`] is an FMU ([`FmuComponent`]) or anything in Rust that implements the trait, such as a
//! diagnoser. A [`System`] holds components, [`connect`](System::connect)ions, external
//! [`input`](System::input)s from recordings and what to [`record`](System::record);
//! [`run`](System::run) initialises it, steps it and gives back the recording. A system can also be
//! read from a file: SSP's `.ssd` and `.ssp`, or a `.toml` of our own ([`open`]).
//!
//! Communication points are `t_k = start + k h`. In **Gauss-Seidel** components step one after the other,
//! so that one which comes later sees the outputs at `t_k+1` of those before it; in **Jacobi** all see
//! the outputs at `t_k`. Both hold inputs over the step and are of first order in `h` in what crosses
//! a connection (Kubler and Schiehlen 2000, "Two methods of simulator coupling").

mod component;
mod connector;
mod document;
mod error;
mod fmu_component;
mod graph;
mod initial;
mod open;
mod run;
mod ssp;
mod system;
mod text_form;

pub use component::{Component, Failure, Phase, Port, PortKind, Ports, Window};
pub use document::Document;
pub use error::{Error, ReadError};
pub use fmu_component::FmuComponent;
pub use open::open;
pub use run::{End, Outcome};
pub use system::{Algorithm, Experiment, System};
