//! Parses files into a [`SceneDescription`].

use super::decode::decode;
use super::directives;
use super::inclusion::Counts;
use super::known::{self, Block};
use super::lexer::{Token, TokenKind, Tokens, shorten};
use super::parameters::{Parameter, parse_list};
use super::scene::{Entity, MaterialDescription, SceneDescription, TextureKind};
use super::state::{OpenBlock, Opener, Scope};
use super::v3;
use crate::bytes::{self, FileBytes};
use crate::error::{ErrorKind, Result};
use crate::files::Files;
use crate::foreign;
use crate::import::warn;
use crate::limits::{self, LONGEST_TEXT};
use crate::source::{Fault, FileId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Parses a scene file; `-` is standard input.
pub fn parse_file(path: &Path) -> Result<SceneDescription> {
    parse_file_from(path, &Files::default())
}

/// Parses a scene file as [`parse_file`] does, from `files`.
pub fn parse_file_from(path: &Path, files: &Files) -> Result<SceneDescription> {
    foreign::check_folder(path, files)?;
    let FileBytes { bytes, stored } = files.read_or_stdin(path, LONGEST_TEXT)?;
    foreign::check_pbrt(path, &bytes)?;
    let text = decode(path, bytes)?;
    let folder = if path.as_os_str() == bytes::STDIN {
        None
    } else {
        path.parent()
    };
    let parser = Parser::new(folder.unwrap_or(Path::new("")), files.clone());
    parse(parser, path, text, stored)
}

/// Parses a scene in memory, whose other files are read from the working directory.
pub fn parse_text(name: &str, text: &str) -> Result<SceneDescription> {
    let parser = Parser::new(Path::new(""), Files::default());
    let stored = text.len() as u64;
    parse(parser, Path::new(name), text.to_owned(), stored)
}

/// Parses a text that has `stored` bytes on the disk.
fn parse(mut parser: Parser, name: &Path, text: String, stored: u64) -> Result<SceneDescription> {
    parser.scene.stored = stored;
    parser.scene.texts.push(name.to_owned());
    let file = parser.scene.sources.add(name, text)?;
    match parser.top(name, file) {
        Ok(()) => Ok(parser.scene),
        Err(fault) => Err(parser.scene.sources.error(fault)),
    }
}

/// The whole state of the parser.
#[derive(Default)]
pub(super) struct Parser {
    pub(super) scene: SceneDescription,
    pub(super) scope: Scope,
    /// True after `WorldBegin`.
    pub(super) in_world: bool,
    /// The object between `ObjectBegin` and `ObjectEnd`.
    pub(super) object: Option<usize>,
    /// Materials by name, with the first use of undefined ones.
    pub(super) materials: BTreeMap<String, (usize, Option<Span>)>,
    /// Objects by name, with the first use of undefined ones.
    pub(super) objects: BTreeMap<String, (usize, Option<Span>)>,
    /// The files that are being read, outermost first.
    pub(super) open: Vec<PathBuf>,
    pub(super) texts: BTreeMap<PathBuf, FileId>,
    /// The included files by their paths beside the scene, each with the path that was read.
    pub(super) included: BTreeMap<PathBuf, (PathBuf, FileId)>,
    pub(super) texture_names: BTreeSet<(TextureKind, String)>,
    pub(super) medium_names: BTreeSet<String>,
    pub(super) counts: Counts,
}

impl Parser {
    fn new(folder: &Path, files: Files) -> Self {
        Self {
            scene: SceneDescription {
                files,
                folder: folder.to_owned(),
                materials: vec![MaterialDescription::default()],
                ..SceneDescription::default()
            },
            ..Self::default()
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

    /// Parses one text. Returns the place of its end.
    pub(super) fn file(&mut self, file: FileId) -> Result<Span, Fault> {
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
        self.counts.directives += 1;
        let count = self.counts.directives;
        self.check_count(count, "directives", limits::DIRECTIVES, token.span)?;
        if let Some(hint) = v3::directive(word) {
            return Err(v3::fault(token.span, &format!("`{word}`"), hint));
        }
        let Some((_, block)) = known::directives().find(|(name, _)| *name == word) else {
            let fault = Fault::syntax(token.span, format!("unknown directive `{}`", shorten(word)));
            return Err(fault.with_nearest(word, known::directives().map(|(name, _)| name)));
        };
        let side = match (block, self.in_world) {
            (Block::World, false) => "before",
            (Block::Options, true) => "after",
            _ => return directives::apply(self, tokens, word, token.span),
        };
        let message = format!("`{word}` stands {side} `WorldBegin`");
        Err(Fault::scene(token.span, message))
    }

    /// Parses a list of parameters.
    pub(super) fn parameters(&mut self, tokens: &mut Tokens<'_>) -> Result<Vec<Parameter>, Fault> {
        let list = parse_list(tokens, self.scope.state.color_space)?;
        if let Some(last) = list.last() {
            self.counts.parameters += list.len() as u64;
            let count = self.counts.parameters;
            self.check_count(count, "parameters", limits::PARAMETERS, last.span)?;
        }
        Ok(list)
    }

    /// Parses a type word and its parameters.
    pub(super) fn entity(
        &mut self,
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

    pub(super) fn open_block(&mut self, opener: Opener, span: Span) -> Result<(), Fault> {
        let deepest = limits::DEEPEST_BLOCK;
        if self.scope.blocks.len() >= deepest {
            let message = format!("blocks within blocks, more than {deepest} deep");
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
                let (opened, closing) = block.opener.words();
                let message = format!("`{end}` closes the `{opened}` of line {line}");
                Err(Fault::scene(span, message).with_hint(format!("`{closing}` is missing")))
            }
            None => Err(Fault::scene(span, format!("`{end}` without `{begin}`"))),
        }
    }

    pub(super) fn check_closed(&self, depth: usize) -> Result<(), Fault> {
        let Some(block) = self.scope.blocks.get(depth) else {
            return Ok(());
        };
        let (begin, end) = block.opener.words();
        let fault = Fault::scene(block.span, format!("`{begin}` is never closed"));
        Err(fault.with_hint(format!("`{end}` is missing")))
    }
}

impl SceneDescription {
    /// Returns the path of a file that the scene names: beside the scene if it exists there, else in the working
    /// directory.
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
