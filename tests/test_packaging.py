"""The wheel, installed away from the source tree, runs and finds its data."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from mbkf.conventions import data_folder
from mbkf.kernel.loading import kernel_name
from mbkf.version import __version__
from tests.quick_compiler import quick_compiler

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[1]
KINDS = ("models", "markers")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Built from a copy of the tree, whose own kernel stays as it is, with the libraries of this environment."""
    folder = tmp_path_factory.mktemp("wheel")
    tree = folder / "tree"
    built = shutil.ignore_patterns("*.so", "__pycache__")
    for name in ("mbkf", "models", "markers", ".ci"):
        shutil.copytree(ROOT / name, tree / name, ignore=built)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tree / name)
    words = ("wheel", str(tree), "--no-deps", "--no-build-isolation", "-w", str(folder))
    pip(*words, CC=quick_compiler(folder / "compiler"))
    (built,) = folder.glob("mbkf-*.whl")
    return built


@pytest.fixture(scope="module")
def site(wheel, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("installed") / "site"
    pip("install", "--no-deps", "--target", str(folder), str(wheel))
    return folder


def pip(*words: str, **environment: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pip", "--disable-pip-version-check", *words],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def run_installed(site: Path, cwd: Path, *words: str) -> str:
    """Run Python on the installed wheel and this environment's libraries, without the source tree."""
    libraries = [path for path in sys.path if path and Path(path).resolve() != ROOT]
    done = subprocess.run(
        [sys.executable, "-S", *words],  # -S: no .pth file, so an editable install is not seen
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        cwd=cwd,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(site), *libraries])},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_wheel_holds_the_package_its_data_and_nothing_else(wheel):
    tops = {name.split("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert tops == {"mbkf", f"mbkf-{__version__}.dist-info"}


@pytest.mark.parametrize("kind", KINDS)
def test_data_are_found_in_the_tree(kind):
    assert data_folder(kind) == ROOT / kind


@pytest.mark.parametrize("kind", KINDS)
def test_data_are_found_in_the_installed_wheel(kind, site, tmp_path):
    code = f"from mbkf.conventions import data_folder; print(data_folder({kind!r}))"
    installed = Path(run_installed(site, tmp_path, "-c", code))
    assert installed == site / "mbkf" / kind
    files = {path.name for path in (ROOT / kind).iterdir() if path.is_file()}
    assert files
    assert {path.name for path in installed.iterdir() if path.is_file()} == files


def test_source_tree_is_not_on_the_path_of_the_installed_package(site, tmp_path):
    code = "import sys, mbkf; print(mbkf.__file__, *sys.path, sep='\\n')"
    imported, *path = run_installed(site, tmp_path, "-c", code).splitlines()
    assert Path(imported).is_relative_to(site)
    assert str(ROOT) not in path


def test_public_names_of_the_installed_package_can_be_imported(site, tmp_path):
    run_installed(site, tmp_path, "-c", "from mbkf import *")


def test_installed_command_gives_its_version_and_help(site, tmp_path):
    assert run_installed(site, tmp_path, "-m", "mbkf", "--version") == f"mbkf {__version__}, {kernel_name()}"
    assert "reconstruct" in run_installed(site, tmp_path, "-m", "mbkf", "--help")
