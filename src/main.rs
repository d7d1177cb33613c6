//! The command `isoslice`. It is a part of the library, so that it is compiled
//! beside the crates before it and not after them.

fn main() -> std::process::ExitCode {
    isoslice::cli::main()
}
