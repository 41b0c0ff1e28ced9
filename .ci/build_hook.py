"""Compiles the kernel when the package is built or installed; without a compiler the package goes without it.

Run by hatchling (pyproject.toml), never by mbkf. The stable ABI makes one build serve every Python from 3.11 on.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import cast

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import sys_tags

FOLDER = Path("mbkf") / "kernel"
NAME = "_kernel"


class KernelHook(BuildHookInterface):
    """Puts the compiled kernel beside its sources, and from there into the wheel."""

    def initialize(self, version: str, build_data: dict[str, object]) -> None:  # noqa: ARG002, the hook's signature
        """Called before a wheel is made, also that of an editable installation."""
        folder = Path(self.root) / FOLDER
        try:
            built = compiled(folder)
        except Exception as failed:  # compilers fail in many ways, and none of them is an error here
            for old in (*folder.glob(f"{NAME}*.so"), *folder.glob(f"{NAME}*.pyd")):
                old.unlink()
            self.app.display_warning(f"mbkf is installed without its compiled kernel: {failed}")
            return
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{_platform()}"
        cast(list[str], build_data["artifacts"]).append(f"/{built.relative_to(self.root).as_posix()}")


def compiled(folder: Path) -> Path:
    """Compiles all sources of a folder into one module of Python's stable ABI, in the same folder.

    Raises:
        Exception: What setuptools raises where no compiler is found or a source does not compile.
    """
    from setuptools import Distribution, Extension
    from setuptools.command.build_ext import build_ext

    sources = sorted(str(path) for path in folder.glob("*.c"))
    kernel = Extension(NAME, sources, py_limited_api=True, libraries=["m"] if os.name == "posix" else [])
    with tempfile.TemporaryDirectory() as scratch:
        command = build_ext(Distribution({"ext_modules": [kernel]}))
        command.build_lib = command.build_temp = scratch
        command.ensure_finalized()
        if command.compiler != "msvc":
            kernel.extra_compile_args = ["-O3", "-fno-math-errno"]
        command.run()
        built = Path(command.get_ext_fullpath(NAME))
        fresh = shutil.copy(built, folder / f"{built.name}.new")
        return Path(fresh).replace(folder / built.name)  # in one go: others may be loading it


def _platform() -> str:
    """The machine's tag; which Linux libraries a wheel runs with is told by the tool that makes releases."""
    return next(tag.platform for tag in sys_tags() if "linux_" not in tag.platform[1:])
