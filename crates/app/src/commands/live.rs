//! `airball live`: writes the page for flying a rig from a browser, and the wall of all rigs.

use super::say;
use crate::cli::LiveArgs;
use crate::report::kit::page;
use crate::report::live::wall::wall;
use crate::report::live::{Place, page as html};
use anyhow::{Result, bail};
use config::Config;
use std::net::SocketAddr;

/// The WebSockets port of `packaging/mosquitto.conf`.
const PORT: u16 = 9001;

/// Writes the page.
///
/// # Errors
/// A config without a rig or a broker, an invalid address, a file that cannot be written.
pub fn live(args: &LiveArgs) -> Result<()> {
    page::may_write(&args.out)?;
    if let Some(path) = &args.wall {
        page::may_write(path)?;
        if path.parent() != args.out.parent() || path == &args.out {
            bail!(
                "--wall {} is not another file of the folder of --out {}; its tiles lead to the page beside it",
                path.display(),
                args.out.display()
            );
        }
    }
    let config = Config::read(&args.config.config, &args.config.over())?;
    let rig = config.need("live", "rig", |tables| tables.rig.as_ref())?;
    let mqtt = config.need("live", "mqtt", |tables| tables.mqtt.as_ref())?;
    if let Some(broker) = args.broker.as_deref().filter(|broker| !is_address(broker)) {
        bail!("--broker {broker:?} is no address of WebSockets; give one like ws://{}:{PORT} or wss://HOST", mqtt.host);
    }
    let fallback = format!("ws://{}:{PORT}", mqtt.host);
    let place = Place { rig: &rig.name, broker: args.broker.as_deref(), fallback: &fallback, login: true };
    page::write(&args.out, &html(&place))?;
    let from = args.broker.as_ref().map_or_else(
        || format!("asks the host that serves it for the broker, as a file {fallback}"),
        |broker| format!("asks {broker}"),
    );
    say(format_args!("page      {}, flies {}; it {from}", args.out.display(), rig.name))?;
    let Some(path) = &args.wall else { return Ok(()) };
    let beside = args.out.file_name().unwrap_or_default().to_string_lossy();
    page::write(path, &wall(&place, &beside))?;
    say(format_args!("wall      {}, shows all rigs of the broker", path.display()))
}

/// The page of a flight that serves it itself.
pub(super) fn local(rig: &str, address: SocketAddr) -> String {
    let server = format!("ws://{address}");
    html(&Place { rig, broker: Some(&server), fallback: &server, login: false })
}

fn is_address(broker: &str) -> bool {
    ["ws://", "wss://"].iter().any(|scheme| broker.strip_prefix(scheme).is_some_and(|host| !host.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::is_address;

    #[test]
    fn an_address_has_a_scheme_of_web_sockets_and_a_host() {
        assert!(is_address("ws://pi.local:9001") && is_address("wss://pi"));
        assert!(!is_address("mqtt://pi") && !is_address("ws://") && !is_address("pi:9001"));
    }
}
