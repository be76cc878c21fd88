//! A diagnosis in words, for a terminal.

use super::document::{Interval, effect_intervals, regions};
use super::left_over::left_over;
use super::mend;
use crate::report::kit::page::parts::places;
use control::compensation::Compensation;
use diagnose::{Change, Closed, Diagnosis, Free, Gap, Named, Place, Verdict};
use std::fmt::Write;

/// The verdict in a sentence, then a line for each thing that was found. `compensation`: what was on in flight.
#[must_use]
pub fn words(found: &Diagnosis, compensation: Option<&Compensation>) -> String {
    let mut words = match found.verdict {
        Verdict::NoGap => "No gap: the model forecasts this record as well as noise allows.".to_owned(),
        Verdict::Parameters => {
            "Only base parameters moved; no effect is missing that this record could show.".to_owned()
        }
        Verdict::Effect => "The rig does something that the model lacks.".to_owned(),
        Verdict::Unexplained if !found.residue.is_significant() => {
            "More effects at once than one record proves.".to_owned()
        }
        Verdict::Unexplained => "Something is left that no effect of the catalogue explains.".to_owned(),
        Verdict::InsufficientData => {
            "This record cannot answer, for the reasons above. Fly one with a moving setpoint, at least 30 s in free flight.".to_owned()
        }
    };
    let known = found.intervals();
    for named in &found.effects {
        let _ = write!(words, "\n{}", effect_in_words(named, found, &known, compensation));
    }
    for place in regions(found).iter().take(3) {
        let _ = write!(words, "\nwrong {} (p = {:.3})", place_in_words(place), place.p_value);
    }
    if let Some(shape) = left_over(found) {
        let _ = write!(words, "\n{shape}");
    }
    let [nominal, refitted, mended] = &found.gaps;
    let at = |gap: &Gap| gap.error_mm[2].map_or("–".into(), |mm| format!("{mm:.2}"));
    let floor = mended.floor_mm[2].map_or("–".into(), |mm| format!("{mm:.2}"));
    let _ = write!(
        words,
        "\nerror 1 s ahead, on stretches not fitted to: {} mm as believed, {} refitted, {} mended, {floor} by noise alone",
        at(nominal),
        at(refitted),
        at(mended)
    );
    if let Some(Closed { value, low, high }) = found.closed {
        let [value, low, high] = [value, low, high].map(whole_percent);
        let _ = write!(words, "\n{value} % of the gap is closed ({low} to {high} %)");
    }
    words
}

/// A line for an effect: how sure, what is to be done about it and its numbers with their 90 % intervals; below it what it
/// looks like and how to mend it, unless it is not there.
fn effect_in_words(
    named: &Named,
    found: &Diagnosis,
    known: &[(Free, f64, f64)],
    compensation: Option<&Compensation>,
) -> String {
    let entry = named.candidate.entry;
    let sure = format!("{:<22} {:.0} % sure   ", entry.name, 100.0 * named.probability);
    if named.change == Change::Removed {
        return format!("{sure}believed, and not there: leave it out of the model");
    }
    // As a config takes it: the page's minus is none.
    let plain = |value: f64| format!("{:.*}", places(value), value + 0.0);
    let with_interval = |(name, Interval { value, low, high }): (&str, Interval)| {
        let ends = low.zip(high).map(|(low, high)| format!(" ({} to {})", plain(low), plain(high)));
        format!("{name} = {}{}", plain(value), ends.unwrap_or_default())
    };
    let own = effect_intervals(named, found, known);
    let in_order = entry.params.iter().filter_map(|param| Some((param.name, *own.get(param.name)?)));
    let width = found.dead_zone_width().filter(|_| entry.name == "dead_zone");
    let width = width.map(|(value, low, high)| ("width", Interval { value, low: Some(low), high: Some(high) }));
    let numbers: Vec<String> = in_order.chain(width).map(with_interval).collect();
    let retuned = if named.change == Change::Retuned { "retuned   " } else { "" };
    let twins = match &named.indistinguishable_from[..] {
        [] => String::new(),
        names => format!("   (cannot be told from {})", names.join(", ")),
    };
    let mend = mend::words(&entry, &found.mended.model, compensation);
    format!(
        "{sure}{retuned}{}{twins}\n{:22} in a log: {}\n{:22} mend: {mend}",
        numbers.join(", "),
        "",
        entry.in_a_log,
        ""
    )
}

/// A place as it stands behind "wrong".
fn place_in_words(place: &Place) -> String {
    match place.signal {
        "lag_s" => format!("{:.2} to {:.2} s after the duty moves", place.from, place.to),
        signal => format!("where {signal} is {:.1} to {:.1}", place.from, place.to),
    }
}

/// A share in whole percent; what rounds to 0 has no sign.
pub fn whole_percent(share: f64) -> String {
    format!("{:.0}", (100.0 * share).round() + 0.0)
}

#[cfg(test)]
mod tests {
    use super::whole_percent;

    #[test]
    fn a_share_that_rounds_to_nothing_has_no_sign() {
        assert_eq!([-0.004, 0.004, -0.006, 0.996].map(whole_percent), ["0", "0", "-1", "100"]);
    }
}
