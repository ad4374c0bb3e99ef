//! The report page of the folder of the results.

use super::analysis::Section;
use super::error::ExperimentError;
use crate::image::Pixels;
use crate::report::{self, Report, ReportImage};
use crate::results::{Pyramid, Results};
use std::collections::BTreeMap;
use std::path::Path;

type Result<T> = std::result::Result<T, ExperimentError>;

/// The name of the report page.
pub const PAGE: &str = "report.html";

/// Writes [`PAGE`] into the folder of the results; `command` is the command that repeats the experiment.
///
/// Errors: an image of the results cannot be read; the page cannot be written.
pub fn write_page(
    folder: &Path,
    results: &Results,
    sections: &[Section],
    command: &str,
) -> Result<()> {
    let (mut tables, mut plots) = (Vec::new(), Vec::new());
    for section in sections {
        tables.extend(section.tables.iter().cloned());
        plots.extend(section.plots.iter().cloned());
    }
    let page = report::html(&Report {
        results,
        tables: &tables,
        plots: &plots,
        images: &images(folder, results)?,
        layers: &layers(folder, results)?,
        command,
    });
    Ok(formats::file::replace(&folder.join(PAGE), page.as_bytes())?)
}

/// Reads the images of each pyramid by the names of their layers; the name of the picture is empty.
fn layers(folder: &Path, results: &Results) -> Result<Vec<BTreeMap<String, Pixels>>> {
    let read = |pyramid: &Pyramid| {
        let file = formats::image::read_layers(&folder.join(&pyramid.images))?;
        let prefixes = file
            .names()
            .filter_map(|name| name.strip_suffix('R').map(str::to_owned));
        let layers = prefixes.filter_map(|prefix| {
            let name = prefix.trim_end_matches('.').to_owned();
            Some((name, Pixels::layer(&file, &prefix)?))
        });
        Ok(layers.collect())
    };
    results.pyramids.iter().map(read).collect()
}

/// Reads the images of the first seed, and their references.
fn images(folder: &Path, results: &Results) -> Result<Vec<ReportImage>> {
    let has_image = |scene: &str| {
        let mut records = results.records.iter();
        records.any(|record| record.scene == scene && record.image.is_some())
    };
    let scenes = results.scenes.iter().filter(|scene| has_image(&scene.name));
    let references = scenes.filter_map(|scene| {
        let image = scene.reference_image.as_ref()?;
        Some((&scene.name, "reference".to_owned(), true, image))
    });
    let renders = results.records.iter().filter_map(|record| {
        let name = format!("{} · {}", record.method, record.budget);
        Some((&record.scene, name, false, record.image.as_ref()?))
    });
    let named = references.chain(renders);
    let all = named.map(|(scene, name, is_reference, image)| {
        let image = formats::image::read(&folder.join(image), None)?;
        Ok(ReportImage {
            scene: scene.clone(),
            name,
            is_reference,
            pixels: Pixels::from(&image),
            flip: None,
        })
    });
    let mut images = all.collect::<Result<Vec<_>>>()?;
    report::add_flip(&mut images);
    Ok(images)
}
