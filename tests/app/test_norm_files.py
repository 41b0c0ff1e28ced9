"""Norms from a file over the page: facts that are known, those that are asked for, and the norms that reports offer."""

from collections import defaultdict

import numpy as np
import pytest

from mbkf.app import reports
from mbkf.app.failures import Refused
from mbkf.app.norm_files import import_norms
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.norms import read_norms
from tests.io.norm_files.made import KNEE, KNEE_SD, PERCENT

FACTS = {
    "name": "Adults", "source": "Rossi 2019", "convention": "clinical", "persons": "30", "ages": "20-40",
    "speeds": "1,1–1,4",
}  # fmt: skip


def table(head=""):
    rows = zip(PERCENT, -KNEE, KNEE_SD, strict=True)
    lines = [
        "percent,knee extension (deg) mean,knee extension (deg) sd",
        *(",".join(map(str, one)) for one in rows),
    ]
    return (head + "\n".join(lines)).encode()


def sent(workspace, content, do="write", file="C:\\norms\\adults.csv", **facts):
    return import_norms(workspace, defaultdict(str, {**facts, "file": file, "do": do}), content)


@pytest.fixture
def workspace(tmp_path):
    return Workspace(tmp_path / "lab")


def test_the_facts_of_the_file_are_shown_and_the_missing_ones_named(workspace):
    found = sent(workspace, table("# source: Rossi\n# age: 20-40\n"))
    assert found["missing"] == ["convention", "persons", "speeds"] and found["groups"] == []
    assert (found["facts"]["source"], found["facts"]["ages"], found["facts"]["persons"]) == (
        "Rossi",
        "20-40",
        "",
    )
    assert sent(workspace, table(), "look", **FACTS)["missing"] == []
    assert list(workspace.root.iterdir()) == [], "nothing is written before it is asked for"


def test_norms_with_all_facts_are_written_once_and_offered_with_reports(workspace):
    found = sent(workspace, table(), **FACTS)
    assert (found["norms"], found["curves"], found["left_out"]) == ("norms-Adults.toml", 1, [])
    assert found["turned"] == ["knee extension"]
    norms = read_norms(workspace.root / "norms-Adults.toml")
    assert (norms.source, norms.ages, norms.speeds) == ("Rossi 2019", (20.0, 40.0), (1.1, 1.4))
    band = norms.curves["walk", "angle", "knee_angle"]
    np.testing.assert_allclose(band.mean[::2], KNEE, atol=1e-4)
    assert reports.choices(workspace, ".")["norms"] == ["norms-Adults.toml"]
    with pytest.raises(Refused, match="there already"):
        sent(workspace, table(), **FACTS)
    assert sent(workspace, table(), **{**FACTS, "name": "session"})["norms"] == "norms-session.toml"


def test_a_file_with_groups_asks_for_one(workspace):
    rows = [
        f"{name},knee flexion,deg,{p},{m},{s}"
        for name in ("slow", "free")
        for p, m, s in zip(PERCENT, KNEE, KNEE_SD, strict=True)
    ]
    groups = "\n".join(["group,curve,unit,percent,mean,sd", *rows]).encode()
    found = sent(workspace, groups, **FACTS)
    assert (found["groups"], found["missing"]) == (["slow", "free"], ["group"])
    assert sent(workspace, groups, **FACTS, group="free")["curves"] == 1


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"file": "norms.docx"}, "ends in .csv"),
        ({"persons": "many"}, "not a number of persons"),
        ({"persons": "0"}, "not a number of persons"),
        ({"ages": "old"}, "'old' is no range"),
        ({"group": "fast"}, "no group 'fast'"),
    ],
)
def test_facts_that_are_not_possible_are_refused(workspace, change, reason):
    with pytest.raises(InvalidInput, match=reason):
        sent(workspace, table(), **{**FACTS, **change})
