//! The broker's address and our credentials: the config's table `[mqtt]`.
//!
//! The password is in a file of its own, so that neither the config nor a log that holds it contains it.

use serde::{Deserialize, Serialize};
use std::net::IpAddr;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::{fs, io};

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

/// Why a link cannot be set up at all. A broker that does not answer is not one of these.
#[derive(Debug, thiserror::Error)]
pub enum MqttError {
    /// The password's file cannot be read.
    #[error("[mqtt] password_file {}: {cause}; the file holds the password and nothing else", path.display())]
    Password {
        /// The file that was tried.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// MQTT has no password without a user.
    #[error("[mqtt] has a password_file but no user; give `user` as well")]
    NoUser,
    /// A file of `[mqtt.tls]` cannot be used.
    #[error("[mqtt.tls] {key} {}: {cause}; it is a file of PEM text, as `openssl` writes it with -----BEGIN lines", path.display())]
    Pem {
        /// Which file.
        key: &'static str,
        /// The file that was tried.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// A certificate needs its key, and the key its certificate.
    #[error("[mqtt.tls] has a {has} but no {lacks}; give both, or neither")]
    NoPair {
        /// The key that is there.
        has: &'static str,
        /// The key that is not.
        lacks: &'static str,
    },
    /// The cryptography cannot be set up.
    #[error("[mqtt.tls]: {0}; fly without TLS, or report it")]
    Tls(rustls::Error),
    /// The rig's name cannot be part of a topic.
    #[error(
        "[rig] name {0:?} cannot be part of an MQTT topic; use 1 to 64 letters, digits, `-`, `_` or `.`, like \"rig1\""
    )]
    RigName(String),
    /// The system gave no thread.
    #[error("no thread for MQTT: {0}")]
    Thread(io::Error),
}

/// A user and the password for the broker. Not printable.
pub(crate) struct Credentials {
    pub(crate) user: String,
    pub(crate) password: String,
}

impl MqttConfig {
    /// TCP port of the broker.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.port.unwrap_or(if self.tls.is_some() { PORTS.1 } else { PORTS.0 })
    }

    /// How the password may get to others, in sentences that end in what to do.
    #[must_use]
    pub fn exposures(&self) -> Vec<String> {
        let Some(file) = &self.password_file else { return Vec::new() };
        let mut found = Vec::new();
        if let Some(mode) =
            fs::metadata(file).ok().map(|about| about.permissions().mode() & 0o777).filter(|m| m & 7 != 0)
        {
            let path = file.display();
            found.push(format!(
                "[mqtt] password_file {path} has mode {mode:o}, so that every user of this computer has the password; \
                 `chmod 600 {path}`"
            ));
        }
        if self.tls.is_none() && !is_local(&self.host) {
            let host = &self.host;
            found.push(format!(
                "[mqtt] the password goes to {host} unencrypted, and whoever reads the network has it; give \
                 `tls.ca_file`, see `broker-certificates` in docs/live.md"
            ));
        }
        found
    }

    /// Reads the password. `None` where the broker needs none.
    pub(crate) fn credentials(&self) -> Result<Option<Credentials>, MqttError> {
        let password = self.password_file.as_deref().map(read_password).transpose()?;
        match (self.user.clone(), password) {
            (Some(user), password) => Ok(Some(Credentials { user, password: password.unwrap_or_default() })),
            (None, Some(_)) => Err(MqttError::NoUser),
            (None, None) => Ok(None),
        }
    }
}

/// Whether a host is this computer, by its name or address.
fn is_local(host: &str) -> bool {
    host == "localhost" || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// The file's text without the line end that editors add.
fn read_password(path: &Path) -> Result<String, MqttError> {
    let text = fs::read_to_string(path).map_err(|cause| MqttError::Password { path: path.to_owned(), cause })?;
    Ok(text.trim_end_matches(['\r', '\n']).to_owned())
}

#[cfg(test)]
mod tests {
    use super::{MqttConfig, MqttError};
    use std::os::unix::fs::PermissionsExt;

    fn config(text: &str) -> MqttConfig {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_host_is_enough_and_the_port_is_the_registered_one() {
        let plain = config("host = 'localhost'");
        assert_eq!((plain.host.as_str(), plain.port()), ("localhost", 1883));
        assert!(plain.credentials().unwrap().is_none());
        assert_eq!(config("host = 'a'\ntls.ca_file = 'ca.pem'").port(), 8883);
        assert_eq!(config("host = 'a'\nport = 5\ntls.ca_file = 'ca.pem'").port(), 5);
    }

    #[test]
    fn a_misspelt_key_is_refused_with_the_known_ones() {
        let error = toml::from_str::<MqttConfig>("host = 'a'\npasword_file = 'b'").unwrap_err().to_string();
        assert!(error.contains("pasword_file") && error.contains("`password_file`"), "{error}");
    }

    #[test]
    fn the_password_is_the_file_without_its_end_of_line() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), " s3cret \r\n").unwrap();
        let config = MqttConfig { password_file: Some(file.path().into()), ..config("host = 'a'\nuser = 'u'") };
        assert_eq!(config.credentials().unwrap().unwrap().password, " s3cret ");
        assert!(!format!("{config:?}{}", toml::to_string(&config).unwrap()).contains("s3cret"));
    }

    #[test]
    fn a_password_file_that_cannot_be_read_is_named() {
        let error = config("host = 'a'\nuser = 'u'\npassword_file = '/no/such/file'").credentials().err().unwrap();
        assert!(error.to_string().contains("/no/such/file"), "{error}");
    }

    #[test]
    fn a_password_that_others_can_read_or_that_goes_to_another_host_unencrypted_is_warned_of() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mode = |mode| std::fs::set_permissions(file.path(), std::fs::Permissions::from_mode(mode)).unwrap();
        let with = |text: &str| MqttConfig { password_file: Some(file.path().into()), ..config(text) };
        mode(0o640);
        for safe in ["host = 'localhost'", "host = '127.0.0.1'", "host = '::1'", "host = 'pi'\ntls.ca_file = 'ca.pem'"]
        {
            assert!(with(safe).exposures().is_empty(), "{safe}");
        }
        let plain = with("host = 'pi'").exposures();
        assert!(
            plain.len() == 1 && plain[0].contains("pi unencrypted") && plain[0].contains("tls.ca_file"),
            "{plain:?}"
        );
        mode(0o644);
        let open = with("host = 'localhost'").exposures();
        assert!(open.len() == 1 && open[0].contains("mode 644") && open[0].contains("chmod 600"), "{open:?}");
        assert!(config("host = 'pi'").exposures().is_empty());
    }

    #[test]
    fn a_password_without_a_user_is_an_error() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let config = MqttConfig { password_file: Some(file.path().into()), ..config("host = 'a'") };
        assert!(matches!(config.credentials(), Err(MqttError::NoUser)));
    }
}
