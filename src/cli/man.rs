//! `surefoot man`: a manual page for the program and one for each command.

use super::args::{Args, ManArgs};
use super::tell;
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use clap::CommandFactory;
use clap_mangen::Man;

/// Writes them.
pub fn run(args: &ManArgs) -> Result<Exit, Failure> {
    let mut program = Args::command();
    program.build();
    let mut outputs = Vec::new();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let page = Man::new(command.clone()).source(concat!("surefoot ", env!("CARGO_PKG_VERSION"))).manual("Surefoot");
        let mut bytes = Vec::new();
        page.render(&mut bytes).map_err(|error| Failure::failed(format!("a manual page: {error}")))?;
        outputs.push(Output { path: args.output.join(page.get_filename()), bytes });
    }
    writer::write(&outputs, &[])?;
    tell(&format!("wrote {} pages into {}", outputs.len(), args.output.display()));
    Ok(Exit::Done)
}
