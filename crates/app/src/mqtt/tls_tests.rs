//! Tests of TLS with a real broker and an authority made for the test.

use super::credentials::MqttError;
use super::link::{Endpoint, Link};
use super::link_support::{about, start};
use super::network;
use super::outage::Outage;
use super::owner::Nobody;
use super::test_broker::{Broker, config};
use config::mqtt::{MqttConfig, TlsConfig};
use config::topics::Topics;
use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, DnType, IsCa, KeyPair};
use rumqttc::{Client, ConnectionError, Event, Packet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// An authority, and the folder with its signed certificates.
struct Authority {
    issuer: CertifiedIssuer<'static, KeyPair>,
    folder: TempDir,
}

impl Authority {
    fn new(name: &str) -> Self {
        let mut params = CertificateParams::new(Vec::new()).unwrap();
        params.distinguished_name.push(DnType::CommonName, name);
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let issuer = CertifiedIssuer::self_signed(params, KeyPair::generate().unwrap()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("ca.pem"), issuer.pem()).unwrap();
        Self { issuer, folder }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A certificate for `name` and its key, in files of that name.
    fn sign(&self, name: &str) -> (PathBuf, PathBuf) {
        let key = KeyPair::generate().unwrap();
        let mut params = CertificateParams::new([name.to_owned()]).unwrap();
        params.distinguished_name.push(DnType::CommonName, name);
        let certificate = params.signed_by(&key, &self.issuer).unwrap();
        let (signed, secret) = (self.file(&format!("{name}.pem")), self.file(&format!("{name}.key")));
        fs::write(&signed, certificate.pem()).unwrap();
        fs::write(&secret, key.serialize_pem()).unwrap();
        (signed, secret)
    }

    /// A broker with a certificate for `name`.
    fn broker(&self, name: &str, more: &str) -> Broker {
        let (certificate, key) = self.sign(name);
        let files = [("cafile", self.file("ca.pem")), ("certfile", certificate), ("keyfile", key)];
        let lines = files.map(|(key, path)| format!("{key} {}\n", path.display())).concat();
        Broker::with_access(&format!("allow_anonymous true\n{lines}{more}"))
    }

    fn trusted(&self) -> TlsConfig {
        TlsConfig { ca_file: self.file("ca.pem"), certificate_file: None, key_file: None }
    }
}

fn over_tls(broker: &Broker, tls: TlsConfig) -> MqttConfig {
    MqttConfig { tls: Some(tls), ..config(broker.port) }
}

/// Connects once: the broker's acknowledgement, or the line for standard error.
fn connect(config: &MqttConfig) -> Result<(), String> {
    let topics = Topics::new("rig1").unwrap();
    let (_client, mut connection) =
        Client::builder(network::options(&Endpoint::Broker(config), "rig1", "1", &topics).unwrap()).build();
    let said = |cause: &ConnectionError| Outage::new(Some("broker".into())).began(cause).unwrap();
    match connection.recv().unwrap() {
        Ok(Event::Incoming(Packet::ConnAck(_))) => Ok(()),
        Ok(other) => panic!("{other:?}"),
        Err(cause) => Err(said(&cause)),
    }
}

fn refused(config: &MqttConfig, words: [&str; 2]) {
    let line = connect(config).unwrap_err();
    assert!(words.iter().all(|word| line.contains(word)), "{line}");
}

#[test]
fn a_broker_whose_authority_is_ours_is_connected_to_by_address_and_the_link_works() {
    let authority = Authority::new("ours");
    let broker = authority.broker("127.0.0.1", "");
    let config = over_tls(&broker, authority.trusted());
    assert_eq!(connect(&config), Ok(()));
    let (link, _mailbox) = start(&config);
    link.stop(None);
}

#[test]
fn a_broker_of_another_authority_is_refused_with_the_file_to_mend() {
    let (theirs, ours) = (Authority::new("theirs"), Authority::new("ours"));
    let broker = theirs.broker("127.0.0.1", "");
    refused(&over_tls(&broker, ours.trusted()), ["UnknownIssuer", "`ca_file`"]);
}

#[test]
fn a_certificate_for_another_host_is_refused_with_the_key_to_mend() {
    let authority = Authority::new("ours");
    let broker = authority.broker("broker.example", "");
    refused(&over_tls(&broker, authority.trusted()), ["not valid for name", "`host`"]);
}

#[test]
fn a_broker_that_asks_for_a_certificate_gets_ours_and_says_so_where_there_is_none() {
    let authority = Authority::new("ours");
    let broker = authority.broker("127.0.0.1", "require_certificate true");
    refused(&over_tls(&broker, authority.trusted()), ["ertificate", "`certificate_file`"]);
    let (certificate, key) = authority.sign("rig1");
    let ours = TlsConfig { certificate_file: Some(certificate), key_file: Some(key), ..authority.trusted() };
    assert_eq!(connect(&over_tls(&broker, ours)), Ok(()));
}

#[test]
fn tls_to_a_port_without_it_is_told_which_port_to_try() {
    let (authority, plain) = (Authority::new("ours"), Broker::start());
    refused(&over_tls(&plain, authority.trusted()), ["TLS", "8883"]);
}

/// The error of a link with these files.
fn why(tls: TlsConfig) -> String {
    let config = MqttConfig { tls: Some(tls), ..config(1) };
    Link::start(&Endpoint::Broker(&config), &about(), None, &Arc::default(), Box::new(Nobody))
        .err()
        .unwrap()
        .to_string()
}

#[test]
fn files_that_hold_no_certificate_or_not_its_key_are_named() {
    let authority = Authority::new("ours");
    let (certificate, key) = authority.sign("rig1");
    let (_, another) = authority.sign("rig2");
    let with = |ca: &Path, certificate: &Path, key: &Path| TlsConfig {
        ca_file: ca.into(),
        certificate_file: Some(certificate.into()),
        key_file: Some(key.into()),
    };
    let ca = authority.file("ca.pem");
    assert!(why(with(Path::new("/no/ca.pem"), &certificate, &key)).contains("ca_file /no/ca.pem"));
    assert!(why(with(&key, &certificate, &key)).contains("holds no certificate"));
    assert!(why(with(&ca, &key, &key)).starts_with("[mqtt.tls] certificate_file"));
    for not_its_key in [&certificate, &another] {
        assert!(why(with(&ca, &certificate, not_its_key)).starts_with("[mqtt.tls] key_file"));
    }
}

#[test]
fn a_certificate_without_its_key_is_an_error() {
    let authority = Authority::new("ours");
    let (certificate, key) = authority.sign("rig1");
    let alone = TlsConfig { certificate_file: Some(certificate), ..authority.trusted() };
    assert!(matches!(super::tls::client(&alone), Err(MqttError::NoPair { lacks: "key_file", .. })));
    let alone = TlsConfig { key_file: Some(key), ..authority.trusted() };
    assert!(matches!(super::tls::client(&alone), Err(MqttError::NoPair { lacks: "certificate_file", .. })));
}
