//! The preview page: one HTML file that needs nothing else.
//!
//! In: a [`Toolpath`] and the file's name. Out: a page with its styles, scripts
//! and moves inside; it loads nothing. Equal input gives equal bytes.
//! Everything that comes from the file is escaped, so that no comment or name
//! in it can become markup or script.
//!
//! [`live_html`] is a page for a program that serves it. The page asks this
//! program for the moves ([`Toolpath::live_moves`]) and for the state of its
//! work.
//!
//! The page's parts are in `crates/preview/assets`, with two libraries in `vendor`.

use super::pack::{Packed, pack};
use super::toolpath::{
    AREA_UNIT, HEAT_UNIT, LENGTH_UNIT, SPEED_UNIT, Statistics, Toolpath,
};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use isoslice_gcode_read::reader::Role;
use serde::Serialize;
use std::io::{self, Write};

/// The page, with `{{name}}` where a part is put in.
const PAGE: &str = include_str!("../assets/page.html");

/// A part of the page: its name, and the text of its file.
macro_rules! part {
    ($name:literal) => {
        part!($name, $name)
    };
    ($name:literal, $file:literal) => {
        ($name, include_str!(concat!("../assets/", $file)))
    };
}

/// The parts that do not come from the file.
const PARTS: &[(&str, &str)] = &[
    ("version", env!("CARGO_PKG_VERSION")),
    part!("style", "style.css"),
    part!("licences", "vendor/LICENSES.txt"),
    part!("twgl", "vendor/twgl.min.js"),
    part!("fflate", "vendor/fflate.min.js"),
    part!("format.js"),
    part!("data.js"),
    part!("camera.js"),
    part!("coarse.js"),
    part!("bed.js"),
    part!("marks.js"),
    part!("scene.js"),
    part!("slider.js"),
    part!("colour.js"),
    part!("roles.js"),
    part!("pick.js"),
    part!("cut.js"),
    part!("warnings.js"),
    part!("main.js"),
];

/// The parts of a page that a program serves. In other pages these parts are
/// empty, except for what the page may load.
const LIVE_PARTS: &[(&str, &str)] = &[
    ("connect", "; img-src data: blob:; connect-src 'self'"),
    part!("live.css"),
    part!("live.html"),
    part!("live-stage.html"),
    part!("live.js"),
];

/// What a page that is only a file may load besides its own text.
const FILE_PARTS: &[(&str, &str)] = &[("connect", "; img-src data:")];

/// The data for the scripts.
#[derive(Serialize)]
struct Told<'a> {
    name: &'a str,
    moves: usize,
    size: usize,
    origin: [f64; 3],
    unit: f64,
    length_unit: f64,
    area_unit: f64,
    speed_unit: f64,
    heat_unit: f64,
    retracted: usize,
    role_names: Vec<&'static str>,
    first: Vec<u32>,
    z: Vec<f64>,
    time: Vec<f64>,
    statistics: &'a Statistics,
}

impl Toolpath {
    /// Writes the page that shows the moves. `name` is the print's name.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write_html(
        &self,
        out: &mut dyn Write,
        name: &str,
    ) -> io::Result<()> {
        let packed = pack(self)?;
        let told = serde_json::to_string(&told(self, &packed, name))?;
        let moves = STANDARD.encode(&packed.bytes);
        write_page(out, FILE_PARTS, name, &told, &moves)
    }

    /// What the page of [`live_html`] asks for: a line of JSON, and behind it
    /// the packed moves.
    ///
    /// # Errors
    /// Never, since it writes to memory. The encoder's interface requires it.
    pub fn live_moves(&self, name: &str) -> io::Result<Vec<u8>> {
        let packed = pack(self)?;
        let mut bytes = serde_json::to_vec(&told(self, &packed, name))?;
        bytes.push(b'\n');
        bytes.extend_from_slice(&packed.bytes);
        Ok(bytes)
    }
}

/// The page of a program that serves it and tells it of the print `name`.
pub fn live_html(name: &str) -> String {
    let mut page = Vec::new();
    // Memory takes any number of bytes.
    let _ = write_page(&mut page, LIVE_PARTS, name, "null", "");
    String::from_utf8_lossy(&page).into_owned()
}

fn told<'a>(path: &'a Toolpath, packed: &Packed, name: &'a str) -> Told<'a> {
    let layers = &path.layers;
    Told {
        name,
        moves: path.len(),
        size: packed.size,
        origin: packed.origin,
        unit: packed.unit,
        length_unit: LENGTH_UNIT,
        area_unit: AREA_UNIT,
        speed_unit: SPEED_UNIT,
        heat_unit: HEAT_UNIT,
        retracted: path.retracted.len(),
        role_names: Role::ALL.iter().map(|r| r.name()).collect(),
        first: layers.iter().map(|l| l.first).collect(),
        // 3 decimals are enough, and keep the numbers short.
        z: layers.iter().map(|l| thousandths(l.z)).collect(),
        time: layers.iter().map(|l| thousandths(l.time)).collect(),
        statistics: &path.statistics,
    }
}

fn write_page(
    out: &mut dyn Write,
    parts: &[(&str, &str)],
    name: &str,
    told: &str,
    moves: &str,
) -> io::Result<()> {
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("{{") {
        out.write_all(before.as_bytes())?;
        let (part, after) = after.split_once("}}").unwrap_or((after, ""));
        match part {
            "title" => out.write_all(escape_html(name).as_bytes())?,
            "told" => out.write_all(escape_json(told).as_bytes())?,
            "moves" => out.write_all(moves.as_bytes())?,
            _ => {
                let mut known = PARTS.iter().chain(parts);
                let text = known.find(|(known, _)| *known == part);
                let text = text.map_or("", |(_, text)| text);
                out.write_all(text.as_bytes())?;
            }
        }
        rest = after;
    }
    out.write_all(rest.as_bytes())
}

fn thousandths(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// Text for between tags, and for attributes in quotes.
fn escape_html(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            sign => escaped.push(sign),
        }
    }
    escaped
}

/// JSON for a script element, with strings that cannot end the element. The
/// escaped signs occur only in JSON's strings.
fn escape_json(json: &str) -> String {
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_gcode_read::reader::Reader;

    fn page(gcode: &str, name: &str) -> String {
        let path = Toolpath::read(Reader::new(gcode.as_bytes())).unwrap();
        let mut page = Vec::new();
        path.write_html(&mut page, name).unwrap();
        String::from_utf8(page).unwrap()
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let page = page("G1 X1 E1\n", "part");
        for outside in ["src=", "href=\"http", "url(http", "@import", "{{"] {
            assert!(!page.contains(outside), "{outside}");
        }
        for (name, _) in PARTS.iter().chain(LIVE_PARTS) {
            let slot = format!("{{{{{name}}}}}");
            assert_eq!(PAGE.matches(&slot).count(), 1, "{slot}");
        }
        // This is the size of a page without its moves.
        assert!(page.len() < 300_000, "{}", page.len());
    }

    #[test]
    fn nothing_from_the_file_becomes_markup() {
        let evil = "</script><script>alert('x')</script>&{{told}}";
        let gcode = format!("; generated by {evil}\nG1 X1 E1 ; {evil}\n");
        let plain = page("G1 X1 E1\n", "part");
        let page = page(&gcode, evil);
        assert!(!page.contains("<script>alert"));
        assert_eq!(
            page.matches("<script").count(),
            plain.matches("<script").count()
        );
        assert_eq!(
            page.matches("</script").count(),
            plain.matches("</script").count()
        );
        assert!(page.contains("&lt;script&gt;alert(&#39;x&#39;)"));
    }

    #[test]
    fn a_served_page_loads_from_its_own_server_only() {
        let page = live_html("</script>{{told}}");
        for outside in ["src=", "href=\"http", "url(http", "@import"] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(page.contains("connect-src 'self'"));
        assert!(page.contains("&lt;/script&gt;{{told}}"));
    }

    #[test]
    fn moves_follow_the_line_that_tells_of_them() {
        let path = Toolpath::read(Reader::new(&b"G1 X1 E1\n"[..])).unwrap();
        let bytes = path.live_moves("a\nb").unwrap();
        let end = bytes.iter().position(|b| *b == b'\n').unwrap();
        let told: serde_json::Value =
            serde_json::from_slice(&bytes[..end]).unwrap();
        assert_eq!(told["name"], "a\nb");
        assert_eq!(told["moves"], path.len());
        assert_eq!(bytes[end + 1..], pack(&path).unwrap().bytes);
    }
}
