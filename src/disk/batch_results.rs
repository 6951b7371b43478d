//! What a batch leaves in its folder when all is done: manifest, sheet, coverage, the helpers of engines. Each gives the files it wrote.

use super::Failure;
use super::folder::Folder;
use super::writer::{self, Output};
use crate::batch::manifest::Table;
use crate::batch::pictures;
use crate::batch::run::{Ended, engines};
use crate::batch::{Plan, Variation};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A batch that ran to its end.
pub struct Results<'a> {
    /// Its plan.
    pub plan: &'a Plan,
    /// Its folder.
    pub folder: &'a Folder<'a>,
    /// The folder's path.
    pub output: &'a Path,
    /// How each variation ended.
    pub endings: &'a [Ended],
}

impl Results<'_> {
    /// Index of the earlier variation that each resembles.
    pub fn alike(&self) -> Vec<Option<usize>> {
        pictures::alike(self.plan, &|variation: &Variation| self.folder.record(variation))
    }

    /// The manifest as JSON, and its files.
    pub fn manifest(&self, alike: &[Option<usize>], merged: bool) -> Result<(Value, Vec<PathBuf>), Failure> {
        let table = Table { plan: self.plan, endings: self.endings, alike, merged };
        let manifest = table.json();
        let mut text = serde_json::to_vec_pretty(&manifest).map_err(|error| Failure::failed(error.to_string()))?;
        text.push(b'\n');
        let tables = vec![
            Output { path: self.output.join("manifest.csv"), bytes: table.csv() },
            Output { path: self.output.join("manifest.json"), bytes: text },
        ];
        Ok((manifest, self.put(tables)?))
    }

    /// The small pictures, page by page.
    pub fn sheet(&self, alike: &[Option<usize>]) -> Result<Vec<PathBuf>, Failure> {
        let mut pages = Vec::new();
        let record = |variation: &Variation| self.folder.record(variation);
        pictures::sheet(self.plan, self.endings, alike, &record, &mut |page, bytes| {
            let name = if page == 0 { "sheet.png".to_owned() } else { format!("sheet_{}.png", page + 1) };
            pages.extend(self.put(vec![Output { path: self.output.join(name), bytes }])?);
            Ok::<(), Failure>(())
        })?;
        Ok(pages)
    }

    /// Directions and impulses.
    pub fn coverage(&self, alike: &[Option<usize>]) -> Result<Vec<PathBuf>, Failure> {
        let bytes = pictures::coverage(self.plan, self.endings, alike).into_bytes();
        self.put(vec![Output { path: self.output.join("coverage.svg"), bytes }])
    }

    /// The helpers of the engines that were asked for, once where clips are.
    pub fn helpers(&self, merged: bool) -> Result<Vec<PathBuf>, Failure> {
        let folders: Vec<PathBuf> = match merged {
            true => vec![self.output.to_owned()],
            false => self.plan.sweep.rigs.iter().map(|rig| self.output.join(&rig.name)).collect(),
        };
        let mut outputs = Vec::new();
        for folder in folders {
            let own = engines(&self.plan.sweep.bake);
            outputs.extend(own.map(|engine| Output { path: folder.join(engine.file), bytes: engine.helper() }));
        }
        self.put(outputs)
    }

    /// Writes files, never over an input of the batch.
    pub fn put(&self, outputs: Vec<Output>) -> Result<Vec<PathBuf>, Failure> {
        writer::write(&outputs, self.folder.inputs())?;
        Ok(outputs.into_iter().map(|output| output.path).collect())
    }
}
