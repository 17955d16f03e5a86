//! An X display for the tests, and as much of the X protocol as is needed to act like a user of a window.

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Message if Xvfb is missing.
const MISSING: &str =
    "Xvfb is not installed, so the window cannot be tested; on Debian and Ubuntu run `apt-get install xvfb`";

/// An X server without a screen, which ends when this is dropped.
pub struct Display {
    server: Child,
    pub name: String,
}

impl Display {
    pub fn start() -> Self {
        let arguments = ["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"];
        let mut command = Command::new("Xvfb");
        command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = command.spawn().unwrap_or_else(|error| panic!("{MISSING} ({error})"));
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb found no free display");
        Self { server, name: format!(":{}", number.trim()) }
    }

    pub fn connect(&self) -> Client {
        Client::new(&self.name[1..])
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A connection to a display.
pub struct Client {
    stream: UnixStream,
    root: u32,
    /// Major opcode of the XTEST extension.
    xtest: u8,
}

/// Keys by their codes on a PC keyboard.
#[derive(Clone, Copy)]
pub enum Key {
    Three = 12,
    Control = 37,
    Z = 52,
}

/// Encodes a request: opcode, data byte, and the rest as 32-bit words.
fn request(code: u8, small: u8, words: &[u32]) -> Vec<u8> {
    let length = (words.len() as u16 + 1).to_le_bytes();
    let head = [code, small, length[0], length[1]];
    head.into_iter().chain(words.iter().flat_map(|word| word.to_le_bytes())).collect()
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

impl Client {
    fn new(number: &str) -> Self {
        let mut stream = UnixStream::connect(format!("/tmp/.X11-unix/X{number}")).unwrap();
        // Little endian, version 11.0, no authority.
        stream.write_all(&[b'l', 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap();
        let mut head = [0; 8];
        stream.read_exact(&mut head).unwrap();
        assert_eq!(head[0], 1, "the display refused the connection");
        let mut setup = vec![0; 4 * usize::from(u16::from_le_bytes([head[6], head[7]]))];
        stream.read_exact(&mut setup).unwrap();
        let vendor = usize::from(u16::from_le_bytes([setup[16], setup[17]])).next_multiple_of(4);
        let root = word(&setup, 32 + vendor + 8 * usize::from(setup[21]));
        let mut client = Self { stream, root, xtest: 0 };
        let name = *b"XTEST\0\0\0";
        let answer = client.request_reply(&request(98, 0, &[5, word(&name, 0), word(&name, 4)]));
        assert_eq!(answer[8], 1, "the display has no XTEST");
        client.xtest = answer[9];
        client
    }

    fn send(&mut self, request: &[u8]) {
        self.stream.write_all(request).unwrap();
    }

    /// Sends a request and returns its reply.
    fn request_reply(&mut self, request: &[u8]) -> Vec<u8> {
        self.send(request);
        loop {
            let mut answer = vec![0; 32];
            self.stream.read_exact(&mut answer).unwrap();
            match answer[0] {
                // An error: the resource is gone.
                0 => return vec![0; 64],
                1 => {
                    let mut more = vec![0; 4 * word(&answer, 4) as usize];
                    self.stream.read_exact(&mut more).unwrap();
                    return [answer, more].concat();
                }
                _ => {}
            }
        }
    }

    fn atom(&mut self, name: &str) -> u32 {
        let padded = format!("{name:\0<width$}", width = name.len().next_multiple_of(4));
        let name = padded.as_bytes().chunks(4).map(|bytes| word(bytes, 0));
        let words: Vec<_> = [name.len() as u32 * 4].into_iter().chain(name).collect();
        let mut request = request(16, 0, &words);
        // The length of the name without padding.
        request[4] = padded.trim_end_matches('\0').len() as u8;
        word(&self.request_reply(&request), 8)
    }

    /// Waits for a visible window and returns it.
    pub fn window(&mut self) -> u32 {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(60) {
            let tree = self.request_reply(&request(15, 0, &[self.root]));
            let count = usize::from(u16::from_le_bytes([tree[16], tree[17]]));
            let children: Vec<_> = (0..count).map(|index| word(&tree, 32 + 4 * index)).collect();
            let is_seen = |window: &u32| self.request_reply(&request(3, 0, &[*window]))[26] == 2;
            if let Some(window) = children.into_iter().find(is_seen) {
                return window;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("no window appeared");
    }

    pub fn resize(&mut self, window: u32, width: u32, height: u32) {
        self.send(&request(12, 0, &[window, 0x4 | 0x8, width, height]));
    }

    /// Hides a window, as a window manager does to minimise it.
    pub fn unmap(&mut self, window: u32) {
        self.send(&request(10, 0, &[window]));
    }

    pub fn map(&mut self, window: u32) {
        self.send(&request(8, 0, &[window]));
    }

    /// Gives a window the keyboard focus, as a window manager does.
    pub fn focus(&mut self, window: u32) {
        self.send(&request(42, 1, &[window, 0]));
    }

    /// Presses and releases a key while other keys are held.
    pub fn key(&mut self, held: &[Key], key: Key) {
        let keys = || held.iter().chain([&key]);
        keys().for_each(|key| self.fake(2, *key as u32, 0));
        keys().rev().for_each(|key| self.fake(3, *key as u32, 0));
    }

    /// Clicks the left mouse button at a position of the display.
    pub fn click(&mut self, x: u32, y: u32) {
        for (kind, button) in [(6, 0), (4, 1), (5, 1)] {
            self.fake(kind, button, x | y << 16);
        }
    }

    /// Sends a keyboard or mouse event of the display: XTEST's FakeInput.
    fn fake(&mut self, kind: u32, detail: u32, position: u32) {
        self.send(&request(self.xtest, 2, &[kind | detail << 8, 0, self.root, 0, 0, position, 0, 0]));
    }

    /// Asks a window to close, as its close button does.
    pub fn close(&mut self, window: u32) {
        let [protocols, delete] = ["WM_PROTOCOLS", "WM_DELETE_WINDOW"].map(|name| self.atom(name));
        let message = 33 | 32 << 8;
        self.send(&request(25, 0, &[window, 0, message, window, protocols, delete, 0, 0, 0, 0]));
    }
}
