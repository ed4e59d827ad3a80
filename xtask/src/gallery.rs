//! `cargo xtask gallery`: draws the pictures of `docs/gallery.md` with the commands that stand beside them.
//!
//! Every line of the page that begins with `suture ` (in backquotes or in a fenced block) and names an output in `docs/gallery` is run
//! as it stands: what the page says is what made the pictures.

use std::fs;
use std::path::Path;

use crate::step::{cargo, step};

/// Runs every command of the gallery; those that need meshes that are not part of the project are left out where these are absent.
///
/// # Errors
/// When the page cannot be read or a command fails.
pub(crate) fn draw(root: &Path) -> Result<(), String> {
    let path = root.join("docs/gallery.md");
    let page = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let commands = commands(&page);
    if commands.is_empty() {
        return Err(format!("{} has no commands", path.display()));
    }
    for words in &commands {
        let missing = words.iter().find(|w| w.starts_with("../shared/") && !root.join(w).exists());
        if let Some(missing) = missing {
            eprintln!("==> left out, {missing} is not here: suture {}", words.join(" "));
            continue;
        }
        step(&format!("suture {}", words.join(" ")), || {
            let mut command = cargo();
            command.args(["run", "--release", "--quiet", "-p", "suture", "--"]).args(words).arg("--quiet");
            let status =
                command.current_dir(root).status().map_err(|e| format!("cargo cannot be started: {e}"))?;
            // 1: there is a picture, of a surface that keeps less than it claims. Some figures are there to show just that.
            if matches!(status.code(), Some(0 | 1)) { Ok(()) } else { Err(format!("it ended with {status}")) }
        })?;
    }
    Ok(())
}

/// The words of all commands, the name of the program left away.
fn commands(page: &str) -> Vec<Vec<String>> {
    let line = |l: &str| {
        let words = l.trim().trim_matches('`').strip_prefix("suture ")?;
        words.contains("-o docs/gallery/").then(|| words.split_whitespace().map(str::to_owned).collect())
    };
    page.lines().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_lines_with_a_picture() {
        let page = "# A\n`suture bubble a.obj -o docs/gallery/a.png`\n\n```text\nsuture fill b.json -o docs/gallery/b.png\nsuture check c.obj\n```\nsaid: `suture x`\n";
        let found = commands(page);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0], ["bubble", "a.obj", "-o", "docs/gallery/a.png"]);
        assert_eq!(found[1][0], "fill");
    }
}
