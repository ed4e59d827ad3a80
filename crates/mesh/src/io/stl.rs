//! Stereolithography, ASCII and binary, with exactly coincident corners welded.

use std::collections::HashMap;

use glam::DVec3;

use super::{
    Loaded, MeshFormat, Notice,
    draft::Draft,
    lexer::{Lexer, excerpt},
};
use crate::{MeshError, Place, weld_key};

const FORMAT: MeshFormat = MeshFormat::Stl;
const HEADER: usize = 84;
const FACET: usize = 50;

/// Whether the length is exactly that of a binary file, or the text begins like an ASCII one.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    has_binary_length(bytes) || is_ascii(bytes)
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, MeshError> {
    // A binary header may begin with "solid" too: the length decides first.
    if !has_binary_length(bytes) && is_ascii(bytes) { read_ascii(bytes) } else { read_binary(bytes) }
}

fn claimed_facets(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..)?.first_chunk().map(|c| u32::from_le_bytes(*c))
}

fn has_binary_length(bytes: &[u8]) -> bool {
    claimed_facets(bytes)
        .is_some_and(|n| n > 0 && bytes.len() as u64 == HEADER as u64 + u64::from(n) * FACET as u64)
}

fn is_ascii(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let solid = text.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    solid && !bytes.iter().take(HEADER + FACET).any(|&b| b == 0)
}

/// Shares one vertex among all corners with the same coordinates.
#[derive(Default)]
struct Welder {
    vertices: HashMap<[u64; 3], u32>,
    corners: usize,
}

impl Welder {
    fn corner(&mut self, p: DVec3, draft: &mut Draft, at: Place) -> Result<(), MeshError> {
        self.corners += 1;
        let next = draft.positions.len() as u32;
        let vertex = *self.vertices.entry(weld_key(p)).or_insert(next);
        if vertex == next {
            draft.positions.push(p);
        }
        draft.corner(i64::from(vertex), None, at, b"")
    }

    fn finish(self, draft: Draft) -> Result<Loaded, MeshError> {
        let mut loaded = draft.finish()?;
        let after = loaded.mesh.positions.len();
        if after < self.corners {
            loaded.notices.insert(0, Notice::Welded { before: self.corners, after });
        }
        Ok(loaded)
    }
}

fn read_binary(bytes: &[u8]) -> Result<Loaded, MeshError> {
    let end = Place::Byte(bytes.len() as u64);
    let Some(claimed) = claimed_facets(bytes) else {
        return Err(MeshError::Truncated { format: FORMAT, at: end, expected: "the 84-byte header" });
    };
    let body = &bytes[HEADER..];
    let (facets, rest) = body.as_chunks::<FACET>();
    if facets.len() < claimed as usize {
        return Err(MeshError::CountExceedsFile {
            format: FORMAT,
            at: Place::Byte(HEADER as u64),
            what: "facets".into(),
            claimed: claimed.into(),
            possible: facets.len() as u64,
        });
    }
    if claimed == 0 {
        return Err(if body.is_empty() {
            MeshError::NoFaces { format: FORMAT, vertices: 0 }
        } else {
            MeshError::Syntax {
                format: FORMAT,
                at: Place::Byte(0),
                found: excerpt(&bytes[..8]),
                expected: "`solid`, or a binary header with the number of facets at byte 80; is this an STL file?",
            }
        });
    }
    let mut draft = Draft::new(FORMAT);
    let mut welder = Welder::default();
    for (f, facet) in facets.iter().take(claimed as usize).enumerate() {
        let at = Place::Byte((HEADER + f * FACET) as u64);
        for k in 0..3 {
            let mut p = [0.0; 3];
            for (i, x) in p.iter_mut().enumerate() {
                let offset = 12 + 12 * k + 4 * i;
                let word: [u8; 4] = std::array::from_fn(|b| facet[offset + b]);
                let value = f32::from_le_bytes(word);
                if !value.is_finite() {
                    let vertex = 3 * f + k;
                    return Err(MeshError::NotFinite {
                        format: FORMAT,
                        at,
                        vertex,
                        value: value.to_string(),
                    });
                }
                *x = f64::from(value);
            }
            welder.corner(p.into(), &mut draft, at)?;
        }
        draft.end_polygon(at);
    }
    let left = (facets.len() - claimed as usize) * FACET + rest.len();
    if left > 0 {
        draft.ignore("byte after the last facet", left, Place::Byte((bytes.len() - left) as u64));
    }
    welder.finish(draft)
}

fn read_ascii(bytes: &[u8]) -> Result<Loaded, MeshError> {
    let mut lexer = Lexer::new(bytes, FORMAT)?;
    let mut draft = Draft::new(FORMAT);
    let mut welder = Welder::default();
    let mut open = false;
    while let Some(word) = lexer.word_anywhere() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                open = true;
                lexer.next_line();
            }
            b"endsolid" => {
                open = false;
                lexer.next_line();
            }
            b"facet" => {
                let at = lexer.place();
                facet(&mut lexer, &mut draft, &mut welder)?;
                draft.end_polygon(at);
            }
            _ => return Err(lexer.syntax(word, "`facet` or `endsolid`")),
        }
    }
    if open {
        draft.ignore("missing `endsolid`", 1, lexer.place());
    }
    welder.finish(draft)
}

/// Everything after `facet` up to and including `endfacet`. The normal is not looked at: many files have zeros or NaN there.
fn facet(lexer: &mut Lexer<'_>, draft: &mut Draft, welder: &mut Welder) -> Result<(), MeshError> {
    keyword(lexer, b"normal", "`normal`")?;
    for _ in 0..3 {
        lexer.require("the normal of the facet")?;
    }
    keyword(lexer, b"outer", "`outer loop`")?;
    keyword(lexer, b"loop", "`outer loop`")?;
    loop {
        let word = lexer.require("`vertex` or `endloop`")?;
        if word.eq_ignore_ascii_case(b"endloop") {
            break;
        }
        if !word.eq_ignore_ascii_case(b"vertex") {
            return Err(lexer.syntax(word, "`vertex` or `endloop`"));
        }
        let mut p = [0.0; 3];
        for x in &mut p {
            let word = lexer.require("a coordinate")?;
            *x = lexer.coordinate(word, welder.corners)?;
        }
        welder.corner(p.into(), draft, lexer.place())?;
    }
    keyword(lexer, b"endfacet", "`endfacet`")
}

fn keyword(lexer: &mut Lexer<'_>, keyword: &[u8], expected: &'static str) -> Result<(), MeshError> {
    let word = lexer.require(expected)?;
    if word.eq_ignore_ascii_case(keyword) { Ok(()) } else { Err(lexer.syntax(word, expected)) }
}
