//! Rust source as a list of words and punctuation, without comments and literals.
//!
//! A syntax tree would not do: paths inside of macro calls count as imports, too.

/// A word or one character of punctuation (`::` counts as one).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    pub text: &'a str,
    pub line: usize,
}

/// Splits a source text. Literals and lifetimes are left out.
pub fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut scanner = Scanner {
        source,
        at: 0,
        line: 1,
        found: Vec::new(),
    };
    while scanner.at < source.len() {
        scanner.step();
    }
    scanner.found
}

struct Scanner<'a> {
    source: &'a str,
    at: usize,
    line: usize,
    found: Vec<Token<'a>>,
}

impl<'a> Scanner<'a> {
    fn rest(&self) -> &'a str {
        &self.source[self.at..]
    }

    /// Moves on by a number of bytes, which end between two characters.
    fn skip(&mut self, bytes: usize) {
        let end = (self.at + bytes).min(self.source.len());
        self.line += self.source[self.at..end].matches('\n').count();
        self.at = end;
    }

    /// Moves behind the next occurrence of `end`, or to the end of the text.
    fn skip_past(&mut self, end: &str) {
        let rest = self.rest();
        self.skip(rest.find(end).map_or(rest.len(), |at| at + end.len()));
    }

    fn push(&mut self, bytes: usize) {
        let text = &self.rest()[..bytes];
        self.found.push(Token {
            text,
            line: self.line,
        });
        self.skip(bytes);
    }

    fn step(&mut self) {
        let rest = self.rest();
        let word = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        if rest.starts_with("//") {
            self.skip_past("\n");
        } else if rest.starts_with("/*") {
            self.skip_block_comment();
        } else if let Some(hashes) = raw_string(rest) {
            self.skip_past("\"");
            self.skip_past(&format!("\"{}", "#".repeat(hashes)));
        } else if rest.starts_with('"') || rest.starts_with("b\"") || rest.starts_with("c\"") {
            self.skip_past("\"");
            self.skip_quoted('"');
        } else if rest.starts_with('\'') || rest.starts_with("b'") {
            self.skip_past("'");
            self.skip_character_or_lifetime();
        } else if rest.starts_with("r#") && rest[2..].starts_with(is_word) {
            self.skip(2);
        } else if word > 0 {
            self.push(word);
        } else if rest.starts_with("::") {
            self.push(2);
        } else {
            let character = rest.chars().next().map_or(1, char::len_utf8);
            if rest.starts_with(char::is_whitespace) {
                self.skip(character);
            } else {
                self.push(character);
            }
        }
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        loop {
            let rest = self.rest();
            if rest.starts_with("/*") {
                depth += 1;
                self.skip(2);
            } else if rest.starts_with("*/") {
                depth -= 1;
                self.skip(2);
            } else {
                self.skip(rest.chars().next().map_or(0, char::len_utf8));
            }
            if depth == 0 || self.at == self.source.len() {
                return;
            }
        }
    }

    /// Moves behind the closing quote; a backslash guards the character after it.
    fn skip_quoted(&mut self, quote: char) {
        let mut is_guarded = false;
        for (at, character) in self.rest().char_indices() {
            if character == quote && !is_guarded {
                self.skip(at + 1);
                return;
            }
            is_guarded = character == '\\' && !is_guarded;
        }
        self.skip(self.rest().len());
    }

    fn skip_character_or_lifetime(&mut self) {
        let mut characters = self.rest().chars();
        let (first, second) = (characters.next(), characters.next());
        if first == Some('\\') || second == Some('\'') {
            self.skip_quoted('\'');
        } else {
            let rest = self.rest();
            self.skip(rest.find(|c| !is_word(c)).unwrap_or(rest.len()));
        }
    }
}

fn is_word(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Number of `#` of a raw string that begins here.
fn raw_string(rest: &str) -> Option<usize> {
    let start = rest.strip_prefix(['b', 'c']).unwrap_or(rest);
    let hashes = start.strip_prefix('r')?;
    let quote = hashes.find(|c| c != '#')?;
    hashes[quote..].starts_with('"').then_some(quote)
}
