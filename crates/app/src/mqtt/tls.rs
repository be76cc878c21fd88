//! TLS to the broker, and the messages for certificates that do not match.
//!
//! The rig trusts the authorities of one file and no others, so that a broker with an authority of its own, made with
//! `openssl`, is as good as a commercial one. The cryptography is `ring`, passed to each connection explicitly: no
//! global provider has to be installed.

use super::credentials::MqttError;
use config::mqtt::TlsConfig;
use rumqttc::ConnectionError;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{CertificateError, ClientConfig, RootCertStore, crypto::ring};
use std::error::Error;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// The client configuration of TLS, from the files of `[mqtt.tls]`.
pub(super) fn client(table: &TlsConfig) -> Result<Arc<ClientConfig>, MqttError> {
    let mut trusted = RootCertStore::empty();
    for authority in certificates("ca_file", &table.ca_file)? {
        trusted.add(authority).map_err(|cause| pem("ca_file", &table.ca_file, &cause))?;
    }
    let provider = Arc::new(ring::default_provider());
    let client = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let client = client.map_err(MqttError::Tls)?.with_root_certificates(trusted);
    let client = match (&table.certificate_file, &table.key_file) {
        (None, None) => client.with_no_client_auth(),
        (Some(certificate), Some(key)) => {
            let chain = certificates("certificate_file", certificate)?;
            let secret = PrivateKeyDer::from_pem_file(key).map_err(|cause| pem("key_file", key, &cause))?;
            client.with_client_auth_cert(chain, secret).map_err(|cause| pem("key_file", key, &cause))?
        }
        (Some(_), None) => return Err(MqttError::NoPair { has: "certificate_file", lacks: "key_file" }),
        (None, Some(_)) => return Err(MqttError::NoPair { has: "key_file", lacks: "certificate_file" }),
    };
    Ok(Arc::new(client))
}

/// All certificates of a file, at least one.
fn certificates(key: &'static str, path: &Path) -> Result<Vec<CertificateDer<'static>>, MqttError> {
    let read = CertificateDer::pem_file_iter(path).and_then(Iterator::collect);
    let found: Vec<_> = read.map_err(|cause| pem(key, path, &cause))?;
    if found.is_empty() { Err(pem(key, path, &"it holds no certificate")) } else { Ok(found) }
}

fn pem(key: &'static str, path: &Path, cause: &dyn std::fmt::Display) -> MqttError {
    MqttError::Pem { key, path: path.to_owned(), cause: cause.to_string() }
}

/// The next step for the user when a connection failed because of TLS; `None` where TLS was not the cause.
pub(super) fn hint(cause: &ConnectionError) -> Option<&'static str> {
    const NO_TLS: &str =
        "The broker may not speak TLS at this port: correct `port` of [mqtt], usually 8883, or remove [mqtt.tls].";
    Some(match failure(cause) {
        None => return matches!(cause, ConnectionError::Tls(_)).then_some(NO_TLS),
        Some(rustls::Error::InvalidMessage(_)) => NO_TLS,
        Some(rustls::Error::InvalidCertificate(why)) => certificate_hint(why),
        Some(rustls::Error::AlertReceived(_)) => {
            "The broker refused us: where it asks for certificates, give `certificate_file` and `key_file` of [mqtt.tls]."
        }
        Some(_) => "Check [mqtt.tls] against the broker's listener.",
    })
}

const fn certificate_hint(why: &CertificateError) -> &'static str {
    match why {
        CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. } => {
            "The broker's certificate is for another name: give `host` of [mqtt] as the certificate has it."
        }
        CertificateError::Expired
        | CertificateError::ExpiredContext { .. }
        | CertificateError::NotValidYet
        | CertificateError::NotValidYetContext { .. } => {
            "Check the clock with `date`, for a Pi Zero keeps none over a power cut; then the certificate's dates."
        }
        _ => "No authority in `ca_file` of [mqtt.tls] signed the broker's certificate: copy the broker's `cafile`.",
    }
}

/// The TLS error at any depth of the error.
fn failure<'a>(cause: &'a (dyn Error + 'static)) -> Option<&'a rustls::Error> {
    let mut link = Some(cause);
    while let Some(cause) = link {
        // An I/O error does not include its inner error in the chain of sources.
        let carried = cause.downcast_ref::<io::Error>().and_then(io::Error::get_ref);
        let carried = carried.and_then(|error| error.downcast_ref()).or_else(|| cause.downcast_ref());
        if carried.is_some() {
            return carried;
        }
        link = cause.source();
    }
    None
}
