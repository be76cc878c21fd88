//! The flags of `airball gallery`.

use super::{ConfigArgs, effect};
use clap::Args;
use std::path::PathBuf;

/// `airball gallery`
#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// Which config: the rig that is shown, and its controller.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write the pages (Markdown) and pictures (SVG) here; older ones are replaced
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Show this effect alone; may be given again
    #[arg(long, value_name = "EFFECT", value_parser = effect())]
    pub only: Vec<String>,
    /// Seed of the simulated rig's noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}
