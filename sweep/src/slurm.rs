//! Script of a Slurm job array: one shard per task of the array, requeued if its node fails.

use std::path::Path;

use crate::{Plan, Status};

/// Options of the Slurm script.
#[derive(Debug, Clone, PartialEq)]
pub struct Slurm<'a> {
    /// Number of shards, each a task of the array.
    pub shards: u64,
    /// Cores per shard.
    pub cores: u64,
    /// Time limit per shard \[min\].
    pub minutes: u64,
    /// Path of the program on the nodes.
    pub program: &'a Path,
    /// Folder of the sweep on the nodes.
    pub folder: &'a Path,
    /// Further options of `sbatch`, such as `--partition=short`.
    pub options: &'a [String],
}

/// Shortest time limit \[min\].
const SHORTEST: f64 = 5.0;
/// Factor over the expected time, since nodes and designs differ.
const MARGIN: f64 = 2.0;

/// Time limit of a shard \[min\] from the mean time per design so far. Returns `None` if no design was timed.
pub fn time_limit(status: &Status, shards: u64, cores: u64) -> Option<u64> {
    let each = status.left_s? / (shards.max(1) * cores.max(1)) as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // positive, saturates
    Some((MARGIN * each / 60.0).max(SHORTEST).ceil() as u64)
}

impl Slurm<'_> {
    /// Returns the text of the script.
    pub fn script(&self, plan: &Plan) -> String {
        let folder = quoted(&self.folder.display().to_string());
        let logs = self.folder.join("slurm-%A_%a.log");
        let mut lines = vec![
            "#!/bin/sh".to_owned(),
            format!("# swimmer sweep, plan {}", plan.hash()),
            "#SBATCH --job-name=swimmer-sweep".to_owned(),
            format!("#SBATCH --array=1-{}", self.shards),
            "#SBATCH --requeue".to_owned(),
            "#SBATCH --nodes=1".to_owned(),
            "#SBATCH --ntasks=1".to_owned(),
            format!("#SBATCH --cpus-per-task={}", self.cores),
            format!("#SBATCH --time={}", self.minutes),
            "#SBATCH --open-mode=append".to_owned(),
            format!("#SBATCH --output={}", quoted(&logs.display().to_string())),
        ];
        lines.extend(
            self.options
                .iter()
                .map(|option| format!("#SBATCH {option}")),
        );
        lines.push(
            "# The shard is the task of the array; what is finished is passed over.".to_owned(),
        );
        lines.push(format!(
            "exec {} sweep run {folder} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"",
            quoted(&self.program.display().to_string()),
        ));
        lines.join("\n") + "\n"
    }
}

/// Quotes a word for the shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+%=:,@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_shell_stay_whole() {
        assert_eq!(quoted("/a/b-1.0"), "/a/b-1.0");
        assert_eq!(quoted("my sweep's"), r"'my sweep'\''s'");
    }

    #[test]
    fn the_limit_follows_what_designs_cost() {
        let status = |left_s| Status {
            left_s,
            ..Status::default()
        };
        assert_eq!(time_limit(&status(None), 4, 2), None);
        assert_eq!(time_limit(&status(Some(1.0)), 4, 2), Some(5));
        assert_eq!(time_limit(&status(Some(8.0 * 3600.0)), 4, 2), Some(120));
    }
}
