//! A glTF file with the bytes it refers to, and what building of it knows throughout.

use super::container::{self, Container, Resource};
use super::json::Root;
use super::place::{GltfFault, Place, describe};
use super::texture::IMAGES_TO_EXPORT;
use crate::error::{Error, ErrorKind, Result};
use crate::files::Files;
use crate::limits::{self, FURTHER_WARNINGS, MOST_WARNINGS};
use crate::pbrt::{Content, DigestBuilder, LoadOptions};
use crate::reading::Reading;
use crate::source::{Fault, FileId, SourceMap, Span};
use crate::space::Layout;
use std::cell::Cell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Extensions that are understood, as docs/reference/gltf.md says how far.
pub(super) const EXTENSIONS: [&str; 17] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_xmp_json_ld",
];

/// A file that was read, with its buffers.
pub(super) struct Document {
    pub(super) root: Root,
    /// The folder that files are named from.
    pub(super) folder: PathBuf,
    /// Where they are looked for.
    files: Files,
    buffers: Vec<Vec<u8>>,
    /// Components that accessors may still read.
    components_left: Cell<u64>,
}

/// Whether something simpler may replace what is not supported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StandIns {
    Accepted,
    Refused,
}

/// What building knows beside the document: warnings, what was read, what the caller wants.
#[derive(Clone)]
pub(super) struct Context<'a> {
    pub(super) options: &'a LoadOptions,
    /// Where everything goes.
    pub(super) layout: Layout,
    stand_ins: StandIns,
    sources: SourceMap,
    file: FileId,
    warnings: Vec<(Place, String, usize)>,
    /// The messages of those warnings that tell of stand-ins.
    refused: BTreeSet<String>,
    pub(super) digest: DigestBuilder,
    /// The names of the files that were read.
    pub(super) files: Vec<PathBuf>,
    pub(super) reading: Reading,
    /// The names of the files that buffers and images are in.
    named: Vec<PathBuf>,
}

impl<'a> Context<'a> {
    /// Reads the container at `path`.
    pub(super) fn open(
        path: &Path,
        options: &'a LoadOptions,
        files: &Files,
    ) -> Result<(Self, Option<Vec<u8>>)> {
        let container = container::read(path, files)?;
        let reading = Reading::new(container.size());
        let Container { json, binary } = container;
        let mut digest = DigestBuilder::new();
        digest.add(Content::Text, json.as_bytes());
        if let Some(binary) = &binary {
            digest.add(Content::Mesh, binary);
        }
        let mut sources = SourceMap::default();
        let file = sources.add(path, json)?;
        let stand_ins = if options.lenient {
            StandIns::Accepted
        } else {
            StandIns::Refused
        };
        let context = Self {
            options,
            layout: Layout::default(),
            stand_ins,
            sources,
            file,
            warnings: Vec::new(),
            refused: BTreeSet::new(),
            digest,
            files: vec![path.to_owned()],
            reading,
            named: Vec::new(),
        };
        Ok((context, binary))
    }

    /// Every file on the disk that was read or is named.
    pub(super) fn inputs(&self, files: &Files) -> Vec<PathBuf> {
        let all: BTreeSet<_> = self.files.iter().chain(&self.named).collect();
        let here = all.into_iter().filter(|path| files.is_from_disk(path));
        here.cloned().collect()
    }

    /// The JSON as a tree. Errors: where it is none, with line and column.
    pub(super) fn parse(&self) -> Result<Root> {
        let text = self.sources.text(self.file);
        serde_json::from_str(&text).map_err(|error| self.json_error(&text, &error))
    }

    fn json_error(&self, text: &str, error: &serde_json::Error) -> Error {
        let line_start: usize = text
            .split_inclusive('\n')
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum();
        let mut start = (line_start + error.column().saturating_sub(1)).min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let span = Span::new(self.file, start..start);
        self.sources.error(Fault::syntax(span, message))
    }

    pub(super) fn error(&self, fault: GltfFault) -> Error {
        fault.in_text(&self.sources, self.file)
    }

    /// Something odd that is no error; what is said twice is counted.
    pub(super) fn warn(&mut self, place: &Place, message: impl Into<String>) {
        let mut message = message.into();
        let is_new = self.warnings.iter().all(|(_, known, _)| *known != message);
        if is_new && self.warnings.len() >= MOST_WARNINGS {
            FURTHER_WARNINGS.clone_into(&mut message);
        }
        let known = self
            .warnings
            .iter_mut()
            .find(|(_, known, _)| *known == message);
        match known {
            Some((_, _, count)) => *count += 1,
            None => self.warnings.push((place.clone(), message, 1)),
        }
    }

    /// Something that the format has and the renderer has not: an error, or a warning that says
    /// what stands in.
    pub(super) fn unsupported(
        &mut self,
        place: &Place,
        what: &str,
        stand_in: &str,
    ) -> Result<(), GltfFault> {
        if self.stand_ins == StandIns::Accepted {
            let message = format!("{what} is not supported: {stand_in}");
            self.refused.insert(message.clone());
            self.warn(place, message);
            return Ok(());
        }
        let message = format!("{what} is not supported");
        let fault = place.fault(ErrorKind::Unsupported, message);
        Err(fault.with_hint(format!("with --lenient, {stand_in}")))
    }

    /// All warnings, each as `file:line:column: message`.
    pub(super) fn told_warnings(&self) -> Vec<String> {
        self.told(|_| true)
    }

    /// Those of them that tell what stands in for what is not supported.
    pub(super) fn told_refusals(&self) -> Vec<String> {
        self.told(|message| self.refused.contains(message))
    }

    /// A place as `file:line:column`.
    pub(super) fn text_of(&self, place: &Place) -> String {
        let span = place.span(self.file, &self.sources.text(self.file));
        let (line, column) = self.sources.line_and_column(span);
        let file = self.sources.name(self.file).display();
        format!("{file}:{line}:{column}")
    }

    fn told(&self, is_meant: impl Fn(&str) -> bool) -> Vec<String> {
        let tell = |(place, message, count): &(Place, String, usize)| {
            let times = match count {
                1 => String::new(),
                count => format!(" ({count} times)"),
            };
            let at = self.text_of(place);
            format!("{at}: {}{times}", describe(place, message))
        };
        let meant = self
            .warnings
            .iter()
            .filter(|(_, message, _)| is_meant(message));
        meant.map(tell).collect()
    }
}

impl Document {
    /// Checks what the file says of itself, and reads its buffers.
    pub(super) fn new(
        context: &mut Context<'_>,
        root: Root,
        (folder, files): (&Path, &Files),
        binary: Option<Vec<u8>>,
    ) -> Result<Self, GltfFault> {
        check_version(&root)?;
        check_extensions(context, &root)?;
        let uris = root.buffers.iter().map(|buffer| &buffer.uri);
        let uris = uris.chain(root.images.iter().map(|image| &image.uri));
        let named = uris
            .flatten()
            .filter_map(|uri| container::file(folder, uri));
        context.named = named.collect();
        let mut document = Self {
            root,
            folder: folder.to_owned(),
            files: files.clone(),
            buffers: Vec::new(),
            components_left: Cell::new(0),
        };
        let mut binary = binary;
        for index in 0..document.root.buffers.len() {
            let buffer = document.read_buffer(context, index, &mut binary)?;
            document.buffers.push(buffer);
        }
        document.start_counting(context);
        Ok(document)
    }

    /// Lets accessors read as much as they may, once more.
    pub(super) fn start_counting(&self, context: &Context<'_>) {
        let components = limits::COMPONENTS.of(context.reading.stored());
        self.components_left.set(components);
    }

    /// Reads what `uri`, found at `place`, stands for.
    pub(super) fn resource(
        &self,
        context: &mut Context<'_>,
        uri: &str,
        place: &Place,
    ) -> Result<Resource, GltfFault> {
        let resource = container::resource((&self.folder, &self.files), uri, place)?;
        if let Some((file, stored)) = &resource.file {
            let (identity, length) = (self.files.identity(file), resource.bytes.len() as u64);
            let counted = context.reading.file(identity, *stored, length);
            counted.map_err(|error| GltfFault::from_error(place, &error))?;
        }
        Ok(resource)
    }

    /// Counts components that an accessor at `place` reads: many may read the same.
    pub(super) fn count_components(&self, count: usize, place: &Place) -> Result<(), GltfFault> {
        let left = self.components_left.get().checked_sub(count as u64);
        self.components_left.set(left.ok_or_else(|| {
            let message = "accessors read the same bytes again and again";
            place.fault(ErrorKind::Limit, message)
        })?);
        Ok(())
    }

    fn read_buffer(
        &self,
        context: &mut Context<'_>,
        index: usize,
        binary: &mut Option<Vec<u8>>,
    ) -> Result<Vec<u8>, GltfFault> {
        let buffer = &self.root.buffers[index];
        let place = Place::of("buffers", index);
        let mut bytes = if let Some(uri) = &buffer.uri {
            let resource = self.resource(context, uri, &place.key("uri"))?;
            if let Some((file, _)) = resource.file {
                context.digest.add(Content::Mesh, &resource.bytes);
                context.files.push(file);
            }
            resource.bytes
        } else {
            let missing = || place.scene("it has no uri, and the file has no binary chunk");
            binary.take().filter(|_| index == 0).ok_or_else(missing)?
        };
        if bytes.len() < buffer.byte_length {
            let (have, wanted) = (bytes.len(), buffer.byte_length);
            let message = format!("it has {have} bytes instead of {wanted}");
            return Err(place.fault(ErrorKind::Data, message));
        }
        // What follows is padding.
        bytes.truncate(buffer.byte_length);
        Ok(bytes)
    }

    /// The bytes of a buffer view, which `user` refers to, and the distance of its values.
    pub(super) fn view(
        &self,
        index: usize,
        user: &Place,
    ) -> Result<(&[u8], Option<usize>), GltfFault> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| {
            let count = self.root.buffer_views.len();
            user.scene(format!(
                "there is no buffer view {index}: the file has {count}"
            ))
        })?;
        let place = Place::of("bufferViews", index);
        let buffer = self.buffers.get(view.buffer).ok_or_else(|| {
            let (buffer, count) = (view.buffer, self.buffers.len());
            place.scene(format!("there is no buffer {buffer}: the file has {count}"))
        })?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end));
        let bytes = bytes.ok_or_else(|| {
            let (offset, length, have) = (view.byte_offset, view.byte_length, buffer.len());
            let message =
                format!("{length} bytes from byte {offset} end beyond the buffer of {have} bytes");
            place.fault(ErrorKind::Data, message)
        })?;
        Ok((bytes, view.byte_stride))
    }
}

fn check_version(root: &Root) -> Result<(), GltfFault> {
    let place = Place::TOP.key("asset");
    let asset = &root.asset;
    let needed = asset.min_version.as_ref().unwrap_or(&asset.version);
    if needed.is_empty() {
        let fault = place.scene("the file does not say which version of glTF it is");
        return Err(fault.with_hint("write \"asset\": {\"version\": \"2.0\"}"));
    }
    let is_read = needed == "2.0" || (asset.min_version.is_none() && needed.starts_with("2."));
    if is_read {
        return Ok(());
    }
    let fault = place.fault(
        ErrorKind::Unsupported,
        format!("the file needs glTF {needed}"),
    );
    Err(fault.with_hint("convert it to glTF 2.0"))
}

fn check_extensions(context: &mut Context<'_>, root: &Root) -> Result<(), GltfFault> {
    let is_known = |name: &String| EXTENSIONS.contains(&name.as_str());
    for (i, name) in root.extensions_required.iter().enumerate() {
        if is_known(name) {
            continue;
        }
        let place = Place::TOP.key("extensionsRequired").index(i);
        let message = format!("the file needs the extension `{name}`, which is not supported");
        let fault = place.fault(ErrorKind::Unsupported, message);
        let hint = match name.as_str() {
            "KHR_draco_mesh_compression"
            | "EXT_meshopt_compression"
            | "KHR_meshopt_compression" => "export it without compression of meshes",
            "KHR_texture_basisu" | "EXT_texture_avif" | "MSFT_texture_dds" => IMAGES_TO_EXPORT,
            _ => return Err(fault.with_nearest(name, EXTENSIONS)),
        };
        return Err(fault.with_hint(hint));
    }
    for (i, name) in root.extensions_used.iter().enumerate() {
        if !is_known(name) {
            let place = Place::TOP.key("extensionsUsed").index(i);
            context.warn(
                &place,
                format!("the unknown extension `{name}` has no effect"),
            );
        }
    }
    Ok(())
}
