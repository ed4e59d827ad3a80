//! Images and their PNG files.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

use crate::ViewError;

/// An image: rows from above, four bytes per pixel (red, green, blue in sRGB, straight alpha).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width × height × 4` bytes.
    pub pixels: Vec<u8>,
}

impl Image {
    /// The four bytes of a pixel, row 0 above; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        let at = 4 * (y as usize * self.width as usize + x as usize);
        let bytes = self.pixels.get(at..at + 4).filter(|_| x < self.width)?;
        bytes.try_into().ok()
    }

    /// The image as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`ViewError::Pixels`] if the fields contradict each other; [`ViewError::Write`] if the encoder refuses the size.
    pub fn to_png(&self) -> Result<Vec<u8>, ViewError> {
        let needed = 4 * self.width as usize * self.height as usize;
        if self.pixels.len() != needed {
            return Err(ViewError::Pixels { given: self.pixels.len(), needed });
        }
        let mut bytes = Vec::new();
        let encode = |bytes: &mut Vec<u8>| {
            let mut encoder = png::Encoder::new(bytes, self.width, self.height);
            encoder.set_color(png::ColorType::Rgba);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.pixels)?;
            writer.finish()
        };
        match encode(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(e) => Err(ViewError::Write { path: PathBuf::new(), source: io::Error::other(e) }),
        }
    }

    /// Writes a PNG file. The file appears complete or not at all: it is written beside its target and then renamed.
    ///
    /// # Errors
    /// As [`to_png`](Self::to_png), and [`ViewError::Write`] with the path.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), ViewError> {
        let path = path.as_ref();
        let bytes = self.to_png()?;
        replace(path, &bytes).map_err(|source| ViewError::Write { path: path.to_owned(), source })
    }
}

/// Writes a file beside its target and renames it.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or_else(|| io::Error::other("the path names no file"))?;
    let mut beside = std::ffi::OsString::from(".");
    beside.push(name);
    beside.push(format!(".{}.{}.tmp", std::process::id(), NUMBER.fetch_add(1, Ordering::Relaxed)));
    let beside = path.with_file_name(beside);
    let write = || {
        let mut file = BufWriter::new(fs::File::create_new(&beside)?);
        file.write_all(bytes)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&beside, path)
    };
    write().inspect_err(|_| {
        // The first error is the one to report.
        let _ = fs::remove_file(&beside);
    })
}
