//! Reads NRRD: a header of lines, an empty line, and the numbers.

use super::Read;
use crate::lattice::Layout;
use crate::numbers::{Kind, Numbers, count};
use crate::stream::{self, Unzipped};
use glam::{DAffine3, DVec3};
use isoslice_base::problem::Problem;

/// How such files begin.
pub(super) const MAGIC: &[u8] = b"NRRD000";

/// The most bytes of a header.
const MOST_HEADER: usize = 1 << 20;

/// The fields of a header that count, as they are written.
struct Header<'a> {
    fields: Vec<(String, &'a str)>,
}

impl<'a> Header<'a> {
    /// The header of a file, and what follows it.
    fn new(bytes: &'a [u8]) -> Problem<(Header<'a>, &'a [u8])> {
        let mut fields = Vec::new();
        let mut at = 0;
        loop {
            let rest = bytes.get(at..).unwrap_or_default();
            let end = rest.iter().position(|b| *b == b'\n');
            let Some(end) = end.filter(|_| at < MOST_HEADER) else {
                return Err("its header does not end; an empty line has to \
                            stand before the numbers"
                    .into());
            };
            let line = rest.get(..end).unwrap_or_default().trim_ascii();
            at += end + 1;
            if line.is_empty() {
                break;
            }
            // Key := value is for other programs.
            if let Ok(line) = std::str::from_utf8(line)
                && let Some((key, value)) = line.split_once(':')
                && !line.starts_with('#')
                && !value.starts_with('=')
            {
                let key = key.trim().to_ascii_lowercase();
                fields.push((key.replace(' ', ""), value.trim()));
            }
        }
        let rest = bytes.get(at..).unwrap_or_default();
        Ok((Header { fields }, rest))
    }

    fn get(&self, key: &str) -> Option<&'a str> {
        let found = self.fields.iter().find(|(k, _)| k == key);
        found.map(|(_, value)| *value)
    }

    fn need(&self, key: &str) -> Problem<&'a str> {
        self.get(key)
            .ok_or_else(|| format!("its header has no `{key}`"))
    }

    /// A whole number of a field, or 0.
    fn whole(&self, key: &str) -> Problem<i64> {
        let Some(value) = self.get(key) else {
            return Ok(0);
        };
        value
            .parse()
            .map_err(|_| format!("its header has `{key}: {value}`"))
    }

    fn kind(&self) -> Problem<Kind> {
        let name = self.need("type")?;
        Ok(match name {
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::U8,
            "signed char" | "int8" | "int8_t" => Kind::I8,
            "ushort" | "unsigned short" | "unsigned short int" | "uint16"
            | "uint16_t" => Kind::U16,
            "short" | "short int" | "signed short" | "signed short int"
            | "int16" | "int16_t" => Kind::I16,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::U32,
            "int" | "signed int" | "int32" | "int32_t" => Kind::I32,
            "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "uint64"
            | "uint64_t" => Kind::U64,
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => Kind::I64,
            "float" => Kind::F32,
            "double" => Kind::F64,
            _ => {
                return Err(format!(
                    "its header has `type: {name}`, which is no number; save it \
                     as float"
                ));
            }
        })
    }

    fn sizes(&self) -> Problem<Vec<usize>> {
        let text = self.need("sizes")?;
        let sizes: Result<Vec<usize>, _> =
            text.split_whitespace().map(str::parse).collect();
        match sizes {
            Ok(sizes) if (1..=16).contains(&sizes.len()) => Ok(sizes),
            _ => Err(format!("its header has `sizes: {text}`")),
        }
    }

    /// The unit of lengths, mm.
    fn unit(&self) -> f64 {
        let text = self.get("spaceunits").or(self.get("units"));
        let first = text.and_then(|t| t.split('"').nth(1)).unwrap_or("mm");
        match first.trim().to_lowercase().as_str() {
            "m" | "meter" | "meters" => 1000.0,
            "cm" => 10.0,
            "um" | "µm" | "μm" | "micron" | "microns" => 0.001,
            "nm" => 1e-6,
            _ => 1.0,
        }
    }

    /// The ways to the next sample along each axis, as far as they are told.
    fn directions(&self, sizes: &[usize]) -> Problem<Vec<Option<DVec3>>> {
        let axes = sizes.len();
        if let Some(text) = self.get("spacedirections") {
            let all = vectors(text)?;
            if all.len() == axes {
                return Ok(all);
            }
            return Err(format!(
                "its header has {} space directions for {axes} axes",
                all.len()
            ));
        }
        let mut all = vec![None; axes];
        let texts = self.get("spacings").unwrap_or("").split_whitespace();
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        for ((way, axis), text) in all.iter_mut().zip(unit).zip(texts) {
            let mm: f64 = text.parse().unwrap_or(f64::NAN);
            *way = mm.is_finite().then(|| axis * mm);
        }
        // Without spacings, the ends of an axis tell them: those of its first and last
        // sample, or of what these stand for.
        for (axis, way) in all.iter_mut().enumerate().take(3) {
            if let (None, Some(from), Some(to)) =
                (&way, self.end("axismins", axis), self.end("axismaxs", axis))
            {
                let n = sizes[axis] as f64;
                let steps = if self.is_cell(axis) { n } else { n - 1.0 };
                *way = (steps > 0.0).then(|| unit[axis] * (to - from) / steps);
            }
        }
        Ok(all)
    }

    /// The end of an axis, if it is told.
    fn end(&self, key: &str, axis: usize) -> Option<f64> {
        let text = self.get(key)?.split_whitespace().nth(axis)?;
        text.parse().ok().filter(|mm: &f64| mm.is_finite())
    }

    /// True if samples stand for cells whose outer sides are the ends of an axis.
    fn is_cell(&self, axis: usize) -> bool {
        let text = self.get("centers").or(self.get("centerings"));
        let own = text.and_then(|text| text.split_whitespace().nth(axis));
        own == Some("cell")
    }

    /// Where the first sample is, given the ways to the next ones.
    fn origin(&self, ways: &[Option<DVec3>]) -> Problem<DVec3> {
        let Some(text) = self.get("spaceorigin") else {
            let unit = [DVec3::X, DVec3::Y, DVec3::Z];
            let own = |(axis, way): (usize, DVec3)| {
                let from = self.end("axismins", axis)?;
                let step = ways.get(axis).copied().flatten().unwrap_or(way);
                let half = if self.is_cell(axis) { 0.5 } else { 0.0 };
                Some(from * way + half * step)
            };
            let all = unit.into_iter().enumerate().filter_map(own);
            return Ok(all.sum());
        };
        match vectors(text)?[..] {
            [Some(origin)] => Ok(origin),
            _ => Err(format!("its header has `space origin: {text}`")),
        }
    }
}

/// Vectors such as `(1,0,0) none (0,0,1)`.
fn vectors(text: &str) -> Problem<Vec<Option<DVec3>>> {
    let mut all = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            all.push(None);
            rest = after.trim_start();
            continue;
        }
        let vector = rest.strip_prefix('(').and_then(|r| r.split_once(')'));
        let Some((inner, after)) = vector else {
            return Err(format!("its header has the vectors `{text}`"));
        };
        let numbers: Result<Vec<f64>, _> =
            inner.split(',').map(|n| n.trim().parse()).collect();
        match numbers.as_deref() {
            Ok([x, y]) => all.push(Some(DVec3::new(*x, *y, 0.0))),
            Ok([x, y, z]) => all.push(Some(DVec3::new(*x, *y, *z))),
            _ => return Err(format!("its header has the vector ({inner})")),
        }
        rest = after.trim_start();
    }
    Ok(all)
}

/// The axes that count, three of them, with the ways along them.
fn axes(
    sizes: &[usize],
    ways: &[Option<DVec3>],
) -> Problem<([usize; 3], [DVec3; 3])> {
    let mut kept: Vec<(usize, Option<DVec3>)> =
        sizes.iter().copied().zip(ways.iter().copied()).collect();
    // Axes of one sample say nothing, as that of a grey picture's one channel.
    while kept.len() > 3
        && let Some(one) = kept.iter().position(|(n, _)| *n == 1)
    {
        kept.remove(one);
    }
    if kept.len() > 3 {
        return Err(format!(
            "it has {} axes; save one volume of it, without time and colours",
            kept.len()
        ));
    }
    kept.resize(3, (1, None));
    let told: Vec<DVec3> = kept.iter().filter_map(|(_, way)| *way).collect();
    // An axis without a way goes across the others.
    let across = |axis: usize| match told[..] {
        [a, b] => a.cross(b).normalize_or_zero(),
        _ => [DVec3::X, DVec3::Y, DVec3::Z][axis],
    };
    let mut found = [DVec3::ZERO; 3];
    let mut size = [1; 3];
    for (axis, (n, way)) in kept.into_iter().enumerate() {
        size[axis] = n;
        found[axis] = way.unwrap_or_else(|| across(axis));
    }
    Ok((size, found))
}

pub(super) fn read(bytes: &[u8]) -> Problem<Read> {
    let (header, data) = Header::new(bytes)?;
    if header.get("datafile").is_some() {
        return Err(
            "its numbers are in another file; save it in one, as .nrrd".into(),
        );
    }
    let kind = header.kind()?;
    let sizes = header.sizes()?;
    let told = header.directions(&sizes)?;
    let (size, ways) = axes(&sizes, &told)?;
    let count = count(size, kind)?;
    let big = header.get("endian").is_some_and(|e| e == "big");
    let lines = header.whole("lineskip")?;
    let skip = header.whole("byteskip")?;
    let mut data = data;
    for _ in 0..lines.clamp(0, 1_000_000) {
        let end = data.iter().position(|b| *b == b'\n');
        let Some(end) = end else { break };
        data = data.get(end + 1..).unwrap_or_default();
    }
    let numbers = match header.need("encoding")? {
        "raw" => {
            let skip = match usize::try_from(skip) {
                Ok(skip) => skip,
                // The last bytes of the file.
                Err(_) => data.len().saturating_sub(count * kind.size()),
            };
            let data = data.get(skip..).unwrap_or_default();
            stream::raw(data, kind, big, count)?
        }
        "gzip" | "gz" => {
            let mut unzipped = Unzipped::new(data);
            unzipped.skip(usize::try_from(skip).unwrap_or(0).min(1 << 30))?;
            unzipped.numbers(kind, big, count)?
        }
        "ascii" | "text" | "txt" => text(data, count)?,
        other => {
            return Err(format!(
                "its numbers are written as {other}; save it raw or with gzip"
            ));
        }
    };
    let unit = header.unit();
    let [x, y, z] = ways.map(|way| way * unit);
    Ok(Read {
        numbers,
        layout: Layout::first_fastest(size),
        scale: [1.0, 0.0],
        lies: Some(DAffine3::from_cols(x, y, z, header.origin(&told)? * unit)),
    })
}

/// Numbers that are text.
fn text(data: &[u8], count: usize) -> Problem<Numbers> {
    // A digit and a space for each.
    if data.len() / 2 + 1 < count {
        return Err(format!(
            "its header says {count} numbers, but {} bytes follow",
            data.len()
        ));
    }
    let text = isoslice_base::encoding::text(data)
        .map_err(|e| format!("its numbers are no text: {e}"))?;
    let mut numbers = Vec::with_capacity(count);
    for (i, word) in text.split_whitespace().take(count).enumerate() {
        let number: f32 = word
            .parse()
            .map_err(|_| format!("number {i} is {word:?}, which is none"))?;
        numbers.push(number);
    }
    if numbers.len() < count {
        return Err(format!(
            "its header says {count} numbers, but {} follow",
            numbers.len()
        ));
    }
    Ok(Numbers::F32(numbers))
}
