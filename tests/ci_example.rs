//! Contract: what `docs/ci.md` tells a user to type works as it stands: its shell blocks, its gate, and
//! every command of its workflow, for a controller that is left alone and for one that is spoilt.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// The blocks of that language in the page.
fn blocks(language: &str) -> Vec<String> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ci.md");
    let page = fs::read_to_string(page).unwrap();
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// The commands of a workflow that are run here, in order: each `run:`, but what installs the program.
fn commands(workflow: &str) -> Vec<String> {
    let mut commands = Vec::new();
    let mut lines = workflow.lines().peekable();
    while let Some(line) = lines.next() {
        let Some((before, command)) = line.split_once("run: ") else { continue };
        if command != "|" {
            commands.push(command.to_owned());
            continue;
        }
        let indent = before.len() + 2;
        let mut block = String::new();
        while let Some(line) =
            lines.next_if(|line| line.len() > indent && line[..indent].trim().is_empty())
        {
            block.extend([&line[indent..], "\n"]);
        }
        commands.push(block);
    }
    commands.retain(|command| !command.starts_with("cargo install"));
    commands
}

/// A repository of a user, with the program on the path.
struct Repository(TempDir);

impl Repository {
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, script: &str) -> Output {
        let program = Path::new(env!("CARGO_BIN_EXE_tandem")).parent().unwrap();
        let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
        Command::new("bash")
            .args(["-eu", "-o", "pipefail", "-c", script])
            .current_dir(self.0.path())
            .env("PATH", path)
            .env("GITHUB_BASE_REF", "main")
            .env("GITHUB_STEP_SUMMARY", self.path("step-summary.md"))
            .output()
            .unwrap()
    }

    #[track_caller]
    fn succeeds(&self, script: &str) {
        let output = self.run(script);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.success(),
            "{script}\n{said}{}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
}

#[test]
fn the_page_can_be_followed() {
    let here = Repository(tempfile::tempdir().unwrap());
    let shell = blocks("sh");
    let [record, self_test, golden] = shell.as_slice() else { panic!("three shell blocks") };
    here.succeeds(record);
    fs::write(here.path("gate.toml"), &blocks("toml")[0]).unwrap();
    let controller = here.path("controller.toml");
    fs::write(&controller, "gamma3 = 2.0\n").unwrap();
    here.succeeds(
        "git init -q && git add controller.toml gate.toml && \
         git -c user.name=t -c user.email=t@example.org commit -qm base && \
         git update-ref refs/remotes/origin/main HEAD",
    );

    let steps = commands(&blocks("yaml")[0]);
    let [base, compare] = steps.as_slice() else { panic!("two commands: {steps:?}") };
    here.succeeds(base);
    here.succeeds(compare);
    let summary = fs::read_to_string(here.path("step-summary.md")).unwrap();
    assert!(summary.starts_with("## = same"), "{summary}");
    for file in ["report.html", "report.json", "junit.xml", "metrics.csv"] {
        assert!(here.path("report").join(file).is_file(), "{file}");
    }

    // A candidate without a safety layer, whose sets do not look ahead: it may not be merged.
    fs::write(&controller, "projection = \"none\"\nb1_free_m = 0.1\nb2_free_m = 0.2\nb1_task_m = 0.1\nb2_task_m = 0.2\n").unwrap();
    fs::remove_dir_all(here.path("report")).unwrap();
    let output = here.run(compare);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let summary = fs::read_to_string(here.path("report/report.md")).unwrap();
    assert!(summary.contains("held against B") && summary.contains("projection"), "{summary}");

    // Three of its four figures are settled by 10 comparisons: whether it passes is not this test's subject.
    here.succeeds(&format!("{} || [ $? -eq 1 ]", self_test.trim_end()));
    assert!(fs::read_to_string(here.path("self-test.md")).unwrap().contains("### Self-test"));
    here.succeeds(golden);
}
