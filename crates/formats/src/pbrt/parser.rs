//! From files to a [`SceneDescription`].

use super::directives;
use super::known::{self, Block, DIRECTIVES};
use super::lexer::{Token, TokenKind, Tokens, shorten};
use super::parameters::{Parameter, parse_list};
use super::scene::{Entity, MaterialDescription, SceneDescription, TextureKind, warn};
use super::state::{OpenBlock, Opener, Scope};
use super::v3;
use crate::bytes;
use crate::error::{Error, ErrorKind, Place, Result};
use crate::files::Files;
use crate::foreign;
use crate::source::{Fault, FileId, Span, line_and_column};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files within files within files.
const DEEPEST: usize = 64;
/// Bytes of texts that are included again, each time: ends exponential nests.
const MOST_REPEATED: u64 = 1 << 28;
/// Blocks within blocks.
const MOST_BLOCKS: usize = 1 << 16;
/// Bytes of one text: places in it are 32-bit numbers.
const LONGEST_TEXT: u64 = u32::MAX as u64;

/// Parses a scene file; `-` is standard input.
pub fn parse_file(path: &Path) -> Result<SceneDescription> {
    parse_file_from(path, &Files::default())
}

/// The same as [`parse_file`], with files from where `files` says.
pub fn parse_file_from(path: &Path, files: &Files) -> Result<SceneDescription> {
    foreign::check_folder(path, files)?;
    let bytes = files.read_or_stdin(path, LONGEST_TEXT)?;
    foreign::check_pbrt(path, &bytes)?;
    let text = decode(path, bytes)?;
    let folder = if path.as_os_str() == bytes::STDIN {
        None
    } else {
        path.parent()
    };
    let parser = Parser::new(folder.unwrap_or(Path::new("")), files.clone());
    parse(parser, path, text)
}

/// Parses a scene that is already in memory; files are looked for in the working directory.
pub fn parse_text(name: &str, text: &str) -> Result<SceneDescription> {
    let parser = Parser::new(Path::new(""), Files::default());
    parse(parser, Path::new(name), text.to_owned())
}

fn parse(mut parser: Parser, name: &Path, text: String) -> Result<SceneDescription> {
    parser.scene.texts.push(name.to_owned());
    let file = parser.scene.sources.add(name, text)?;
    match parser.top(name, file) {
        Ok(()) => Ok(parser.scene),
        Err(fault) => Err(parser.scene.sources.error(fault)),
    }
}

/// Bytes as text: UTF-8 and nothing else.
fn decode(path: &Path, bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let error = Error::new(ErrorKind::Syntax, "the text is UTF-16").in_file(path);
        return Err(error.with_hint("save it as UTF-8"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let before = String::from_utf8_lossy(before);
        let (line, column) = line_and_column(&before, before.len());
        let error = Error::new(ErrorKind::Syntax, "the text is not UTF-8").in_file(path);
        error
            .at(Place {
                line,
                column,
                excerpt: None,
            })
            .with_hint("save it as UTF-8")
    })
}

/// The parser's whole state.
pub(super) struct Parser {
    pub(super) scene: SceneDescription,
    pub(super) scope: Scope,
    /// True after `WorldBegin`.
    pub(super) in_world: bool,
    /// The object between `ObjectBegin` and `ObjectEnd`.
    pub(super) object: Option<usize>,
    /// Materials by name, with the first use of those that are not defined yet.
    pub(super) materials: BTreeMap<String, (usize, Option<Span>)>,
    /// Objects by name, in the same way.
    pub(super) objects: BTreeMap<String, (usize, Option<Span>)>,
    /// The files that are being read, outermost first.
    open: Vec<PathBuf>,
    texts: BTreeMap<PathBuf, FileId>,
    pub(super) texture_names: BTreeSet<(TextureKind, String)>,
    pub(super) medium_names: BTreeSet<String>,
    /// Bytes that may be included again.
    repeats_left: u64,
}

impl Parser {
    fn new(folder: &Path, files: Files) -> Self {
        let default_material = MaterialDescription {
            name: None,
            entity: None,
        };
        let materials = vec![default_material];
        let folder = folder.to_owned();
        Self {
            scene: SceneDescription {
                files,
                folder,
                materials,
                ..SceneDescription::default()
            },
            scope: Scope::default(),
            in_world: false,
            object: None,
            materials: BTreeMap::new(),
            objects: BTreeMap::new(),
            open: Vec::new(),
            texts: BTreeMap::new(),
            texture_names: BTreeSet::new(),
            medium_names: BTreeSet::new(),
            repeats_left: MOST_REPEATED,
        }
    }

    fn top(&mut self, name: &Path, file: FileId) -> Result<(), Fault> {
        self.open.push(name.to_owned());
        let end = self.file(file)?;
        if !self.in_world {
            let fault = Fault::scene(end, "the file ends without `WorldBegin`");
            return Err(fault.with_hint("put it before the first shape, light or material"));
        }
        self.check_closed(0)?;
        self.check_defined()
    }

    /// Parses one text to its end, which it returns.
    fn file(&mut self, file: FileId) -> Result<Span, Fault> {
        let text = self.scene.sources.text(file);
        let mut tokens = Tokens::new(&text, file);
        while let Some(token) = tokens.next()? {
            self.directive(&mut tokens, &token)?;
        }
        Ok(Span::new(file, text.len()..text.len()))
    }

    fn directive(&mut self, tokens: &mut Tokens<'_>, token: &Token<'_>) -> Result<(), Fault> {
        let TokenKind::Word(word) = token.kind else {
            let message = format!("expected a directive, found {}", token.describe());
            return Err(Fault::syntax(token.span, message));
        };
        if let Some(hint) = v3::directive(word) {
            return Err(v3::fault(token.span, &format!("`{word}`"), hint));
        }
        let Some((_, block)) = DIRECTIVES.iter().find(|(name, _)| *name == word) else {
            let fault = Fault::syntax(token.span, format!("unknown directive `{}`", shorten(word)));
            return Err(fault.with_nearest(word, DIRECTIVES.iter().map(|(name, _)| *name)));
        };
        match (block, self.in_world) {
            (Block::World, false) => {
                let message = format!("`{word}` stands before `WorldBegin`");
                Err(Fault::scene(token.span, message))
            }
            (Block::Options, true) => {
                let message = format!("`{word}` stands after `WorldBegin`");
                Err(Fault::scene(token.span, message))
            }
            _ => directives::apply(self, tokens, word, token.span),
        }
    }

    /// Parses the parameters that follow.
    pub(super) fn parameters(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Parameter>, Fault> {
        parse_list(tokens, self.scope.state.color_space)
    }

    /// Parses a type word and parameters.
    pub(super) fn entity(
        &self,
        tokens: &mut Tokens<'_>,
        names: &known::Names,
        defaults: &Arc<Vec<Parameter>>,
    ) -> Result<Entity, Fault> {
        let (kind, span) = tokens.expect_quoted("a type")?;
        names.check(&kind, span)?;
        let explicit = self.parameters(tokens)?;
        let parameters = super::ParameterList {
            explicit,
            defaults: Arc::clone(defaults),
        };
        Ok(Entity {
            kind: kind.into_owned(),
            parameters,
            span,
        })
    }

    pub(super) fn warn(&mut self, span: Span, message: impl Into<String>) {
        warn(&mut self.scene.warnings, span, message);
    }

    /// Reads `Include`d files with the state as it is.
    pub(super) fn include(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        if self.open.len() >= DEEPEST {
            let message = format!("files include files more than {DEEPEST} deep");
            return Err(Fault::new(ErrorKind::Limit, span, message));
        }
        let path = self.scene.resolve(name);
        if self.open.contains(&path) {
            return Err(Fault::scene(
                span,
                format!("`{}` includes itself", path.display()),
            ));
        }
        let file = self
            .load(&path)
            .map_err(|error| Fault::from_error(span, &error))?;
        self.open.push(path);
        let result = self.file(file);
        self.open.pop();
        result.map(|_| ())
    }

    /// Reads an `Import`ed file with a copy of the state.
    pub(super) fn import(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        let copy = Scope {
            state: self.scope.state.clone(),
            ..Scope::default()
        };
        let outer = std::mem::replace(&mut self.scope, copy);
        self.include(name, span)?;
        self.check_closed(0)?;
        self.scope = outer;
        Ok(())
    }

    fn load(&mut self, path: &Path) -> Result<FileId> {
        // One file has many names.
        let key = self.scene.files.identity(path);
        if !self.scene.texts.iter().any(|known| known == path) {
            self.scene.texts.push(path.to_owned());
        }
        if let Some(&file) = self.texts.get(&key) {
            let length = self.scene.sources.text(file).len() as u64;
            let left = self.repeats_left.checked_sub(length);
            self.repeats_left = left.ok_or_else(|| {
                let message = format!(
                    "files are included repeatedly, more than {MOST_REPEATED} bytes in all"
                );
                Error::new(ErrorKind::Limit, message).in_file(path)
            })?;
            return Ok(file);
        }
        let text = decode(path, self.scene.files.read(path, LONGEST_TEXT)?)?;
        let file = self.scene.sources.add(path, text)?;
        self.texts.insert(key, file);
        Ok(file)
    }

    pub(super) fn open_block(&mut self, opener: Opener, span: Span) -> Result<(), Fault> {
        if self.scope.blocks.len() >= MOST_BLOCKS {
            let message = format!("blocks within blocks, more than {MOST_BLOCKS} deep");
            return Err(Fault::new(ErrorKind::Limit, span, message));
        }
        let saved = self.scope.state.clone();
        self.scope.blocks.push(OpenBlock {
            opener,
            span,
            saved,
        });
        Ok(())
    }

    pub(super) fn close_block(&mut self, opener: Opener, span: Span) -> Result<(), Fault> {
        let (begin, end) = opener.words();
        match self.scope.blocks.pop() {
            Some(block) if block.opener == opener => {
                self.scope.state = block.saved;
                Ok(())
            }
            Some(block) => {
                let (line, _) = self.scene.sources.line_and_column(block.span);
                let (opened, wanted) = block.opener.words();
                let message = format!("`{end}` closes the `{opened}` of line {line}");
                Err(Fault::scene(span, message).with_hint(format!("`{wanted}` is missing")))
            }
            None => Err(Fault::scene(span, format!("`{end}` without `{begin}`"))),
        }
    }

    fn check_closed(&self, depth: usize) -> Result<(), Fault> {
        let Some(block) = self.scope.blocks.get(depth) else {
            return Ok(());
        };
        let (begin, end) = block.opener.words();
        let fault = Fault::scene(block.span, format!("`{begin}` is never closed"));
        Err(fault.with_hint(format!("`{end}` is missing")))
    }
}

impl SceneDescription {
    /// The path of a file that the scene names: beside the scene, else in the working directory.
    pub fn resolve(&self, name: &str) -> PathBuf {
        let beside = self.folder.join(name);
        let here = Path::new(name);
        if !self.files.exists(&beside) && self.files.exists(here) {
            here.to_owned()
        } else {
            beside
        }
    }
}
