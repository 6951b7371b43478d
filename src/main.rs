//! The `surefoot` program: hands the command line to `cli`, with the window it may open, and its exit code back to the shell.

fn main() -> std::process::ExitCode {
    surefoot::cli::run(std::env::args_os(), studio())
}

#[cfg(feature = "studio")]
fn studio() -> Option<surefoot::cli::OpenStudio> {
    Some(|open, measure| {
        let times = surefoot::studio::run(open, measure)?;
        times.map(|times| serde_json::to_string(&times).map_err(|error| error.to_string())).transpose()
    })
}

#[cfg(not(feature = "studio"))]
fn studio() -> Option<surefoot::cli::OpenStudio> {
    None
}
