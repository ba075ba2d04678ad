//! The command line as such: help, examples, suggestions, `-`, `--replace`, `--quiet`, completions and manual pages.

use std::io::Write;
use std::process::{Command, Stdio};

use tautline_validation::support::program::program;
use tautline_workflow::machines;

use super::program::{Answer, Folder, tautline};

/// Starts a command with an environment of its own and a text on standard input.
fn answer(mut command: Command, input: &[u8]) -> Answer {
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    // A command that fails early does not read.
    let _ = stdin.write_all(input);
    drop(stdin);
    child.wait_with_output().expect("it ends").into()
}

fn reading(arguments: &[&str], input: &str) -> Answer {
    let mut command = Command::new(program());
    command.args(arguments);
    answer(command, input.as_bytes())
}

/// Names of the commands, and of those of `study`, in the order of the help.
fn commands(words: &[&str]) -> Vec<String> {
    let help = tautline(&[words, &["--help"]].concat()).succeeded().stdout;
    let (_, list) = help.split_once("Commands:\n").expect("commands");
    let (list, _) = list.split_once("\n\n").expect("their end");
    let names = list
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

/// The lines of the examples in the help of a command.
fn examples(words: &[&str]) -> Vec<String> {
    let help = tautline(&[words, &["--help"]].concat()).succeeded().stdout;
    let (_, after) = help.split_once("\nExamples:\n").expect("examples");
    let lines = after.lines().filter(|line| line.starts_with("  tautline "));
    lines.map(|line| line.trim().to_owned()).collect()
}

/// Words of examples that need more than the program: files of the user, a controller, typed answers, a long time.
const NEED_MORE: [&str; 13] = [
    "--hypothesis",
    "--record",
    "tautline history",
    "log.csv",
    "opc.tcp:",
    "cell.json",
    "study ",
    "~/",
    "--roll-back",
    "config.g",
    "pulleys.xlsx",
    "simulated.csv",
    "certificate.toml",
];

#[cfg(unix)]
#[test]
fn examples_of_the_help_run_one_after_the_other() {
    let folder = Folder::new();
    let programs = program().parent().expect("a folder").display();
    let path = format!("{programs}:{}", std::env::var("PATH").expect("a path"));
    let mut count = 0;
    for name in commands(&[]).iter().filter(|name| *name != "study") {
        for line in examples(&[name]) {
            if NEED_MORE.iter().any(|part| line.contains(part)) {
                continue;
            }
            let mut shell = Command::new("sh");
            shell
                .args(["-c", &line])
                .env("PATH", &path)
                .current_dir(folder.path());
            let answer = answer(shell, b"");
            assert_eq!(answer.code, Some(0), "{line}: {}", answer.stderr);
            count += 1;
        }
    }
    assert!(count > 35, "only {count} examples");
}

#[test]
fn help_says_what_the_program_does_and_fits_the_terminal() {
    let help = tautline(&["--help"]).succeeded().stdout;
    let first = help.lines().next().expect("a line");
    assert!(
        first.starts_with("Calibrate cable-driven parallel robots"),
        "{first}"
    );
    let width = |columns: &str| {
        let mut command = Command::new(program());
        command.args(["identify", "--help"]).env("COLUMNS", columns);
        let help = answer(command, b"").succeeded().stdout;
        // Examples are not to be broken.
        let (text, _) = help.split_once("Examples:").expect("examples");
        text.lines()
            .map(|line| line.chars().count())
            .max()
            .expect("lines")
    };
    assert!((55..=70).contains(&width("70")), "{}", width("70"));
    assert!((90..=110).contains(&width("110")), "{}", width("110"));
}

#[test]
fn a_mistyped_command_gets_a_suggestion() {
    for words in [&["identfy"][..], &["identfy", "mini", "--json", "-"]] {
        tautline(words).refused(&["identfy: neither a command", "`tautline identify`?"]);
    }
    let answer = tautline(&["identify", "mini", "--jsn", "-"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.contains("'--json'"), "{}", answer.stderr);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_display_there_is_a_sentence_and_a_hint() {
    let mut command = Command::new(program());
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let answer = answer(command, b"");
    let told = &answer.stderr;
    assert_eq!(answer.code, Some(1), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(told.contains("no window can be opened"), "{told}");
    assert!(
        told.contains("DISPLAY") && told.contains("`tautline --help`"),
        "{told}"
    );
    assert!(!told.contains(".rs") && !told.contains(".cargo"), "{told}");
}

#[test]
fn files_are_replaced_only_if_that_was_asked_for() {
    let folder = Folder::new();
    let [data, model, plan, report] =
        ["data", "model.json", "plan.csv", "report.html"].map(|name| folder.join(name));
    let simulate = ["simulate", "--robot", "planar", "--poses", "8", "-o", &data];
    tautline(&simulate).succeeded();
    let compared = folder.join("compared.html");
    for words in [
        &simulate[..],
        &["new", "mini", "-o", &model],
        &["plan", "planar", "--poses", "5", "-o", &plan],
        &["identify", &data, "--model-out", &model],
        &["identify", &data, "--values", &plan],
        &["export", &data, "-o", &plan],
        &["compare", &data, &data, "--report", &compared],
        &["report", &data, "-o", &report],
        &["symbols", "mini", "-o", &model],
        &["completions", "bash", "-o", &model],
        &["schemas", "-o", &folder.join("schemas")],
        &["man", "-o", &folder.join("man")],
    ] {
        let first = tautline(words);
        if first.code == Some(0) {
            tautline(words).refused(&["already exists, expected --replace"]);
        } else {
            first.refused(&["already exists, expected --replace"]);
        }
        tautline(&[words, &["--replace"]].concat()).succeeded();
    }
    // The same command may be repeated, also with a file that another program has made for its result.
    let result = folder.write("result.json", "");
    for _ in 0..2 {
        tautline(&["identify", &data, "--json", &result]).succeeded();
    }
    assert_eq!(
        folder.json("result.json")["format"],
        "tautline-identification"
    );
    let empty = folder.write("empty.json", "");
    tautline(&["new", "mini", "-o", &empty]).succeeded();
}

#[test]
fn counts_have_an_upper_bound() {
    let folder = Folder::new();
    let out = folder.join("data");
    for words in [
        &["plan", "mini", "--poses", "1000000000"][..],
        &["plan", "mini", "--candidates", "1000000000"],
        &[
            "simulate",
            "--robot",
            "mini",
            "-o",
            &out,
            "--poses",
            "1000000000",
        ],
    ] {
        let answer = tautline(words);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(
            answer.stderr.contains("1000000000 is not in 0..="),
            "{}",
            answer.stderr
        );
    }
}

#[test]
fn no_output_replaces_an_input_and_none_follows_a_link() {
    let folder = Folder::new();
    let data = folder.join("data");
    tautline(&["simulate", "--robot", "mini", "--poses", "12", "-o", &data]).succeeded();
    // Neither a session that the same command makes.
    let run = folder.join("run.json");
    let measure = [
        "measure",
        &run,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
        "--json",
        &run,
    ];
    tautline(&measure).refused(&["run.json: is an input of this command"]);
    assert!(!std::path::Path::new(&run).exists());
    let robot = folder.join("data/robot.json");
    let poses = folder.join("data/poses.csv");
    let other = folder.write("other.json", "{\"format\": \"tautline-session\"}");
    let link = folder.join("link.json");
    std::os::unix::fs::symlink(&other, &link).expect("a link");
    let before = [&robot, &poses, &other].map(|file| std::fs::read(file).expect("a file"));
    for (words, why) in [
        (vec!["identify", &data, "--json", &robot], "already exists"),
        (
            vec!["identify", &data, "--json", &robot, "--replace"],
            "is an input",
        ),
        (
            vec!["identify", &data, "--model-out", &robot, "--replace"],
            "is an input",
        ),
        (
            vec!["export", &data, "-o", &poses, "--replace"],
            "is an input",
        ),
        (vec!["identify", &data, "--json", &other], "already exists"),
        (
            vec!["identify", &data, "--json", &link, "--replace"],
            "is a link",
        ),
        (
            vec!["simulate", "--robot", &robot, "-o", &data, "--replace"],
            "is an input",
        ),
    ] {
        tautline(&words).refused(&[why]);
        let now = [&robot, &poses, &other].map(|file| std::fs::read(file).expect("a file"));
        assert!(now == before, "{words:?}");
    }
}

#[test]
fn a_dash_is_standard_input_and_output() {
    let folder = Folder::new();
    let data = folder.join("data");
    tautline(&[
        "simulate", "--robot", "mini", "--poses", "12", "--phases", "-o", &data,
    ])
    .succeeded();
    let robot = tautline(&["new", "planar", "-o", "-"]).succeeded();
    assert_eq!(robot.json()["format"], "tautline-robot");
    let planned = reading(&["plan", "-", "--poses", "5", "-o", "-"], &robot.stdout).succeeded();
    assert!(
        planned.stdout.starts_with("pose,x_m,y_m,"),
        "{}",
        planned.stdout
    );
    assert_eq!(planned.stdout.lines().count(), 6);
    let model = tautline(&["identify", &data, "--model-out", "-"]).succeeded();
    let evaluate = ["evaluate", &data, "--model", "-", "--json", "-"];
    let evaluated = reading(&evaluate, &model.stdout).succeeded();
    assert_eq!(evaluated.json()["converged"], true);
    for (words, begin) in [
        (&["identify", &data, "--statistics", "-"][..], "pose,"),
        (&["export", &data, "-o", "-"], "pose,"),
        (&["report", &data, "-o", "-"], "<!DOCTYPE html>"),
        (
            &["compare", &data, &data, "--report", "-"],
            "<!DOCTYPE html>",
        ),
    ] {
        let text = tautline(words).succeeded().stdout;
        assert!(text.starts_with(begin), "{words:?}: {text}");
    }
    let check = std::fs::read_to_string(format!("{data}/check.csv")).expect("a table");
    let figures = reading(&["accuracy", "-", "--json", "-"], &check).succeeded();
    assert_eq!(figures.json()["format"], "tautline-accuracy");
    reading(&["accuracy", "-"], "kind,target\npose,P1\n").refused(&["standard input"]);
    reading(&["plan", "-"], "{").refused(&["standard input", "line"]);
    tautline(&["identify", &data, "--model-out", "-", "--json", "-"])
        .refused(&["found 2 outputs for standard output"]);

    let session = folder.join("run.json");
    let measure = [
        "measure",
        &session,
        "--controller",
        "sim",
        "--robot",
        "-",
        "--poses",
        "20",
        "--arm",
    ];
    reading(&measure, &model.stdout).succeeded();
    let text = std::fs::read_to_string(&session).expect("a session");
    let diagnosed = reading(&["diagnose", "-", "--json", "-"], &text).succeeded();
    assert_eq!(diagnosed.json()["format"], "tautline-diagnosis");
}

#[test]
fn a_quiet_command_prints_results_and_errors_only() {
    let folder = Folder::new();
    let data = folder.join("data");
    for words in [
        &[
            "simulate", "--robot", "mini", "--poses", "3", "-o", &data, "-q",
        ][..],
        &["--quiet", "new", "facade", "-o", &folder.join("robot.json")],
    ] {
        let answer = tautline(words).succeeded();
        assert_eq!((answer.stdout.as_str(), answer.stderr.as_str()), ("", ""));
    }
    assert!(
        tautline(&["effects", "-q"])
            .succeeded()
            .stdout
            .contains("winch_scale")
    );
    let file = folder.write("more.csv", "more\n");
    tautline(&["-q", "accuracy", &file]).refused(&["more.csv"]);
    let noisy = ["report", &data, "-o", &folder.join("r.html")];
    let quiet = tautline(&[&noisy[..], &["--quiet"]].concat()).succeeded();
    assert_eq!(quiet.stderr, "");
}

#[test]
fn progress_is_for_terminals() {
    let folder = Folder::new();
    let session = folder.join("run.json");
    let sim = ["--controller", "sim", "--arm"];
    let measure = ["measure", &session, "--robot", "planar", "--poses", "8"];
    tautline(&[&measure[..], &sim].concat()).succeeded();
    let answer = tautline(&[&["verify", &session][..], &sim].concat()).succeeded();
    assert_eq!(answer.stderr, "");
}

#[cfg(unix)]
#[test]
fn completions_know_commands_and_options() {
    let folder = Folder::new();
    let file = folder.join("tautline.bash");
    tautline(&["completions", "bash", "-o", &file]).succeeded();
    let complete = |words: &str| {
        let last = words.split(' ').count();
        let script = format!(
            "source '{file}'; COMP_WORDS=(tautline {words}); COMP_CWORD={last}; \
             _tautline tautline \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"; echo \"${{COMPREPLY[@]}}\""
        );
        let mut bash = Command::new("bash");
        bash.args(["--norc", "-c", &script]);
        answer(bash, b"").succeeded().stdout
    };
    assert_eq!(complete("identi").trim(), "identify");
    assert_eq!(complete("identify --toler").trim(), "--tolerances");
    assert_eq!(complete("identify --method pub").trim(), "published");
    assert_eq!(complete("new hang").trim(), "hangprinter");
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let text = tautline(&["completions", shell]).succeeded().stdout;
        assert!(text.contains("precalibrate"), "{shell}");
    }
}

#[test]
fn every_command_has_a_manual_page_with_examples() {
    let folder = Folder::new();
    tautline(&["man", "-o", &folder.join("man")]).succeeded();
    let study = commands(&["study"])
        .into_iter()
        .map(|name| format!("study-{name}"));
    let pages: Vec<String> = commands(&[]).into_iter().chain(study).collect();
    assert!(pages.len() > 26, "{pages:?}");
    for name in pages.iter().filter(|name| *name != "study") {
        let page = folder.join(&format!("man/tautline-{name}.1"));
        let page = std::fs::read_to_string(&page).expect(name);
        assert!(page.contains(".SH EXAMPLES"), "{name}");
        assert!(page.contains("\ntautline "), "{name}: {page}");
    }
    let main = std::fs::read_to_string(folder.join("man/tautline.1")).expect("a page");
    assert!(main.contains(".SH \"EXIT STATUS\""), "{main}");
}

#[test]
fn presets_and_templates_are_one_list() {
    let folder = Folder::new();
    for name in machines::names() {
        let answer = tautline(&["new", name, "-o", "-"]).succeeded();
        let symbols = tautline(&["symbols", name]).succeeded();
        assert_eq!(answer.json()["format"], "tautline-robot");
        assert_eq!(symbols.json()["format"], "tautline-symbols");
        for words in [&["plan"][..], &["simulate", "--robot"]] {
            let help = tautline(&[&words[..1], &["--help"]].concat())
                .succeeded()
                .stdout;
            assert!(help.contains(name), "{name}: {help}");
        }
    }
    let data = folder.join("data");
    tautline(&["simulate", "--robot", "facade", "--poses", "3", "-o", &data]).succeeded();
    tautline(&["new", "mini", "--width", "3", "-o", "-"])
        .refused(&["--width: mini has one size only", "facade"]);
    let sized = [
        "new",
        "suspended",
        "--width",
        "12",
        "--depth",
        "9",
        "--height",
        "7",
        "-o",
        "-",
    ];
    let robot = tautline(&sized).succeeded().json();
    assert_eq!(robot["cables"][0]["pulley"]["entry_point_m"][2], 7.0);
}

#[test]
fn the_effects_and_the_certificate_are_documents_too() {
    let effects = tautline(&["effects", "--json", "-"]).succeeded().json();
    assert_eq!(effects["format"], "tautline-effects");
    let list = effects["effects"].as_array().expect("a list");
    let slip = list.iter().find(|one| one["effect"] == "cable_slip");
    let parameters = &slip.expect("listed")["parameters"];
    assert_eq!(parameters[0]["unit"], "m");
    assert_eq!(parameters[1]["is_given"], true);
    let both = tautline(&["effects", "--json", "-", "--quantities"]);
    assert_eq!(both.code, Some(2), "{}", both.stderr);
    assert!(
        both.stderr.contains("cannot be used with '--quantities'"),
        "{}",
        both.stderr
    );

    let folder = Folder::new();
    let mut command = Command::new(program());
    command.env("TAUTLINE_HOME", folder.join("home"));
    let file = folder.join("own.der");
    command.args(["certificate", "--json", "-", "-o", &file]);
    let document = answer(command, b"").succeeded().json();
    assert_eq!(document["format"], "tautline-certificate");
    let sha256 = document["sha256"].as_str().expect("text");
    assert_eq!(sha256.split(':').count(), 32, "{sha256}");
    assert!(std::fs::metadata(&file).expect("written").len() > 500);
}
