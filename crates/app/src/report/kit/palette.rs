//! The colours of every picture and page: the same colour for the same signal, in a light and in a dark theme.
//!
//! Recorded is the text's own black, the belief vermilion and the mended model blue: the pair that people with
//! red-green colour blindness distinguish best. Source of the hues: Okabe and Ito, "Color universal design", 2008,
//! darkened for the light theme and lightened for the dark one. Contrast by WCAG 2.2: at least 4.5 to 1, so that a
//! label may have the colour of its line.

use plotters::style::RGBColor;
use std::fmt::Write;

/// A colour: its name in style sheets, and its value on light and on dark background.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ink {
    name: &'static str,
    light: RGBColor,
    dark: RGBColor,
}

/// The colours of a picture on white; a page replaces them by the theme's colours.
pub const SETPOINT: RGBColor = RGBColor(0x6b, 0x70, 0x7b);
pub const RECORDED: RGBColor = RGBColor(0x1c, 0x20, 0x28);
pub const NOMINAL: RGBColor = RGBColor(0xb8, 0x4a, 0x00);
pub const MENDED: RGBColor = RGBColor(0x00, 0x67, 0xa8);
pub const DUTY: RGBColor = RGBColor(0x00, 0x73, 0x5c);
pub const FORCE: RGBColor = RGBColor(0x8b, 0x3a, 0x86);
pub const SHADE: RGBColor = RGBColor(0xf0, 0xb4, 0x29);
pub const TEXT: RGBColor = RGBColor(0x4a, 0x50, 0x5b);
pub const GRID: RGBColor = RGBColor(0xdd, 0xdf, 0xe3);

/// All colours, and the background.
const INKS: [Ink; 9] = [
    Ink { name: "setpoint", light: SETPOINT, dark: RGBColor(0x9a, 0xa3, 0xb2) },
    Ink { name: "recorded", light: RECORDED, dark: RGBColor(0xf1, 0xf3, 0xf7) },
    Ink { name: "nominal", light: NOMINAL, dark: RGBColor(0xff, 0x9d, 0x52) },
    Ink { name: "mended", light: MENDED, dark: RGBColor(0x5c, 0xb8, 0xff) },
    Ink { name: "duty", light: DUTY, dark: RGBColor(0x45, 0xc9, 0xa5) },
    Ink { name: "force", light: FORCE, dark: RGBColor(0xdc, 0x8f, 0xd6) },
    Ink { name: "shade", light: SHADE, dark: RGBColor(0xd9, 0xa3, 0x2c) },
    Ink { name: "axis", light: TEXT, dark: RGBColor(0xb4, 0xbb, 0xc7) },
    Ink { name: "grid", light: GRID, dark: RGBColor(0x34, 0x3a, 0x45) },
];
/// The colour of the stop button, with white letters; nothing else has it.
const STOP: Ink = Ink { name: "stop", light: RGBColor(0xb3, 0x00, 0x1b), dark: RGBColor(0xb3, 0x00, 0x1b) };
const GROUND: Ink = Ink { name: "ground", light: RGBColor(0xff, 0xff, 0xff), dark: RGBColor(0x16, 0x19, 0x1f) };

/// The colours as custom properties of a style sheet, by the theme that the reader prefers; on paper always the light
/// one.
#[must_use]
pub fn stylesheet() -> String {
    let properties = |colour: fn(&Ink) -> RGBColor| {
        INKS.iter().chain([&GROUND, &STOP]).fold(String::new(), |mut all, ink| {
            // Writing to a string cannot fail.
            let _ = write!(all, "--{}:{};", ink.name, hex(colour(ink)));
            all
        })
    };
    format!(
        ":root{{color-scheme:light dark;{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        properties(|ink| ink.light),
        properties(|ink| ink.dark)
    )
}

/// A drawing in which every colour is replaced by the page's theme colour.
#[must_use]
pub fn themed(svg: &str) -> String {
    INKS.iter().fold(svg.to_owned(), |svg, ink| {
        svg.replace(&format!("\"{}\"", hex(ink.light)), &format!("\"var(--{})\"", ink.name))
    })
}

/// The name of a colour in style sheets; that of the text for an unknown colour.
#[must_use]
pub fn name(colour: RGBColor) -> &'static str {
    INKS.iter().find(|ink| ink.light == colour).map_or("axis", |ink| ink.name)
}

/// A colour as the drawing library writes it.
fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

#[cfg(test)]
mod tests {
    use super::{GROUND, INKS, Ink, RGBColor, STOP, hex, themed};

    /// Relative luminance and contrast by WCAG 2.2.
    fn contrast(one: RGBColor, other: RGBColor) -> f64 {
        let linear = |channel: u8| match f64::from(channel) / 255.0 {
            low if low <= 0.04045 => low / 12.92,
            high => ((high + 0.055) / 1.055).powf(2.4),
        };
        let luminance = |RGBColor(r, g, b)| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b) + 0.05;
        let ratio: f64 = luminance(one) / luminance(other);
        ratio.max(1.0 / ratio)
    }

    #[test]
    fn contrast_is_that_of_the_standard() {
        assert!((contrast(RGBColor(0, 0, 0), RGBColor(255, 255, 255)) - 21.0).abs() < 1e-9);
        // The published example of the lightest grey that passes on white.
        assert!((contrast(RGBColor(0x76, 0x76, 0x76), RGBColor(255, 255, 255)) - 4.54).abs() < 0.005);
    }

    #[test]
    fn every_ink_that_draws_lines_or_text_can_be_read_in_both_themes() {
        let drawn = INKS.iter().filter(|ink| !["shade", "grid"].contains(&ink.name));
        for Ink { name, light, dark } in drawn {
            assert!(contrast(*light, GROUND.light) >= 4.5, "{name} on white");
            assert!(contrast(*dark, GROUND.dark) >= 4.5, "{name} on dark");
        }
        let white = RGBColor(0xff, 0xff, 0xff);
        assert!(contrast(STOP.light, white) >= 7.0 && contrast(STOP.dark, white) >= 7.0);
    }

    #[test]
    fn a_themed_drawing_names_every_ink_and_keeps_no_colour_of_one() {
        let drawn: String = INKS.iter().map(|ink| format!("<line stroke=\"{}\"/>", hex(ink.light))).collect();
        let themed = themed(&drawn);
        assert!(!themed.contains('#'), "{themed}");
        assert_eq!(themed.matches("var(--").count(), INKS.len());
    }
}
