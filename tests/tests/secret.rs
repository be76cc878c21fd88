//! The broker's password of a flight is kept secret: it is not in a log, which may be passed on, nor in the output,
//! which a service stores.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use system_tests::{Bench, Broker, Ran};

/// Its base64 has no padding and begins at a whole group of bytes, whatever follows.
const PASSWORD: &str = "Zw1eback-und-Kaese-42";
const BASE64: &str = "WncxZWJhY2stdW5kLUthZXNlLTQy";
/// With the user before it, as in HTTP.
const WITH_USER: &str = "cmlnOlp3MWViYWNrLXVuZC1LYWVzZS00Mg";

/// A flight of two seconds with this password: its output, its log's bytes, and the output of `log info`.
fn flown(bench: &Bench, password: &str) -> (Ran, Vec<u8>, String) {
    bench.write("password", format!("{password}\n"));
    // A file that others can read is warned of.
    fs::set_permissions(bench.path("password"), fs::Permissions::from_mode(0o600)).unwrap();
    let ran = bench.run(&["run", "--sim", "--duration", "2", "--log", "f.mcap"]);
    let log = fs::read(bench.path("f.mcap")).unwrap();
    let info = bench.output(&["log", "info", "f.mcap"]);
    fs::remove_file(bench.path("f.mcap")).unwrap();
    (ran, log, info)
}

fn holds(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

#[test]
fn neither_log_nor_screen_holds_the_brokers_password_whether_it_is_right_or_wrong() {
    let bench = Bench::default();
    let broker = Broker::with_user(&bench, "rig", PASSWORD);
    let config = bench.read("config.toml");
    let login = format!("port = {}\nuser = \"rig\"\npassword_file = \"password\"", broker.port);
    assert!(config.contains("port = 1883"));
    bench.write("config.toml", config.replace("port = 1883", &login));

    let (right, right_log, right_info) = flown(&bench, PASSWORD);
    assert_eq!(right.code, Some(0), "{}", right.errors);
    assert!(!right.errors.contains("password_file"), "it is let in: {}", right.errors);
    // The config is in the log, so that a password in it would be as well; a password repeated twice is a wrong one,
    // and refused.
    assert!(holds(&right_log, "password_file"));
    let (wrong, wrong_log, wrong_info) = flown(&bench, &format!("{PASSWORD}{PASSWORD}"));
    assert!(wrong.errors.contains("password_file"), "it is refused: {}", wrong.errors);

    let said = [right.output, right.errors, right_info, wrong.output, wrong.errors, wrong_info].map(String::into_bytes);
    for (k, bytes) in said.iter().chain([&right_log, &wrong_log]).enumerate() {
        for secret in [PASSWORD, BASE64, WITH_USER] {
            assert!(!holds(bytes, secret), "{k}: {secret}");
        }
    }
}
