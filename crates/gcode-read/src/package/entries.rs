//! The small files in the archive.
//!
//! In: what is known of the print. Out: the texts of the files. Names of parts
//! may be anything, and are escaped.

use super::{About, GCODE, PartBox};
use glam::DVec2;
use serde_json::json;

/// Beginning of every XML file.
const XML: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Pictures in the archive.
pub(super) const PICTURE: &str = "Metadata/plate_1.png";
pub(super) const SMALL: &str = "Metadata/plate_1_small.png";
/// Where the parts stand.
pub(super) const PLATE: &str = "Metadata/plate_1.json";

/// The sheet on the bed: the one that comes with every printer of Bambu Lab's.
const SHEET: &str = "textured_plate";

/// A colour for lists of filaments. A file with one filament could have any.
const COLOUR: &str = "#FFFFFF";

/// Kinds of files in the archive.
pub(super) fn content_types() -> String {
    let kinds = [
        (
            "rels",
            "application/vnd.openxmlformats-package.relationships+xml",
        ),
        (
            "model",
            "application/vnd.ms-package.3dmanufacturing-3dmodel+xml",
        ),
        ("png", "image/png"),
        ("gcode", "text/x.gcode"),
    ];
    let lines = kinds.map(|(extension, kind)| {
        format!(
            " <Default Extension=\"{extension}\" ContentType=\"{kind}\"/>\n"
        )
    });
    let spaces = "http://schemas.openxmlformats.org/package/2006/content-types";
    format!(
        "{XML}<Types xmlns=\"{spaces}\">\n{}</Types>\n",
        lines.concat()
    )
}

/// A file of relationships: targets and their kinds.
fn relationships(all: &[(&str, &str)]) -> String {
    let line = |(i, (target, kind)): (usize, &(&str, &str))| {
        format!(
            " <Relationship Target=\"/{target}\" Id=\"rel-{}\" \
             Type=\"{kind}\"/>\n",
            i + 1
        )
    };
    let lines: String = all.iter().enumerate().map(line).collect();
    let spaces = "http://schemas.openxmlformats.org/package/2006/relationships";
    format!(
        "{XML}<Relationships xmlns=\"{spaces}\">\n{lines}</Relationships>\n"
    )
}

/// What the container begins with.
pub(super) fn root_relationships(about: &About) -> String {
    let model = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
    let thumbnail = "http://schemas.openxmlformats.org/package/2006/\
                     relationships/metadata/thumbnail";
    let ours =
        |name: &str| format!("http://schemas.bambulab.com/package/2021/{name}");
    let (middle, small) = (
        ours("cover-thumbnail-middle"),
        ours("cover-thumbnail-small"),
    );
    let mut all = vec![("3D/3dmodel.model", model)];
    if !about.pictures.is_empty() {
        all.push((PICTURE, thumbnail));
        all.push((PICTURE, &middle));
        all.push((SMALL, &small));
    }
    relationships(&all)
}

/// Which G-code belongs to the plate.
pub(super) fn plate_relationships() -> String {
    let kind = "http://schemas.bambulab.com/package/2021/gcode";
    relationships(&[(GCODE, kind)])
}

/// A model without meshes.
pub(super) fn model(about: &About) -> String {
    let core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
    let ours = "http://schemas.bambulab.com/package/2021";
    format!(
        "{XML}<model unit=\"millimeter\" xml:lang=\"en-US\" xmlns=\"{core}\" \
         xmlns:BambuStudio=\"{ours}\">\n \
         <metadata name=\"Application\">{}</metadata>\n \
         <metadata name=\"BambuStudio:3mfVersion\">1</metadata>\n \
         <resources>\n </resources>\n <build/>\n</model>\n",
        escaped(&about.maker)
    )
}

/// Lines of keys and values.
fn metadata(all: &[(&str, String)]) -> String {
    let line = |(key, value): &(&str, String)| {
        let value = escaped(value);
        format!("    <metadata key=\"{key}\" value=\"{value}\"/>\n")
    };
    all.iter().map(line).collect()
}

/// Which entries belong to the plate.
pub(super) fn model_settings(about: &About) -> String {
    let mut all = vec![
        ("plater_id", "1".to_owned()),
        ("plater_name", String::new()),
        ("locked", "false".to_owned()),
        ("filament_maps", "1".to_owned()),
        ("gcode_file", GCODE.to_owned()),
    ];
    if !about.pictures.is_empty() {
        all.push(("thumbnail_file", PICTURE.to_owned()));
    }
    all.push(("pattern_bbox_file", PLATE.to_owned()));
    let lines = metadata(&all);
    format!("{XML}<config>\n  <plate>\n{lines}  </plate>\n</config>\n")
}

/// What the print takes, and which printer it is for.
pub(super) fn slice_info(about: &About) -> String {
    let yes = |is: bool| is.to_string();
    let header = "  <header>\n    \
         <header_item key=\"X-BBL-Client-Type\" value=\"slicer\"/>\n    \
         <header_item key=\"X-BBL-Client-Version\" value=\"\"/>\n  </header>\n";
    let all = metadata(&[
        ("index", "1".to_owned()),
        ("printer_model_id", model_id(&about.printer).to_owned()),
        ("nozzle_diameters", number(about.nozzle)),
        ("timelapse_type", "0".to_owned()),
        ("prediction", format!("{:.0}", about.time)),
        ("weight", format!("{:.2}", about.mass_g)),
        ("outside", yes(false)),
        ("support_used", yes(about.supports)),
        ("label_object_enabled", yes(about.labelled)),
        ("filament_maps", "1".to_owned()),
    ]);
    let part = |(i, part): (usize, &PartBox)| {
        format!(
            "    <object identify_id=\"{}\" name=\"{}\" skipped=\"false\"/>\n",
            i + 1,
            escaped(&part.name)
        )
    };
    let parts: String = about.parts.iter().enumerate().map(part).collect();
    let filament = format!(
        "    <filament id=\"1\" tray_info_idx=\"{}\" type=\"{}\" \
         color=\"{COLOUR}\" used_m=\"{:.2}\" used_g=\"{:.2}\"/>\n",
        filament_id(&about.material),
        escaped(&about.material),
        about.length * 1e-3,
        about.mass_g
    );
    format!(
        "{XML}<config>\n{header}  <plate>\n{all}{parts}{filament}  \
         </plate>\n</config>\n"
    )
}

/// Where the parts stand.
pub(super) fn plate(about: &About) -> String {
    let corners = |min: DVec2, max: DVec2| {
        [min.x, min.y, max.x, max.y].map(|x| (x * 1e3).round() / 1e3)
    };
    let part = |(i, part): (usize, &PartBox)| {
        let size = part.max - part.min;
        json!({
            "area": (size.x * size.y * 1e3).round() / 1e3,
            "bbox": corners(part.min, part.max),
            "id": i + 1,
            "layer_height": about.layer_height,
            "name": part.name,
        })
    };
    let parts: Vec<_> = about.parts.iter().enumerate().map(part).collect();
    let both =
        |a: (DVec2, DVec2), b: (DVec2, DVec2)| (a.0.min(b.0), a.1.max(b.1));
    let boxes = about.parts.iter().map(|part| (part.min, part.max));
    let (min, max) = boxes.reduce(both).unwrap_or_default();
    json!({
        "bbox_all": corners(min, max),
        "bbox_objects": parts,
        "bed_type": SHEET,
        "filament_colors": [COLOUR],
        "filament_ids": [0],
        "first_extruder": 0,
        "is_seq_print": about.one_by_one,
        "nozzle_diameter": about.nozzle,
        "version": 2,
    })
    .to_string()
}

/// What Bambu Lab's printers call themselves, by the name that they are sold
/// under: `model_id` in Bambu Studio's `resources/profiles/BBL/machine`. A
/// printer warns of a file for another one.
fn model_id(name: &str) -> &'static str {
    let name: String = name
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|c| c.to_ascii_lowercase())
        .collect();
    let name = name.trim_start_matches("bambu").trim_start_matches("lab");
    match name {
        "a1" => "N2S",
        "a1mini" => "N1",
        "p1p" => "C11",
        "p1s" => "C12",
        "x1c" | "x1carbon" => "BL-P001",
        "x1" => "BL-P002",
        "x1e" => "C13",
        _ => "",
    }
}

/// What Bambu Lab's printers call a material of any maker: `filament_id` in
/// `resources/profiles/BBL/filament`, "Generic …".
fn filament_id(material: &str) -> &'static str {
    match material.trim().to_ascii_uppercase().as_str() {
        "PLA" => "GFL99",
        "PETG" => "GFG99",
        "ABS" => "GFB99",
        "ASA" => "GFB98",
        "PC" => "GFC99",
        "PA" => "GFN99",
        "TPU" => "GFU99",
        "PVA" => "GFS99",
        _ => "",
    }
}

/// A number without needless digits.
fn number(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Text for an attribute or between tags. Characters that XML cannot hold are
/// left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}
