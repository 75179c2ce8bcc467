//! The text that people read first: `--help` of the program and of every command. Changes are
//! reviewed as text (`cargo insta review`).

use crate::program::Workplace;

#[test]
fn help_of_every_command() {
    let here = Workplace::new();
    let help = here.tandem("--help").succeeds().stdout;
    let commands: Vec<String> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .filter(|name| name != "help")
        .collect();
    assert!(commands.len() >= 12, "{commands:?}");
    insta::assert_snapshot!("tandem", help);
    for command in commands {
        let help = here.tandem(&format!("{command} --help")).succeeds().stdout;
        // Whoever asks for help learns what it is for and what to type.
        assert!(help.contains("Usage: tandem"), "{command}: {help}");
        insta::assert_snapshot!(command, help);
    }
}

#[test]
fn lists_of_what_there_is_to_name() {
    let here = Workplace::new();
    insta::assert_snapshot!("list-scenarios", here.tandem("scenarios").succeeds().stdout);
    insta::assert_snapshot!("list-controllers", here.tandem("controllers").succeeds().stdout);
    insta::assert_snapshot!("list-topics", here.tandem("topics").succeeds().stdout);
    let parameters = here.tandem("controllers tandem-kinematic").succeeds().stdout;
    for key in ["gamma3", "b1_task_m", "control_period_s"] {
        assert!(parameters.contains(key), "{parameters}");
    }
}
