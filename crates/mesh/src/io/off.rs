//! Geomview OFF: `[ST][C][N]OFF`, ASCII.
//!
//! Colours may follow the coordinates of a vertex and the indices of a face; how many numbers they have differs among programs, so
//! that the rest of the line is skipped. Files with everything on one line have no such rest.

use glam::DVec3;

use super::{
    Loaded, MeshFormat,
    draft::Draft,
    lexer::{Lexer, excerpt, integer, number},
};
use crate::MeshError;

const FORMAT: MeshFormat = MeshFormat::Off;

/// Whether the first word begins with a header keyword.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let Ok(mut lexer) = Lexer::new(bytes, FORMAT) else { return false };
    lexer.word_anywhere().is_some_and(|word| Header::parse(word).is_some())
}

#[derive(Clone, Copy, Debug, Default)]
struct Header {
    /// Length of the keyword in its word; counts may be glued to it.
    length: usize,
    normals: bool,
    dimension_four: bool,
    dimension_any: bool,
}

impl Header {
    /// `[ST][C][N][4][n]OFF` at the beginning of a word.
    fn parse(word: &[u8]) -> Option<Self> {
        let mut header = Self::default();
        let mut rest = word;
        let mut flag = |prefix: &[u8]| match rest.strip_prefix(prefix) {
            Some(after) => {
                rest = after;
                true
            }
            None => false,
        };
        flag(b"ST");
        flag(b"C");
        header.normals = flag(b"N");
        header.dimension_four = flag(b"4");
        header.dimension_any = flag(b"n");
        let named = flag(b"OFF") || flag(b"off");
        let glued = rest.is_empty() || rest[0].is_ascii_digit();
        header.length = word.len() - rest.len();
        (named && glued).then_some(header)
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, MeshError> {
    let mut lexer = Lexer::new(bytes, FORMAT)?;
    let word = lexer.clone().require("the header `OFF`")?;
    let Some(header) = Header::parse(word) else {
        return Err(lexer.syntax(word, "the header `OFF` (or COFF, NOFF, CNOFF, STOFF)"));
    };
    // The counts may be glued to the keyword.
    lexer.word_part(|_| Some(header.length));
    let at = lexer.place();
    let unsupported = |what| MeshError::Unsupported { format: FORMAT, at, what };
    if header.dimension_four || header.dimension_any {
        return Err(unsupported("4OFF and nOFF have coordinates of another dimension; convert to OFF"));
    }
    if lexer.clone().word().is_some_and(|word| word == b"BINARY") {
        return Err(unsupported("binary OFF is not read; save it as ASCII"));
    }
    let mut body = Body { draft: Draft::new(FORMAT), lexer, lines: false };
    let [vertices, faces] = body.counts()?;
    body.vertices(vertices, header.normals)?;
    body.faces(faces)?;
    if body.lexer.word_anywhere().is_some() {
        body.draft.ignore("data after the last face", 1, body.lexer.place());
    }
    body.draft.finish()
}

struct Body<'a> {
    draft: Draft,
    lexer: Lexer<'a>,
    /// Whether every vertex and face begins a line of its own.
    lines: bool,
}

impl Body<'_> {
    /// Numbers of vertices and faces; that of edges may be missing.
    fn counts(&mut self) -> Result<[u64; 2], MeshError> {
        let mut counts = [0; 2];
        for count in &mut counts {
            let word = self.lexer.require("the numbers of vertices, faces and edges")?;
            *count = integer(word).ok_or_else(|| self.lexer.syntax(word, "a number of vertices or faces"))?;
        }
        if let Some(word) = self.lexer.word() {
            integer::<u64>(word).ok_or_else(|| self.lexer.syntax(word, "a number of edges"))?;
        } else {
            // A number alone on the next line is that of edges, not a vertex.
            let mut ahead = self.lexer.clone();
            let alone = ahead.word_anywhere().is_some_and(|w| integer::<u64>(w).is_some());
            if alone && ahead.word().is_none() {
                self.lexer = ahead;
            }
        }
        self.lines = self.lexer.clone().word().is_none();
        Ok(counts)
    }

    /// Refuses a count whose shortest possible text, `size` bytes each, is longer than the rest of the file.
    fn fits(&self, claimed: u64, size: u64, what: &str) -> Result<usize, MeshError> {
        // The last one needs no line end.
        let possible = (self.lexer.remaining() as u64 + 1) / size;
        if claimed <= possible {
            return Ok(claimed as usize);
        }
        let (at, what) = (self.lexer.place(), what.to_owned());
        Err(MeshError::CountExceedsFile { format: FORMAT, at, what, claimed, possible })
    }

    fn vertices(&mut self, count: u64, normals: bool) -> Result<(), MeshError> {
        let count = self.fits(count, if normals { 12 } else { 6 }, "vertices")?;
        self.draft.positions.reserve_exact(count);
        for vertex in 0..count {
            let mut p = [0.0; 3];
            for x in &mut p {
                let word = self.lexer.require("a vertex")?;
                *x = self.lexer.coordinate(word, vertex)?;
            }
            self.draft.positions.push(p.into());
            if normals {
                let mut n = [0.0; 3];
                for x in &mut n {
                    let word = self.lexer.require("a normal")?;
                    *x = number(word).ok_or_else(|| self.lexer.syntax(word, "a number"))?;
                }
                self.draft.normals.push(DVec3::from(n));
            }
            self.skip_colour("colour or texture coordinate of a vertex");
        }
        Ok(())
    }

    fn faces(&mut self, count: u64) -> Result<(), MeshError> {
        let count = self.fits(count, 2, "faces")?;
        for _ in 0..count {
            let word = self.lexer.require("a face")?;
            let at = self.lexer.place();
            let corners: u64 =
                integer(word).ok_or_else(|| self.lexer.syntax(word, "the number of corners of a face"))?;
            let corners = self.fits(corners, 2, "corners of a face")?;
            for _ in 0..corners {
                let word = self.lexer.require("a vertex index")?;
                self.index(word)?;
            }
            self.draft.end_polygon(at);
            self.skip_colour("colour of a face");
        }
        Ok(())
    }

    fn index(&mut self, word: &[u8]) -> Result<(), MeshError> {
        let at = self.lexer.place();
        let digits = word.strip_prefix(b"-").unwrap_or(word);
        match integer::<i64>(word) {
            Some(index) => self.draft.corner(index, None, at, word),
            None if !digits.is_empty() && digits.iter().all(u8::is_ascii_digit) => {
                Err(self.draft.index_error("vertex", excerpt(word), at))
            }
            None => Err(self.lexer.syntax(word, "a vertex index")),
        }
    }

    fn skip_colour(&mut self, what: &str) {
        if self.lines {
            let at = self.lexer.place();
            if self.lexer.word().is_some() {
                self.draft.ignore(what, 1, at);
            }
            self.lexer.next_line();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str) -> Loaded {
        let loaded = read(text.as_bytes()).unwrap();
        assert_eq!(loaded.mesh.faces, [[0, 1, 2]], "{text}");
        assert_eq!(loaded.mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::Y], "{text}");
        loaded
    }

    #[test]
    fn header_variants() {
        check("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        check("OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2");
        check("OFF\n3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        check("OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2");
        check("# c\n\n  COFF # c\n\n3 1\n0 0 0 1 1 1 1\n1 0 0 0.5\n0 1 0 255 0 0\n3 0 1 2 7\n");
        let loaded =
            check("CNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9\n1 0 0 0 0 1 9 9 9\n0 1 0 0 0 1 9 9 9\n3 0 1 2\n");
        assert_eq!(loaded.mesh.normals, Some(vec![DVec3::Z; 3]));
    }

    #[test]
    fn what_is_not_read_says_so() {
        for text in ["4OFF\n1 1 1\n", "OFF BINARY\n", "nOFF\n3\n"] {
            assert!(matches!(read(text.as_bytes()), Err(MeshError::Unsupported { .. })), "{text}");
        }
        assert!(matches!(read(b"OFFICE 1 2 3"), Err(MeshError::Syntax { .. })));
        assert!(matches!(read(b"OFF\n3 -1 0\n"), Err(MeshError::Syntax { .. })));
    }

    #[test]
    fn points_and_edges_are_skipped_with_a_notice() {
        let loaded = check("OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n1 0\n2 0 1\n3 0 1 2\n");
        assert_eq!(loaded.notices.len(), 1, "{:?}", loaded.notices);
    }
}
