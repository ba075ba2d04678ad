//! The built program in a window, driven by keys and pointer, observed through the accessible elements that it reports.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use super::display::{Display, keys};
use crate::support::program::program;

/// Time limit after which the program counts as hung.
const PATIENCE: Duration = Duration::from_secs(120);
/// Time between two checks.
const PAUSE: Duration = Duration::from_millis(10);

/// An element of the window.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Role, such as `Button`.
    pub role: String,
    /// Its accessible name.
    pub name: String,
    /// Left, top, width, height in pixels.
    pub place: [f64; 4],
    /// Whether the element is selected.
    pub selected: bool,
}

impl Element {
    /// Its middle.
    #[must_use]
    pub fn middle(&self) -> (i16, i16) {
        let [x, y, width, height] = self.place;
        ((x + width / 2.0) as i16, (y + height / 2.0) as i16)
    }
}

/// The running program.
pub struct Window {
    /// Display of the window.
    pub display: Display,
    program: Child,
    folder: PathBuf,
}

impl Window {
    /// Starts the program on a display of `size`, and returns when it started. `folder` takes its settings and its output.
    ///
    /// # Errors
    /// If the display or the program cannot be started.
    pub fn start(folder: &Path, size: [u32; 2], arguments: &[&str]) -> Result<(Self, Instant)> {
        let display = Display::new(size[0], size[1])?;
        let errors = fs::File::create(folder.join("stderr"))?;
        let executable = program();
        // Of an earlier start; usually there was none.
        let _ = fs::remove_file(folder.join("shown"));
        let begin = Instant::now();
        let program = Command::new(executable)
            .arg("--observed")
            .arg(folder.join("shown"))
            .args(arguments)
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("TAUTLINE_HOME", folder.join("home"))
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .current_dir(folder)
            .stdout(Stdio::null())
            .stderr(errors)
            .spawn()
            .context("the program cannot be started")?;
        let window = Self {
            display,
            program,
            folder: folder.to_owned(),
        };
        Ok((window, begin))
    }

    /// Starts the program so that it fills a display of `size`.
    ///
    /// # Errors
    /// If the display or the program fails, or the window does not come.
    pub fn open(folder: &Path, size: [u32; 2], arguments: &[&str]) -> Result<Self> {
        let (mut window, _) = Self::start(folder, size, arguments)?;
        let id = window.until("the window", |window| window.display.window("Tautline"))?;
        window.display.fill(id, size[0], size[1])?;
        window.display.focus(id)?;
        window.until("the window fills the display", |window| {
            let wide = |e: &Element| e.place[0] + e.place[2] >= f64::from(size[0]) - 24.0;
            let (_, elements) = window.shown()?;
            Ok(elements.iter().any(wide).then_some(()))
        })?;
        window.rest()?;
        Ok(window)
    }

    /// Number of the program among those that run.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.program.id()
    }

    /// Standard error of the program.
    #[must_use]
    pub fn complaints(&self) -> String {
        fs::read_to_string(self.folder.join("stderr")).unwrap_or_default()
    }

    /// Number of frames so far, and the elements of the last one.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn shown(&self) -> Result<(u64, Vec<Element>)> {
        let text = fs::read_to_string(self.folder.join("shown")).unwrap_or_default();
        let mut lines = text.lines();
        let frames = lines.next().map_or(Ok(0), str::parse)?;
        let elements: Result<Vec<Element>> = lines.map(element).collect();
        Ok((frames, elements?))
    }

    /// Polls until `look` returns a value.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn until<T>(&mut self, what: &str, look: impl Fn(&Self) -> Result<Option<T>>) -> Result<T> {
        let start = Instant::now();
        loop {
            if let Some(found) = look(self)? {
                return Ok(found);
            }
            if let Some(status) = self.program.try_wait()? {
                let complaints = self.complaints();
                bail!("waiting for {what}: the program ended, {status}\n{complaints}");
            }
            if start.elapsed() > PATIENCE {
                let (_, shown) = self.shown()?;
                let names: Vec<&str> = shown.iter().map(|e| e.name.as_str()).collect();
                let complaints = self.complaints();
                bail!("{what} does not come; there is {names:?}\n{complaints}");
            }
            thread::sleep(PAUSE);
        }
    }

    /// Waits for the first element that fits.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn element(&mut self, what: &str, fits: impl Fn(&Element) -> bool) -> Result<Element> {
        self.until(what, |window| {
            let (_, elements) = window.shown()?;
            Ok(elements.into_iter().find(|element| fits(element)))
        })
    }

    /// Waits for the element of this role and name.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn named(&mut self, role: &str, name: &str) -> Result<Element> {
        self.element(&format!("the {role} {name}"), |element| {
            element.role == role && element.name == name
        })
    }

    /// Waits for a text that begins like this.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn text(&mut self, beginning: &str) -> Result<Element> {
        self.element(&format!("the text {beginning}"), |element| {
            element.name.starts_with(beginning)
        })
    }

    /// Waits until no new frames are drawn.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn rest(&mut self) -> Result<()> {
        self.until("rest", |window| {
            let before = window.shown()?.0;
            thread::sleep(Duration::from_millis(300));
            Ok((window.shown()?.0 == before).then_some(()))
        })
    }

    /// Clicks into the middle of an element.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn click(&self, element: &Element) -> Result<()> {
        self.display.move_to(element.middle())?;
        self.display.button(true)?;
        thread::sleep(Duration::from_millis(30));
        self.display.button(false)
    }

    /// Types into a field, instead of what is in it.
    ///
    /// # Errors
    /// If the display fails or the text does not appear.
    pub fn enter(&mut self, field: &str, text: &str) -> Result<()> {
        let field = self.named("TextInput", field)?;
        self.click(&field)?;
        // Keys that come in the frame of the click are not the field's yet.
        self.rest()?;
        self.command('a')?;
        self.display.write(text)?;
        self.element("the typed text", |element| element.name == text)?;
        self.rest()
    }

    /// Strikes a letter or digit with the control key held, and the shift key, too, for a capital.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn command(&self, key: char) -> Result<()> {
        let held: &[u32] = match key.is_ascii_uppercase() {
            true => &[keys::CONTROL, keys::SHIFT],
            false => &[keys::CONTROL],
        };
        self.display
            .strike(held, u32::from(key.to_ascii_lowercase()))
    }

    /// Waits until the program has ended of itself.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn end(&mut self) -> Result<ExitStatus> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(status) = self.program.try_wait()? {
                return Ok(status);
            }
            thread::sleep(PAUSE);
        }
        bail!("the program does not end")
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn element(line: &str) -> Result<Element> {
    let parts: Vec<&str> = line.split('\t').collect();
    ensure!(parts.len() == 7, "{line} has not seven parts");
    let number = |k: usize| parts[k].parse::<f64>().context("a number");
    Ok(Element {
        role: parts[0].into(),
        name: parts[1].into(),
        place: [number(2)?, number(3)?, number(4)?, number(5)?],
        selected: parts[6] == "selected",
    })
}
