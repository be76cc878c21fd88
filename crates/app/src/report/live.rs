//! The live page: one file that a broker can serve or a browser open, which flies a rig over MQTT.
//!
//! It has no limit, unit or name of its own; those come from the rig's `about`. The stop button's script comes first
//! and does not depend on the others, so that it works if they fail.

pub mod wall;

use super::kit::page::{CHART_SCRIPT, CHART_STYLE, STYLE, hash_of};
use super::kit::palette;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const MQTT_SCRIPT: &str = include_str!("../../assets/mqtt/mqtt.min.js");
const PLACE_SCRIPT: &str = include_str!("../../assets/live/place.js");
const STOP_SCRIPT: &str = include_str!("../../assets/live/stop.js");
const LIVE_STYLE: &str = include_str!("../../assets/live/live.css");
const CHARTS: &str = include_str!("../../assets/live/charts.js");
const LIVE_SCRIPT: &str = include_str!("../../assets/live/live.js");

/// The rig and the broker of the page.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// The rig's name in topics.
    pub rig: &'a str,
    /// The broker's WebSockets address, wherever the page comes from.
    pub broker: Option<&'a str>,
    /// The same where `broker` is not given and the page is opened as a file; a page from a server uses its own host.
    pub fallback: &'a str,
    /// Whether a broker may ask for a login.
    pub login: bool,
}

/// The page's HTML.
#[must_use]
pub fn page(place: &Place<'_>) -> String {
    let first = [PLACE_SCRIPT, STOP_SCRIPT].join("\n");
    let script = [MQTT_SCRIPT, CHART_SCRIPT, CHARTS, LIVE_SCRIPT].join("\n");
    let style = format!("{}{CHART_STYLE}\n{STYLE}\n{LIVE_STYLE}", palette::stylesheet());
    let page = html! {
        (DOCTYPE)
        html lang="en" data-rig=(place.rig) data-broker=[place.broker] data-fallback=(place.fallback)
            data-served[!place.login] {
            head { (head(&format!("{} – airball live", place.rig), &style, &policy(place, &[&first, &script]))) }
            body data-stale="true" {
                header.bar { (bar(place.rig)) }
                main {
                    (foreign())
                    (connection(place.login))
                    p #others hidden {}
                    div.live {
                        div { (now()) (pictures()) (timing()) }
                        div { (setpoint()) (modes()) (controller()) (gains()) (numbers()) (experiment()) p #reply role="status" {} }
                    }
                }
                footer {
                    p #about {}
                    p { "Charts: uPlot, © Leon Sorokin, MIT licence. MQTT: MQTT.js, © its contributors, MIT licence." }
                }
                script { (PreEscaped(first)) }
                script { (PreEscaped(script)) }
            }
        }
    };
    page.into_string()
}

/// The head of a page of one file.
fn head(title: &str, style: &str, policy: &str) -> Markup {
    html! {
        meta charset="utf-8";
        meta name="viewport" content="width=device-width, initial-scale=1";
        meta http-equiv="Content-Security-Policy" content=(policy);
        meta name="generator" content=(concat!("airball ", env!("CARGO_PKG_VERSION")));
        // A browser requests an icon where none is named.
        link rel="icon" href="data:,";
        title { (title) }
        style { (PreEscaped(style)) }
    }
}

/// What the page may do: run these scripts, and connect to its broker.
fn policy(place: &Place<'_>, scripts: &[&str]) -> String {
    let hashes: Vec<_> = scripts.iter().map(|script| format!("'sha256-{}'", hash_of(script))).collect();
    let hosts = place.broker.and_then(hosts_of).unwrap_or_else(|| "ws: wss:".to_owned());
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; script-src {}; connect-src {hosts}; img-src data:; base-uri 'none'; form-action 'none'",
        hashes.join(" ")
    )
}

/// The sources of a policy that allow every port of a broker's host and no other host. `None`: a policy cannot name it.
fn hosts_of(broker: &str) -> Option<String> {
    let (_, place) = broker.split_once("://")?;
    let host = place.split(['/', '?', '#']).next()?.split(':').next()?;
    let fit = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '.');
    (!host.is_empty() && host.chars().all(fit)).then(|| format!("ws://{host}:* wss://{host}:*"))
}

fn bar(rig: &str) -> Markup {
    html! {
        button #stop type="button" { "STOP" }
        h1 { (rig) }
        p role="status" { span.word #link data-good="false" { "no connection yet" } " " span.word #rig-state data-good="false" { "rig unknown" } }
        p #stop-said role="alert" {}
        p #fault role="alert" {}
        p #last-fault {}
    }
}

fn now() -> Markup {
    let value = |class: &str, id: &str, name: &str, unit: &str| html! { div class=(class) { dt { (name) } dd { span id=(id) { "–" } small { " " (unit) } } } };
    let words = |id: &str, name: &str| html! { div { dt { (name) } dd.text id=(id) { "–" } } };
    html! {
        dl.now {
            (value("of-setpoint", "setpoint", "Setpoint", "mm"))
            (value("of-position", "position", "Position", "mm"))
            (value("of-duty", "duty", "Duty", "%"))
            div { dt { "Mode" } dd.text { span #mode role="status" { "–" } } }
            (words("flying-controller", "Controller"))
            (words("experiment", "Experiment"))
        }
    }
}

fn pictures() -> Markup {
    html! {
        div #height-chart role="img" aria-label="Setpoint and position over the last half minute; their values stand above" {}
        div #duty-chart role="img" aria-label="Duty over the last half minute; its value stands above" {}
        p.small { label { input #full type="checkbox" disabled; "Draw every cycle, not ten a second" } " " span #rate {} }
    }
}

fn timing() -> Markup {
    html! {
        h2 { "Lateness of the cycles" }
        p.small #lateness { "–" }
        p.small #late {}
    }
}

fn setpoint() -> Markup {
    html! {
        fieldset {
            legend { "Setpoint" }
            label for="slider" { "Height, mm" }
            input #slider type="range" min="0" max="1" step="1";
            form.row #setpoint-form {
                label { "Number, mm" input #wanted type="number" step="any" inputmode="decimal" required; }
                button type="submit" { "Send there" }
            }
            p.hint #limits {}
        }
    }
}

fn modes() -> Markup {
    html! {
        fieldset {
            legend { "Fan" }
            div.row {
                button #fly type="button" { "Fly again" }
                button #programme type="button" { "Back to the programme" }
            }
        }
    }
}

fn controller() -> Markup {
    html! {
        fieldset {
            legend { "Controller" }
            label for="controller" { "Flies, from now on" }
            select #controller {}
        }
    }
}

fn gains() -> Markup {
    html! {
        fieldset #gain-set {
            legend { "Gains of the PID" }
            form #gain-form {
                div #gains {}
                p #critical {}
                p #gain-warning role="status" {}
                button type="submit" { "Change together" }
            }
        }
    }
}

fn numbers() -> Markup {
    html! {
        fieldset #number-set {
            legend { "All numbers" }
            details {
                summary { "Controllers, compensation and observer" }
                form #number-form {
                    div #numbers {}
                    div.row {
                        button type="submit" { "Change numbers together" }
                        button #undo type="button" { "Undo the last change" }
                    }
                }
            }
        }
    }
}

fn experiment() -> Markup {
    html! {
        fieldset {
            legend { "Experiment" }
            form.row #experiment-form {
                label { "Flown once, then the programme" select #experiments {} }
                button type="submit" { "Start" }
            }
        }
    }
}

/// Shown where the page's address names the broker of another host.
fn foreign() -> Markup {
    html! {
        div #foreign role="alert" hidden {
            p #foreign-said {}
            button #foreign-use type="button" { "Use this broker" }
        }
    }
}

fn connection(login: bool) -> Markup {
    html! {
        details #connection hidden[!login] {
            summary { "Connection" }
            form.row #connection-form {
                label { "User" input #user type="text" autocomplete="username"; }
                label { "Password" input #password type="password" autocomplete="current-password"; }
                button type="submit" { "Connect" }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{LIVE_SCRIPT, MQTT_SCRIPT, PLACE_SCRIPT, Place, STOP_SCRIPT, page};

    const PLACE: Place<'_> = Place { rig: "rig1", broker: None, fallback: "ws://localhost:9001", login: true };

    #[test]
    fn no_script_ends_early_or_loads_another() {
        for script in [PLACE_SCRIPT, STOP_SCRIPT, LIVE_SCRIPT, MQTT_SCRIPT] {
            assert!(!script.to_lowercase().contains("</script"));
        }
        let page = page(&PLACE);
        assert_eq!(page.matches("<script").count(), 2);
        assert!(!page.contains("src=\"") && !page.contains("@import"));
    }

    #[test]
    fn what_a_stranger_wrote_into_a_config_stays_words() {
        let page = page(&Place { rig: "\"><img src=x>", broker: Some("ws://\"><b>"), ..PLACE });
        assert!(!page.contains("<img") && !page.contains("\"><b>"));
    }

    #[test]
    fn a_page_for_one_broker_may_speak_to_its_host_alone() {
        let allowed = |broker| page(&Place { broker, ..PLACE }).contains("connect-src ws://b.local:* wss://b.local:*;");
        assert!(allowed(Some("wss://b.local:1/mqtt")) && !allowed(None));
        for odd in ["ws://a;script-src *", "ws://[::1]:9001", "ws://user@host", "ws://"] {
            assert!(page(&Place { broker: Some(odd), ..PLACE }).contains("connect-src ws: wss:;"), "{odd}");
        }
    }

    #[test]
    fn a_broker_is_named_only_where_one_was_given() {
        assert!(!page(&PLACE).contains("data-broker"));
        assert!(page(&Place { broker: Some("wss://b:1"), ..PLACE }).contains("data-broker=\"wss://b:1\""));
    }

    #[test]
    fn a_page_that_a_flight_serves_speaks_of_no_broker() {
        assert!(!page(&PLACE).contains("data-served"));
        assert!(page(&Place { login: false, ..PLACE }).contains(" data-served"));
        assert!(STOP_SCRIPT.contains("the flight") && LIVE_SCRIPT.contains("accepted: "));
    }
}
