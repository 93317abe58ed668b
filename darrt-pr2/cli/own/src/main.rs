fn main() -> std::process::ExitCode {
    darrt_cli::main_with(&darrt_own::registry())
}
