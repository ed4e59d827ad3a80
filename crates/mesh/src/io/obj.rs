//! Wavefront OBJ: `v`, `vn` and `f`.
//!
//! Our own reader because libraries that follow `g` and `usemtl` give every group its own vertices and so cut the mesh apart along
//! the borders of materials. Here a vertex is a `v` line, whatever texture coordinates and normals faces combine it with.

use glam::DVec3;

use super::{
    Loaded, MeshFormat,
    draft::Draft,
    lexer::{Lexer, excerpt, integer, number},
};
use crate::MeshError;

const FORMAT: MeshFormat = MeshFormat::Obj;

/// Whether the first word is a common keyword followed by something.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let Ok(mut lexer) = Lexer::new(bytes, FORMAT) else { return false };
    let keyword = lexer.word_anywhere();
    let known: [&[u8]; 9] = [b"v", b"vn", b"vt", b"f", b"o", b"g", b"s", b"mtllib", b"usemtl"];
    keyword.is_some_and(|k| known.contains(&k)) && lexer.word().is_some()
}

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, MeshError> {
    let mut lexer = Lexer::new(bytes, FORMAT)?;
    let mut draft = Draft::new(FORMAT);
    loop {
        if let Some(keyword) = lexer.word() {
            statement(keyword, &mut lexer, &mut draft)?;
        }
        if !lexer.next_line() {
            return draft.finish();
        }
    }
}

fn statement(keyword: &[u8], lexer: &mut Lexer<'_>, draft: &mut Draft) -> Result<(), MeshError> {
    let at = lexer.place();
    match keyword {
        b"v" => {
            let vertex = draft.positions.len();
            let mut p = [0.0; 3];
            for x in &mut p {
                let word = word_of(lexer, "a vertex has three coordinates")?;
                *x = lexer.coordinate(word, vertex)?;
            }
            draft.positions.push(p.into());
            // A weight, a colour, or both; not numbers in some files.
            if lexer.word().is_some() {
                draft.ignore("colour or weight of a vertex", 1, at);
            }
        }
        b"vn" => {
            let mut n = [0.0; 3];
            for x in &mut n {
                let word = word_of(lexer, "a normal has three coordinates")?;
                *x = number(word).ok_or_else(|| lexer.syntax(word, "a number"))?;
            }
            draft.normals.push(DVec3::from(n));
        }
        b"f" | b"fo" => {
            while let Some(word) = lexer.word() {
                corner(word, lexer, draft)?;
            }
            if draft.open_corners() < 3 && lexer.remaining() == 0 {
                return Err(lexer.truncated("another corner of the face"));
            }
            draft.end_polygon(at);
        }
        b"l" => draft.ignore("line element (l)", 1, at),
        b"p" => draft.ignore("point element (p)", 1, at),
        b"vt" | b"vp" | b"g" | b"o" | b"s" | b"mg" | b"usemtl" | b"mtllib" | b"usemap" | b"maplib"
        | b"lod" | b"bevel" | b"c_interp" | b"d_interp" | b"shadow_obj" | b"trace_obj" => {}
        b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim"
        | b"hole" | b"scrv" | b"sp" | b"end" | b"con" => {
            draft.ignore("statement of a free-form surface", 1, at)
        }
        _ => draft.ignore("unknown statement", 1, at),
    }
    Ok(())
}

/// The next word of the line, which must be there.
fn word_of<'a>(lexer: &mut Lexer<'a>, expected: &'static str) -> Result<&'a [u8], MeshError> {
    match lexer.word() {
        Some(word) => Ok(word),
        None if lexer.remaining() == 0 => Err(lexer.truncated(expected)),
        None => Err(lexer.syntax(b"end of line", expected)),
    }
}

/// `v`, `v/t`, `v//n`, `v/t/n`; missing numbers after a slash are tolerated, texture coordinates not looked at.
fn corner(word: &[u8], lexer: &Lexer<'_>, draft: &mut Draft) -> Result<(), MeshError> {
    let at = lexer.place();
    let mut parts = word.split(|&b| b == b'/');
    let vertex = parts.next().unwrap_or_default();
    let normal = parts.nth(1).filter(|part| !part.is_empty());
    let resolve = |part: &[u8], what: &'static str, count: usize| match integer::<i64>(part) {
        Some(0) => Err(draft.index_error(what, "0".into(), at)),
        Some(i) if i > 0 => Ok(i - 1),
        // Relative to what has been defined so far.
        Some(i) => i
            .checked_add(count as i64)
            .filter(|&i| i >= 0)
            .ok_or_else(|| draft.index_error(what, i.to_string(), at)),
        None if is_integer(part) => Err(draft.index_error(what, excerpt(part), at)),
        None => Err(lexer.syntax(word, "a corner such as 7, 7/2, 7//3 or 7/2/3")),
    };
    let v = resolve(vertex, "vertex", draft.positions.len())?;
    let n = normal.map(|part| resolve(part, "normal", draft.normals.len())).transpose()?;
    draft.corner(v, n, at, word)
}

fn is_integer(part: &[u8]) -> bool {
    let digits = part.strip_prefix(b"-").or(part.strip_prefix(b"+")).unwrap_or(part);
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Place, io::Notice};

    fn load(text: &str) -> Result<Loaded, MeshError> {
        read(text.as_bytes())
    }

    #[test]
    fn every_form_of_a_corner() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                    f 1 2 3\nf 1/1 2/1 3/1\nf 1/1/1 2/1/1 3/1/1\nf 1// 2// 3//\nf -3 -2/-1 -1/-1\n";
        let loaded = load(text).unwrap();
        assert_eq!(loaded.mesh.faces, vec![[0, 1, 2]; 5]);
        assert_eq!(loaded.notices, [Notice::DroppedNormals { reason: "some faces name none" }]);
    }

    #[test]
    fn groups_and_materials_do_not_cut_the_mesh() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ng a\nusemtl x\nf 1 2 3\ng b\nusemtl y\nf 3 2 4\n";
        let loaded = load(text).unwrap();
        assert_eq!((loaded.mesh.positions.len(), loaded.mesh.faces.len()), (4, 2));
        assert!(loaded.notices.is_empty());
    }

    #[test]
    fn normals_are_kept_to_the_bit_or_averaged_with_a_notice() {
        let text =
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 2\nvn 2 0 0\nf 1//1 2//1 3//1\nf 3//2 2//1 4//2\n";
        let loaded = load(text).unwrap();
        let normals = loaded.mesh.normals.unwrap();
        assert_eq!((normals[0], normals[1], normals[3]), (2.0 * DVec3::Z, 2.0 * DVec3::Z, 2.0 * DVec3::X));
        assert!((normals[2] - (DVec3::X + DVec3::Z).normalize()).length() < 1e-15);
        assert_eq!(loaded.notices, [Notice::AveragedNormals { vertices: 1 }]);
    }

    #[test]
    fn errors_name_the_line() {
        let base = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        for (line, place) in [("f 1 2 4\n", 4), ("f 0 1 2\n", 4), ("\nf 1 2 99999999999999999999\n", 5)] {
            match load(&format!("{base}{line}")) {
                Err(MeshError::Index { at, .. }) => assert_eq!(at, Place::Line(place)),
                other => panic!("{line}: {other:?}"),
            }
        }
        let e = load("v 0 0 0\nv 1 nan 0\n").unwrap_err();
        assert_eq!(
            e.to_string(),
            "OBJ, line 2: coordinate `nan` of vertex 1 (from 0) is not a finite number; correct or remove the vertex"
        );
        assert!(matches!(load("v 1 2\nf 1 1 1\n"), Err(MeshError::Syntax { at: Place::Line(1), .. })));
        assert!(matches!(load("v 0 0 0\nf 1 -2 1\n"), Err(MeshError::Index { .. })));
    }

    #[test]
    fn a_face_may_run_ahead_of_its_vertices() {
        assert_eq!(load("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap().mesh.faces, [[0, 1, 2]]);
    }

    #[test]
    fn two_corners_are_skipped_unless_the_file_ends_there() {
        let base = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2";
        assert!(matches!(load(base), Err(MeshError::Truncated { at: Place::Line(5), .. })));
        let loaded = load(&format!("{base}\n")).unwrap();
        assert_eq!(loaded.notices, [Notice::SkippedFaces { faces: 1, first: Place::Line(5), corners: 2 }]);
    }
}
