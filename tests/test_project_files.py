"""Files that other programs read about the project: workflows, forms, the conda recipe; each against what it names."""

import os
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from mbkf.version import __version__

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
OTHERS = (*(ROOT / ".github").rglob("*.yml"), ROOT / ".pre-commit-config.yaml", ROOT / "CITATION.cff")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def read(path):
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def test_every_file_is_yaml_with_entries():
    assert WORKFLOWS
    for path in OTHERS:
        assert isinstance(read(path), dict), path


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_read_only_end_in_time_and_call_what_exists(path):
    flow = read(path)
    assert flow["permissions"] == {"contents": "read"}
    for name, job in flow["jobs"].items():
        assert job["timeout-minutes"] <= 60, name
        for step in job["steps"]:
            assert re.fullmatch(r"[\w./-]+@(v\d+|[0-9a-f]{40})", step.get("uses", "a@v1"))
            for script in re.findall(r"\.ci/\w+", step.get("run", "")):
                assert os.access(ROOT / script, os.X_OK), script
            for extra in re.findall(r'"\.\[(\w+)\]"', step.get("run", "")):
                assert extra in PROJECT["optional-dependencies"]


def test_tests_run_on_the_pythons_and_systems_that_the_package_names():
    matrix = read(ROOT / ".github" / "workflows" / "tests.yml")["jobs"]["tests"]["strategy"]["matrix"]
    named = {label.rpartition(" ")[2] for label in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", label)}
    assert set(matrix["python"]) == named
    assert {system.partition("-")[0] for system in matrix["system"]} == {"ubuntu", "macos"}


def test_the_conda_recipe_asks_for_what_the_package_asks_for():
    """But for Pinocchio, of which conda-forge has no later version for Windows."""
    recipe = read(ROOT / ".ci" / "conda" / "recipe.yaml")
    assert recipe["context"]["version"] == __version__
    asked = {need.replace(" ", "") for need in recipe["requirements"]["run"]}
    named = {
        need.replace("pin>=4", "pinocchio>=3.4").replace("meshcat>", "meshcat-python>")
        for need in PROJECT["dependencies"]
    }
    assert asked == named | {f"python{PROJECT['requires-python']}"}


def test_the_citation_names_the_version():
    assert read(ROOT / "CITATION.cff")["version"] == __version__


def test_every_version_has_its_page_of_changes():
    assert (ROOT / "docs" / "changes" / f"{__version__}.md").is_file()
