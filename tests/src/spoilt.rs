//! Records with numbers that are finite and absurd: any column off by a power of ten, single wild cells, any length.
//! The same ones in every run.

use std::fmt::Write;

/// A table as it is in a CSV.
#[derive(Clone, Debug)]
pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// A spoilt table, and what was done to it in words.
#[derive(Clone, Debug)]
pub struct Spoilt {
    /// In words.
    pub what: String,
    /// As a CSV.
    pub csv: String,
}

/// What is done with a column of a table, in words, to each cell in it.
type Change = (String, Box<dyn Fn(usize, &str) -> String>);

/// Values that no rig has, and some that one might have, but not in a single row.
const WILD: [&str; 12] = [
    "1.7976931348623157e308",
    "-1e308",
    "1e150",
    "-1e30",
    "1e12",
    "1e6",
    "-1e4",
    "1e3",
    "200",
    "0",
    "5e-324",
    "-1e-300",
];

/// Numbers that look random.
#[derive(Clone, Copy, Debug)]
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// One of `count`.
    fn one_of(&mut self, count: usize) -> usize {
        usize::try_from(self.next()).unwrap_or_default() % count.max(1)
    }
}

impl Table {
    /// A CSV without quotes, its first `rows`.
    #[must_use]
    pub fn of(csv: &str, rows: usize) -> Self {
        let cells = |line: &str| line.split(',').map(Into::into).collect::<Vec<String>>();
        let mut lines = csv.lines();
        let header = lines.next().map(cells).unwrap_or_default();
        Self { header, rows: lines.take(rows).map(cells).collect() }
    }

    /// As a CSV, with at most `rows`.
    fn csv(&self, rows: usize) -> String {
        self.rows.iter().take(rows).fold(self.header.join(",") + "\n", |mut text, row| {
            // A string takes everything.
            let _ = writeln!(text, "{}", row.join(","));
            text
        })
    }

    /// The table spoilt in one of very many ways, the one of this number.
    #[must_use]
    pub fn spoilt(&self, number: u64) -> Spoilt {
        let mut random = Random(number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        random.next();
        if random.one_of(8) == 0 {
            let rows = [0, 1, 2, 3, 5, 19, 20, 21, 50, 76, 77, 150, 299, 300, 301][random.one_of(15)];
            return Spoilt { what: format!("{rows} rows"), csv: self.csv(rows) };
        }
        // Not the last column, which marks fresh readings.
        let column = random.one_of(self.header.len() - 1);
        let (how, change) = self.change(&mut random);
        let mut table = self.clone();
        for (k, row) in table.rows.iter_mut().enumerate() {
            row[column] = change(k, &row[column]);
        }
        Spoilt { what: format!("{} {how}", self.header[column]), csv: table.csv(usize::MAX) }
    }

    fn change(&self, random: &mut Random) -> Change {
        let number = |cell: &str| cell.parse::<f64>().ok();
        match random.one_of(6) {
            0 | 1 => {
                let power = [-300, -30, -12, -9, -6, -4, -3, -2, -1, 1, 2, 3, 4, 6, 9, 12, 30, 300][random.one_of(18)];
                let by = 10.0_f64.powi(power);
                let scaled = move |_, cell: &str| number(cell).map_or(String::new(), |value| (value * by).to_string());
                (format!("times 1e{power}"), Box::new(scaled))
            }
            2 | 3 => {
                let (value, last) = (WILD[random.one_of(WILD.len())], self.rows.len() - 1);
                let at = [0, 1, last / 3, last / 2, last - 1, last][random.one_of(6)];
                let wild = move |k, cell: &str| if k == at { value.into() } else { cell.into() };
                (format!("in row {} {value}", at + 1), Box::new(wild))
            }
            4 => {
                let (a, b) = (WILD[random.one_of(WILD.len())], WILD[random.one_of(WILD.len())]);
                (
                    format!("{a} and {b} in turn"),
                    Box::new(move |k, _| if k.is_multiple_of(2) { a.into() } else { b.into() }),
                )
            }
            _ => {
                let seed = random.next();
                let any = move |k: usize, _: &str| {
                    let mut of_row = Random(seed.wrapping_add(k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
                    let (digits, power) = (of_row.next() % 1000, i32::try_from(of_row.next() % 600).unwrap_or(0) - 300);
                    format!("{}{digits}e{power}", if of_row.next().is_multiple_of(2) { "-" } else { "" })
                };
                ("of any magnitude".into(), Box::new(any))
            }
        }
    }
}
