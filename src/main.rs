//! The `surefoot` program: hands the command line to `cli` and its exit code back to the shell.

fn main() -> std::process::ExitCode {
    surefoot::cli::run(std::env::args_os())
}
