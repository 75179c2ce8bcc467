//! Compiles `proto/tandem/v1/*.proto` with `protox`, so that building needs no `protoc` binary,
//! and leaves the descriptor set beside the generated code for the schema records of MCAP files.

use std::{env, error::Error, fs, path::PathBuf};

use prost::Message as _;

#[expect(
    clippy::disallowed_methods,
    reason = "the environment tells a build script where to write"
)]
fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from("proto");
    let mut files: Vec<PathBuf> = fs::read_dir(root.join("tandem/v1"))?
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<_, _>>()?;
    files.retain(|path| path.extension().is_some_and(|e| e == "proto"));
    files.sort();

    let mut descriptors = protox::compile(&files, [&root])?;
    prost_build::Config::new().compile_fds(descriptors.clone())?;

    // Comments and positions are for the compiler alone; they would only make every log longer.
    for file in &mut descriptors.file {
        file.source_code_info = None;
    }
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("tandem.v1.fds"), descriptors.encode_to_vec())?;
    println!("cargo:rerun-if-changed=proto");
    Ok(())
}
