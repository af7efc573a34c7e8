# Copyright The Talcum authors. MIT OR Apache-2.0.
"""Talcum for Spack: put this folder into a repository of packages as packages/talcum, then `spack install talcum`."""

from spack.package import *
from spack_repo.builtin.build_systems.cargo import CargoPackage


class Talcum(CargoPackage):
    """MPI-parallel CFD-DEM of fluidised beds of fine, cohesive powders: the same bits on any number of ranks."""

    homepage = "https://talcum.invalid"
    url = "https://talcum.invalid/talcum-0.1.0.tar.gz"
    git = "https://talcum.invalid/talcum.git"

    license("MIT OR Apache-2.0", checked_by="the Talcum authors")

    version("0.1.0", tag="v0.1.0")

    depends_on("c", type="build")
    depends_on("rust@1.89:", type="build")
    depends_on("pkgconfig", type="build")
    # bindgen reads mpi.h and hdf5.h by libclang.
    depends_on("llvm+clang", type="build")
    depends_on("mpi")
    depends_on("hdf5@1.10.5:+mpi+shared")

    def setup_build_environment(self, env):
        """Says where MPI, HDF5 and libclang are."""
        env.set("MPICC", self.spec["mpi"].mpicc)
        env.set("HDF5_DIR", self.spec["hdf5"].prefix)
        env.set("LIBCLANG_PATH", self.spec["llvm"].prefix.lib)

    @property
    def build_args(self):
        """The versions of Cargo.lock, with which a release is tested."""
        return ["--locked"]

    @run_after("install")
    def install_manual_and_completions(self):
        """Made by the program itself."""
        talcum = Executable(self.prefix.bin.talcum)
        talcum("manual", self.prefix.share.man.man1)
        for shell, folder, name in [
            ("bash", self.prefix.share.join("bash-completion/completions"), "talcum"),
            ("zsh", self.prefix.share.join("zsh/site-functions"), "_talcum"),
            ("fish", self.prefix.share.join("fish/vendor_completions.d"), "talcum.fish"),
        ]:
            mkdirp(folder)
            with open(join_path(folder, name), "w") as file:
                talcum("completions", shell, output=file)
