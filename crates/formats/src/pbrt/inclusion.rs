//! Includes texts within texts, and checks their limits.

use super::decode::decode;
use super::parser::Parser;
use super::state::Scope;
use crate::bytes::FileBytes;
use crate::error::{ErrorKind, Result};
use crate::limits::{self, Allowance, LONGEST_TEXT};
use crate::source::{Fault, FileId, Span};
use std::path::Path;

/// A hint for repeated inclusions.
const REPEAT_BY_OBJECTS: &str =
    "make an object of what is repeated (ObjectBegin), and instances of it (ObjectInstance)";

/// The counts of parsed items that have limits.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) inclusions: u64,
    /// The size of texts that were included repeatedly. Unit: bytes.
    pub(super) again: u64,
    pub(super) directives: u64,
    pub(super) parameters: u64,
}

impl Parser {
    /// Reads an `Include`d file, which shares the state.
    pub(super) fn include(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        self.check_inclusion(span)?;
        let beside = self.scene.folder.join(name);
        let known = self.included.get(&beside).cloned();
        let path = known
            .as_ref()
            .map_or_else(|| self.scene.resolve(name), |(path, _)| path.clone());
        if self.open.contains(&path) {
            let message = format!("`{}` includes itself", path.display());
            return Err(Fault::scene(span, message));
        }
        let file = match known {
            Some((_, file)) => self.load_again(file, span)?,
            None => self.load(&path, span)?,
        };
        self.included.insert(beside, (path.clone(), file));
        self.open.push(path);
        let result = self.file(file);
        self.open.pop();
        result.map(|_| ())
    }

    /// Reads an `Import`ed file, which gets a copy of the state.
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

    fn check_inclusion(&mut self, span: Span) -> Result<(), Fault> {
        let limit = |message| Err(Fault::new(ErrorKind::Limit, span, message));
        let deepest = limits::DEEPEST_INCLUSION;
        if self.open.len() >= deepest {
            return limit(format!("files include files more than {deepest} deep"));
        }
        self.counts.inclusions += 1;
        let most = limits::MOST_INCLUSIONS;
        if self.counts.inclusions > most {
            return limit(format!("files are included more than {most} times in all"));
        }
        Ok(())
    }

    /// Reads a file whose name is used for the first time.
    fn load(&mut self, path: &Path, span: Span) -> Result<FileId, Fault> {
        // A file may have several names.
        let key = self.scene.files.identity(path);
        if let Some(&file) = self.texts.get(&key) {
            self.scene.texts.push(path.to_owned());
            return self.load_again(file, span);
        }
        let file = self
            .read_text(path)
            .map_err(|error| Fault::from_error(span, &error))?;
        self.scene.texts.push(path.to_owned());
        self.texts.insert(key, file);
        Ok(file)
    }

    fn read_text(&mut self, path: &Path) -> Result<FileId> {
        let FileBytes { bytes, stored } = self.scene.files.read(path, LONGEST_TEXT)?;
        self.scene.stored += stored;
        self.scene.sources.add(path, decode(path, bytes)?)
    }

    /// Counts a text that is included repeatedly.
    fn load_again(&mut self, file: FileId, span: Span) -> Result<FileId, Fault> {
        self.counts.again += self.scene.sources.text(file).len() as u64;
        let what = "bytes that are included again";
        self.check_count(self.counts.again, what, limits::TEXTS_AGAIN, span)?;
        Ok(file)
    }

    /// Refuses a count beyond the allowance for the bytes of the texts: a few bytes, packed or included
    /// repeatedly, expand to any number of items.
    pub(super) fn check_count(
        &self,
        count: u64,
        what: &str,
        allowance: Allowance,
        span: Span,
    ) -> Result<(), Fault> {
        let stored = self.scene.stored;
        let most = allowance.of(stored);
        if count <= most {
            return Ok(());
        }
        let message = format!("texts of {stored} bytes stand for more than {most} {what}");
        Err(Fault::new(ErrorKind::Limit, span, message).with_hint(REPEAT_BY_OBJECTS))
    }
}
