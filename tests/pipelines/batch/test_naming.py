"""Captures without names are labelled before they are reconstructed; those with names are left as they are."""

from dataclasses import replace

import pytest

from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.subject import read_subject
from mbkf.pipelines.batch.naming import named, needs_names
from mbkf.pipelines.batch.run import batch
from mbkf.viz.report.document import labels_of
from tests.studies import study, walk_folder


@pytest.fixture(scope="module")
def captures():
    return {name: read_capture(walk_folder() / f"{name}.c3d") for name in ("trial", "raw")}


SUBJECT = read_subject(walk_folder() / "subject.toml")


def test_names_are_needed_where_points_have_none(captures):
    assert needs_names(captures["raw"], SUBJECT) and not needs_names(captures["trial"], SUBJECT)
    markers = captures["trial"].markers
    few = markers.select(markers.names[:10])
    assert not needs_names(replace(captures["trial"], markers=few), SUBJECT), (
        "no point without a name is left"
    )
    assert named(captures["trial"], SUBJECT).capture is captures["trial"]


def test_a_batch_names_them_and_tells(tmp_path):
    """The same walk with and without names: the same motion."""
    folder = study(tmp_path / "study", trials=1)
    write_c3d(read_capture(walk_folder() / "raw.c3d"), folder / "P1" / "raw.c3d")
    table = batch(folder, tmp_path / "out", workers=1)
    assert table["status"].to_pylist() == ["done", "done"]
    raw, walk = (tmp_path / "out" / "P1" / name for name in ("raw", "walk1"))
    found, other = read_reconstruction(raw), read_reconstruction(walk)
    assert abs(found.angles - other.angles)[20:-20].max() < 0.05
    assert any("were labelled" in text for text in found.warnings)
    assert not any("were labelled" in text for text in other.warnings)
    labels = labels_of(raw, read_summary(raw)["trial"])
    assert labels is not None and labels["assigned_fraction"] > 0.9
    assert labels_of(walk, "walk1") is None
