//! Where the user's own profiles are, and the printers that files are sent to.

use anyhow::bail;
use clap::Args;
use isoslice::settings::Profiles;
use std::path::PathBuf;

/// Where the user's own profiles are.
#[derive(Args, Clone, Debug, PartialEq)]
pub(super) struct ProfilesSource {
    /// Folder of your own profiles, which has the folders printers, filaments
    /// and presets [default: $ISOSLICE_PROFILES, or isoslice in the folder
    /// for configuration]
    #[arg(long = "profiles", value_name = "DIR", help_heading = "Settings")]
    folder: Option<PathBuf>,
}

impl ProfilesSource {
    /// Profiles in a folder, or in the usual one if none is named.
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        ProfilesSource { folder }
    }

    /// The folder of the user's profiles, which need not exist.
    pub(super) fn folder(&self) -> Option<PathBuf> {
        self.folder.clone().or_else(Profiles::usual_folder)
    }

    /// All profiles of the program and of the folder.
    pub(super) fn find(&self) -> anyhow::Result<Profiles> {
        // The usual folder may be missing. A folder that was named must be
        // there.
        if let Some(folder) = &self.folder
            && !folder.is_dir()
        {
            bail!("there is no folder {} (--profiles)", folder.display());
        }
        Ok(Profiles::new(self.folder()))
    }
}
