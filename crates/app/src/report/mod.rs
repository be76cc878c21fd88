//! What a person reads and looks at: [`summary`] of a flight, [`gap`] of a replay, the [`plot`] of both, the [`diagnosis`] with
//! its [`closed_loop`] and what to fly [`next`], either of them as a [`page`], and a [`design`] with
//! its picture, and what was [`identify`](mod@identify)ed.

pub mod closed_loop;
pub mod design;
pub mod design_plot;
pub mod diagnosis;
pub mod gap;
pub mod identify;
pub mod left_over;
pub mod logs;
pub mod measure;
pub mod measure_plot;
pub mod mend;
pub mod missing_force;
pub mod next;
pub mod page;
mod palette;
pub mod plot;
pub mod signals;
mod stages;
pub mod steps;
pub mod summary;
mod table;
