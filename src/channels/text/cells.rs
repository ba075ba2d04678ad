//! One line as cells.

/// Separator of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Separator {
    /// This character.
    Character(char),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    /// The separators to try, most likely first.
    pub const ALL: [Self; 5] = [
        Self::Character('\t'),
        Self::Character(';'),
        Self::Character(','),
        Self::Character('|'),
        Self::Blanks,
    ];
}

/// The cells of one line; the buffers are reused from line to line.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    text: String,
    ranges: Vec<(usize, usize)>,
}

impl Cells {
    /// The cells of a line.
    pub fn of(line: &str, separator: Separator) -> Self {
        let mut cells = Self::default();
        cells.split(line, separator);
        cells
    }

    /// Cells that were separated already.
    pub fn from_texts(texts: &[String]) -> Self {
        let mut cells = Self::default();
        for text in texts {
            let start = cells.text.len();
            cells.text.push_str(text.trim());
            cells.ranges.push((start, cells.text.len()));
        }
        cells
    }

    /// Splits a line. Quotation marks around a cell protect separators and, doubled, themselves.
    pub fn split(&mut self, line: &str, separator: Separator) {
        self.text.clear();
        self.ranges.clear();
        self.text.push_str(line);
        match separator {
            Separator::Blanks => self.split_at_blanks(),
            Separator::Character(at) if line.contains('"') => self.split_quoted(line, at),
            Separator::Character(at) => {
                let mut start = 0;
                for (end, _) in line.match_indices(at) {
                    self.push_trimmed(start, end);
                    start = end + at.len_utf8();
                }
                self.push_trimmed(start, line.len());
            }
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.ranges.len()
    }

    /// A cell without blanks around it; empty if there are fewer.
    pub fn get(&self, k: usize) -> &str {
        self.ranges
            .get(k)
            .map_or("", |(start, end)| &self.text[*start..*end])
    }

    /// All cells.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.len()).map(|k| self.get(k))
    }

    /// Whether no cell has a text.
    pub fn are_blank(&self) -> bool {
        self.iter().all(str::is_empty)
    }

    fn push_trimmed(&mut self, start: usize, end: usize) {
        let cell = &self.text[start..end];
        let left = cell.len() - cell.trim_start().len();
        let right = cell.trim().len();
        self.ranges.push((start + left, start + left + right));
    }

    fn split_at_blanks(&mut self) {
        let mut start = None;
        for (at, letter) in self.text.char_indices() {
            match (letter.is_whitespace(), start) {
                (true, Some(from)) => {
                    self.ranges.push((from, at));
                    start = None;
                }
                (false, None) => start = Some(at),
                _ => {}
            }
        }
        if let Some(from) = start {
            self.ranges.push((from, self.text.len()));
        }
    }

    fn split_quoted(&mut self, line: &str, at: char) {
        self.text.clear();
        let mut start = 0;
        let mut quoted = false;
        let mut letters = line.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '"' if quoted && letters.peek() == Some(&'"') => {
                    letters.next();
                    self.text.push('"');
                }
                '"' if quoted => quoted = false,
                '"' if self.text[start..].trim().is_empty() => quoted = true,
                _ if letter == at && !quoted => {
                    let end = self.text.len();
                    self.push_trimmed(start, end);
                    start = end;
                }
                _ => self.text.push(letter),
            }
        }
        let end = self.text.len();
        self.push_trimmed(start, end);
    }
}
