//! XML, of unknown origin: elements one after another.

use crate::space::Space;
use isoslice_base::units::{human_list, human_start};
use isoslice_mesh::MeshError;
use quick_xml::XmlVersion;
use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesStart, Event as Raw};
use quick_xml::name::{NamespaceError, ResolveResult};
use quick_xml::reader::NsReader;
use std::io::{self, BufRead, BufReader, Read};
use std::str::FromStr;

/// Greatest length of an element's start or of a text, bytes.
const LONGEST: usize = 1 << 20;
/// Greatest number of characters of a word in a message.
const LONGEST_SHOWN: usize = 30;
/// Greatest number of elements around an element. Models have six.
const DEEPEST: usize = 64;

/// What follows in a file.
pub(crate) enum Event<'a> {
    Start(Element<'a>),
    /// The end of an element, also of one that has no content: where its name
    /// is from, and the name.
    End(Space, &'a str),
    Text(String),
}

/// An element's start.
pub(crate) struct Element<'a> {
    space: Space,
    raw: &'a BytesStart<'a>,
    at: &'a dyn Fn() -> String,
}

impl<'a> Element<'a> {
    fn new(
        space: Space,
        raw: &'a BytesStart<'a>,
        at: &'a dyn Fn() -> String,
    ) -> Element<'a> {
        Element { space, raw, at }
    }

    /// Where its name is from.
    pub(crate) fn space(&self) -> Space {
        self.space
    }

    /// The name, without its prefix.
    pub(crate) fn name(&self) -> &str {
        self.raw.local_name().into_inner()
    }

    /// Why its prefix cannot be used.
    pub(crate) fn undeclared(&self) -> MeshError {
        let name = self.raw.name().into_inner();
        let prefix = name.split(':').next().unwrap_or_default();
        self.wrong(format!(
            "the prefix {:?} of an element is not declared",
            human_start(prefix, LONGEST_SHOWN)
        ))
    }

    /// Why the element cannot be used.
    pub(crate) fn wrong(&self, what: impl Into<String>) -> MeshError {
        MeshError::at((self.at)(), what)
    }

    /// The attributes that can be read, their values being as in the file.
    fn attributes(&self) -> impl Iterator<Item = Attribute<'_>> {
        let mut attributes = self.raw.attributes();
        attributes.with_checks(false);
        attributes.filter_map(Result::ok)
    }

    fn attribute(&self, name: &str) -> Option<Attribute<'_>> {
        self.attributes().find(|a| a.key.0 == name)
    }

    /// An attribute as text.
    pub(crate) fn text(&self, name: &str) -> Result<Option<String>, MeshError> {
        let Some(attribute) = self.attribute(name) else {
            return Ok(None);
        };
        let text = attribute
            .normalized_value(XmlVersion::Implicit1_0)
            .map_err(|e| {
                self.wrong(format!("the attribute {name} cannot be read: {e}"))
            })?;
        Ok(Some(text.into_owned()))
    }

    /// An attribute that has to be there, as text.
    pub(crate) fn required(&self, name: &str) -> Result<String, MeshError> {
        self.text(name)?.ok_or_else(|| self.absent(name))
    }

    /// Why an attribute that is not there has to be.
    pub(crate) fn absent(&self, name: &str) -> MeshError {
        self.wrong(format!("there is no attribute {name}"))
    }

    /// An attribute that is one of some words, each with what it stands for.
    /// `kind` says what they are.
    pub(crate) fn word<T: Copy>(
        &self,
        name: &str,
        kind: &str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, MeshError> {
        let text = self.text(name)?;
        text.map(|text| self.one_of(&text, kind, words)).transpose()
    }

    /// What a text stands for that has to be one of some words.
    pub(crate) fn one_of<T: Copy>(
        &self,
        text: &str,
        kind: &str,
        words: &[(&str, T)],
    ) -> Result<T, MeshError> {
        let found = words.iter().find(|(word, _)| *word == text);
        found.map(|(_, meant)| *meant).ok_or_else(|| {
            let all: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            self.wrong(format!(
                "{text:?} is no {kind}; those of 3MF are {}",
                human_list(&all, "and")
            ))
        })
    }

    /// An attribute by the end of its name, whatever its prefix is.
    pub(crate) fn text_of_any(
        &self,
        local: &str,
    ) -> Result<Option<String>, MeshError> {
        let is_meant = |a: &Attribute| a.key.local_name().as_ref() == local;
        match self.attributes().find(is_meant) {
            Some(attribute) => self.text(attribute.key.0),
            None => Ok(None),
        }
    }

    /// The first of its attributes' names, without prefixes, for which something is
    /// known.
    pub(crate) fn among_attributes<T>(
        &self,
        known: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        self.attributes()
            .find_map(|a| known(a.key.local_name().as_ref()))
    }

    /// Attributes that name a prefix: prefix and namespace.
    pub(crate) fn prefixes(&self) -> Vec<(String, String)> {
        let named = self.attributes().filter_map(|a| {
            let prefix = a.key.0.strip_prefix("xmlns:")?;
            Some((prefix.to_owned(), a.value.into_owned()))
        });
        named.collect()
    }

    /// The prefixes of its attributes.
    pub(crate) fn prefixes_of_attributes(&self) -> Vec<String> {
        let prefixes =
            self.attributes().filter_map(|a| a.key.0.split_once(':'));
        prefixes.map(|(prefix, _)| prefix.to_owned()).collect()
    }

    /// An attribute that has to be a number.
    pub(crate) fn number<T: FromStr>(
        &self,
        name: &str,
    ) -> Result<T, MeshError> {
        let attribute = self.attribute(name);
        let value = attribute.as_ref().map(|a| a.value.trim_ascii());
        let parsed = value.and_then(|text| text.parse().ok());
        parsed.ok_or_else(|| match value {
            None => self.absent(name),
            Some(value) => self.wrong(format!(
                "the attribute {name} is {:?}, which is no number that it may be",
                human_start(value, LONGEST_SHOWN)
            )),
        })
    }
}

/// What is wrong, in words that do not tell how to change the program.
fn said(error: &quick_xml::Error) -> String {
    match error {
        quick_xml::Error::Namespace(NamespaceError::TooManyBindings(_)) => {
            "it declares too many namespaces inside one another".to_owned()
        }
        quick_xml::Error::Io(error) => error.to_string(),
        other => other.to_string(),
    }
}

/// Calls `see` with all that is in a file. `name` is that of the file.
pub(crate) fn read(
    name: &str,
    bytes: &mut dyn Read,
    mut see: impl FnMut(Event) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let mut reader = NsReader::from_reader(Short {
        source: BufReader::with_capacity(1 << 16, bytes),
        left: LONGEST,
    });
    let mut depth = 0usize;
    let mut count = 0u32;
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        reader.get_mut().left = LONGEST;
        let before = reader.buffer_position();
        let at = || format!("{name}, byte {}", before + 1);
        let (space, event) = reader
            .read_resolved_event_into(&mut buffer)
            .map_err(|e| MeshError::at(at(), said(&e)))?;
        let space = match space {
            ResolveResult::Bound(namespace) => Space::of(namespace.0),
            ResolveResult::Unbound => Space::Core,
            ResolveResult::Unknown(_) => Space::Undeclared,
        };
        count = count.wrapping_add(1);
        if count.is_multiple_of(65_536) {
            isoslice_base::limits::go_on()?;
        }
        match event {
            Raw::Start(raw) => {
                depth += 1;
                if depth > DEEPEST {
                    let what = "elements inside elements inside elements …";
                    return Err(MeshError::at(at(), what));
                }
                see(Event::Start(Element::new(space, &raw, &at)))?;
            }
            Raw::Empty(raw) => {
                see(Event::Start(Element::new(space, &raw, &at)))?;
                see(Event::End(space, raw.local_name().into_inner()))?;
            }
            Raw::End(raw) => {
                depth = depth.saturating_sub(1);
                see(Event::End(space, raw.local_name().into_inner()))?;
            }
            Raw::Text(text) => {
                let text = text.to_string();
                if !text.trim().is_empty() {
                    see(Event::Text(text))?;
                }
            }
            Raw::DocType(_) => {
                let what = "a document type, which 3MF does not allow";
                return Err(MeshError::at(at(), what));
            }
            Raw::Eof if depth > 0 => {
                let what = "the file ends within an element: it is cut off; \
                            save it again";
                return Err(MeshError::at(at(), what));
            }
            Raw::Eof => return Ok(()),
            _ => {}
        }
    }
}

/// Bytes that end in an error if one event takes too many.
struct Short<R> {
    source: R,
    left: usize,
}

impl<R: BufRead> Read for Short<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        self.source.read(out)
    }
}

impl<R: BufRead> BufRead for Short<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.left == 0 {
            return Err(io::Error::other("an element of more than 1 MB"));
        }
        self.source.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.left = self.left.saturating_sub(count);
        self.source.consume(count);
    }
}
