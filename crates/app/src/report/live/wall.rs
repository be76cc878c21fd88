//! The wall: one page with a tile for each rig of a broker, which leads to the live page of that rig.

use super::{LIVE_STYLE, MQTT_SCRIPT, PLACE_SCRIPT, Place, connection, foreign, head, policy};
use crate::report::kit::page::STYLE;
use crate::report::kit::palette;
use maud::{DOCTYPE, PreEscaped, html};

const WALL_SCRIPT: &str = include_str!("../../../assets/live/wall.js");
const WALL_STYLE: &str = include_str!("../../../assets/live/wall.css");

/// The wall's HTML; `live_page` is the file of the live page, beside it.
#[must_use]
pub fn wall(place: &Place<'_>, live_page: &str) -> String {
    let script = [MQTT_SCRIPT, WALL_SCRIPT].join("\n");
    let style = format!("{}{STYLE}\n{LIVE_STYLE}\n{WALL_STYLE}", palette::stylesheet());
    let policy = policy(place, &[PLACE_SCRIPT, &script]);
    let page = html! {
        (DOCTYPE)
        html lang="en" data-rig=(place.rig) data-broker=[place.broker] data-fallback=(place.fallback) data-page=(live_page) {
            head { (head("Rigs – airball live", &style, &policy)) }
            body {
                header.bar {
                    h1 { "Rigs" }
                    p #count role="status" {}
                }
                main {
                    (foreign())
                    (connection(place.login))
                    ul #rigs aria-label="Rigs of the broker" {}
                    p #none hidden { "No rig has been heard of. Start one with " code { "airball run" } ", connected to this broker." }
                }
                footer { p { "MQTT: MQTT.js, © its contributors, MIT licence." } }
                script { (PreEscaped(PLACE_SCRIPT)) }
                script { (PreEscaped(script)) }
            }
        }
    };
    page.into_string()
}

#[cfg(test)]
mod tests {
    use super::{Place, WALL_SCRIPT, wall};

    #[test]
    fn the_wall_is_one_file_that_leads_to_the_page_beside_it_and_commands_nothing() {
        let place = Place { rig: "rig1", broker: None, fallback: "ws://localhost:9001", login: true };
        let page = wall(&place, "a\"b.html");
        assert!(page.contains("data-page=\"a&quot;b.html\"") && !page.contains("src=\"") && !page.contains("/set/"));
        assert!(!WALL_SCRIPT.to_lowercase().contains("</script") && !WALL_SCRIPT.contains("publish"));
    }
}
