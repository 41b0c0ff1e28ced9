"""An installation ends where the kernel does not compile, unless the environment asks to go without it."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.quick_compiler import quick_compiler

ROOT = Path(__file__).resolve().parents[2]
NEEDED = ("pyproject.toml", "README.md", "LICENSE", "mbkf/version.py")
FOLDERS = ("mbkf/kernel", "models", "markers", ".ci")


@pytest.fixture
def tree(tmp_path) -> Path:
    """What a wheel with a kernel is made from."""
    for folder in FOLDERS:
        shutil.copytree(
            ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("*.so", "__pycache__")
        )
    for name in NEEDED:
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def built(tree: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "hatchling", "build", "-t", "wheel"]
    own = {name: value for name, value in os.environ.items() if name != "MBKF_KERNEL"}
    return subprocess.run(
        words, cwd=tree, env=own | environment, capture_output=True, text=True, timeout=120, check=False
    )


def wheels(tree: Path) -> list[Path]:
    return list((tree / "dist").glob("*.whl"))


def kernels_in(wheel: Path) -> list[str]:
    return [name for name in zipfile.ZipFile(wheel).namelist() if name.endswith((".so", ".pyd"))]


@pytest.mark.parametrize("compiler", ["false", "no-compiler-has-this-name"])
def test_without_a_working_compiler_the_installation_ends_and_says_what_to_do(tree, compiler):
    done = built(tree, CC=compiler)
    assert done.returncode == 1
    assert compiler in done.stderr
    assert "apt install gcc" in done.stderr
    assert "MBKF_KERNEL=reference" in done.stderr
    assert wheels(tree) == []


def test_an_error_in_a_source_is_shown(tree):
    (tree / "mbkf" / "kernel" / "broken.c").write_text("#error this source is broken\n")
    done = built(tree)
    assert done.returncode == 1
    assert "#error this source is broken" in done.stdout + done.stderr


def test_the_environment_can_ask_to_go_without(tree):
    (tree / "mbkf" / "kernel" / "_kernel.abi3.so").touch()  # of an earlier installation
    done = built(tree, CC="false", MBKF_KERNEL="reference")
    assert done.returncode == 0
    assert "without its compiled kernel" in done.stdout + done.stderr
    (wheel,) = wheels(tree)
    assert wheel.name.endswith("-py3-none-any.whl")
    assert kernels_in(wheel) == []


def test_a_compiler_makes_a_wheel_for_every_python_from_3_11_on(tree):
    assert built(tree, CC=quick_compiler(tree / "compiler")).returncode == 0
    (wheel,) = wheels(tree)
    assert "-cp311-abi3-" in wheel.name
    assert len(kernels_in(wheel)) == 1
