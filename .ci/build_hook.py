"""Compiles the kernel when the package is built or installed.

Run by hatchling (pyproject.toml), never by mbkf; ``python .ci/build_hook.py`` compiles it in place, for work on mbkf.
The stable ABI makes one build serve every Python from 3.11 on.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import cast

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import sys_tags

FOLDER = Path("mbkf") / "kernel"
NAME = "_kernel"

SWITCH, REFERENCE = "MBKF_KERNEL", "reference"
"""The environment variable that mbkf.kernel.loading reads, too; with this value nothing is compiled."""

WITHOUT = f"""mbkf is built without its compiled kernel, because {SWITCH}={REFERENCE} asks for that. A step of the
filters takes several times as long; results agree to rounding."""

FAILED = f"""The kernel of mbkf was not compiled: {{}}
If a compiler reported an error, it stands above. If there is no C compiler, install one:
  Debian, Ubuntu   apt install gcc libc6-dev
  Fedora           dnf install gcc
  macOS            xcode-select --install
  Windows          Build Tools for Visual Studio, with the C++ workload
  conda            conda install c-compiler
To install mbkf without the kernel, set {SWITCH}={REFERENCE}: a step of the filters takes several times as long then."""


class KernelHook(BuildHookInterface):
    """Puts the compiled kernel beside its sources, and from there into the wheel."""

    def initialize(self, version: str, build_data: dict[str, object]) -> None:  # noqa: ARG002, the hook's signature
        """Called before a wheel is made, also that of an editable installation.

        Raises:
            SystemExit: The kernel cannot be compiled, and the environment does not ask to go without it.
        """
        folder = Path(self.root) / FOLDER
        if os.environ.get(SWITCH) == REFERENCE:
            for old in (*folder.glob(f"{NAME}*.so"), *folder.glob(f"{NAME}*.pyd")):
                old.unlink()
            self.app.display_warning(WITHOUT)
            return
        try:
            built = compiled(folder)
        except Exception as failed:  # setuptools and its compilers share no type of error
            self.app.abort(FAILED.format(failed))
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{_platform()}"
        cast(list[str], build_data["artifacts"]).append(f"/{built.relative_to(self.root).as_posix()}")


def compiled(folder: Path, flags: Sequence[str] = ("-O3", "-fno-math-errno", "-fvisibility=hidden")) -> Path:
    """Compiles all sources of a folder into one module of Python's stable ABI, in the same folder.

    Args:
        folder: ``mbkf/kernel``; its declarations become prototypes and binding first.
        flags: Options of compilers other than Microsoft's.

    Raises:
        Exception: Any that setuptools raises where no compiler is found or a source does not compile.
    """
    import numpy as np
    from setuptools import Distribution, Extension
    from setuptools.command.build_ext import build_ext

    class Command(build_ext):
        def build_extensions(self) -> None:
            self.compiler.compile = _beside_each_other(self.compiler.compile)
            super().build_extensions()

    with tempfile.TemporaryDirectory() as scratch:
        kernel = Extension(
            NAME,
            sorted(str(path) for path in folder.glob("*.c")),
            include_dirs=[scratch, str(folder), np.get_include()],
            libraries=["m"] if os.name == "posix" else [],
            py_limited_api=True,
        )
        write_binding(folder, Path(scratch))
        command = Command(Distribution({"ext_modules": [kernel]}))
        command.build_lib = command.build_temp = scratch
        command.ensure_finalized()
        if command.compiler != "msvc":
            kernel.extra_compile_args = kernel.extra_link_args = list(flags)
        command.run()
        built = Path(command.get_ext_fullpath(NAME))
        fresh = shutil.copy(built, folder / f"{built.name}.new")
        return Path(fresh).replace(folder / built.name)  # in one go: others may be loading it


def _beside_each_other(one_by_one: Callable[..., list[str]]) -> Callable[..., list[str]]:
    """A compiler's method that compiles as many sources at once as there are processors."""

    def compile_all(sources: Sequence[str], *where: object, **how: object) -> list[str]:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(lambda source: one_by_one([source], *where, **how), sources))
        return [path for paths in objects for path in paths]

    return compile_all


def write_binding(folder: Path, to: Path) -> None:
    """Writes prototypes and binding made from the declarations in a folder."""
    beside = str(Path(__file__).resolve().parent)
    if beside not in sys.path:  # hatchling loads this file alone
        sys.path.insert(0, beside)
    import kernel_binding as made
    import kernel_declarations

    found = kernel_declarations.declarations(folder)
    (to / "declared.h").write_text(made.header(found), encoding="utf-8")
    (to / "binding.h").write_text(made.binding(found), encoding="utf-8")


def _platform() -> str:
    """The machine's tag; the tool that makes releases replaces it by one that names the Linux libraries needed."""
    return next(tag.platform for tag in sys_tags() if "linux_" not in tag.platform[1:])


if __name__ == "__main__":
    print(compiled(Path(__file__).resolve().parents[1] / FOLDER))
