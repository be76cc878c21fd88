//! The columns that a record was read from: quantity = value·scale + offset.

/// The source of a quantity: a column, and the conversion of its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceColumn {
    /// Its name in the file.
    pub column: String,
    /// The same as TOML writes it, in quotes.
    pub quoted: String,
    /// Our unit per theirs.
    pub scale: f64,
    /// Added after scaling, in our unit.
    pub offset: f64,
    /// Further keys of the column in `[import]`, such as `, integrate = true`; they stay as they are.
    pub further_keys: String,
}

impl SourceColumn {
    /// Whether a user finds the quantity under another name or in another unit than `own`, our column of it. A
    /// difference of columns, or an integral, is in no column.
    #[must_use]
    pub fn is_foreign(&self, own: &Self) -> bool {
        self != own && self.further_keys.is_empty()
    }
}

/// The sources of the quantities that a finding may change.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceColumns {
    /// Of the time, s.
    pub time_s: SourceColumn,
    /// Of the duty, percent.
    pub duty_percent: SourceColumn,
    /// Of the position, mm.
    pub position_mm: SourceColumn,
}

impl Default for SourceColumns {
    /// Columns with the names of the quantities, in our units.
    fn default() -> Self {
        let own = |name: &str| SourceColumn {
            column: name.to_owned(),
            quoted: format!("\"{name}\""),
            scale: 1.0,
            offset: 0.0,
            further_keys: String::new(),
        };
        Self { time_s: own("time_s"), duty_percent: own("duty_percent"), position_mm: own("position_mm") }
    }
}
