//! Our credentials at the broker, and how they may get to others.
//!
//! The password is in a file of its own, so that neither the config nor a log that holds it contains it.

use config::mqtt::MqttConfig;
use config::topics::RigNameError;
use std::net::IpAddr;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::{fs, io};

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
    #[error(
        "[mqtt.tls] {key} {}: {cause}; it is a file of PEM text, as `openssl` writes it with -----BEGIN lines",
        path.display()
    )]
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
    #[error(transparent)]
    RigName(#[from] RigNameError),
    /// The system gave no thread.
    #[error("no thread for MQTT: {0}")]
    Thread(io::Error),
}

/// A user and the password for the broker. Not printable.
pub(super) struct Credentials {
    pub(super) user: String,
    pub(super) password: String,
}

/// How the password may get to others, in sentences that end in what to do.
pub(crate) fn exposures(table: &MqttConfig) -> Vec<String> {
    let Some(file) = &table.password_file else { return Vec::new() };
    let mut found = Vec::new();
    if let Some(mode) = fs::metadata(file).ok().map(|about| about.permissions().mode() & 0o777).filter(|m| m & 7 != 0) {
        let path = file.display();
        found.push(format!(
            "[mqtt] password_file {path} has mode {mode:o}, so that every user of this computer has the password; \
             `chmod 600 {path}`"
        ));
    }
    if table.tls.is_none() && !is_local(&table.host) {
        let host = &table.host;
        found.push(format!(
            "[mqtt] the password goes to {host} unencrypted, and whoever reads the network has it; give \
             `tls.ca_file`, see `broker-certificates` in docs/live.md"
        ));
    }
    found
}

/// Reads the password. `None` where the broker needs none.
pub(super) fn credentials(table: &MqttConfig) -> Result<Option<Credentials>, MqttError> {
    let password = table.password_file.as_deref().map(read_password).transpose()?;
    match (table.user.clone(), password) {
        (Some(user), password) => Ok(Some(Credentials { user, password: password.unwrap_or_default() })),
        (None, Some(_)) => Err(MqttError::NoUser),
        (None, None) => Ok(None),
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
    use super::{MqttError, credentials, exposures};
    use config::mqtt::MqttConfig;
    use std::os::unix::fs::PermissionsExt;

    fn config(text: &str) -> MqttConfig {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn the_password_is_the_file_without_its_end_of_line() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), " s3cret \r\n").unwrap();
        let config = MqttConfig { password_file: Some(file.path().into()), ..config("host = 'a'\nuser = 'u'") };
        assert_eq!(credentials(&config).unwrap().unwrap().password, " s3cret ");
        assert!(!format!("{config:?}{}", toml::to_string(&config).unwrap()).contains("s3cret"));
    }

    #[test]
    fn a_password_file_that_cannot_be_read_is_named() {
        let error = credentials(&config("host = 'a'\nuser = 'u'\npassword_file = '/no/such/file'")).err().unwrap();
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
            assert!(exposures(&with(safe)).is_empty(), "{safe}");
        }
        let plain = exposures(&with("host = 'pi'"));
        assert!(
            plain.len() == 1 && plain[0].contains("pi unencrypted") && plain[0].contains("tls.ca_file"),
            "{plain:?}"
        );
        mode(0o644);
        let open = exposures(&with("host = 'localhost'"));
        assert!(open.len() == 1 && open[0].contains("mode 644") && open[0].contains("chmod 600"), "{open:?}");
        assert!(exposures(&config("host = 'pi'")).is_empty());
    }

    #[test]
    fn a_password_without_a_user_is_an_error() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let config = MqttConfig { password_file: Some(file.path().into()), ..config("host = 'a'") };
        assert!(matches!(credentials(&config), Err(MqttError::NoUser)));
    }
}
