//! The built program, for suites that start it.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use serde_json::Value;
use tempfile::TempDir;

/// The program next to this test or program, built if it is missing or older than its sources.
///
/// # Panics
/// If it cannot be built.
#[must_use]
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        if let Ok(path) = std::env::var("CARGO_BIN_EXE_tautline") {
            return path.into();
        }
        let own = std::env::current_exe().expect("a path");
        // Tests lie in the folder deps, programs beside it.
        let mut folders = own.ancestors().skip(1).skip_while(|f| f.ends_with("deps"));
        let folder = folders.next().expect("the folder of the profile");
        let program = folder.join(format!("tautline{}", std::env::consts::EXE_SUFFIX));
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let sources = newest(&root.join("src"));
        if modified(&program).is_none_or(|built| sources.is_some_and(|changed| changed > built)) {
            build(&root, folder);
        }
        program
    })
}

fn build(root: &Path, folder: &Path) {
    let profile = match folder.file_name().and_then(|name| name.to_str()) {
        None | Some("debug") => "dev",
        Some(name) => name,
    };
    let target = folder.parent().expect("the target folder");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--profile", profile, "--workspace"])
        // With a test beside it, so that libraries have the features that the tests have, and are not built twice.
        .args(["--bin", "tautline", "--test", "workbench_window"])
        .arg("--target-dir")
        .arg(target)
        .current_dir(root)
        .status();
    assert!(status.expect("cargo starts").success());
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).ok()?.modified().ok()
}

/// Time of the last change below a folder.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let times = entries.filter_map(|entry| match entry.file_type().ok()?.is_dir() {
        true => newest(&entry.path()),
        false => modified(&entry.path()),
    });
    times.max()
}

/// Output and exit code of a run of the program.
pub struct Answer {
    /// Its exit code; none where it was killed.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Answer {
    /// Asserts success.
    ///
    /// # Panics
    /// If the program failed.
    pub fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// Asserts bad input: exit code 2, nothing on standard output, one sentence with these parts.
    ///
    /// # Panics
    /// If the program did anything else.
    pub fn refused(&self, parts: &[&str]) {
        assert_eq!(self.code, Some(2), "{}{}", self.stdout, self.stderr);
        assert_eq!(self.stdout, "");
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        assert!(self.stderr.ends_with('\n'));
        for part in parts {
            assert!(self.stderr.contains(part), "{} lacks {part}", self.stderr);
        }
    }

    /// Standard output, all of it, as JSON.
    ///
    /// # Panics
    /// If it is none.
    #[must_use]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).expect("nothing but JSON on standard output")
    }
}

impl From<Output> for Answer {
    fn from(output: Output) -> Self {
        let [stdout, stderr] =
            [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8"));
        Self {
            code: output.status.code(),
            stdout,
            stderr,
        }
    }
}

/// Runs the program without standard input.
///
/// # Panics
/// If it cannot be started.
pub fn tautline(arguments: &[&str]) -> Answer {
    run(&mut command(arguments))
}

/// The program with arguments, to be run in an environment of its own.
#[must_use]
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(program());
    command.args(arguments);
    // Settings of a user, such as hypotheses, are not used.
    let absent = format!("tautline-tests-{}", std::process::id());
    command.env("TAUTLINE_HOME", std::env::temp_dir().join(absent));
    // No keyring is used either.
    command.env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/dev/null");
    command
}

/// Runs a command without standard input.
///
/// # Panics
/// If it cannot be started.
pub fn run(command: &mut Command) -> Answer {
    let output = command.stdin(Stdio::null()).output();
    output.expect("the program starts").into()
}

/// Starts the program, whose standard input is `input`.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn start(arguments: &[&str], input: Stdio) -> Child {
    spawn(&mut command(arguments), input)
}

/// Starts a command, whose standard input is `input`.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn spawn(command: &mut Command, input: Stdio) -> Child {
    command
        .stdin(input)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Lets a started program run to its end, and calls `heard` with every line of its standard error.
///
/// # Panics
/// If its output cannot be read.
pub fn heard(mut child: Child, mut heard: impl FnMut(&str, &mut Child)) -> Answer {
    let told = BufReader::new(child.stderr.take().expect("a pipe"));
    let mut stderr = String::new();
    for line in told.lines() {
        let line = line.expect("text");
        stderr.push_str(&line);
        stderr.push('\n');
        heard(&line, &mut child);
    }
    let output = child.wait_with_output().expect("it ends");
    Answer {
        stderr,
        ..output.into()
    }
}

/// Starts the program and kills it once `when` says so; its standard error until then, and whether it was still running.
///
/// # Panics
/// If it cannot be started.
pub fn killed(command: &mut Command, mut when: impl FnMut(Duration) -> bool) -> (String, bool) {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let begun = Instant::now();
    while !when(begun.elapsed()) {
        if child.try_wait().expect("a state").is_some() {
            break;
        }
        sleep(Duration::from_micros(200));
    }
    let ran = child.try_wait().expect("a state").is_none();
    // It may end by itself meanwhile.
    let _ = child.kill();
    let mut told = String::new();
    let mut stderr = child.stderr.take().expect("a pipe");
    stderr.read_to_string(&mut told).expect("text");
    child.wait().expect("it has ended");
    (told, ran)
}

/// Labels of the poses that a measuring run has reported to be on disk.
#[must_use]
pub fn on_disk(told: &str) -> Vec<i64> {
    let labels = told.lines().filter_map(|line| {
        let (label, rest) = line.strip_prefix("pose ")?.split_once(' ')?;
        rest.starts_with("is on disk").then(|| label.parse().ok())?
    });
    labels.collect()
}

/// Files next to a session file that belong to it.
///
/// # Panics
/// If the folder cannot be read.
#[must_use]
pub fn beside(path: &str) -> Vec<PathBuf> {
    let folder = Path::new(path).parent().expect("a folder");
    let name = Path::new(path).file_name().expect("a name");
    let name = format!("{}.", name.to_string_lossy());
    let entries = std::fs::read_dir(folder).expect("readable").flatten();
    let paths = entries.map(|entry| entry.path());
    let belongs = |path: &PathBuf| {
        path.file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with(&name))
    };
    paths.filter(belongs).collect()
}

/// A folder with paths in it as text.
pub struct Folder(TempDir);

impl Folder {
    /// An empty one, removed with this.
    ///
    /// # Panics
    /// If it cannot be made.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "it makes a folder")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    /// Path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// A path in it.
    ///
    /// # Panics
    /// If it is no text.
    #[must_use]
    pub fn join(&self, name: &str) -> String {
        self.path().join(name).to_str().expect("UTF-8").to_owned()
    }

    /// Writes a file in it; its path.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path().join(name), text).expect("written");
        self.join(name)
    }

    /// A JSON file in it.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn json(&self, name: &str) -> Value {
        let text = std::fs::read_to_string(self.path().join(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    }
}
