use super::*;
use isoslice_settings::ImageFormat;
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

fn about() -> About {
    About {
        maker: "isoslice 1".into(),
        printer: "Bambu Lab A1 mini".into(),
        nozzle: 0.4,
        material: "PETG".into(),
        time: 3725.4,
        length: 1234.5,
        mass_g: 3.7,
        layers: 42,
        parts: vec![PartBox {
            name: "<\"&'>\u{7}\u{ffff} ü".into(),
            min: DVec2::new(1.0, 2.0),
            max: DVec2::new(11.0, 7.0),
        }],
        pictures: [(512, b"large"), (128, b"small")]
            .map(|(size, file)| {
                let format = ImageFormat::Png;
                let pixels = [size, size];
                (PictureSize { pixels, format }, file.to_vec())
            })
            .into(),
        ..About::default()
    }
}

fn packed(text: &str) -> Vec<u8> {
    let mut out = Vec::new();
    let mut packer = Packer::new(&mut out).unwrap();
    // In pieces, as they come.
    for piece in text.as_bytes().chunks(1000) {
        packer.write_all(piece).unwrap();
    }
    packer.finish(&about()).unwrap();
    out
}

fn unpacked(bytes: &[u8]) -> Result<String, String> {
    let mut text = String::new();
    let opened = Opened::new(&mut &bytes[..]);
    let read = opened.and_then(|mut opened| opened.read_to_string(&mut text));
    read.map(|_| text).map_err(|e| e.to_string())
}

fn text() -> String {
    let line = |i: u32| format!("G1 X{} E0.{i:05}\n", i % 977);
    let lines: String = (0..40_000).map(line).collect();
    format!("{}{lines}", blank("isoslice 1"))
}

/// An archive with these entries.
fn archive(entries: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        let options = SimpleFileOptions::default().compression_method(method);
        zip.start_file(*name, options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn text_comes_back_with_its_head_filled_in() {
    let text = text();
    let bytes = packed(&text);
    assert_eq!(bytes, packed(&text));
    let back = unpacked(&bytes).unwrap();
    // Lines keep their numbers, and all but the head their bytes.
    assert_eq!(back.lines().count(), text.lines().count());
    let body =
        |text: &str| text.split_once("HEADER_BLOCK_END").unwrap().1.len();
    assert_eq!(body(&back), body(&text));
    for line in [
        "; total layer number: 42",
        "; model printing time: 1h 2m 5s; total estimated time: 1h 2m 5s",
        "; total filament length [mm] : 1234.50",
    ] {
        assert!(back.contains(&format!("\n{line}\n")), "{line}");
    }
}

#[test]
fn the_small_files_are_what_printers_read() {
    let mut zip = ZipArchive::new(Cursor::new(packed(&text()))).unwrap();
    let mut entry = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = zip.by_name(name).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        bytes
    };
    assert_eq!(entry("Metadata/plate_1.png"), b"large");
    assert_eq!(entry("Metadata/plate_1_small.png"), b"small");
    let info = String::from_utf8(entry("Metadata/slice_info.config")).unwrap();
    for part in [
        "key=\"printer_model_id\" value=\"N1\"",
        "key=\"prediction\" value=\"3725\"",
        "key=\"weight\" value=\"3.70\"",
        "name=\"&lt;&quot;&amp;'&gt; ü\"",
        "type=\"PETG\"",
        "tray_info_idx=\"GFG99\"",
        "used_m=\"1.23\"",
    ] {
        assert!(info.contains(part), "{part}: {info}");
    }
    let plate: serde_json::Value =
        serde_json::from_slice(&entry("Metadata/plate_1.json")).unwrap();
    assert_eq!(plate["bbox_all"], serde_json::json!([1.0, 2.0, 11.0, 7.0]));
    assert_eq!(plate["bbox_objects"][0]["area"], 50.0);
    let sum = entry("Metadata/plate_1.gcode.md5");
    assert_eq!(sum.len(), 32);
    assert!(
        sum.iter()
            .all(|b| b.is_ascii_digit() || b.is_ascii_uppercase())
    );
}

#[test]
fn archives_of_others_are_read_as_well() {
    let text = "; HEADER_BLOCK_START\nG28\n";
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        let entries = [
            ("a.txt", &b"x"[..]),
            ("Metadata/plate_3.gcode", text.as_bytes()),
        ];
        assert_eq!(unpacked(&archive(&entries, method)), Ok(text.to_owned()));
    }
}

#[test]
fn what_is_no_single_plate_is_an_error() {
    let stored = CompressionMethod::Stored;
    let error = |bytes: &[u8]| unpacked(bytes).unwrap_err();
    let none = archive(&[("3D/3dmodel.model", b"<model/>")], stored);
    assert!(error(&none).contains("without G-code"), "{}", error(&none));
    let two = archive(
        &[
            ("Metadata/plate_1.gcode", b"G28\n"),
            ("Metadata/plate_2.gcode", b"G28\n"),
        ],
        stored,
    );
    assert!(error(&two).contains("2 sliced plates"), "{}", error(&two));
    let wrong = archive(
        &[
            ("Metadata/plate_1.gcode", b"G28\n"),
            (
                "Metadata/plate_1.gcode.md5",
                b"00000000000000000000000000000000",
            ),
        ],
        stored,
    );
    assert!(error(&wrong).contains("MD5"), "{}", error(&wrong));
    let many: Vec<String> = (0..10_100).map(|i| format!("{i}")).collect();
    let many: Vec<(&str, &[u8])> =
        many.iter().map(|n| (&**n, &b""[..])).collect();
    assert!(error(&archive(&many, stored)).contains("entries"));
    assert!(error(b"PK\x03\x04 and nothing of an archive").contains("archive"));
}

#[test]
fn bombs_are_refused_before_they_go_off() {
    let zeros = vec![b'\n'; 64 << 20];
    let bomb = archive(
        &[("Metadata/plate_1.gcode", &zeros)],
        CompressionMethod::Deflated,
    );
    assert!(bomb.len() < 1 << 17, "{}", bomb.len());
    let error = unpacked(&bomb).unwrap_err();
    assert!(error.contains("far longer"), "{error}");
    // One archive claims to be shorter than it is.
    let mut lies = archive(
        &[("Metadata/plate_1.gcode", &zeros[..1 << 20])],
        CompressionMethod::Deflated,
    );
    let size = (1u32 << 20).to_le_bytes();
    while let Some(at) = memchr::memmem::find(&lies, &size) {
        lies[at..at + 4].copy_from_slice(&100u32.to_le_bytes());
    }
    assert!(unpacked(&lies).is_err());
}

#[test]
fn damage_is_noticed_wherever_it_is() {
    let text: String = (0..400).map(|i| format!("G1 X{i} E1\n")).collect();
    let whole = archive(
        &[("Metadata/plate_1.gcode", text.as_bytes())],
        CompressionMethod::Deflated,
    );
    for cut in [5, 60, whole.len() / 2, whole.len() - 5] {
        assert!(unpacked(&whole[..cut]).is_err(), "{cut}");
    }
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        // A date or the like may change, but never the text.
        if let Ok(read) = unpacked(&bytes) {
            assert!(read == text || at < MAGIC.len(), "byte {at}");
        }
    }
}
