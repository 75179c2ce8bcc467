# The same checks that .ci/run makes, one by one.

# Everything that must hold before a change may land
ci:
    .ci/run

# All tests
test:
    cargo test --workspace --locked

# Formatting, lints and documentation
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --locked -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked --document-private-items

# The same hash everywhere (needs debug and release builds)
determinism:
    cargo build --locked
    cargo build --release --locked
    .ci/determinism

# Independent readers of the logs (needs a release build)
readers:
    cargo build --release --locked
    .ci/readers

# Fixtures against their golden results, and a changed default that must be caught
fixtures-hold:
    cargo build --locked
    target/debug/tandem check fixtures
    .ci/changed-default

# The HTML report in Chromium, used as a reader would; screenshots into docs/report (needs a release build)
report-page:
    cargo build --release --locked
    .ci/report-page docs/report

# Figures and their table in docs/controller.md, section 11
figures:
    cargo build --release --locked
    python3 docs/make-figures.py

# The README's main command
demo:
    cargo run --release --locked -- demo --force

# Licences, banned crates and sources (needs cargo-deny)
deny:
    cargo deny check licenses bans sources

# Make the fixtures again
fixtures:
    fixtures/make

# What a comparison notices: the tables of docs/self-test.md
self-test:
    cargo build --release --locked
    python3 docs/make-self-test.py

# The printed laws against the corrected ones: docs/flagship.md
flagship:
    cargo build --release --locked
    python3 docs/make-flagship.py
