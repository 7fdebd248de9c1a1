//! Compiles the one C function that the import side needs: FMI 2.0 hands its log messages over as
//! `printf` arguments, and a function with a variable number of arguments cannot be written in Rust.

fn main() {
    println!("cargo::rerun-if-changed=c/fmi2_log.c");
    #[cfg(feature = "import")]
    cc::Build::new().file("c/fmi2_log.c").warnings(true).compile("drivescope_fmi2_log");
}
