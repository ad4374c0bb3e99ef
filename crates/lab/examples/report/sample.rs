//! An invented experiment: nothing in it was rendered.

use bidir::sampler::{Dimension, Domain, Purpose, Sampler, SamplerKind};
use bidir_lab::image::Pixels;
use bidir_lab::report::{ImageKind, Report, ReportImage, Sheet, add_flip, html};
use bidir_lab::results::{
    Axis, BudgetInfo, BudgetKind, Cell, Claim, FORMAT, Machine, MethodInfo, Plot, PlotKind,
    Pyramid, Rays, Record, Results, Scale, SceneInfo, Series, StrategyInfo, Table, Verdict,
};
use formats::image::encode_png;

/// Methods, and the error that each has with one sample per pixel.
const METHODS: [(&str, &str, f64); 4] = [
    ("all <connections>", "all", 0.9),
    ("per-pair", "per-pair", 1.6),
    ("ray-roulette", "ray-roulette", 1.05),
    ("budget 2", "budget:2", 1.11),
];
const SCENES: [&str; 2] = ["room & lamp", "apartment"];
const SAMPLES: [u64; 4] = [1, 4, 16, 64];
const SIZE: [usize; 2] = [96, 72];

/// An experiment with its images.
pub(crate) struct Sample {
    results: Results,
    tables: Vec<Table>,
    plots: Vec<Plot>,
    images: Vec<ReportImage>,
    sheets: Vec<Sheet>,
}

impl Sample {
    pub(crate) fn new() -> Self {
        let mut images: Vec<_> = SCENES.iter().flat_map(|scene| images(scene)).collect();
        add_flip(&mut images);
        Self {
            results: results(),
            tables: vec![errors()],
            plots: vec![convergence(), histogram()],
            images,
            sheets: ["weighted.png", "raw.png"].map(sheet).into(),
        }
    }

    pub(crate) fn page(&self) -> String {
        html(&Report {
            results: &self.results,
            tables: &self.tables,
            plots: &self.plots,
            images: &self.images,
            sheets: &self.sheets,
            command: "bidir experiment sample.toml --out sample",
        })
    }
}

fn results() -> Results {
    Results {
        format: FORMAT,
        title: "Which shadow rays pay? (invented numbers)".into(),
        description: "Bidirectional path tracing connects every light vertex with every camera \
                      vertex. Four rules that choose some of these connections are compared.\n\n\
                      Every number of this page is made up: it shows what a report looks like."
            .into(),
        program: "bidir 0.1.0".into(),
        machine: Machine {
            processor: "An invented processor, 8 cores".into(),
            threads: 8,
            isa: "sse2".into(),
            system: "linux x86_64".into(),
        },
        scenes: SCENES.iter().map(|name| scene(name)).collect(),
        methods: METHODS
            .iter()
            .map(|(name, rays, _)| method(name, rays))
            .collect(),
        budgets: SAMPLES.iter().map(|&spp| budget(spp)).collect(),
        records: records(),
        pyramids: vec![pyramid()],
        contributions: Vec::new(),
        claims: vec![slope(), speedup(), roulette()],
    }
}

fn scene(name: &str) -> SceneInfo {
    SceneInfo {
        name: name.into(),
        file: format!("scenes/{}.pbrt", name.replace(' ', "-")),
        digest: "4f3c0a9be2d17786".into(),
        size: SIZE,
        reference:
            "mean of path tracing and of bidirectional path tracing, 65536 samples per pixel \
                    each, whose means agree in all 48 blocks at the level 0.001"
                .into(),
        reference_image: Some(format!("references/{name}.exr")),
        reference_mse: Some(2.5e-7),
    }
}

fn method(name: &str, shadow_rays: &str) -> MethodInfo {
    let settings = [
        ("integrator", "bdpt"),
        ("max-depth", "none"),
        ("mis", "power"),
        ("path-roulette", "albedo"),
        ("shadow-rays", shadow_rays),
    ];
    let settings = settings.map(|(key, value)| (key.to_owned(), value.to_owned()));
    MethodInfo {
        name: name.into(),
        settings: settings.into(),
    }
}

fn budget(spp: u64) -> BudgetInfo {
    BudgetInfo {
        name: format!("{spp} spp"),
        kind: BudgetKind::Samples,
        amount: spp as f64,
    }
}

fn records() -> Vec<Record> {
    let mut records = Vec::new();
    for scene in SCENES {
        for (method, _, error) in METHODS {
            for spp in SAMPLES {
                records.extend((1..=5).map(|seed| record([scene, method], spp, seed, error)));
            }
        }
    }
    records
}

fn record([scene, method]: [&str; 2], spp: u64, seed: u64, error: f64) -> Record {
    let rays = 6912 * spp;
    Record {
        scene: scene.into(),
        method: method.into(),
        budget: format!("{spp} spp"),
        seed,
        spp,
        seconds: 0.02 * spp as f64,
        processor_seconds: None,
        training_seconds: None,
        training_processor_seconds: None,
        rays: Rays {
            camera: 4 * rays,
            light: 4 * rays,
            connection: 7 * rays,
            light_image: 3 * rays,
            training: 0,
        },
        connections_blocked: 2 * rays,
        metrics: [("relmse".to_owned(), error / spp as f64)].into(),
        efficiency_rays: 1.0,
        efficiency_seconds: 1.0,
        image: None,
    }
}

fn pyramid() -> Pyramid {
    let strategies = [(0, 2), (1, 1), (0, 3), (1, 2), (2, 1)];
    let strategy = |(s, t)| StrategyInfo {
        s,
        t,
        mean: 0.1,
        raw_mean: 0.1 * f64::from(s + t),
        variance: Some(0.01),
        rays: 100_000 * u64::from(s),
        blocked: 31_000 * u64::from(s),
        raw_dropped: 0,
    };
    Pyramid {
        scene: SCENES[0].into(),
        method: METHODS[0].0.into(),
        seed: 1,
        spp: 16,
        size: SIZE,
        vertices: 3,
        mean: 0.8,
        longer: 0.3,
        strategies: strategies.map(strategy).into(),
        weighted: "weighted.png".into(),
        raw: "raw.png".into(),
    }
}

/// A picture where a contact sheet would be.
fn sheet(name: &str) -> Sheet {
    let image = picture(SCENES[0]);
    let png = encode_png(SIZE.map(|side| side as u32), &image.data);
    Sheet {
        name: name.into(),
        png: png.expect("the picture has all its pixels"),
    }
}

fn slope() -> Claim {
    Claim {
        id: "slope".into(),
        claim: "The mean square error of every method falls as 1 / samples.".into(),
        source: "an invented paper, section 3".into(),
        verdict: Verdict::Reproduced,
        found: "Slopes in the log-log plot are between −1.02 and −0.98 for all methods.".into(),
        method: "95 % intervals of least-squares slopes over 5 seeds".into(),
        tables: Vec::new(),
        plots: vec![convergence()],
    }
}

fn speedup() -> Claim {
    let row = |scene: &str, method: &str, [value, low, high]: [f64; 3]| {
        let gain = Cell::Interval { value, low, high };
        vec![
            Cell::Text(scene.into()),
            Cell::Text(method.into()),
            gain,
            Cell::Number(value * 1.07),
        ]
    };
    let columns = [
        "scene",
        "method",
        "efficiency per ray, relative to the first",
        "published",
    ];
    Claim {
        id: "gain".into(),
        claim: "One ray for each pair of subpaths doubles the efficiency.".into(),
        source: "an invented paper, table 1 (b)".into(),
        verdict: Verdict::NotReproduced,
        found: "It is 1.31 [1.24, 1.38] times as efficient in the room.".into(),
        method: "bootstrap of ratios paired by seed, 95 %, 5 seeds".into(),
        tables: vec![Table {
            caption: "Efficiency per ray.".into(),
            columns: columns.map(str::to_owned).to_vec(),
            rows: vec![
                row(SCENES[0], "per-pair", [1.31, 1.24, 1.38]),
                row(SCENES[0], "ray-roulette", [1.52, 1.45, 1.61]),
                row(SCENES[0], "budget 2", [1.49, 1.41, 1.57]),
                row(SCENES[1], "per-pair", [0.853, 0.821, 0.884]),
                row(SCENES[1], "ray-roulette", [1.21, 1.17, 1.25]),
                row(SCENES[1], "budget 2", [1.0e-5, 0.9e-5, 1.1e-5]),
            ],
        }],
        plots: Vec::new(),
    }
}

fn roulette() -> Claim {
    Claim {
        id: "roulette".into(),
        claim: "Roulette is better than a budget.".into(),
        source: "folklore".into(),
        verdict: Verdict::Undecided,
        found: "The ratio is 1.02 [0.96, 1.09].".into(),
        method: "bootstrap of ratios paired by seed, 95 %, 5 seeds".into(),
        tables: Vec::new(),
        plots: Vec::new(),
    }
}

fn errors() -> Table {
    let mut rows = Vec::new();
    for (index, scene) in SCENES.iter().enumerate() {
        for (method, _, error) in METHODS {
            let value = error * (1.0 + index as f64) / 64.0;
            let interval = |factor: f64| Cell::Interval {
                value: factor * value,
                low: 0.94 * factor * value,
                high: 1.06 * factor * value,
            };
            let names = [*scene, method].map(|name| Cell::Text(name.into()));
            let numbers = [
                interval(1.0),
                interval(0.3),
                interval(7.0),
                Cell::Number(18.0 * 64.0),
            ];
            rows.push(names.into_iter().chain(numbers).collect());
        }
    }
    let columns = [
        "scene",
        "method",
        "relmse",
        "flip",
        "efficiency_rays",
        "rays per pixel",
    ];
    Table {
        caption: "Errors with 64 samples per pixel, 95 % intervals over 5 seeds.".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    }
}

fn axis(label: &str, scale: Scale) -> Axis {
    Axis {
        label: label.into(),
        scale,
    }
}

fn convergence() -> Plot {
    let series = |(name, _, error): &(&str, &str, f64)| {
        let at = |&spp: &u64| [spp as f64 * 18.0, error / spp as f64];
        let points: Vec<_> = SAMPLES.iter().map(at).collect();
        Series {
            name: (*name).into(),
            intervals: points.iter().map(|[_, y]| [0.88 * y, 1.13 * y]).collect(),
            points,
        }
    };
    Plot {
        caption: format!(
            "Convergence in {}: error over rays, 95 % intervals over 5 seeds.",
            SCENES[0]
        ),
        kind: PlotKind::Lines,
        x: axis("rays per pixel", Scale::Log),
        y: axis("relative mean square error", Scale::Log),
        series: METHODS.iter().map(series).collect(),
    }
}

fn histogram() -> Plot {
    let series = |(index, name): (usize, &str)| {
        let bins = (0..16).map(|bin| f64::from(bin) / 8.0 - 1.0);
        let height = |x: f64| libm::exp(-6.0 * (x - 0.3 * index as f64) * (x - 0.3 * index as f64));
        Series {
            name: name.into(),
            points: bins.map(|x| [x, 1.2 * height(x)]).collect(),
            intervals: Vec::new(),
        }
    };
    Plot {
        caption: "Distribution of contributions, by strategy.".into(),
        kind: PlotKind::Histogram,
        x: axis("log₁₀ of the contribution", Scale::Linear),
        y: axis("density", Scale::Linear),
        series: ["s = 1", "s = 2", "t = 1"]
            .into_iter()
            .enumerate()
            .map(series)
            .collect(),
    }
}

/// The reference of a scene, and what methods made of it.
fn images(scene: &str) -> Vec<ReportImage> {
    let reference = picture(scene);
    let mut images: Vec<_> = METHODS
        .iter()
        .map(|(method, _, error)| {
            let pixels = noisy(&reference, *error / 4.0);
            ReportImage {
                scene: scene.into(),
                kind: ImageKind::Render {
                    method: (*method).into(),
                    budget: "16 spp".into(),
                },
                pixels,
                flip: None,
            }
        })
        .collect();
    images.push(ReportImage {
        scene: scene.into(),
        kind: ImageKind::Reference,
        pixels: reference,
        flip: None,
    });
    images
}

/// A wall with a lamp in front of it, and a floor of tiles.
fn picture(scene: &str) -> Pixels {
    let warm = if scene == SCENES[0] { 1.0 } else { 0.4 };
    let pixel = |index: usize| {
        let [x, y] = [index % SIZE[0], index / SIZE[0]].map(|place| place as f64);
        let distance = (x - 30.0) * (x - 30.0) + (y - 24.0) * (y - 24.0);
        let lamp = if distance < 40.0 {
            12.0
        } else {
            60.0 / (distance + 40.0)
        };
        let tile = ((x / 8.0) as u64 + (y / 6.0) as u64) % 2;
        let ground = if y > 48.0 {
            0.1 + 0.4 * tile as f64
        } else {
            0.25
        };
        let light = lamp + ground * (0.3 + lamp);
        [
            light,
            light * (0.6 + 0.3 * warm),
            light * (1.2 - 0.8 * warm),
        ]
        .map(|light| light as f32)
    };
    Pixels {
        size: SIZE,
        data: (0..SIZE[0] * SIZE[1]).map(pixel).collect(),
    }
}

/// The picture with noise of this relative size.
fn noisy(pixels: &Pixels, error: f64) -> Pixels {
    let sampler = Sampler::new(SamplerKind::Independent, (error * 1000.0) as u64);
    let noise = |(index, pixel): (usize, &[f32; 3])| {
        let point = sampler.stream(Domain::Camera, 0, index as u64);
        let [u, v] = point.get_2d(Dimension::at(0, Purpose::Scatter)).to_array();
        // Mostly too dark, sometimes far too bright.
        let factor = 1.0 - error as f32 * u + if v > 0.98 { 6.0 * error as f32 } else { 0.0 };
        pixel.map(|channel| channel * factor)
    };
    Pixels {
        size: pixels.size,
        data: pixels.data.iter().enumerate().map(noise).collect(),
    }
}
