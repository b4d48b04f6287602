use core::fmt;
use std::borrow::Cow;
use std::path::Path;

use veduta_cells::{Contents, PartitionSettings, ground_from_afar, partition};
use veduta_city::{CellOverride, Cells, CellsOverrides, CityGraph, CityPlan, Finding, GraphOverrides, Id, Severity, file};
use veduta_growth::plan::Stock;
use veduta_route::{StreetNet, Unreached, unreached};
use veduta_store::{CellParts, CityStats, CityWriter};

use crate::companions;
use crate::{
    BakeError, Heights, Input, InputKind, cells_overrides_beside, lay_on_ground, overrides_beside, read_facades, read_models,
};

/// What may be chosen of a bake.
#[derive(Debug, Clone, Default)]
pub struct BakeSettings {
    /// Seed instead of the graph's own.
    pub seed: Option<u64>,
    /// How cells are cut.
    pub partition: PartitionSettings,
}

/// Where a bake is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Reading and surveying the map.
    Survey,
    /// Growing the plan.
    Grow,
    /// Cutting cells and finding what is visible.
    Cut,
    /// Writing the city.
    Pack,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 4] = [Self::Survey, Self::Grow, Self::Cut, Self::Pack];
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Survey => "surveying the map",
            Self::Grow => "growing the plan",
            Self::Cut => "cutting cells",
            Self::Pack => "writing the city",
        })
    }
}

/// A baked city.
#[derive(Debug, Clone)]
pub struct Baked {
    /// What was written.
    pub stats: CityStats,
    /// What was dropped or repaired on the way, stage by stage.
    pub findings: Vec<Finding>,
}

/// A plan and what was dropped or repaired on the way to it.
#[derive(Debug, Clone)]
pub struct Planned {
    /// The plan.
    pub plan: CityPlan,
    /// Findings of survey, overrides and growth.
    pub findings: Vec<Finding>,
}

/// The city graph of an input as it is, without its overrides: what `veduta-bake survey` writes, so that the overrides
/// beside it are applied once, by whoever reads that graph.
///
/// # Errors
/// If the input cannot be read or is not what it should be.
pub fn survey_bare(input: &Input) -> Result<(CityGraph, Vec<Finding>), BakeError> {
    let (graph, findings) = read_graph(input)?;
    let errors = graph.validate();
    if errors.is_empty() { Ok((graph, findings)) } else { Err(BakeError::Graph { path: input.path.clone(), errors }) }
}

/// The city graph of an input, with its overrides applied, and what growth draws from: the stock, and what they bring.
///
/// # Errors
/// If the input or its overrides cannot be read or are not what they should be.
pub fn survey(input: &Input) -> Result<(CityGraph, Stock, Vec<Finding>), BakeError> {
    let (mut graph, mut findings) = read_graph(input)?;
    let beside = overrides_beside(&input.path);
    let mut stock = Stock::new();
    // What is wrong before is the graph's, what is wrong after and was not before is the edits'; an edit may mend a graph.
    let own = graph.validate();
    if beside.exists() {
        let overrides = read_overrides(&beside)?;
        findings.extend(overrides.apply(&mut graph));
        graph.fill_ids();
        let told = |errors| BakeError::Stock { path: beside.clone(), errors };
        let (models, notes) = read_models(&overrides, &beside).map_err(|mut errors| errors.swap_remove(0))?;
        findings.extend(notes.into_iter().map(|note| Finding::new(Severity::Note, Id::NONE, None, note)));
        stock.models = models;
        stock.facades = read_facades(&overrides, &beside).map_err(|mut errors| errors.swap_remove(0))?;
        stock = stock.with(&overrides.styles, overrides.monuments, overrides.furniture).map_err(told)?;
    }
    let (old, new): (Vec<_>, Vec<_>) = graph.validate().into_iter().partition(|error| own.contains(error));
    if !new.is_empty() {
        return Err(BakeError::Graph { path: beside, errors: new });
    }
    if old.is_empty() { Ok((graph, stock, findings)) } else { Err(BakeError::Graph { path: input.path.clone(), errors: old }) }
}

/// Overrides whose edits may be applied.
fn read_overrides(path: &Path) -> Result<GraphOverrides, BakeError> {
    let overrides: GraphOverrides = file::read(path)?;
    let errors = overrides.validate();
    if errors.is_empty() { Ok(overrides) } else { Err(BakeError::Overrides { path: path.to_owned(), errors }) }
}

/// A graph as it was written or surveyed; not validated yet, because an edit may mend it.
fn read_graph(input: &Input) -> Result<(CityGraph, Vec<Finding>), BakeError> {
    let (mut graph, mut findings) = match input.kind {
        InputKind::Osm => {
            let name = input.path.file_name().unwrap_or_default().to_string_lossy();
            let survey = veduta_survey::survey_osm(&input.content()?, &name)?;
            (survey.graph, survey.findings)
        }
        InputKind::Vector => {
            let name = input.path.file_name().unwrap_or_default().to_string_lossy();
            let map = input.vector.as_ref().ok_or_else(|| BakeError::UnknownKind(input.path.clone()))?;
            let survey = map.survey(&name)?;
            (survey.graph, survey.findings)
        }
        InputKind::Raster => {
            let survey = input.raster.clone().unwrap_or_default().survey(&input.path, &mut |_| ())?;
            (survey.graph, survey.findings)
        }
        InputKind::Graph => (file::read::<CityGraph>(&input.path)?, Vec::new()),
        InputKind::Words => {
            let survey = veduta_survey::survey_words(&file::read(&input.path)?)?;
            (survey.graph, survey.findings)
        }
        InputKind::Plan => return Err(BakeError::UnknownKind(input.path.clone())),
    };
    graph.fill_ids();
    // What lies too far away, or nowhere, is told by whoever validates the graph.
    if input.heights != Heights::default() && graph.validate().is_empty() {
        findings.extend(lay_on_ground(&mut graph, &input.heights)?);
    }
    Ok((graph, findings))
}

/// The plan of an input.
///
/// # Errors
/// As [`survey`], and if the graph cannot be grown.
pub fn plan(input: &Input, settings: &BakeSettings, progress: &mut dyn FnMut(Stage)) -> Result<Planned, BakeError> {
    progress(Stage::Survey);
    if input.kind == InputKind::Plan {
        if input.heights != Heights::default() {
            return Err(BakeError::HeightsOfPlan(input.path.clone()));
        }
        let plan: CityPlan = file::read(&input.path)?;
        plan.terrain.check().map_err(|reason| BakeError::Terrain { path: input.path.clone(), reason })?;
        return Ok(Planned { plan, findings: Vec::new() });
    }
    let (mut graph, stock, mut findings) = survey(input)?;
    graph.seed = settings.seed.unwrap_or(graph.seed);
    progress(Stage::Grow);
    let growth = veduta_growth::plan::grow(&graph, &stock)?;
    findings.extend(growth.findings);
    Ok(Planned { plan: growth.plan, findings })
}

/// Places that nobody can walk to from most others, with the reason.
fn places_apart(plan: &CityPlan) -> Vec<Finding> {
    let net = StreetNet::new(&plan.streets);
    let told = |Unreached { place, why }: Unreached<'_>| {
        let why = why.map_or_else(|| "the streets there are not joined to those of other places".to_owned(), |why| why.to_string());
        let message = format!("no way on foot leads to “{}” from most other places: {why}", place.name);
        Finding::new(Severity::Note, place.id, Some(place.pos), message)
    };
    unreached(&net, &plan.places).into_iter().map(told).collect()
}

/// A person's edits to the cells of an input, from `X.cells.overrides.ron` beside it; none where there is no such file.
///
/// # Errors
/// If the file cannot be read or has a mistake.
pub fn cell_edits(input: &Path) -> Result<Vec<CellOverride>, BakeError> {
    let path = cells_overrides_beside(input);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let overrides: CellsOverrides = file::read(&path)?;
    let errors = overrides.validate();
    if errors.is_empty() { Ok(overrides.edits) } else { Err(BakeError::Overrides { path, errors }) }
}

/// Cuts a plan into cells, with a person's edits to these.
#[must_use]
pub fn cut(plan: &CityPlan, edits: &[CellOverride], settings: &BakeSettings) -> (Cells, Vec<Finding>) {
    let cut = partition(plan, edits, &settings.partition);
    (cut.cells, cut.findings)
}

/// Bakes an input to a city directory, whole or not at all.
///
/// # Errors
/// If any stage fails; what stood at `out` before still stands.
pub fn bake(input: &Path, out: &Path, settings: &BakeSettings, progress: &mut dyn FnMut(Stage)) -> Result<Baked, BakeError> {
    bake_input(&Input::of(input)?, out, settings, progress)
}

/// Bakes an input with all that was said of it, as [`bake`] does a path.
///
/// # Errors
/// As [`bake`].
pub fn bake_input(input: &Input, out: &Path, settings: &BakeSettings, progress: &mut dyn FnMut(Stage)) -> Result<Baked, BakeError> {
    // A mistake in them is told before the work begins.
    let edits = cell_edits(&input.path)?;
    let Planned { plan, mut findings } = plan(input, settings, progress)?;
    findings.extend(places_apart(&plan));
    let mut writer = CityWriter::new(out, &plan)?;
    progress(Stage::Cut);
    let (cells, more) = cut(&plan, &edits, settings);
    findings.extend(more);
    if cells.cells.is_empty() {
        return Err(BakeError::Empty(input.path.clone()));
    }
    progress(Stage::Pack);
    let contents = Contents::new(&plan, &cells);
    let parts = |cell: usize| {
        let shell = contents.shell(cell);
        let ground = Some(ground_from_afar(&shell));
        CellParts { shell: Cow::Owned(shell), sheet: Cow::Owned(contents.sheet(cell)), pictures: contents.pictures(cell), ground }
    };
    writer.cells(&plan, &cells, &parts)?;
    findings.extend(companions::bring(&input.path, &mut writer)?);
    // The index of a large city takes as much again as its cells: the plan need not be there meanwhile.
    drop(contents);
    drop(plan);
    let stats = writer.finish(cells)?;
    Ok(Baked { stats, findings })
}
