//! Stanford PLY, ASCII and binary of either endianness.
//!
//! Of `vertex` the properties `x y z` and `nx ny nz` are read, of `face` the list `vertex_indices` (or `vertex_index`); everything
//! else is stepped over, whatever its types.

use glam::DVec3;

use super::{
    Loaded, MeshFormat,
    draft::Draft,
    lexer::{Lexer, excerpt, integer, newline, number},
};
use crate::{MeshError, Place};

const FORMAT: MeshFormat = MeshFormat::Ply;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, MeshError> {
    let header = Header::parse(bytes)?;
    let mut draft = Draft::new(FORMAT);
    let mut source = Source::new(bytes, &header)?;
    for element in &header.elements {
        source.fits(element)?;
        match element.name.as_str() {
            "vertex" => vertices(element, &mut source, &mut draft)?,
            "face" => faces(element, &mut source, &mut draft)?,
            _ => {
                if element.count > 0 {
                    draft.ignore(
                        &format!("element `{}`", element.name),
                        element.count as usize,
                        source.place(),
                    );
                }
                for _ in 0..if element.properties.is_empty() { 0 } else { element.count } {
                    for property in &element.properties {
                        source.step_over(property)?;
                    }
                    source.end_element(&mut draft);
                }
            }
        }
    }
    if source.trailing() {
        draft.ignore("data after the last element", 1, source.place());
    }
    draft.finish()
}

fn vertices(element: &Element, source: &mut Source<'_>, draft: &mut Draft) -> Result<(), MeshError> {
    if element.count == 0 {
        return Ok(());
    }
    let find = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_none());
    let position = [find("x"), find("y"), find("z")];
    if position.contains(&None) {
        return Err(element.missing("the scalar properties x, y and z of `vertex`"));
    }
    let normal = [find("nx"), find("ny"), find("nz")];
    let normals = !normal.contains(&None);
    let count = element.count as usize;
    draft.positions.reserve_exact(count);
    if normals {
        draft.normals.reserve_exact(count);
    }
    for vertex in 0..count {
        let (mut p, mut n) = ([0.0; 3], [0.0; 3]);
        for (k, property) in element.properties.iter().enumerate() {
            if property.list.is_some() {
                source.step_over(property)?;
                continue;
            }
            let place = source.place();
            // A colour may be no number at all; only what is used must be one.
            let Some(axis) = position.iter().position(|&i| i == Some(k)) else {
                match normal.iter().position(|&i| i == Some(k)) {
                    Some(axis) => n[axis] = source.number(property.scalar)?,
                    None => source.step_over(property)?,
                }
                continue;
            };
            let x = source.number(property.scalar)?;
            if !x.is_finite() {
                return Err(MeshError::NotFinite { format: FORMAT, at: place, vertex, value: x.to_string() });
            }
            p[axis] = x;
        }
        source.end_element(draft);
        draft.positions.push(p.into());
        if normals {
            draft.normals.push(DVec3::from(n));
        }
    }
    Ok(())
}

fn faces(element: &Element, source: &mut Source<'_>, draft: &mut Draft) -> Result<(), MeshError> {
    if element.count == 0 {
        return Ok(());
    }
    let named =
        |p: &Property| p.list.is_some() && matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let Some(indices) = element.properties.iter().position(named) else {
        return Err(element.missing("the list property vertex_indices of `face`"));
    };
    for _ in 0..element.count {
        for (k, property) in element.properties.iter().enumerate() {
            let Some(length) = property.list.filter(|_| k == indices) else {
                source.step_over(property)?;
                continue;
            };
            let at = source.place();
            for _ in 0..source.list_length(length, property.scalar)? {
                let value = source.number(property.scalar)?;
                if value.fract() != 0.0 || !(0.0..f64::from(u32::MAX)).contains(&value) {
                    return Err(draft.index_error("vertex", value.to_string(), at));
                }
                draft.corner(value as i64, None, at, b"")?;
            }
            draft.end_polygon(at);
        }
        source.end_element(draft);
    }
    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"int64" => Self::I64,
            b"uint64" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number in the first `size` bytes, the least significant first. 64-bit integers are rounded; as indices they are out of
    /// range long before that.
    fn decode(self, bytes: [u8; 8]) -> f64 {
        let bits = u64::from_le_bytes(bytes);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::I64 => bits as i64 as f64,
            Self::U64 => bits as f64,
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }
}

#[derive(Debug)]
struct Property {
    name: String,
    scalar: Scalar,
    /// Type of the length, for a list.
    list: Option<Scalar>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    at: Place,
}

impl Element {
    fn missing(&self, expected: &'static str) -> MeshError {
        let names: Vec<_> = self.properties.iter().map(|p| p.name.as_str()).collect();
        let found = excerpt(format!("{} ({})", self.name, names.join(" ")).as_bytes());
        MeshError::Syntax { format: FORMAT, at: self.at, found, expected }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Debug)]
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the data begin.
    end: usize,
    lines: u64,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, MeshError> {
        let mut lexer = Lexer::new(bytes, FORMAT)?;
        let word = lexer.require("the header `ply`")?;
        if word != b"ply" {
            return Err(lexer.syntax(word, "the header `ply`"));
        }
        // How long a line end is must be known, for the first byte of binary data may look like a part of it.
        let line_end = newline(lexer.rest());
        let (mut encoding, mut elements) = (None, Vec::<Element>::new());
        loop {
            if !lexer.next_line() {
                return Err(lexer.truncated("`end_header`"));
            }
            match lexer.word() {
                None | Some(b"comment" | b"obj_info") => {}
                Some(b"format") => encoding = Some(format(&mut lexer)?),
                Some(b"element") => {
                    let element = element(&mut lexer)?;
                    if element.name == "vertex" && elements.iter().any(|e| e.name == "vertex") {
                        return Err(lexer.syntax(b"element vertex", "only one element `vertex`"));
                    }
                    elements.push(element);
                }
                Some(b"property") => {
                    let property = property(&mut lexer)?;
                    match elements.last_mut() {
                        Some(element) => element.properties.push(property),
                        None => {
                            return Err(lexer.syntax(b"property", "`element` before the first `property`"));
                        }
                    }
                }
                Some(b"end_header") => break,
                Some(word) => return Err(lexer.syntax(word, "`element`, `property` or `end_header`")),
            }
        }
        let Some(encoding) = encoding else {
            return Err(lexer.syntax(b"end_header", "`format` before `end_header`"));
        };
        let rest = lexer.rest();
        let blanks = rest.iter().take_while(|&&b| b == b' ').count();
        let end_length = newline(&rest[blanks..]).min(line_end);
        let end = bytes.len() - (rest.len() - blanks - end_length);
        let Place::Line(line) = lexer.place() else { return Err(lexer.truncated("`end_header`")) };
        Ok(Self { encoding, elements, end, lines: line })
    }
}

fn header_word<'a>(lexer: &mut Lexer<'a>, expected: &'static str) -> Result<&'a [u8], MeshError> {
    lexer.word().ok_or_else(|| lexer.syntax(b"end of line", expected))
}

fn format(lexer: &mut Lexer<'_>) -> Result<Encoding, MeshError> {
    let expected = "ascii, binary_little_endian or binary_big_endian";
    let word = header_word(lexer, expected)?;
    Ok(match word {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::Little,
        b"binary_big_endian" => Encoding::Big,
        _ => return Err(lexer.syntax(word, expected)),
    })
}

fn element(lexer: &mut Lexer<'_>) -> Result<Element, MeshError> {
    let name = excerpt(header_word(lexer, "the name of an element")?);
    let word = header_word(lexer, "the number of elements")?;
    let count = integer(word).ok_or_else(|| lexer.syntax(word, "the number of elements"))?;
    Ok(Element { name, count, properties: Vec::new(), at: lexer.place() })
}

fn property(lexer: &mut Lexer<'_>) -> Result<Property, MeshError> {
    let scalar = |lexer: &mut Lexer<'_>| {
        let expected = "a type such as uchar, int, float or double";
        let word = header_word(lexer, expected)?;
        Scalar::parse(word).ok_or_else(|| lexer.syntax(word, expected))
    };
    let mut list = None;
    if lexer.clone().word() == Some(b"list") {
        lexer.word();
        let length = scalar(lexer)?;
        if !length.is_integer() {
            return Err(lexer.syntax(b"float", "an integer type for the length of a list"));
        }
        list = Some(length);
    }
    let scalar = scalar(lexer)?;
    let name = excerpt(header_word(lexer, "the name of a property")?);
    Ok(Property { name, scalar, list })
}

/// The data behind the header.
enum Source<'a> {
    Ascii { lexer: Lexer<'a>, header_lines: u64 },
    Binary { bytes: &'a [u8], at: usize, big: bool },
}

impl<'a> Source<'a> {
    fn new(bytes: &'a [u8], header: &Header) -> Result<Self, MeshError> {
        Ok(match header.encoding {
            Encoding::Ascii => {
                Self::Ascii { lexer: Lexer::new(&bytes[header.end..], FORMAT)?, header_lines: header.lines }
            }
            encoding => Self::Binary { bytes, at: header.end, big: encoding == Encoding::Big },
        })
    }

    fn place(&self) -> Place {
        match self {
            Self::Ascii { lexer, header_lines } => match lexer.place() {
                Place::Line(line) => Place::Line(line + header_lines),
                byte => byte,
            },
            Self::Binary { at, .. } => Place::Byte(*at as u64),
        }
    }

    /// In text, goes to the next line: an element has a line of its own. Some files have more on it than their header says.
    fn end_element(&mut self, draft: &mut Draft) {
        let place = self.place();
        if let Self::Ascii { lexer, .. } = self {
            if lexer.word().is_some() {
                draft.ignore("line with more numbers than the header declares", 1, place);
            }
            lexer.next_line();
        }
    }

    fn remaining(&self) -> usize {
        match self {
            Self::Ascii { lexer, .. } => lexer.remaining(),
            Self::Binary { bytes, at, .. } => bytes.len() - at,
        }
    }

    fn trailing(&self) -> bool {
        match self {
            Self::Ascii { lexer, .. } => lexer.clone().word_anywhere().is_some(),
            Self::Binary { .. } => self.remaining() > 0,
        }
    }

    fn truncated(&self, expected: &'static str) -> MeshError {
        MeshError::Truncated { format: FORMAT, at: self.place(), expected }
    }

    /// Refuses a count that the remaining bytes cannot hold.
    fn fits(&self, element: &Element) -> Result<(), MeshError> {
        let size = element.properties.iter().map(|p| self.least(p.list.unwrap_or(p.scalar))).sum();
        self.holds(element.count, size, &element.name)
    }

    /// Least number of bytes of one number: text needs a digit and a separator.
    fn least(&self, scalar: Scalar) -> usize {
        match self {
            Self::Ascii { .. } => 2,
            Self::Binary { .. } => scalar.size(),
        }
    }

    fn holds(&self, claimed: u64, size: usize, what: &str) -> Result<(), MeshError> {
        // In text, the last number needs no separator.
        let bytes = self.remaining() + usize::from(matches!(self, Self::Ascii { .. }));
        let possible = bytes.checked_div(size).map_or(u64::MAX, |n| n as u64);
        if claimed <= possible {
            return Ok(());
        }
        let (at, what) = (self.place(), format!("{what} entries"));
        Err(MeshError::CountExceedsFile { format: FORMAT, at, what, claimed, possible })
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        let place = self.place();
        match self {
            Self::Ascii { lexer, .. } => {
                let Some(word) = lexer.word_anywhere() else { return Err(self.truncated("a number")) };
                number(word).ok_or_else(|| MeshError::Syntax {
                    format: FORMAT,
                    at: place,
                    found: excerpt(word),
                    expected: "a number",
                })
            }
            Self::Binary { bytes, at, big } => {
                let size = scalar.size();
                let Some(word) = bytes.get(*at..*at + size) else { return Err(self.truncated("a number")) };
                *at += size;
                let mut little = [0; 8];
                little[..size].copy_from_slice(word);
                if *big {
                    little[..size].reverse();
                }
                Ok(scalar.decode(little))
            }
        }
    }

    fn list_length(&mut self, length: Scalar, scalar: Scalar) -> Result<u64, MeshError> {
        let place = self.place();
        let value = self.number(length)?;
        if !(value >= 0.0 && value.fract() == 0.0) {
            let found = value.to_string();
            return Err(MeshError::Syntax {
                format: FORMAT,
                at: place,
                found,
                expected: "the length of a list",
            });
        }
        self.holds(value as u64, self.least(scalar), "list")?;
        Ok(value as u64)
    }

    fn step_over(&mut self, property: &Property) -> Result<(), MeshError> {
        let count = match property.list {
            Some(length) => self.list_length(length, property.scalar)?,
            None => 1,
        };
        match self {
            Self::Ascii { lexer, .. } => {
                for _ in 0..count {
                    if lexer.word_anywhere().is_none() {
                        return Err(self.truncated("a number"));
                    }
                }
            }
            Self::Binary { bytes, at, .. } => {
                let size = count as usize * property.scalar.size();
                if size > bytes.len() - *at {
                    return Err(self.truncated("a property"));
                }
                *at += size;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Notice;

    const ASCII: &str = "ply\nformat ascii 1.0\nelement edge 1\nproperty int a\nproperty list uchar float b\n\
        element face 1\nproperty float q\nproperty list uchar ushort vertex_index\nelement vertex 3\n\
        property float x\nproperty list int double w\nproperty double y\nproperty short z\nend_header\n\
        7 2 0.5 0.5\n1.5 3 0 1 2\n0 1 9 0 0\n1 0 0 0\n0 0 1 0\n";

    #[test]
    fn elements_in_any_order_with_any_properties() {
        let loaded = read(ASCII.as_bytes()).unwrap();
        assert_eq!(loaded.mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert_eq!(loaded.mesh.faces, [[0, 1, 2]]);
        let crlf = ASCII.replace('\n', "\r\n");
        assert_eq!(read(crlf.as_bytes()).unwrap().mesh, loaded.mesh);
        let ignored = Notice::Ignored { what: "element `edge`".into(), count: 1, first: Place::Line(15) };
        assert_eq!(loaded.notices, [ignored]);
    }

    /// A triangle whose first data byte is a line feed, behind headers with each kind of line end.
    #[test]
    fn binary_data_may_begin_with_a_line_feed() {
        for end in ["\n", "\r\n", "\r"] {
            let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n\
                property uchar z\nelement face 1\nproperty list uchar uint64 vertex_indices\nend_header\n";
            let mut bytes = header.replace('\n', end).into_bytes();
            bytes.extend([10, 0, 0, 11, 0, 0, 10, 1, 0, 3]);
            for index in [0u64, 1, 2] {
                bytes.extend(index.to_le_bytes());
            }
            let mesh = read(&bytes).unwrap().mesh;
            assert_eq!(mesh.positions[0], DVec3::new(10.0, 0.0, 0.0), "{end:?}");
            assert_eq!(mesh.faces, [[0, 1, 2]]);
            for cut in 0..bytes.len() {
                assert!(read(&bytes[..cut]).is_err(), "{end:?} cut at {cut}");
            }
        }
    }

    #[test]
    fn errors_name_the_line_of_the_file() {
        let at = |text: &str| match read(text.as_bytes()) {
            Err(
                MeshError::Index { at, .. } | MeshError::Syntax { at, .. } | MeshError::NotFinite { at, .. },
            ) => at,
            other => panic!("{other:?}"),
        };
        assert_eq!(at(&ASCII.replace("0 1 2\n", "0 1 3\n")), Place::Line(16));
        assert_eq!(at(&ASCII.replace("0 1 2\n", "0 1 -1\n")), Place::Line(16));
        assert_eq!(at(&ASCII.replace("1 0 0 0\n", "1 0 x 0\n")), Place::Line(18));
        assert_eq!(at(&ASCII.replace("0 0 1 0\n", "0 0 1 inf\n")), Place::Line(19));
        assert_eq!(at(&ASCII.replace("property short z\n", "")), Place::Line(9));
    }

    #[test]
    fn a_second_list_of_vertices_is_refused() {
        let text = ASCII.replace("element edge 1\n", "element vertex 0\nelement edge 1\n");
        assert!(matches!(read(text.as_bytes()), Err(MeshError::Syntax { at: Place::Line(10), .. })));
    }

    #[test]
    fn many_strange_elements_are_lumped_together() {
        let strange: String = (0..50).map(|k| format!("element e{k} 1\n")).collect();
        let text = ASCII.replace("element edge 1\n", &format!("{strange}element edge 1\n"));
        assert_eq!(read(text.as_bytes()).unwrap().notices.len(), 17);
    }

    #[test]
    fn numbers_that_the_header_does_not_declare_are_ignored_with_a_notice() {
        let loaded = read(ASCII.replace("0 1 2\n", "0 1 2 8 8 8\n").as_bytes()).unwrap();
        let what = "line with more numbers than the header declares".to_owned();
        let expected = Notice::Ignored { what, count: 1, first: Place::Line(16) };
        assert_eq!(loaded.notices.last(), Some(&expected));
    }

    #[test]
    fn an_element_without_properties_takes_no_time() {
        let text = ASCII.replace("element edge 1\n", "element nothing 99999999999999\nelement edge 1\n");
        assert!(read(text.as_bytes()).is_ok());
    }
}
