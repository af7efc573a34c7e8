"""Tests of scripts/install with stand-ins for the compilers, MPI, HDF5, cargo and Python of a machine."""

from __future__ import annotations

import shutil
import subprocess
import unittest

from made_up_results import SCRIPTS, ScriptTest

# What the script calls of the system itself. apt-get and sudo are not among them: the machine is a cluster.
SYSTEM = (
    "bash cat awk cmp cp dirname env false flock grep head id mkdir mktemp nproc paste readlink rm sed sleep sort tail tr true uname xargs"
).split()

# "Compiles" by naming what was asked for; ldd, below, says what is linked. OTHER_MPI is what HDF5 was built with.
MPICC = """#!/usr/bin/env bash
if [ "$1" = -show ]; then echo "gcc -I/opt/${MPI:-one}/include -L/opt/one/lib -lmpi"; exit 0; fi
[ "$1" = -o ] && echo "$(basename "$2")" >"$2"
"""
LDD = """#!/usr/bin/env bash
case "$(cat "$1")" in
    mpi) echo "libmpi.so.40 => $MACHINE/one/libmpi.so.40 (0x1)" ;;
    trial) echo "libmpi.so.${OTHER_MPI:-40} => $MACHINE/${OTHER_MPI:-one}/libmpi.so.${OTHER_MPI:-40} (0x1)" ;;
esac
echo "libc.so.6 => /lib/libc.so.6 (0x2)"
"""
PKG_CONFIG = """#!/usr/bin/env bash
case "$*" in
    *--cflags-only-I*) echo "-I$MACHINE/hdf5/include" ;;
    *--libs*) echo "-L$MACHINE/hdf5/lib -l${HDF5_NAME:-hdf5}" ;;
esac
"""
PYTHON = """#!/usr/bin/env bash
case "$*" in
    *"-m venv "*) mkdir -p "${!#}/bin"; cp "$0" "${!#}/bin/python"; echo made >>"$MACHINE/environments"; sleep 0.5 ;;
    *"-m pip install"*) [ "${PIP:-works}" = works ] || { echo "no such address" >&2; exit 1; } ;;
esac
"""
CARGO = """#!/usr/bin/env bash
echo "cargo 1.95.0"
echo "$*" >>"$MACHINE/cargo-calls"
"""
ANSWERS = "#!/usr/bin/env bash\necho '{}'\n"
# Reads what it is given: who writes to a program that has ended is ended too.
CC = """#!/usr/bin/env bash
case " $* " in *" - "*) while read -r line; do :; done ;; esac
"""


class TestInstalling(ScriptTest):
    """scripts/install on a made-up cluster with everything in place."""

    def setUp(self) -> None:
        super().setUp()
        self.tools = self.folder / "tools"
        for folder in ["tools", "root/scripts", "hdf5/include", "hdf5/lib", "clang/clang/15/include", "home"]:
            (self.folder / folder).mkdir(parents=True)
        for name in ["install", "requirements.txt"]:
            shutil.copy(SCRIPTS / name, self.folder / "root/scripts" / name)
        for name in SYSTEM:
            found = shutil.which(name)
            assert found, name
            (self.tools / name).symlink_to(found)
        (self.tools / "basename").symlink_to(shutil.which("basename") or "")
        (self.folder / "hdf5/include/H5pubconf.h").write_text("#define H5_HAVE_PARALLEL 1\n")
        (self.folder / "clang/libclang.so").write_text("")
        (self.folder / "clang/clang/15/include/stddef.h").write_text("")
        programs = {"mpicc": MPICC, "ldd": LDD, "pkg-config": PKG_CONFIG, "python3": PYTHON,
                    "cargo": CARGO, "cc": CC, "git": ANSWERS.format(""),
                    "mpirun": ANSWERS.format(""), "h5pcc": ANSWERS.format("")}  # fmt: skip
        for name, text in programs.items():
            (self.tools / name).write_text(text)
            (self.tools / name).chmod(0o755)

    def start(self, **more: str) -> subprocess.Popen[str]:
        """Starts the script."""
        environment = {"PATH": str(self.tools), "HOME": str(self.folder / "home"), "MACHINE": str(self.folder),
                       "LIBCLANG_PATH": str(self.folder / "clang")}  # fmt: skip
        command = [str(self.tools / "bash"), str(self.folder / "root/scripts/install")]
        return subprocess.Popen(command, env=environment | more, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def install(self, **more: str) -> tuple[int, str]:
        """Calls the script; returns its exit code and what it said."""
        return self.end_of(self.start(**more))

    @staticmethod
    def end_of(script: subprocess.Popen[str]) -> tuple[int, str]:
        """Waits for a script; returns its exit code and what it said."""
        said, _ = script.communicate(timeout=60)
        return script.returncode, said

    def test_one_mpi_is_accepted(self) -> None:
        code, said = self.install()
        self.assertEqual(code, 0, said)
        self.assertTrue((self.folder / "root/.venv/requirements.txt").exists())

    def test_two_mpis_are_refused(self) -> None:
        # The trial with HDF5 is linked with one library alone, and that is not the compiler's.
        code, said = self.install(OTHER_MPI="12")
        self.assertEqual(code, 1, said)
        self.assertIn("two MPIs would be linked", said)
        self.assertIn("libmpi.so.12", said)
        self.assertIn("libmpi.so.40", said)

    def test_bindings_of_another_mpi_are_removed(self) -> None:
        def cleans() -> int:
            return (self.folder / "cargo-calls").read_text().count("-p mpi-sys")

        for mpi, expected in [("one", 0), ("one", 0), ("other", 2), ("other", 2), ("one", 4)]:
            code, said = self.install(MPI=mpi)
            self.assertEqual((code, cleans()), (0, expected), said)

    def test_hdf5_of_another_name_is_not_taken(self) -> None:
        code, said = self.install(HDF5_NAME="hdf5_openmpi")
        self.assertEqual(code, 1, said)
        self.assertIn("has another name than libhdf5", said)
        # HDF5_DIR has the last word.
        code, said = self.install(HDF5_NAME="hdf5_openmpi", HDF5_DIR=str(self.folder / "hdf5"))
        self.assertEqual(code, 0, said)
        self.assertIn(f"HDF5_DIR='{self.folder}/hdf5'", said)

    def test_a_failure_of_pip_is_a_warning(self) -> None:
        code, said = self.install(PIP="fails")
        self.assertEqual(code, 0, said)
        self.assertIn("warning: pip could not install", said)
        # And the next call tries again.
        self.assertFalse((self.folder / "root/.venv/requirements.txt").exists())
        code, said = self.install()
        self.assertEqual(code, 0, said)
        self.assertNotIn("warning", said)

    def test_two_at_once_make_one_environment(self) -> None:
        for code, said in map(self.end_of, [self.start(), self.start()]):
            self.assertEqual(code, 0, said)
            self.assertNotIn("warning", said)
        self.assertEqual((self.folder / "environments").read_text(), "made\n")

    def test_what_is_missing_is_named(self) -> None:
        (self.tools / "mpirun").unlink()
        code, said = self.install()
        self.assertEqual(code, 1, said)
        self.assertIn("mpirun: module load openmpi", said)


if __name__ == "__main__":
    unittest.main()
