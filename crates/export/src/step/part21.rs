//! The clear text encoding of STEP (ISO 10303-21:2016, *Clear text encoding of the exchange structure*, §5 and §6): numbers, strings,
//! references and numbered instances, one per line, in ASCII.

use std::collections::HashMap;
use std::fmt::Write;

/// The number of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Id(u32);

/// A data section in the making. Equal points are one instance: the control points along an edge belong to its face, its curve and
/// its vertices.
#[derive(Debug, Default)]
pub(crate) struct Section {
    text: String,
    last: u32,
    /// Looked up, never iterated.
    points: HashMap<[u64; 3], Id>,
    /// The same.
    shared: HashMap<String, Id>,
}

impl Section {
    /// Appends an instance, whose text is `KEYWORD(…)` or a complex `(A(…)B(…))`.
    pub(crate) fn add(&mut self, text: std::fmt::Arguments<'_>) -> Id {
        self.last += 1;
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "#{}={text};", self.last);
        Id(self.last)
    }

    /// An instance that is not repeated if it is there already.
    pub(crate) fn share(&mut self, text: String) -> Id {
        if let Some(&id) = self.shared.get(&text) {
            return id;
        }
        let id = self.add(format_args!("{text}"));
        self.shared.insert(text, id);
        id
    }

    /// A point of two or three coordinates; one of three that is there already is not repeated.
    pub(crate) fn point(&mut self, coordinates: &[f64]) -> Id {
        // A negative zero is no other point.
        let key = <[f64; 3]>::try_from(coordinates).ok().map(|c| c.map(|x| (x + 0.0).to_bits()));
        if let Some(&id) = key.as_ref().and_then(|k| self.points.get(k)) {
            return id;
        }
        let id = self.add(format_args!("CARTESIAN_POINT('',{})", list(coordinates, |&x| Real(x))));
        if let Some(key) = key {
            self.points.insert(key, id);
        }
        id
    }

    /// The whole file. `schema` is the identifier of the schema, `time` an ISO 8601 time.
    pub(crate) fn finish(self, name: &str, schema: &str, time: &str, program: &str) -> String {
        let mut out = String::with_capacity(self.text.len() + 512);
        out.push_str("ISO-10303-21;\nHEADER;\n");
        let (name, schema) = (Text(name), Text(schema));
        let (time, program) = (Text(time), Text(program));
        let _ = writeln!(out, "FILE_DESCRIPTION(({name}),'2;1');");
        let _ = writeln!(out, "FILE_NAME({name},{time},(''),(''),{program},{program},'');");
        let _ = writeln!(out, "FILE_SCHEMA(({schema}));\nENDSEC;\nDATA;");
        out.push_str(&self.text);
        out.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
        out
    }
}

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// A number: the shortest decimal that reads back to the same bits, always with a point; there is no way to write what is not finite,
/// which becomes zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Real(pub(crate) f64);

impl std::fmt::Display for Real {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let x = if self.0.is_finite() { self.0 + 0.0 } else { 0.0 };
        let text = format!("{x:?}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, ""));
        let mantissa = mantissa.strip_suffix(".0").unwrap_or(mantissa);
        f.write_str(mantissa)?;
        if !mantissa.contains('.') {
            f.write_str(".")?;
        }
        if exponent.is_empty() { Ok(()) } else { write!(f, "E{exponent}") }
    }
}

/// A string, quotes included: quotes and backslashes doubled, everything outside printable ASCII as `\X2\` (basic plane) or `\X4\`
/// (the others) in hexadecimal (ISO 10303-21, 6.4.3).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Text<'a>(pub(crate) &'a str);

impl std::fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Number of hexadecimal digits of the run that is open.
        let mut open = 0;
        f.write_str("'")?;
        for c in self.0.chars() {
            let digits = match c {
                ' '..='~' => 0,
                _ if (c as u32) < 0x1_0000 => 4,
                _ => 8,
            };
            if open != digits {
                if open > 0 {
                    f.write_str("\\X0\\")?;
                }
                match digits {
                    4 => f.write_str("\\X2\\")?,
                    8 => f.write_str("\\X4\\")?,
                    _ => {}
                }
                open = digits;
            }
            match (digits, c) {
                (0, '\'') => f.write_str("''")?,
                (0, '\\') => f.write_str("\\\\")?,
                (0, c) => f.write_char(c)?,
                (n, c) => write!(f, "{:0n$X}", c as u32)?,
            }
        }
        f.write_str(if open > 0 { "\\X0\\'" } else { "'" })
    }
}

/// A list in parentheses.
pub(crate) fn list<T, D: std::fmt::Display>(items: &[T], show: impl Fn(&T) -> D) -> String {
    let mut out = String::from("(");
    for (i, item) in items.iter().enumerate() {
        if i > 0 {
            out.push(',');
        }
        let _ = write!(out, "{}", show(item));
    }
    out.push(')');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_read_back() {
        for (x, text) in [
            (0.0, "0."),
            (-0.0, "0."),
            (1.0, "1."),
            (-0.25, "-0.25"),
            (1e-7, "1.E-7"),
            (1.5e300, "1.5E300"),
            (f64::NAN, "0."),
            (123456.0, "123456."),
        ] {
            assert_eq!(Real(x).to_string(), text);
        }
        for k in 0..1000 {
            let x = (f64::from(k) * 0.7391).sin() * 10f64.powi(k % 40 - 20);
            let text = Real(x).to_string();
            assert!(text.contains('.') && !text.contains('e'), "{text}");
            assert_eq!(text.parse::<f64>().unwrap(), x);
        }
    }

    #[test]
    fn strings_are_encoded_as_the_standard_demands() {
        for (plain, encoded) in [
            ("part", "'part'"),
            ("it's", "'it''s'"),
            ("a\\b", "'a\\\\b'"),
            // The example of the standard (6.4.3.3): two runs of the basic plane.
            ("ä", "'\\X2\\00E4\\X0\\'"),
            ("Flügel 翼1", "'Fl\\X2\\00FC\\X0\\gel \\X2\\7FFC\\X0\\1'"),
            ("é𝕊é", "'\\X2\\00E9\\X0\\\\X4\\0001D54A\\X0\\\\X2\\00E9\\X0\\'"),
            ("\n\u{7f}", "'\\X2\\000A007F\\X0\\'"),
            ("", "''"),
        ] {
            assert_eq!(Text(plain).to_string(), encoded);
        }
    }

    #[test]
    fn equal_points_are_one_instance() {
        let mut section = Section::default();
        let a = section.point(&[1.0, 0.0, -2.5]);
        assert_eq!(section.point(&[1.0, -0.0, -2.5]), a);
        assert_ne!(section.point(&[1.0, 0.0]), section.point(&[1.0, 0.0]));
        let file = section.finish("x", "S { 1 }", "2026-01-01T00:00:00", "p");
        assert!(file.is_ascii());
        assert!(file.contains("#1=CARTESIAN_POINT('',(1.,0.,-2.5));\n"), "{file}");
        assert!(
            file.starts_with("ISO-10303-21;\nHEADER;\n") && file.ends_with("ENDSEC;\nEND-ISO-10303-21;\n")
        );
    }
}
