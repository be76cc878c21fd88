//! The broker's address and our credentials: the config's table `[mqtt]`.
//!
//! The password is in a file of its own, so that neither the config nor a log that holds it contains it.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The table `[mqtt]`. Absent: a flight without commands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MqttConfig {
    /// Name or address of the broker.
    pub host: String,
    /// TCP port of the broker; absent: the registered one, 1883, or 8883 with TLS.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<u16>,
    /// User name, where the broker requires one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub user: Option<String>,
    /// File whose text is the user's password.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub password_file: Option<PathBuf>,
    /// Encryption, and the authorities that may sign the broker's certificate; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tls: Option<TlsConfig>,
    /// Experiment files on offer besides the program's own, to be started in flight by their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub experiments: Vec<PathBuf>,
}

/// The table `[mqtt.tls]`. Absent: an unencrypted connection.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TlsConfig {
    /// PEM file of the authorities, one of which must have signed the broker's certificate.
    pub ca_file: PathBuf,
    /// PEM file of our own certificate, where the broker requires one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate_file: Option<PathBuf>,
    /// PEM file of the private key of that certificate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_file: Option<PathBuf>,
}

/// The ports that IANA registered for MQTT, without TLS and with it.
const PORTS: (u16, u16) = (1883, 8883);

impl MqttConfig {
    /// TCP port of the broker.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.port.unwrap_or(if self.tls.is_some() { PORTS.1 } else { PORTS.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::MqttConfig;

    fn config(text: &str) -> MqttConfig {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_host_is_enough_and_the_port_is_the_registered_one() {
        let plain = config("host = 'localhost'");
        assert_eq!((plain.host.as_str(), plain.port()), ("localhost", 1883));
        assert_eq!(config("host = 'a'\ntls.ca_file = 'ca.pem'").port(), 8883);
        assert_eq!(config("host = 'a'\nport = 5\ntls.ca_file = 'ca.pem'").port(), 5);
    }

    #[test]
    fn a_misspelt_key_is_refused_with_the_known_ones() {
        let error = toml::from_str::<MqttConfig>("host = 'a'\npasword_file = 'b'").unwrap_err().to_string();
        assert!(error.contains("pasword_file") && error.contains("`password_file`"), "{error}");
    }
}
