//! A diagram in a page: drawn for a wide and for a narrow screen, in the theme's colours, with an alternative text.

use crate::report::kit::plot::{Diagram, shapes};
use maud::{Markup, PreEscaped, html};

/// Size of a figure, pixels: on a wide screen, and on a phone where that differs.
#[derive(Clone, Copy)]
pub struct Size {
    wide: (u32, u32),
    narrow: Option<(u32, u32)>,
}

impl Size {
    /// Across the page.
    pub const WIDE: Self = Self { wide: (960, 270), narrow: Some((360, 260)) };
    /// Beside the first numbers.
    pub const FIRST: Self = Self { wide: (720, 310), narrow: Some((360, 280)) };
    /// One of several in a row.
    pub const SMALL: Self = Self { wide: (360, 240), narrow: None };
    /// One of two in a row.
    pub const HALF: Self = Self { wide: (548, 260), narrow: Some((360, 250)) };
    /// A plane with equal scales, one of two in a row.
    pub const PLANE: Self = Self { wide: (548, 470), narrow: Some((360, 312)) };
}

/// A figure with its caption. `alt` is its alternative text.
pub fn figure(diagram: &Diagram, size: Size, alt: &str, caption: &Markup) -> Markup {
    html! {
        figure {
            (picture(diagram, size, alt))
            figcaption { (caption) }
        }
    }
}

/// The picture alone.
pub fn picture(diagram: &Diagram, size: Size, alt: &str) -> Markup {
    html! {
        @if let Some(narrow) = size.narrow {
            (drawing(diagram, size.wide, "wide", alt))
            (drawing(diagram, narrow, "narrow", alt))
        } @else {
            (drawing(diagram, size.wide, "any", alt))
        }
    }
}

fn drawing(diagram: &Diagram, size: (u32, u32), class: &str, alt: &str) -> Markup {
    // A page has words for what a file has as a title.
    match shapes(size, diagram) {
        Ok((view, shapes)) => html! {
            svg class=(class) viewBox=(view) role="img" aria-label=(alt) { (PreEscaped(shapes)) }
        },
        Err(why) => html! { p.nothing class=(class) { "No picture: " (why) "." } },
    }
}
