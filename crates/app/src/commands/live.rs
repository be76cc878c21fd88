//! `airball live`: writes the page for flying a rig from a browser.

use super::say;
use crate::cli::LiveArgs;
use crate::config::Config;
use crate::report::kit::page;
use crate::report::live::{Place, page as html};
use anyhow::{Result, bail};

/// The WebSockets port of `packaging/mosquitto.conf`.
const PORT: u16 = 9001;

/// Writes the page.
///
/// # Errors
/// A config without a rig or a broker, an invalid address, a file that cannot be written.
pub fn live(args: &LiveArgs) -> Result<()> {
    page::may_write(&args.out)?;
    let config = Config::read(&args.config.config, &args.config.over())?;
    let rig = config.need("live", "rig", |tables| tables.rig.as_ref())?;
    let mqtt = config.need("live", "mqtt", |tables| tables.mqtt.as_ref())?;
    if let Some(broker) = args.broker.as_deref().filter(|broker| !is_address(broker)) {
        bail!("--broker {broker:?} is no address of WebSockets; give one like ws://{}:{PORT} or wss://HOST", mqtt.host);
    }
    let fallback = format!("ws://{}:{PORT}", mqtt.host);
    page::write(&args.out, &html(&Place { rig: &rig.name, broker: args.broker.as_deref(), fallback: &fallback }))?;
    let from = args.broker.as_ref().map_or_else(
        || format!("asks the host that serves it for the broker, as a file {fallback}"),
        |broker| format!("asks {broker}"),
    );
    say(format_args!("page      {}, flies {}; it {from}", args.out.display(), rig.name))
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
