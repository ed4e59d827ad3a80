//! Words and lines of the text formats.

use crate::{MeshError, Place, io::MeshFormat};

/// Splits bytes into words and lines; counts lines. Lines end with LF, CRLF or CR.
#[derive(Clone, Debug)]
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
    format: MeshFormat,
    /// `#` begins a comment.
    comments: bool,
    /// A backslash at the end of a line joins it with the next one.
    continuation: bool,
}

impl<'a> Lexer<'a> {
    /// Over `bytes` without its byte order mark, if it has one.
    pub(super) fn new(bytes: &'a [u8], format: MeshFormat) -> Result<Self, MeshError> {
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            let what = "the text is UTF-16; save it as UTF-8";
            return Err(MeshError::Unsupported { format, at: Place::Line(1), what });
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let comments = matches!(format, MeshFormat::Obj | MeshFormat::Off);
        Ok(Self { bytes, at: 0, line: 1, format, comments, continuation: format == MeshFormat::Obj })
    }

    pub(super) fn place(&self) -> Place {
        Place::Line(self.line)
    }

    /// Bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The bytes not yet read.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The next word on this line or a later one, of which `length` says how many bytes to read.
    pub(super) fn word_part(&mut self, length: impl FnOnce(&[u8]) -> Option<usize>) -> Option<&'a [u8]> {
        let word = self.word_anywhere()?;
        let length = length(word)?.min(word.len());
        self.at -= word.len() - length;
        Some(&word[..length])
    }

    /// The next word of this line.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            match *self.bytes.get(self.at)? {
                b'\n' | b'\r' => return None,
                b'#' if self.comments => {
                    self.skip_while(|b| !is_newline(b));
                    return None;
                }
                b'\\' => match self.continues() {
                    Some(next) => {
                        self.at = next;
                        self.line += 1;
                    }
                    None => break,
                },
                b if is_blank(b) => self.at += 1,
                _ => break,
            }
        }
        let start = self.at;
        while let Some(&b) = self.bytes.get(self.at) {
            let ends = is_blank(b)
                || is_newline(b)
                || (b == b'#' && self.comments)
                || (b == b'\\' && self.continues().is_some());
            if ends {
                break;
            }
            self.at += 1;
        }
        Some(&self.bytes[start..self.at])
    }

    /// Goes to the beginning of the next line; `false` at the end of the file.
    pub(super) fn next_line(&mut self) -> bool {
        while self.word().is_some() {}
        match newline(&self.bytes[self.at..]) {
            0 => false,
            length => {
                self.at += length;
                self.line += 1;
                true
            }
        }
    }

    /// The next word on this line or a later one.
    pub(super) fn word_anywhere(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.word() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// `word_anywhere`, which must be there.
    pub(super) fn require(&mut self, expected: &'static str) -> Result<&'a [u8], MeshError> {
        self.word_anywhere().ok_or_else(|| self.truncated(expected))
    }

    pub(super) fn truncated(&self, expected: &'static str) -> MeshError {
        MeshError::Truncated { format: self.format, at: self.place(), expected }
    }

    pub(super) fn syntax(&self, found: &[u8], expected: &'static str) -> MeshError {
        MeshError::Syntax { format: self.format, at: self.place(), found: excerpt(found), expected }
    }

    /// `word` as a coordinate of `vertex`.
    pub(super) fn coordinate(&self, word: &[u8], vertex: usize) -> Result<f64, MeshError> {
        let value = number(word).ok_or_else(|| self.syntax(word, "a coordinate"))?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(MeshError::NotFinite { format: self.format, at: self.place(), vertex, value: excerpt(word) })
    }

    fn skip_while(&mut self, condition: impl Fn(u8) -> bool) {
        while self.bytes.get(self.at).is_some_and(|&b| condition(b)) {
            self.at += 1;
        }
    }

    /// Where the next line begins, if the backslash here joins it to this one.
    fn continues(&self) -> Option<usize> {
        if !self.continuation {
            return None;
        }
        let rest = &self.bytes[self.at + 1..];
        let blanks = rest.iter().take_while(|&&b| is_blank(b)).count();
        let length = newline(&rest[blanks..]);
        (length > 0).then_some(self.at + 1 + blanks + length)
    }
}

/// `word` as a number, NaN and infinities included.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// `word` as an integer, or `None` where it is none or overflows.
pub(super) fn integer<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// At most 32 printable characters of `word`.
pub(super) fn excerpt(word: &[u8]) -> String {
    const LIMIT: usize = 32;
    let shown: String = String::from_utf8_lossy(&word[..word.len().min(4 * LIMIT)])
        .chars()
        .take(LIMIT)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    let cut = word.len() > 4 * LIMIT || String::from_utf8_lossy(word).chars().count() > LIMIT;
    if cut { shown + "…" } else { shown }
}

/// Length of the line end that `bytes` begins with, or 0.
pub(super) fn newline(bytes: &[u8]) -> usize {
    match bytes {
        [b'\r', b'\n', ..] => 2,
        [b'\r' | b'\n', ..] => 1,
        _ => 0,
    }
}

fn is_newline(b: u8) -> bool {
    matches!(b, b'\n' | b'\r')
}

fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0b | 0x0c)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(u64, String)> {
        let mut lexer = Lexer::new(text.as_bytes(), MeshFormat::Obj).unwrap();
        let mut found = Vec::new();
        while let Some(word) = lexer.word_anywhere() {
            let Place::Line(line) = lexer.place() else { unreachable!() };
            found.push((line, String::from_utf8_lossy(word).into_owned()));
        }
        found
    }

    #[track_caller]
    fn check(text: &str, expected: &[(u64, &str)]) {
        let expected: Vec<_> = expected.iter().map(|&(line, word)| (line, word.to_owned())).collect();
        assert_eq!(words(text), expected);
    }

    #[test]
    fn line_ends_of_all_systems_count_once() {
        check("a\nb\r\nc\rd", &[(1, "a"), (2, "b"), (3, "c"), (4, "d")]);
    }

    #[test]
    fn a_backslash_joins_lines_even_before_blanks_and_inside_a_word() {
        check("a \\\nb\\ \r\nc\\d", &[(1, "a"), (2, "b"), (3, "c\\d")]);
    }

    #[test]
    fn a_backslash_in_a_comment_joins_nothing() {
        check("a # b \\\nc#d", &[(1, "a"), (2, "c")]);
    }

    #[test]
    fn a_byte_order_mark_is_no_word_and_utf_16_is_refused() {
        check("\u{feff}v", &[(1, "v")]);
        assert!(matches!(
            Lexer::new(&[0xff, 0xfe, b'v', 0], MeshFormat::Obj),
            Err(MeshError::Unsupported { .. })
        ));
    }
}
