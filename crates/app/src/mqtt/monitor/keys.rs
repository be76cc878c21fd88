//! The keys of the monitor.

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// The action of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deed {
    /// Quit; the flight goes on.
    Quit,
    /// A value of `set/mode`.
    Mode(&'static str),
    /// Move the setpoint by this distance, mm.
    Nudge(f64),
    /// Say what the keys do.
    Help,
    /// A key without a meaning.
    Unknown(char),
}

impl Deed {
    /// Fan off.
    pub const STOP: Self = Self::Mode("stop");
}

/// Small and large step of the setpoint, mm.
const NUDGES: (f64, f64) = (5.0, 50.0);

/// The keys in words, for the bottom line.
pub const HELP: &str = "↑ ↓ 5 mm   PgUp PgDn 50 mm   space STOP   f fly   p programme   ? keys   q quit";

/// The same in sentences.
pub const ALL: &str = "↑ and ↓ (or k and j) move the setpoint by 5 mm, PgUp and PgDn by 50 mm; \
     space or s stops the fan; f flies again; p goes back to the programme; q quits, and the flight goes on";

/// The action of a key, if any.
#[must_use]
pub fn deed(key: KeyEvent) -> Option<Deed> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Deed::Quit),
        KeyCode::Char('q') => Some(Deed::Quit),
        KeyCode::Char(' ' | 's') => Some(Deed::STOP),
        KeyCode::Char('f') => Some(Deed::Mode("fly")),
        KeyCode::Char('p') => Some(Deed::Mode("programme")),
        KeyCode::Up | KeyCode::Char('k') => Some(Deed::Nudge(NUDGES.0)),
        KeyCode::Down | KeyCode::Char('j') => Some(Deed::Nudge(-NUDGES.0)),
        KeyCode::PageUp => Some(Deed::Nudge(NUDGES.1)),
        KeyCode::PageDown => Some(Deed::Nudge(-NUDGES.1)),
        KeyCode::Char('?' | 'h') => Some(Deed::Help),
        KeyCode::Char(other) => Some(Deed::Unknown(other)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{Deed, deed};
    use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

    fn press(code: KeyCode) -> Option<Deed> {
        deed(KeyEvent::new(code, KeyModifiers::NONE))
    }

    #[test]
    fn space_stops_arrows_nudge_and_a_letter_without_a_meaning_is_told_so() {
        assert_eq!(press(KeyCode::Char(' ')), Some(Deed::STOP));
        assert_eq!(press(KeyCode::Up), Some(Deed::Nudge(5.0)));
        assert_eq!(press(KeyCode::PageDown), Some(Deed::Nudge(-50.0)));
        assert_eq!(press(KeyCode::Char('?')), Some(Deed::Help));
        assert_eq!(press(KeyCode::Char('c')), Some(Deed::Unknown('c')));
        assert_eq!((press(KeyCode::Enter), press(KeyCode::Esc)), (None, None));
    }

    #[test]
    fn control_c_leaves_and_a_key_that_is_let_go_does_nothing() {
        assert_eq!(deed(KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL)), Some(Deed::Quit));
        let up = KeyEvent::new_with_kind(KeyCode::Char(' '), KeyModifiers::NONE, KeyEventKind::Release);
        assert_eq!(deed(up), None);
    }
}
