"""Plates without corners get those of a file, by name or in order; forces in plate axes are turned into the world's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.plate_corners import plate_axes
from mbkf.stream.placed_plates import PlacedPlates, PlateGeometry
from mbkf.stream.source import SourceFrame
from tests.captures import made_capture
from tests.stream.scripted import ScriptedSource, frames_of

CAPTURE = made_capture(3)
STREAM, FRAMES = frames_of(CAPTURE)
GEOMETRY = PlateGeometry("lab.c3d", CAPTURE.plates)


def bare(plates, origins=False):
    """The stream with plates that have no corners."""
    nowhere = [
        replace(one, corners_m=None, origin_m=one.origin_m if origins else np.zeros(3)) for one in plates
    ]
    return replace(STREAM, plates=tuple(nowhere))


def placed(stream, geometry=GEOMETRY, **options):
    source = PlacedPlates(ScriptedSource(stream, FRAMES), geometry, **options)
    return source, source.connect(1.0)


def test_corners_come_by_name_and_moments_are_about_the_middle():
    source, found = placed(bare(STREAM.plates[::-1]))
    for one, other in zip(found.plates, CAPTURE.plates[::-1], strict=True):
        np.testing.assert_array_equal(one.corners_m, other.corners_m)
        np.testing.assert_allclose(one.origin_m, other.corners_m.mean(axis=0))
    ((kind, sentence),) = source.news()
    assert kind == "plates" and "'2', '1' are those of lab.c3d" in sentence
    assert source.read(0.0) is FRAMES[0]


def test_names_that_differ_stand_in_the_files_order():
    renamed = [replace(one, name=f"FP{k}") for k, one in enumerate(STREAM.plates)]
    _, found = placed(bare(renamed))
    assert [one.name for one in found.plates] == ["FP0", "FP1"]
    np.testing.assert_array_equal(found.plates[1].corners_m, CAPTURE.plates[1].corners_m)


def test_a_point_that_the_stream_states_stays():
    moved = [replace(one, origin_m=np.array([0.3, 0.2, 0.1])) for one in STREAM.plates]
    _, found = placed(bare(moved, origins=True))
    np.testing.assert_array_equal(found.plates[0].origin_m, [0.3, 0.2, 0.1])


def test_a_stream_with_corners_keeps_its_own():
    elsewhere = tuple(replace(one, corners_m=one.corners_m + 1.0) for one in CAPTURE.plates)
    source, found = placed(STREAM, PlateGeometry("lab.c3d", elsewhere))
    assert found is STREAM and source.news() == []


def test_forces_in_plate_axes_are_turned():
    source, _ = placed(bare(STREAM.plates), in_plate_axes=True)
    world = FRAMES[0].plates.wrench
    turns = [plate_axes(one.corners_m) for one in CAPTURE.plates]
    local = np.array(world)
    for k, turn in enumerate(turns):
        local[:, k, :3], local[:, k, 3:] = world[:, k, :3] @ turn, world[:, k, 3:] @ turn
    source._source.script = [
        SourceFrame(
            0, 0.0, FRAMES[0].markers_m, FRAMES[0].unlabelled_m, replace(FRAMES[0].plates, wrench=local)
        )
    ]
    found = source.read(0.0)
    np.testing.assert_allclose(found.plates.wrench, world, atol=1e-9)
    assert np.abs(local - world).max() > 100.0, "z points down in a plate"


def test_other_plates_are_refused_by_their_names():
    renamed = [replace(one, name="FP") for one in STREAM.plates[:1]]
    with pytest.raises(InvalidInput, match=r"1 plates without corners \('FP'\), lab.c3d has 2 \('1', '2'\)"):
        placed(bare(renamed))


@pytest.mark.parametrize("plates", [(), bare(STREAM.plates).plates])
def test_a_file_without_corners_is_refused(plates):
    with pytest.raises(InvalidInput, match=r"lab\.c3d: not every force plate"):
        PlateGeometry("lab.c3d", plates)


def test_silence_and_the_end_pass(tmp_path):
    source, _ = placed(bare(STREAM.plates), in_plate_axes=True)
    source._source.script = [None]
    assert source.read(0.0) is None
    with pytest.raises(EOFError):
        source.read(0.0)
    source.close()
    assert source._source.closed
