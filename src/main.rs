//! The `polder` command.

/// Meshing makes and drops millions of small arrays on every core; mimalloc keeps them local to a
/// thread and gives pages back, so that peak memory follows the work in flight.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    polder::cli::run().into()
}
