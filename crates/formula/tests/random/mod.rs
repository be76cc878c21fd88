//! Random formulas and numbers, the same in every run.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part of it")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]

use formula::Formula;

/// The variables of the random formulas.
pub const NAMES: [&str; 4] = ["x", "v", "k", "start"];

/// Knuth's linear congruential generator (MMIX), of which the upper bits are used.
pub struct Random(pub u64);

impl Random {
    /// A whole number below `end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    /// A number within these.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        let parts = u32::try_from(self.below(1 << 30)).unwrap();
        low + (high - low) * f64::from(parts) / f64::from(1_u32 << 30)
    }

    /// A number for a text, of one of a few sizes.
    fn number(&mut self) -> String {
        let small = self.below(50);
        match self.below(4) {
            0 => format!("{small}"),
            1 => format!("0.{small:02}"),
            2 => format!("{small}e-1"),
            _ => format!("1.{small}"),
        }
    }

    /// The text of a formula with about so many operations, each operand in brackets.
    pub fn text(&mut self, operations: u64) -> String {
        if operations == 0 {
            let variable = usize::try_from(self.below(4)).unwrap();
            return if self.below(3) == 0 { self.number() } else { NAMES[variable].into() };
        }
        let left = self.below(operations);
        let (a, b) = (self.text(left), self.text(operations - 1 - left));
        match self.below(17) {
            0 | 1 => format!("({a}) + ({b})"),
            2 | 3 => format!("({a}) - ({b})"),
            4 | 5 => format!("({a}) * ({b})"),
            6 => format!("({a}) / ({b})"),
            7 => format!("({a}) ^ {}", self.below(6)),
            8 => format!("({a}) ^ ({b})"),
            9 => format!("-({a})"),
            10 => format!("max({a}, {b})"),
            11 => format!("min({a}, {b}, 7)"),
            12 => format!("clamp({a}, -2, {b})"),
            13 => format!("if({a} < v, x, {b})"),
            _ => {
                let functions = ["abs", "sign", "sqrt", "exp", "ln", "tanh", "sin", "cos"];
                let function = functions[usize::try_from(self.below(8)).unwrap()];
                format!("{function}({a})")
            }
        }
    }

    /// A formula.
    pub fn formula(&mut self) -> Formula {
        let operations = self.below(10);
        let text = self.text(operations);
        Formula::parse(&text, &NAMES).unwrap_or_else(|mistake| panic!("{text}: {mistake}"))
    }

    /// Numbers for the variables.
    pub fn point(&mut self) -> [f64; 4] {
        [0; 4].map(|_| self.within(-3.0, 3.0))
    }
}
