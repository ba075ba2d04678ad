//! A virtual screen: Xvfb, its keyboard, its pointer, its pixels.

use std::io::{BufRead, BufReader, IoSlice};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use image::RgbaImage;
use x11rb::connection::{Connection, RequestConnection};
use x11rb::protocol::xproto::{
    self, AtomEnum, ConnectionExt as _, ImageFormat, InputFocus, Window,
};
use x11rb::rust_connection::RustConnection;

/// Number of the XTEST request for a key, a button or a move.
const FAKE_INPUT: u8 = 2;

/// Keysyms of keys without a character.
pub mod keys {
    /// Return.
    pub const RETURN: u32 = 0xff0d;
    /// Left control key.
    pub const CONTROL: u32 = 0xffe3;
    /// Left shift key.
    pub const SHIFT: u32 = 0xffe1;
}

/// An X server without a screen; it ends with this value.
pub struct Display {
    server: Child,
    /// Value of `DISPLAY` for programs on this display.
    pub name: String,
    connection: RustConnection,
    root: Window,
    /// First byte of requests of the extension XTEST.
    xtest: u8,
}

impl Display {
    /// A display of this size in pixels, at a number that is free.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        Self::with_options(width, height, &[])
    }

    /// A display without OpenGL by way of X11.
    ///
    /// # Errors
    /// If the display fails.
    pub fn without_glx(width: u32, height: u32) -> Result<Self> {
        Self::with_options(width, height, &["-extension", "GLX"])
    }

    fn with_options(width: u32, height: u32, options: &[&str]) -> Result<Self> {
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0"])
            .arg(format!("{width}x{height}x24"))
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server =
            server.context("Xvfb cannot be started; install it: bash .ci/packages xvfb")?;
        let mut number = String::new();
        let told = server.stdout.take().context("a pipe")?;
        BufReader::new(told).read_line(&mut number)?;
        if number.trim().is_empty() {
            let status = server.wait()?;
            bail!("Xvfb ended without a display: {status}");
        }
        let name = format!(":{}", number.trim());
        let (connection, screen) = x11rb::connect(Some(&name))?;
        let root = connection.setup().roots[screen].root;
        let xtest = connection.extension_information("XTEST")?;
        let xtest = xtest.context("Xvfb has no XTEST")?.major_opcode;
        Ok(Self {
            server,
            name,
            connection,
            root,
            xtest,
        })
    }

    /// The first window whose title contains this, while it is shown.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn window(&self, title: &str) -> Result<Option<Window>> {
        let tree = self.connection.query_tree(self.root)?.reply()?;
        for window in tree.children {
            let shown = self.connection.get_window_attributes(window)?.reply();
            let is_shown = shown.is_ok_and(|shown| shown.map_state == xproto::MapState::VIEWABLE);
            if is_shown && self.title(window)?.contains(title) {
                return Ok(Some(window));
            }
        }
        Ok(None)
    }

    fn title(&self, window: Window) -> Result<String> {
        let (title, any) = (AtomEnum::WM_NAME, AtomEnum::ANY);
        let connection = &self.connection;
        let reply = connection.get_property(false, window, title, any, 0, 256)?;
        let found = reply.reply();
        Ok(found.map_or_else(
            |_| String::new(),
            |reply| String::from_utf8_lossy(&reply.value).into_owned(),
        ))
    }

    /// Keys go to this window: there is no window manager that would see to it.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn focus(&self, window: Window) -> Result<()> {
        let connection = &self.connection;
        connection
            .set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME)?
            .check()?;
        Ok(())
    }

    /// Resizes a window and puts it into the upper left corner.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn fill(&self, window: Window, width: u32, height: u32) -> Result<()> {
        let place = xproto::ConfigureWindowAux::new().x(0).y(0);
        let place = place.width(width).height(height);
        self.connection.configure_window(window, &place)?.check()?;
        Ok(())
    }

    fn fake(&self, kind: u8, detail: u8, (x, y): (i16, i16)) -> Result<()> {
        // Built by hand: the feature of x11rb would have winit, eframe and their dependents built twice.
        let mut request = [0; 36];
        request[..4].copy_from_slice(&[self.xtest, FAKE_INPUT, 9, 0]);
        request[4..6].copy_from_slice(&[kind, detail]);
        request[12..16].copy_from_slice(&self.root.to_ne_bytes());
        request[24..26].copy_from_slice(&x.to_ne_bytes());
        request[26..28].copy_from_slice(&y.to_ne_bytes());
        let slices = [IoSlice::new(&request)];
        let sent = self
            .connection
            .send_request_without_reply(&slices, Vec::new())?;
        sent.check()?;
        Ok(())
    }

    /// Moves the pointer.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn move_to(&self, (x, y): (i16, i16)) -> Result<()> {
        self.fake(xproto::MOTION_NOTIFY_EVENT, 0, (x, y))
    }

    /// Presses the left button, or releases it.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn button(&self, pressed: bool) -> Result<()> {
        let kind = match pressed {
            true => xproto::BUTTON_PRESS_EVENT,
            false => xproto::BUTTON_RELEASE_EVENT,
        };
        self.fake(kind, 1, (0, 0))
    }

    /// Strikes the key of a keysym while others are held.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn strike(&self, held: &[u32], key: u32) -> Result<()> {
        let (code, shifted) = self.code(key)?;
        let mut held = held.to_vec();
        if shifted && !held.contains(&keys::SHIFT) {
            held.push(keys::SHIFT);
        }
        let held: Result<Vec<u8>> = held.iter().map(|key| Ok(self.code(*key)?.0)).collect();
        let held = held?;
        let (press, release) = (xproto::KEY_PRESS_EVENT, xproto::KEY_RELEASE_EVENT);
        held.iter()
            .try_for_each(|code| self.fake(press, *code, (0, 0)))?;
        self.fake(press, code, (0, 0))?;
        self.fake(release, code, (0, 0))?;
        held.iter()
            .rev()
            .try_for_each(|code| self.fake(release, *code, (0, 0)))
    }

    /// Types letters, digits and signs of ASCII.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn write(&self, text: &str) -> Result<()> {
        ensure!(text.is_ascii(), "{text} cannot be typed");
        text.bytes()
            .try_for_each(|byte| self.strike(&[], u32::from(byte)))
    }

    /// The key that has this keysym, and whether with the shift key.
    fn code(&self, key: u32) -> Result<(u8, bool)> {
        let setup = self.connection.setup();
        let count = setup.max_keycode - setup.min_keycode + 1;
        let mapping = self
            .connection
            .get_keyboard_mapping(setup.min_keycode, count)?
            .reply()?;
        let width = usize::from(mapping.keysyms_per_keycode);
        let rows = mapping.keysyms.chunks(width);
        for (row, code) in rows.zip(setup.min_keycode..) {
            if let Some(level) = row.iter().take(2).position(|sym| *sym == key) {
                return Ok((code, level == 1));
            }
        }
        bail!("no key has the keysym {key:#x}")
    }

    /// Pixels of a part of the screen: left, top, width, height.
    ///
    /// # Errors
    /// If the display or the program fails, or at the time limit.
    pub fn picture(&self, (x, y, width, height): (i16, i16, u16, u16)) -> Result<RgbaImage> {
        let connection = &self.connection;
        let whole = ImageFormat::Z_PIXMAP;
        let image = connection
            .get_image(whole, self.root, x, y, width, height, u32::MAX)?
            .reply()?;
        let bytes = image.data.chunks_exact(4);
        let pixels: Vec<u8> = bytes.flat_map(|p| [p[2], p[1], p[0], 255]).collect();
        RgbaImage::from_raw(width.into(), height.into(), pixels).context("32 bits per pixel")
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
