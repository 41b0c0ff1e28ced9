"""Captures without names are labelled before they are reconstructed; those with names are left as they are."""

from dataclasses import replace

import pytest

from mbkf.errors import UnknownName
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.subject import read_subject
from mbkf.study.batch.naming import body_of_points, is_nameless, named, needs_names
from mbkf.viz.report.document import labels_of
from tests.studies import batch_here, study, walk_folder


@pytest.fixture(scope="module")
def captures():
    return {name: read_capture(walk_folder() / f"{name}.c3d") for name in ("trial", "raw")}


@pytest.fixture(scope="module")
def subject():
    return read_subject(walk_folder() / "subject.toml")


def test_names_are_needed_where_points_have_none(captures, subject):
    assert needs_names(captures["raw"], subject) and not needs_names(captures["trial"], subject)
    markers = captures["trial"].markers
    few = markers.select(markers.names[:10])
    assert not needs_names(replace(captures["trial"], markers=few), subject), (
        "no point without a name is left"
    )
    assert named(captures["trial"], subject).capture is captures["trial"]


def test_a_batch_names_them_and_tells_beside_the_result_whatever_the_trial_is_called(tmp_path):
    """The same walk with and without names: the same motion."""
    folder = study(tmp_path / "study", trials=1)
    write_c3d(read_capture(walk_folder() / "raw.c3d"), folder / "P1" / "summary.c3d")
    table = batch_here(folder, tmp_path / "out", static_only=True)
    assert table["status"].to_pylist() == ["done", "done"]
    raw, walk = (tmp_path / "out" / "P1" / name for name in ("summary", "walk1"))
    found, other = read_reconstruction(raw), read_reconstruction(walk)
    assert abs(found.angles - other.angles)[20:-20].max() < 0.05
    assert any("were labelled" in text for text in found.warnings)
    assert not any("were labelled" in text for text in other.warnings)
    assert read_summary(raw)["trial"] == "summary", "the result's own summary is whole"
    labels = labels_of(raw, "summary")
    assert labels is not None and labels["assigned_fraction"] > 0.9
    assert labels_of(walk, "walk1") is None


def test_a_trial_that_cannot_be_labelled_is_told_and_the_others_are_done(tmp_path):
    folder = study(tmp_path / "study", trials=1)
    raw = read_capture(walk_folder() / "raw.c3d")
    few = replace(raw, markers=raw.markers.select(raw.markers.names[:4]))
    write_c3d(few, folder / "P1" / "few.c3d")
    table = batch_here(folder, tmp_path / "out", static_only=True).to_pylist()
    assert {one["trial"]: one["status"] for one in table} == {"few": "failed", "walk1": "done"}


def test_a_person_without_any_name_is_found_from_the_points(tmp_path, subject):
    folder = tmp_path / "study" / "P1"
    folder.mkdir(parents=True)
    raw = read_capture(walk_folder() / "raw.c3d")
    assert is_nameless(raw)
    write_c3d(raw, folder / "raw.c3d")
    table = batch_here(folder.parent, tmp_path / "out", static_only=True)
    assert table["status"].to_pylist() == ["done"]
    found = read_reconstruction(tmp_path / "out" / "P1" / "raw")
    assert found.subject.mass_kg == pytest.approx(subject.mass_kg, rel=0.05), "weighed by the plates"
    assert found.subject.protocol != subject.protocol
    with pytest.raises(UnknownName, match="nosuch"):
        body_of_points(raw, subject.mass_kg, subject.height_m, "nosuch")
