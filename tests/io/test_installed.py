"""Readers and motions of other installed packages: found by every command, and left out where they are broken."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mbkf
from mbkf.errors import MbkfWarning
from mbkf.io import installed
from mbkf.study.batch.folder import plan_of_folder
from tests.io.c3d_builder import standing_points

ROOT = Path(__file__).resolve().parents[2]
READER = """
import numpy as np
import mbkf

@mbkf.register_reader(".xyz", title="rows of x y z in mm")
def read_xyz(path, options):
    with path.open(encoding="utf-8") as file:
        names = tuple(file.readline().split())
        rows = np.loadtxt(file)
    markers = mbkf.MarkerTrajectories(names, 1e-3 * rows.reshape(-1, len(names), 3), 100.0)
    return mbkf.Capture(str(path), markers)
"""
BACKEND = """
import zipfile

def build_wheel(folder, config_settings=None, metadata_directory=None):
    info = "my_xyz-1.dist-info/"
    files = {
        "my_xyz.py": open("my_xyz.py").read(),
        info + "METADATA": "Metadata-Version: 2.1\\nName: my-xyz\\nVersion: 1\\n",
        info + "WHEEL": "Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n",
        info + "entry_points.txt": "[mbkf.readers]\\nxyz = my_xyz\\n",
    }
    files[info + "RECORD"] = "".join(name + ",,\\n" for name in [*files, info + "RECORD"])
    with zipfile.ZipFile(folder + "/my_xyz-1-py3-none-any.whl", "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return "my_xyz-1-py3-none-any.whl"
"""
# A build backend without requirements, so that pip needs neither a network nor setuptools.

MOTION = """
from mbkf.synthesis.motions import register_motion, registered_motion
register_motion("slow_squat", seconds=2.0)(registered_motion("squat").planner)
"""


def install(folder: Path, name: str, source: str, group: str = installed.READERS) -> Path:
    """A package with one module and one entry point, laid out as pip lays it out."""
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.py").write_text(source)
    info = folder / f"{name}-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
    (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {name}\n")
    return folder


def mbkf_command(folder: Path, *words: str, cwd: Path | None = None) -> subprocess.CompletedProcess:
    searched = os.pathsep.join((str(ROOT), str(folder), os.environ.get("PYTHONPATH", "")))
    return subprocess.run(
        [sys.executable, "-m", "mbkf", *map(str, words)],
        env=os.environ | {"PYTHONPATH": searched},
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return install(tmp_path_factory.mktemp("site") / "packages", "xyz_reader", READER)


def write_xyz(path: Path, names, positions_m) -> Path:
    rows = "\n".join(" ".join(f"{1e3 * x:.4f}" for x in point) for point in positions_m.reshape(-1, 3))
    path.write_text(" ".join(names) + "\n" + rows + "\n")
    return path


def test_every_command_reads_the_files_of_an_installed_reader(site, tmp_path):
    person, recorded = mbkf.synthesise("squat", seconds=1.0, seed=4)
    markers = recorded.trial.markers
    trial = write_xyz(tmp_path / "a.xyz", markers.names, markers.positions_m)
    mbkf.write_subject(person, tmp_path / "subject.toml")
    shown = mbkf_command(site, "info", trial)
    assert shown.returncode == 0, shown.stderr
    assert f"{len(markers.names)} " in shown.stdout and shown.stderr == ""
    words = ("--subject", tmp_path / "subject.toml", "--filter", "kinematic", "--out", tmp_path / "result")
    done = mbkf_command(site, "reconstruct", trial, *words)
    assert done.returncode == 0, done.stderr
    result = mbkf.read_reconstruction(tmp_path / "result")
    assert result.frames == markers.frames and result.tracked.all()
    unknown = mbkf_command(site, "info", tmp_path / "a.xlsx")
    assert unknown.returncode == 2 and ".tsv or .xyz file" in unknown.stderr


def test_folders_of_a_study_are_searched_for_them(site, tmp_path):
    folder = tmp_path / "P01"
    folder.mkdir()
    write_xyz(folder / "walk.xyz", tuple("abcdefgh"), standing_points(20) / 1e3)
    code = "import sys; from mbkf.study.batch.folder import captures_in; from pathlib import Path; "
    code += "print([path.name for path in captures_in(Path(sys.argv[1]))])"
    searched = os.pathsep.join((str(ROOT), str(site)))
    found = subprocess.run(
        [sys.executable, "-c", code, folder],
        env=os.environ | {"PYTHONPATH": searched},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.strip() == "['walk.xyz']"
    with pytest.raises(mbkf.MbkfError):  # without the package there is no capture in it
        plan_of_folder(tmp_path)


def test_a_broken_reader_is_named_and_left_out(site, tmp_path):
    broken = install(tmp_path / "site", "broken_reader", "raise RuntimeError('no licence')\n")
    trial = write_xyz(tmp_path / "a.xyz", tuple("abcdefgh"), standing_points(20) / 1e3)
    shown = mbkf_command(Path(os.pathsep.join((str(site), str(broken)))), "info", trial)
    assert shown.returncode == 0
    (warning,) = shown.stderr.splitlines()
    assert warning.startswith("mbkf: warning: 'broken_reader' (mbkf.readers) of the package 'broken_reader'")
    assert "RuntimeError: no licence" in warning and "uninstall" in warning


def test_a_taken_suffix_is_named_as_such(tmp_path, monkeypatch):
    source = "import mbkf\nmbkf.register_reader('.trc', title='mine')(print)\n"
    monkeypatch.syspath_prepend(install(tmp_path / "site", "taken_reader", source))
    monkeypatch.setattr(installed, "_imported", set())
    with pytest.warns(MbkfWarning, match=r"taken_reader.*'\.trc' files are read as TRC already"):
        installed.import_installed(installed.READERS)


def test_a_module_is_imported_once_and_may_read_files_meanwhile(tmp_path, monkeypatch):
    source = "import mbkf\nfrom mbkf.io.capture import CAPTURES\nassert '.c3d' in CAPTURES.suffixes\n"
    monkeypatch.syspath_prepend(install(tmp_path / "site", "reading_reader", source))
    monkeypatch.setattr(installed, "_imported", set())
    installed.import_installed(installed.READERS)
    module = sys.modules.pop("reading_reader")
    installed.import_installed(installed.READERS)
    assert module is not None and "reading_reader" not in sys.modules


def test_the_help_imports_no_other_package(tmp_path):
    loud = install(tmp_path / "site", "loud_reader", "print('imported')\n")
    install(loud, "loud_motion", "print('imported')\n", installed.MOTIONS)
    shown = mbkf_command(loud, "--help")
    assert shown.returncode == 0 and "imported" not in shown.stdout
    assert "imported" in mbkf_command(loud, "info", tmp_path / "a.c3d").stdout


def test_motions_of_an_installed_package_are_known(tmp_path):
    site = install(tmp_path / "site", "slow_motion", MOTION, installed.MOTIONS)
    made = mbkf_command(site, "synth", "--motion", "slow_squat", "--seconds", "1", "--out", tmp_path / "made")
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "made" / "trial.c3d").is_file()
    unknown = mbkf_command(site, "synth", "--motion", "sl0w_squat", "--out", tmp_path / "made")
    assert unknown.returncode == 2 and "did you mean slow_squat" in unknown.stderr


@pytest.mark.parametrize("place", ["archive", "egg"])
def test_packages_in_archives_and_eggs_are_found(tmp_path, monkeypatch, place):
    name = f"{place}_reader"
    site = install(tmp_path / "site", name, "")
    if place == "archive":
        site = Path(shutil.make_archive(str(tmp_path / "packages"), "zip", site))
    else:
        site = site.rename(tmp_path / "packages.egg")
        info = (site / f"{name}-1.dist-info").rename(site / "EGG-INFO")
        (info / "METADATA").rename(info / "PKG-INFO")
    monkeypatch.syspath_prepend(site)
    monkeypatch.setattr(installed, "_imported", set())
    installed.import_installed(installed.READERS)
    assert sys.modules.pop(name).__name__ == name


@pytest.mark.slow
def test_pip_installs_such_a_package(tmp_path):
    source, place = tmp_path / "source", tmp_path / "place"
    source.mkdir()
    (source / "my_xyz.py").write_text(READER)
    (source / "backend.py").write_text(BACKEND)
    (source / "pyproject.toml").write_text(
        '[build-system]\nrequires = []\nbuild-backend = "backend"\nbackend-path = ["."]\n'
    )
    options = ("-q", "--no-deps", "--no-build-isolation", "--target", place)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", *options, source]
    subprocess.run(pip, check=True, capture_output=True)
    trial = write_xyz(tmp_path / "a.xyz", tuple("abcdefgh"), standing_points(20) / 1e3)
    shown = mbkf_command(place, "info", trial)
    assert shown.returncode == 0, shown.stderr


def test_the_reader_of_the_documentation_is_short():
    lines = (ROOT / "docs" / "examples" / "14_own_reader.py").read_text(encoding="utf-8").splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("@mbkf.register_reader"))
    end = next(k for k in range(begin, len(lines)) if lines[k].startswith("    return"))
    assert end - begin + 1 <= 15
