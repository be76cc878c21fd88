//! `airball monitor`: a rig in a terminal; without a terminal, one line a second.

use super::say;
use crate::cli::MonitorArgs;
use crate::mqtt::monitor::Monitor;
use crate::mqtt::monitor::keys::{Deed, deed};
use crate::mqtt::monitor::view::draw;
use crate::mqtt::remote::{Heard, Remote};
use anyhow::{Context, Result, bail};
use config::Config;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event};
use std::io::{IsTerminal, stdin, stdout};
use std::time::{Duration, Instant};

/// How long the first state may take where there is no screen.
const PATIENCE: Duration = Duration::from_secs(10);
/// Time between two checks of keys and messages.
const TURN: Duration = Duration::from_millis(50);
/// Time between two lines.
const LINES: Duration = Duration::from_secs(1);

/// Shows a rig until the user quits.
///
/// # Errors
/// A config without a rig or a broker; a terminal that cannot be drawn on; without a terminal, a rig that sends
/// nothing.
pub fn monitor(args: &MonitorArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.over())?;
    let rig = config.need("monitor", "rig", |tables| tables.rig.as_ref())?;
    let mqtt = config.need("monitor", "mqtt", |tables| tables.mqtt.as_ref())?;
    let remote = Remote::start(mqtt, &rig.name)?;
    let monitor = Monitor::of(&rig.name);
    if args.once || !stdout().is_terminal() || !stdin().is_terminal() {
        let nothing = format!("nothing heard of {} from the broker at {}:{}", rig.name, mqtt.host, mqtt.port());
        return lines(monitor, &remote, args.once, &nothing);
    }
    let mut terminal = ratatui::try_init().context("this terminal cannot be drawn on; try `airball monitor --once`")?;
    let watched = watch(&mut terminal, monitor, &remote);
    ratatui::restore();
    watched
}

/// The screen.
fn watch(terminal: &mut DefaultTerminal, mut monitor: Monitor, remote: &Remote) -> Result<()> {
    loop {
        terminal.draw(|frame| draw(frame, &monitor, Instant::now()))?;
        if let Some(heard) = remote.next(TURN) {
            monitor.hear(heard);
        }
        while event::poll(Duration::ZERO)? {
            let Event::Key(key) = event::read()? else { continue };
            match deed(key) {
                Some(Deed::Quit) => return Ok(()),
                Some(deed) => act(&mut monitor, remote, deed),
                None => {}
            }
        }
    }
}

fn act(monitor: &mut Monitor, remote: &Remote, deed: Deed) {
    if let Some((quantity, payload)) = monitor.command(deed)
        && !remote.send(quantity, &payload)
    {
        monitor.unsent(deed);
    }
}

/// A line a second, or the first one only; an error that begins with `nothing` where no rig is received.
fn lines(mut monitor: Monitor, remote: &Remote, once: bool, nothing: &str) -> Result<()> {
    let (mut due, mut deadline) = (Instant::now(), Some(Instant::now() + PATIENCE));
    let mut lost = String::from("the broker answers, the rig does not: is `airball run` on?");
    loop {
        let heard = remote.next(TURN);
        if let Some(Heard::Lost(why)) = &heard {
            lost = format!("{why}; start one with `mosquitto`, or correct [mqtt] of the config");
        }
        let new = matches!(heard, Some(Heard::State(_)));
        heard.into_iter().for_each(|heard| monitor.hear(heard));
        if new && Instant::now() >= due {
            say(monitor.line().unwrap_or_default())?;
            if once {
                return Ok(());
            }
            (due, deadline) = (Instant::now() + LINES, None);
        }
        if deadline.is_some_and(|deadline| Instant::now() > deadline) {
            bail!("{nothing}: {lost}");
        }
    }
}
