"""The rows of URDF files pass for exported files, and see a wrong mass and a moved joint."""

from dataclasses import replace

import numpy as np
import pytest

import mbkf
from benchmarks.packages import urdf_readers
from benchmarks.packages.urdf_readers import urdf_rows
from mbkf.synthesis.person import synthesise_subject

PERSON = synthesise_subject(2)


def failed(folder):
    return [row.name for row in urdf_rows(PERSON, folder, np.random.default_rng(0)) if not row.passed]


def test_the_export_passes(tmp_path):
    assert failed(tmp_path) == []


def test_a_reader_that_lacks_is_left_out(monkeypatch, tmp_path):
    monkeypatch.setattr(urdf_readers, "installed", lambda module: False)
    rows = urdf_rows(PERSON, tmp_path, np.random.default_rng(0))
    assert [row.name for row in rows if row.note] == [
        f"URDF in {name}: total mass off" for name in ("MuJoCo", "PyBullet")
    ]


@pytest.mark.parametrize(
    ("change", "seen"),
    [
        ({"mass_kg": 1.0000001}, "inertial parameters"),
        ({"origin_m": 1.0000001}, "frames in 10 postures"),
    ],
)
def test_a_difference_is_seen(monkeypatch, tmp_path, change, seen):
    def load(path, read=mbkf.load_body):
        body = read(path)
        ((key, factor),) = change.items()
        head = replace(body.segments[3], **{key: factor * getattr(body.segments[3], key)})
        return replace(body, segments=(*body.segments[:3], head, *body.segments[4:]))

    monkeypatch.setattr(mbkf, "load_body", load, raising=False)
    (name,) = failed(tmp_path)
    assert seen in name


def test_a_wrong_mass_is_seen_in_every_reader(monkeypatch, tmp_path):
    monkeypatch.setattr("mbkf.model.urdf.LINK_MASS_KG", 1e-4)
    found = failed(tmp_path)
    assert {"URDF in Pinocchio: total mass off", "URDF in MuJoCo: total mass off"} <= set(found)
