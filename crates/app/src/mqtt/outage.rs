//! Messages on standard error when the connection to the broker changes: one line per change, however often it is
//! tried.

use super::hearing::too_large;
use super::tls;
use rumqttc::{ConnectReturnCode, ConnectionError};

/// The last message.
#[derive(Debug)]
pub(super) struct Outage {
    /// `host:port`; `None`: the program's own server, of which nothing need be said.
    broker: Option<String>,
    /// `None` before the first message.
    connected: Option<bool>,
    /// The advice of the last message of an outage: another kind of cause has another.
    advice: Option<&'static str>,
}

impl Outage {
    pub(super) const fn new(broker: Option<String>) -> Self {
        Self { broker, connected: None, advice: None }
    }

    /// The line for a connection, unless already written.
    pub(super) fn over(&mut self) -> Option<String> {
        let new = self.connected.replace(true) != Some(true);
        let broker = self.broker.as_ref().filter(|_| new)?;
        Some(format!("note: mqtt: connected to the broker at {broker}"))
    }

    /// The line for a refused or lost connection, unless one of this kind is already written.
    pub(super) fn began(&mut self, cause: &ConnectionError) -> Option<String> {
        let hint = hint(cause);
        let is_known = self.advice.replace(hint) == Some(hint);
        let what = match self.connected.replace(false) {
            Some(false) if is_known => return None,
            Some(true) => "lost the broker",
            Some(false) | None => "no broker",
        };
        let broker = self.broker.as_ref()?;
        Some(format!("warning: mqtt: {what} at {broker}: {cause}; the flight goes on without commands. {hint}"))
    }
}

/// The next step for the user.
fn hint(cause: &ConnectionError) -> &'static str {
    use ConnectReturnCode::{BadUserNamePassword, NotAuthorized};
    match cause {
        ConnectionError::ConnectionRefused(BadUserNamePassword | NotAuthorized) => {
            "Check `user` and `password_file` of [mqtt]."
        }
        _ if too_large(cause).is_some() => {
            "Somebody sent a huge message; if it is retained, remove it: mosquitto_pub -r -n -t TOPIC."
        }
        _ => tls::hint(cause)
            .unwrap_or("Start one with `mosquitto`, or correct host and port of [mqtt]; the rig tries again."),
    }
}

#[cfg(test)]
mod tests {
    use super::Outage;
    use rumqttc::{ConnectReturnCode, ConnectionError};

    #[test]
    fn an_outage_and_its_end_are_said_once_each() {
        let mut outage = Outage::new(Some("localhost:1883".into()));
        let line = outage.began(&ConnectionError::NetworkTimeout).unwrap();
        assert!(
            line.contains("no broker at localhost:1883: Network timeout") && line.contains("`mosquitto`"),
            "{line}"
        );
        assert_eq!(outage.began(&ConnectionError::NetworkTimeout), None);
        assert!(outage.over().is_some());
        assert_eq!(outage.over(), None);
        assert!(outage.began(&ConnectionError::NetworkTimeout).unwrap().contains("lost"));
    }

    #[test]
    fn an_outage_that_becomes_a_refusal_is_said_again_and_once() {
        let mut outage = Outage::new(Some("localhost:1883".into()));
        let refused = ConnectionError::ConnectionRefused(ConnectReturnCode::BadUserNamePassword);
        assert!(outage.began(&ConnectionError::NetworkTimeout).is_some());
        assert!(outage.began(&refused).unwrap().contains("`password_file`"));
        assert_eq!(outage.began(&refused), None);
    }

    #[test]
    fn a_refused_user_is_told_which_keys_to_check() {
        let cause = ConnectionError::ConnectionRefused(ConnectReturnCode::NotAuthorized);
        assert!(Outage::new(Some(String::new())).began(&cause).unwrap().contains("`password_file`"));
    }
}
