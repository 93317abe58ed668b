//! The picture as dots.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::PictureError;

/// Dots per unit of the page: lines are sharp on fine screens and in print.
const SCALE: f32 = 2.0;
/// Most dots on one side.
const MOST_DOTS: f32 = 16_384.0;

/// Families without serifs, some of which most machines have.
const PLAIN: [&str; 6] = ["Helvetica", "Arial", "Liberation Sans", "DejaVu Sans", "Noto Sans", "Segoe UI"];

/// A PNG file of an SVG picture, twice its size; the fonts are those of this machine.
///
/// # Errors
/// [`PictureError::Raster`] when this machine has no font for the texts, or the picture cannot be drawn.
pub fn png(picture: &str) -> Result<Vec<u8>, PictureError> {
    let failed = |reason: String| PictureError::Raster { reason };
    let fonts = fonts();
    if fonts.is_empty() {
        return Err(failed("there are no fonts on this machine; install some, or ask for an .svg file".to_owned()));
    }
    let options = Options { fontdb: Arc::clone(&fonts), ..Options::default() };
    let tree = Tree::from_str(picture, &options).map_err(|error| failed(error.to_string()))?;
    let size = tree.size();
    let scale = SCALE.min(MOST_DOTS / size.width().max(size.height()));
    let dots = size.to_int_size().scale_by(scale).ok_or_else(|| failed("it has no size".to_owned()))?;
    let mut image = Pixmap::new(dots.width(), dots.height()).ok_or_else(|| failed("it is too large".to_owned()))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut image.as_mut());
    image.encode_png().map_err(|error| failed(error.to_string()))
}

/// The fonts of this machine, looked up once.
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    Arc::clone(FONTS.get_or_init(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_system_fonts();
        // The picture ends its list of families with any that has no serifs; which one that is here must be said.
        let names = || fonts.faces().filter(|face| !face.monospaced).filter_map(|face| Some(&face.families.first()?.0));
        let plain = PLAIN.into_iter().find_map(|plain| names().find(|name| *name == plain));
        if let Some(name) = plain.or_else(|| names().next()).cloned() {
            fonts.set_sans_serif_family(name);
        }
        Arc::new(fonts)
    }))
}
