//! Reads VTU, the files of VTK's unstructured grids: values at points, or at
//! the centres of cells.
//!
//! Numbers are text, or bytes in base64, or bytes after all elements, and bytes
//! may be compressed in blocks by zlib.

use super::{Read, SamplesOptions};
use crate::numbers::{Kind, Numbers};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use flate2::read::ZlibDecoder;
use glam::DVec3;
use isoslice_base::problem::{Problem, go_on};
use roxmltree::{Document, Node, ParsingOptions};
use std::io::Read as _;

/// The most numbers of an array.
const MOST: usize = 1 << 27;

/// The most elements of a file.
const MOST_NODES: u32 = 100_000;

/// Whether a file is one of VTK's XML files.
pub(super) fn is(bytes: &[u8]) -> bool {
    let start = bytes.get(..2000.min(bytes.len())).unwrap_or_default();
    start.windows(8).any(|w| w == b"<VTKFile")
}

/// How bytes are written.
struct File<'a> {
    big: bool,
    /// Bytes of a number that counts bytes: 4 or 8.
    count: usize,
    zipped: bool,
    appended: Option<Appended<'a>>,
}

/// What follows all elements, and whether it is in base64.
type Appended<'a> = (&'a [u8], bool);

/// The elements of a file, and what follows them.
fn parts(bytes: &[u8]) -> Problem<(String, Option<Appended<'_>>)> {
    let find = |what: &[u8], from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        rest.windows(what.len())
            .position(|w| w == what)
            .map(|i| i + from)
    };
    let text = |bytes: &[u8]| {
        isoslice_base::encoding::text(bytes)
            .map(str::to_owned)
            .map_err(|e| format!("its elements are no text: {e}"))
    };
    let Some(at) = find(b"<AppendedData", 0) else {
        return Ok((text(bytes)?, None));
    };
    let broken =
        || "its appended data does not begin; save it again".to_owned();
    let tag_end = find(b">", at).ok_or_else(broken)?;
    let from = find(b"_", tag_end).ok_or_else(broken)? + 1;
    let tag = text(bytes.get(at..tag_end).unwrap_or_default())?;
    let before = text(bytes.get(..at).unwrap_or_default())?;
    let data = bytes.get(from..).unwrap_or_default();
    let base64 = !tag.contains("raw");
    Ok((before + "</VTKFile>", Some((data, base64))))
}

pub(super) fn read(bytes: &[u8], options: &SamplesOptions) -> Problem<Read> {
    let (text, appended) = parts(bytes)?;
    let parsing = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&text, parsing)
        .map_err(|e| format!("it is no XML, as VTU is: {e}"))?;
    let root = document.root_element();
    if root.attribute("type") != Some("UnstructuredGrid") {
        return Err(format!(
            "it is a {}; save an unstructured grid (.vtu)",
            root.attribute("type").unwrap_or("file without a type")
        ));
    }
    let compressor = root.attribute("compressor");
    if compressor.is_some_and(|c| c != "vtkZLibDataCompressor") {
        return Err("it is compressed by other than zlib; save it with zlib \
                    or without compression"
            .into());
    }
    let file = File {
        big: root.attribute("byte_order") == Some("BigEndian"),
        count: match root.attribute("header_type") {
            Some("UInt64") => 8,
            _ => 4,
        },
        zipped: compressor.is_some(),
        appended,
    };
    let mut read = Read {
        points: Vec::new(),
        values: Vec::new(),
        flat: false,
    };
    let pieces = root.descendants().filter(|n| n.has_tag_name("Piece"));
    for piece in pieces {
        go_on()?;
        file.piece(piece, options, &mut read)?;
    }
    Ok(read)
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|n| n.has_tag_name(name))
}

fn arrays<'a, 'b: 'a>(
    node: Option<Node<'a, 'b>>,
) -> impl Iterator<Item = Node<'a, 'b>> {
    let all = node.into_iter().flat_map(|n| n.children());
    all.filter(|n| n.has_tag_name("DataArray"))
}

/// How many numbers stand at each place.
fn components(array: Node) -> usize {
    let text = array.attribute("NumberOfComponents");
    text.and_then(|t| t.parse().ok()).unwrap_or(1).max(1)
}

fn size(piece: Node, name: &str) -> Problem<usize> {
    let text = piece.attribute(name).unwrap_or("");
    let size = text.trim().parse().ok().filter(|n| *n <= MOST / 8);
    size.ok_or_else(|| {
        format!("its piece has {name}=\"{text}\"; a million is a lot")
    })
}

/// The array that is meant, the part of its numbers, and whether it is of
/// cells.
fn chosen<'a, 'b>(
    piece: Node<'a, 'b>,
    options: &SamplesOptions,
) -> Problem<(Node<'a, 'b>, usize, bool)> {
    let data = [("PointData", false), ("CellData", true)];
    let all = data.into_iter().flat_map(|(name, cells)| {
        arrays(child(piece, name)).map(move |array| (array, cells))
    });
    let all: Vec<_> = all.collect();
    let name = |array: Node| array.attribute("Name").unwrap_or("").to_owned();
    let names: Vec<String> = all.iter().map(|(a, _)| name(*a)).collect();
    let names = names.join(", ");
    let Some(wanted) = &options.column else {
        return match all[..] {
            [(array, cells)] if components(array) == 1 => Ok((array, 0, cells)),
            _ => Err(format!(
                "which of its values is meant? Name it with `column`: {names}"
            )),
        };
    };
    // stress:2 is the third number of each place.
    let (plain, part) = match wanted.rsplit_once(':') {
        Some((plain, part)) => (plain, part.parse::<usize>().ok()),
        None => (wanted.as_str(), None),
    };
    let found = |n: &str| {
        let same = |(a, _): &&(Node, bool)| name(*a).eq_ignore_ascii_case(n);
        all.iter().find(same).copied()
    };
    let whole = found(wanted).map(|(array, cells)| (array, None, cells));
    let partly = || found(plain).map(|(array, cells)| (array, part, cells));
    let Some((array, part, cells)) = whole.or_else(partly) else {
        return Err(format!("there is no {wanted:?}: there are {names}"));
    };
    let count = components(array);
    match part {
        Some(part) if part < count => Ok((array, part, cells)),
        None if count == 1 => Ok((array, 0, cells)),
        _ => Err(format!(
            "{plain:?} has {count} numbers at each place; name one of them, \
             such as \"{plain}:0\""
        )),
    }
}

impl File<'_> {
    fn piece(
        &self,
        piece: Node,
        options: &SamplesOptions,
        read: &mut Read,
    ) -> Problem<()> {
        let count = size(piece, "NumberOfPoints")?;
        let cells = size(piece, "NumberOfCells")?;
        if count == 0 {
            return Ok(());
        }
        let place = arrays(child(piece, "Points")).next();
        let place = place.ok_or("its piece has no points")?;
        let numbers = self.numbers(place, 3 * count)?;
        let points: Vec<DVec3> =
            numbers.chunks_exact(3).map(DVec3::from_slice).collect();
        let (array, part, of_cells) = chosen(piece, options)?;
        let step = components(array);
        let n = if of_cells { cells } else { count };
        let needed = n.checked_mul(step).ok_or("its arrays are too large")?;
        let values = self.numbers(array, needed)?;
        let places = if of_cells {
            self.centres(piece, &points, cells)?
        } else {
            points
        };
        let values = values.into_iter().skip(part).step_by(step);
        for (point, value) in places.into_iter().zip(values) {
            // Places without a value.
            if value.is_finite() {
                read.points.push(point);
                read.values.push(value);
            }
        }
        Ok(())
    }

    /// The means of cells' points.
    fn centres(
        &self,
        piece: Node,
        points: &[DVec3],
        cells: usize,
    ) -> Problem<Vec<DVec3>> {
        let find = |name: &str| {
            arrays(child(piece, "Cells"))
                .find(|a| a.attribute("Name") == Some(name))
                .ok_or_else(|| format!("its cells have no {name}"))
        };
        let ends = self.numbers(find("offsets")?, cells)?;
        let all = ends.last().copied().unwrap_or(0.0);
        if !(0.0..=MOST as f64).contains(&all) {
            return Err(format!("its cells have {all} points"));
        }
        let corners = self.numbers(find("connectivity")?, all as usize)?;
        let mut from = 0;
        let mut centres = Vec::with_capacity(cells);
        for (i, end) in ends.into_iter().enumerate() {
            let end = end as usize;
            let own = corners.get(from..end).unwrap_or_default();
            let places = own.iter().map(|i| points.get(*i as usize));
            let sum: Option<DVec3> = places.map(|p| p.copied()).sum();
            let centre = sum.filter(|_| !own.is_empty()).ok_or_else(|| {
                format!("cell {i} has points that there are not")
            })?;
            centres.push(centre / own.len() as f64);
            from = end;
        }
        Ok(centres)
    }

    /// The numbers of an array, which are so many.
    fn numbers(&self, array: Node, count: usize) -> Problem<Vec<f64>> {
        let name = array.attribute("Name").unwrap_or("Points");
        self.array(array, count)
            .map_err(|e| format!("the array {name:?}: {e}"))
    }

    fn array(&self, array: Node, count: usize) -> Problem<Vec<f64>> {
        if count > MOST {
            return Err(format!("it has {count} numbers; save fewer"));
        }
        let text = array.text().unwrap_or("").trim();
        if array.attribute("format").unwrap_or("ascii") == "ascii" {
            if text.len() / 2 + 1 < count {
                return Err("it has fewer numbers than places".into());
            }
            let words = text.split_whitespace().take(count);
            let all: Result<Vec<f64>, _> = words.map(str::parse).collect();
            let all = all.map_err(|e| format!("it has no number: {e}"))?;
            return if all.len() == count {
                Ok(all)
            } else {
                Err("it has fewer numbers than places".into())
            };
        }
        let kind = match array.attribute("type").unwrap_or("") {
            "Int8" => Kind::I8,
            "UInt8" => Kind::U8,
            "Int16" => Kind::I16,
            "UInt16" => Kind::U16,
            "Int32" => Kind::I32,
            "UInt32" => Kind::U32,
            "Int64" => Kind::I64,
            "UInt64" => Kind::U64,
            "Float32" => Kind::F32,
            "Float64" => Kind::F64,
            other => return Err(format!("its type is {other:?}")),
        };
        let needed = count * kind.size();
        let bytes = if let Some(at) = array.attribute("offset") {
            let (data, base64) =
                self.appended.ok_or("it refers to data that there is not")?;
            let at: usize =
                at.trim().parse().map_err(|_| format!("offset {at:?}"))?;
            let data = data.get(at..).unwrap_or_default();
            if base64 {
                // It ends where another begins, which is not known here.
                let end = data.iter().position(|b| *b == b'<');
                let data = data.get(..end.unwrap_or(data.len()));
                let data = data.unwrap_or_default().trim_ascii();
                self.of_base64(data, needed)?
            } else {
                self.unpacked(data, needed)?
            }
        } else {
            self.of_base64(text.as_bytes(), needed)?
        };
        Ok(floats(&bytes, kind, self.big))
    }

    /// A number that counts bytes.
    fn word(&self, bytes: &[u8], at: usize) -> Problem<usize> {
        let start = at.saturating_mul(self.count);
        let word = bytes
            .get(start..start.saturating_add(self.count))
            .ok_or("it ends too early")?;
        let add = |sum: u64, b: &u8| sum << 8 | u64::from(*b);
        let value = if self.big {
            word.iter().fold(0, add)
        } else {
            word.iter().rev().fold(0, add)
        };
        usize::try_from(value).map_err(|_| "it is too large".into())
    }

    /// The bytes of base64, of which the header is apart if they are
    /// compressed.
    fn of_base64(&self, text: &[u8], needed: usize) -> Problem<Vec<u8>> {
        let letters = |bytes: usize| bytes.div_ceil(3) * 4;
        let decode = |from: usize, bytes: usize| {
            let end = from.saturating_add(letters(bytes)).min(text.len());
            let part = text.get(from..end).unwrap_or_default();
            let end = part.iter().position(|b| *b == b'=');
            let end = end.map_or(part.len(), |i| i.div_ceil(4) * 4);
            BASE64
                .decode(part.get(..end).unwrap_or(part))
                .map_err(|e| format!("its base64 is broken: {e}"))
        };
        if !self.zipped {
            return self.unpacked(&decode(0, self.count + needed)?, needed);
        }
        let blocks = self.word(&decode(0, self.count)?, 0)?;
        if blocks > text.len() {
            return Err(format!("it has {blocks} blocks in a short text"));
        }
        let length = (3 + blocks) * self.count;
        let mut bytes = decode(0, length)?;
        bytes.truncate(length);
        let packed = (0..blocks).try_fold(0_usize, |sum, block| {
            let length = self.word(&bytes, 3 + block)?;
            Ok::<_, String>(sum.saturating_add(length.min(text.len())))
        })?;
        bytes.extend(decode(letters(length), packed)?);
        self.unpacked(&bytes, needed)
    }

    /// What follows a header that says how many bytes there are.
    fn unpacked(&self, bytes: &[u8], needed: usize) -> Problem<Vec<u8>> {
        let short = "it has fewer numbers than places";
        if !self.zipped {
            let data = bytes.get(self.count..).unwrap_or_default();
            return Ok(data.get(..needed).ok_or(short)?.to_vec());
        }
        let blocks = self.word(bytes, 0)?;
        if blocks > bytes.len() {
            return Err(format!("it has {blocks} blocks in a short file"));
        }
        let mut at = (3 + blocks) * self.count;
        let mut out = Vec::new();
        for block in 0..blocks {
            go_on()?;
            let length = self.word(bytes, 3 + block)?;
            let end = at.saturating_add(length);
            let part = bytes.get(at..end).ok_or("it ends too early")?;
            // No more than is needed is ever unpacked.
            let left = (needed - out.len()) as u64;
            ZlibDecoder::new(part)
                .take(left)
                .read_to_end(&mut out)
                .map_err(|e| format!("its compressed data is broken: {e}"))?;
            at = end;
        }
        if out.len() < needed {
            return Err(short.into());
        }
        Ok(out)
    }
}

/// Numbers from bytes.
fn floats(bytes: &[u8], kind: Kind, big: bool) -> Vec<f64> {
    // Wide numbers keep all their digits.
    let wide = |read: fn([u8; 8]) -> f64| -> Vec<f64> {
        let (all, _) = bytes.as_chunks::<8>();
        all.iter()
            .map(|b| {
                let mut b = *b;
                if big {
                    b.reverse();
                }
                read(b)
            })
            .collect()
    };
    match kind {
        Kind::F64 => wide(f64::from_le_bytes),
        Kind::I64 => wide(|b| i64::from_le_bytes(b) as f64),
        Kind::U64 => wide(|b| u64::from_le_bytes(b) as f64),
        Kind::I32 | Kind::U32 => {
            let (all, _) = bytes.as_chunks::<4>();
            let one = |b: &[u8; 4]| {
                let mut b = *b;
                if big {
                    b.reverse();
                }
                if kind == Kind::I32 {
                    i32::from_le_bytes(b).into()
                } else {
                    u32::from_le_bytes(b).into()
                }
            };
            all.iter().map(one).collect()
        }
        _ => {
            let mut numbers = kind.list(bytes.len() / kind.size());
            kind.append(bytes, big, &mut numbers);
            match numbers {
                Numbers::U8(all) => all.into_iter().map(f64::from).collect(),
                Numbers::I8(all) => all.into_iter().map(f64::from).collect(),
                Numbers::U16(all) => all.into_iter().map(f64::from).collect(),
                Numbers::I16(all) => all.into_iter().map(f64::from).collect(),
                Numbers::F32(all) => all.into_iter().map(f64::from).collect(),
            }
        }
    }
}
