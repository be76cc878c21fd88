//! The live page without a broker: the program serves page and messages itself, to browsers of this computer.
//!
//! ```text
//!  browser ── HTTP: the page ──────────────▶┐
//!     └────── WebSocket: MQTT 3.1.1 ───────▶│ server ── exchange ── pipe ── link ── rings ── loop
//! ```
//!
//! One thread of its own; the link speaks to it as to a broker, through a pipe in memory. It listens on the loopback
//! address alone, and answers only requests for a name of this computer that come from its own page: another web page
//! in the same browser is refused. Visitors may command the rig and nothing else.

mod exchange;
mod server;
mod session;

pub use server::LocalServer;

#[cfg(test)]
mod tests;
