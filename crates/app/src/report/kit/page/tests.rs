use super::made::Made;
use super::{Page, Record, Section, policy};
use crate::report::kit::palette::RECORDED;
use crate::report::kit::plot::{Diagram, Line};
use maud::html;

const HOSTILE: &str = "</script><script>alert(1)</script>\"' onload=x";

fn page() -> String {
    let line = Line { label: "recorded", colour: RECORDED, points: vec![(0.0, 1.0), (1.0, 2.0)] };
    let record = Record { diagrams: vec![Diagram { lines: vec![line], ..Diagram::default() }] };
    let sections = vec![Section::across("record", "The record", record.still(&[HOSTILE]))];
    let first = html! { (super::parts::to_copy("id", HOSTILE, HOSTILE)) };
    Page {
        kind: "test",
        made: &Made::by(std::iter::once(HOSTILE.into())),
        from: vec![HOSTILE.into()],
        answer: HOSTILE,
        first,
        sections,
        record: &record,
    }
    .render()
}

#[test]
fn words_of_strangers_stay_words() {
    let page = page();
    assert_eq!(page.matches("<script").count(), 2, "the record and the script of the page");
    assert_eq!(page.matches("alert(1)").count(), page.matches("&lt;script&gt;alert(1)").count());
    assert!(!page.contains("\"' onload"), "an attribute was left");
}

#[test]
fn the_only_script_that_may_run_is_that_of_the_page() {
    let page = page();
    let script = page.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
    // Inside an attribute, quotes are written as entities.
    assert!(page.contains(&policy(script)), "{}", policy(script));
    assert!(policy(script).starts_with("default-src 'none'"));
    // Expected value by OpenSSL: printf 'alert(1)' | openssl dgst -sha256 -binary | base64
    assert!(policy("alert(1)").contains("'sha256-bhHHL3z2vDgxUt0W3dWQOrprscmda2Y5pLsLg4GF+pI='"));
}

#[test]
fn nothing_in_a_page_is_asked_of_a_network() {
    let page = page();
    for word in ["src=\"http", "href=\"http", "url(", "@import", "fetch(", "XMLHttpRequest"] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
fn a_sign_becomes_a_minus_and_a_hyphen_within_words_stays() {
    let words = super::parts::minus("steady-state, -0.2 to 1e-6, (-3), 2026-01-02, --patch");
    assert_eq!(words, "steady-state, −0.2 to 1e-6, (−3), 2026-01-02, --patch");
}

#[test]
fn a_command_is_broken_between_its_words_alone() {
    let typed = super::parts::command("airball run --log").into_string();
    assert_eq!(typed, "<code class=\"typed\"><span>airball</span> <span>run</span> <span>--log</span></code>");
    assert!(super::STYLE.contains(".typed span { display: inline-block;"));
}

#[test]
fn the_command_of_a_page_can_be_given_to_a_shell() {
    let words = ["diagnose", "my log.csv", "--patch", "it's.toml", "", "$(rm)"].map(String::from);
    assert_eq!(
        Made::by(words.into_iter()).command(),
        "airball diagnose 'my log.csv' --patch 'it'\\''s.toml' '' '$(rm)'"
    );
}
