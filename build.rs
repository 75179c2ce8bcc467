//! Notes the commit that the program is built from, for the metadata of every log it writes.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn main() {
    // Without git, or outside a checkout, the commit is unknown and that is what logs will say.
    let commit = git(&["rev-parse", "HEAD"]).unwrap_or_default();
    let dirty =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|s| !s.is_empty());
    println!("cargo:rustc-env=TANDEM_COMMIT={commit}");
    println!("cargo:rustc-env=TANDEM_DIRTY={dirty}");
    for path in ["HEAD", "index"] {
        if let Some(path) = git(&["rev-parse", "--git-path", path]) {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    for folder in
        ["build.rs", "src", "schemas", "controller", "simulator", "recorder", "replay", "compare"]
    {
        println!("cargo:rerun-if-changed={folder}");
    }
}
