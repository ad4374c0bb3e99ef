# Recipes for people; `.ci/run` is what a change must pass.

set shell := ["bash", "-euo", "pipefail", "-c"]

# Shows this list.
default:
    @just --list

# Everything that must pass, or some stages of it.
check *STAGES:
    .ci/run {{STAGES}}

# All tests, or those whose names contain FILTER.
test FILTER="":
    cargo test --release -- {{FILTER}}

# The statistical tests, with other random numbers where SEED is given.
stat SEED="1":
    BIDIR_TEST_SEED={{SEED}} cargo test --release -p bidir --lib tests::
    BIDIR_TEST_SEED={{SEED}} cargo test --release -p bidir --test suite -- analytic:: layers::
    BIDIR_TEST_SEED={{SEED}} cargo test --release -p bidir-formats --test estimators
    BIDIR_TEST_SEED={{SEED}} cargo test --release -p bidir-formats --test suite -- real_scenes::

# Writes the pages that are generated.
docs:
    cargo build --release
    ${CARGO_TARGET_DIR:-target}/release/bidir man --markdown > docs/reference/cli.md
    BIDIR_WRITE_PAGES=1 cargo test --release -p bidir-formats --lib limits
    BIDIR_WRITE_PAGES=1 cargo test --release -p bidir-cli --test cli choices
    python3 tools/tables
    python3 tools/python_reference

# The libraries' documentation.
doc:
    cargo doc --release --workspace --no-deps --document-private-items

# Formats all sources.
fmt:
    cargo fmt --all

# Checks texts, names and sizes, which no compiler does.
tidy:
    tools/tidy

# Renders SCENE into out/, with any flags of `bidir render`.
render SCENE *FLAGS:
    mkdir -p out
    cargo run --release -- render {{SCENE}} -o out/{{file_stem(SCENE)}}.exr {{FLAGS}}

# A quick look at SCENE: a few seconds, a small image.
look SCENE *FLAGS:
    mkdir -p out
    cargo run --release -- render {{SCENE}} -o out/{{file_stem(SCENE)}}-look.png --time 5s {{FLAGS}}

# Makes the pictures of pages in the browser: needs node, Chromium and a built bidir.
pictures:
    cd crates/viewer/browser && npm ci --no-audit --no-fund
    cd crates/viewer/browser && node pictures.js view {{justfile_directory()}}/docs/images/view.jpg
    target/release/bidir experiment experiments/shadow-rays.toml -o out/shadow-rays
    cd crates/viewer/browser && node pictures.js report {{justfile_directory()}}/out/shadow-rays/report.html {{justfile_directory()}}/docs/images/report.jpg

# Writes the scenes of furnished rooms.
scenes:
    python3 tools/make_scenes

# Measures the cost of the exact film.
bench-film:
    cargo bench -p bidir-formats --bench film

# Instructions of samples and of their stages, by valgrind; what changed since the figures kept.
bench-instr *FLAGS:
    cargo build --release
    python3 tools/bench_instr {{FLAGS}}

# How speed and memory grow with threads, triangles, instances, pixels, lights and bounces.
bench-scaling *FLAGS:
    cargo build --release
    python3 tools/bench_scaling {{FLAGS}}

# Measures the cost of being watched in the browser, also by a client that never reads.
bench-view *FLAGS:
    cargo build --release
    python3 tools/bench_view {{FLAGS}}

# Measures the time of `auto` and of its plans to the same noise; needs the Python package.
bench-auto *FLAGS:
    python3 tools/bench_auto {{FLAGS}}

# Measures the time and memory of a render over Ray, beside one without; needs the Python package.
bench-ray *FLAGS:
    python3 tools/bench_ray {{FLAGS}}

# The same work in Mitsuba and LuxCore: installs them beside the build (1.2 GB) where they are absent.
bench-peers *FLAGS:
    cargo build --release
    python3 tools/peers bench {{FLAGS}}

# Whether our image and those of the other renderers are the same.
verify-peers *FLAGS:
    cargo build --release
    python3 tools/peers verify {{FLAGS}}

# Measures the time of rays, beside the crate obvhs and Embree where there is one: BIDIR_EMBREE is the path of its library.
bench-rays *ARGS:
    cargo bench -p bidir-accel --features bench-peers --bench rays -- {{ARGS}}

# Puts faults into a copy of light transport: each must turn some test red.
mutants *FLAGS:
    python3 tools/mutants {{FLAGS}}

# Lets cargo-mutants put faults into what changed lately, for half an hour.
mutants-changed:
    tools/nightly "$(date +%s)" changed

# Feeds each parser, or those named, with made-up files for so many seconds; see fuzz/README.md.
fuzz SECONDS *TARGETS:
    tools/fuzz {{SECONDS}} {{TARGETS}}

# Kills the program, lets system calls fail, damages its inputs and strains its limits; or some parts of that.
attack *FLAGS:
    cargo build --release
    cargo build --release --example mutations
    python3 tools/attack {{FLAGS}}

# Fresh random numbers, long property tests, attacks and mutants, with a summary; or some stages of it.
nightly SEED="" *STAGES:
    tools/nightly "{{SEED}}" {{STAGES}}
