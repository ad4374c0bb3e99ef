//! A glTF file with the bytes it refers to.

use super::container::{self, Container, Resource};
use super::json::Root;
use super::place::{GltfFault, Place};
use super::texture::IMAGES_TO_EXPORT;
use crate::error::{Error, ErrorKind, Result};
use crate::file::folder_of;
use crate::files::Files;
use crate::import::{self, Content, Document as _, LoadOptions};
use crate::limits::{self, LARGEST_GLTF};
use crate::source::{Fault, SourceMap, Span, boundary_before};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// The supported extensions. docs/reference/gltf.md says how far each is supported.
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

/// Extensions without effect whose warning is at each material that has them.
const WITHOUT_EFFECT: [&str; 2] = ["KHR_materials_dispersion", "KHR_materials_iridescence"];

pub(super) type Context<'a> = import::Context<'a, Document>;
pub(super) type Log = import::Log<Place>;

/// A file that was read, with its buffers.
pub(super) struct Document {
    path: PathBuf,
    pub(super) root: Root,
    /// The source of files.
    files: Files,
    buffers: Vec<Vec<u8>>,
    /// Number of components that accessors may still read.
    components_left: Cell<u64>,
}

impl import::Document for Document {
    type Place = Place;
    const TOP: Place = Place::TOP;

    fn files(&self) -> &Files {
        &self.files
    }

    fn named_files(&self) -> Vec<PathBuf> {
        let buffers = self.root.buffers.iter().map(|buffer| &buffer.uri);
        let uris = buffers.chain(self.root.images.iter().map(|image| &image.uri));
        let file = |uri: &String| container::file(folder_of(&self.path), uri);
        uris.flatten().filter_map(file).collect()
    }

    fn text(&self, place: &Place) -> String {
        let file = self.path.display();
        if *place == Place::TOP {
            return file.to_string();
        }
        format!("{file}: {place}")
    }

    fn error(&self, fault: GltfFault) -> Error {
        let mut error = Error::new(fault.kind, fault.message).in_file(&self.path);
        if fault.place != Place::TOP {
            error = error.at_value(fault.place.to_string());
        }
        match fault.hint {
            Some(hint) => error.with_hint(hint),
            None => error,
        }
    }
}

impl Document {
    /// Reads the file at `path`, checks its version and extensions, and reads its buffers.
    pub(super) fn open(path: &Path, options: &LoadOptions, files: &Files) -> Result<(Self, Log)> {
        let container = container::read(path, files)?;
        let mut log = Log::new(options, vec![path.to_owned()], container.size());
        let Container { json, mut binary } = container;
        log.add(Content::Text, json.as_bytes(), []);
        if let Some(binary) = &binary {
            log.add(Content::Mesh, binary, []);
        }
        let mut document = Self {
            path: path.to_owned(),
            root: parse(path, json)?,
            files: files.clone(),
            buffers: Vec::new(),
            components_left: Cell::new(0),
        };
        let read = check_version(&document.root)
            .and_then(|()| check_extensions(&mut log, &document.root))
            .and_then(|()| {
                let indices = 0..document.root.buffers.len();
                indices
                    .map(|index| document.read_buffer(&mut log, index, &mut binary))
                    .collect()
            });
        document.buffers = read.map_err(|fault| document.error(fault))?;
        Ok((document, log))
    }

    /// Resets the number of components that accessors may read to what files of `stored` bytes allow.
    pub(super) fn start_counting(&self, stored: u64) {
        self.components_left.set(limits::COMPONENTS.of(stored));
    }

    /// Reads the resource of `uri`, which is the value at `place`.
    pub(super) fn resource(
        &self,
        log: &mut Log,
        uri: &str,
        place: &Place,
    ) -> Result<Resource, GltfFault> {
        container::resource(folder_of(&self.path), uri, place, |file| {
            log.read(&self.files, file, LARGEST_GLTF)
        })
    }

    /// Counts components that an accessor at `place` reads. Errors: too many, as accessors may share bytes.
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
        log: &mut Log,
        index: usize,
        binary: &mut Option<Vec<u8>>,
    ) -> Result<Vec<u8>, GltfFault> {
        let buffer = &self.root.buffers[index];
        let place = Place::of("buffers", index);
        let mut bytes = if let Some(uri) = &buffer.uri {
            let resource = self.resource(log, uri, &place.key("uri"))?;
            if let Some(file) = resource.file {
                log.add(Content::Mesh, &resource.bytes, [file]);
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
        // The rest is padding.
        bytes.truncate(buffer.byte_length);
        Ok(bytes)
    }

    /// Returns the bytes of the buffer view `index`, which the value at `user` names, and its stride in bytes.
    pub(super) fn view(
        &self,
        index: usize,
        user: &Place,
    ) -> Result<(&[u8], Option<usize>), GltfFault> {
        let view = user.find(&self.root.buffer_views, index, "buffer view")?;
        let place = Place::of("bufferViews", index);
        let buffer = place.find(&self.buffers, view.buffer, "buffer")?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let found = end.and_then(|end| buffer.get(view.byte_offset..end));
        let bytes = found.ok_or_else(|| {
            let (offset, length, have) = (view.byte_offset, view.byte_length, buffer.len());
            let message =
                format!("{length} bytes from byte {offset} end beyond the buffer of {have} bytes");
            place.fault(ErrorKind::Data, message)
        })?;
        Ok((bytes, view.byte_stride))
    }
}

/// Parses the JSON of `path`. Errors: it is malformed, with line and column.
fn parse(path: &Path, json: String) -> Result<Root> {
    let root = serde_json::from_str(&json);
    root.or_else(|error| {
        let text = error.to_string();
        let message = text.split(" at line ").next().unwrap_or_default();
        let start = offset(&json, &error);
        let mut sources = SourceMap::default();
        let file = sources.add(path, json)?;
        let span = Span::new(file, start..start);
        Err(sources.error(Fault::syntax(span, message)))
    })
}

/// Returns the position in `text` of an error. Unit: bytes.
fn offset(text: &str, error: &serde_json::Error) -> usize {
    let lines = text.split_inclusive('\n');
    let before: usize = lines
        .take(error.line().saturating_sub(1))
        .map(str::len)
        .sum();
    boundary_before(text, before + error.column().saturating_sub(1))
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

fn check_extensions(log: &mut Log, root: &Root) -> Result<(), GltfFault> {
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
            | "KHR_meshopt_compression" => "export it without compressing meshes",
            "KHR_texture_basisu" | "EXT_texture_avif" | "MSFT_texture_dds" => IMAGES_TO_EXPORT,
            _ => return Err(fault.with_nearest(name, EXTENSIONS)),
        };
        return Err(fault.with_hint(hint));
    }
    for (i, name) in root.extensions_used.iter().enumerate() {
        if !is_known(name) && !WITHOUT_EFFECT.contains(&name.as_str()) {
            let place = Place::TOP.key("extensionsUsed").index(i);
            log.warn(place, format!("the extension `{name}` has no effect"));
        }
    }
    Ok(())
}
