"""Forces of QTM, in the plate's axes or the laboratory's, become the plate's force on the body about its centre."""

import numpy as np
import pytest

from benchmarks.streams.qualisys_server import on_plate
from mbkf.io.axes import rotation_to_world
from mbkf.stream.qualisys.packets import PlateForces
from mbkf.stream.qualisys.parameters import QtmDescription
from mbkf.stream.qualisys.plates import LABORATORY, LABORATORY_ORIGIN, LOCAL, PlateForceReader
from mbkf.stream.source import StreamDescription, empty_plate

CORNERS = np.array([[0.8, 0.1, 0.0], [0.2, 0.1, 0.0], [0.2, 0.5, 0.0], [0.8, 0.5, 0.0]])
"""In the order of C3D of a plate whose x points forward and whose z points down."""

CENTRE = CORNERS.mean(axis=0)
POINT = CENTRE + np.array([0.11, -0.07, 0.0])
FORCE = np.array([30.0, -20.0, 700.0])
WRENCH = np.hstack([FORCE, np.cross(POINT - CENTRE, FORCE) + np.array([0, 0, 4.0])])


def reader(rotation=None):
    plates = tuple(
        empty_plate(name, 1000.0, 0.0, CENTRE + shift, 10.0, CORNERS + shift)
        for name, shift in (("1", np.zeros(3)), ("2", np.array([1.0, 0, 0])))
    )
    stream = StreamDescription("x", ("A",), 100.0, 0.0, plates)
    return PlateForceReader(QtmDescription(stream, (1, 2), np.eye(3) if rotation is None else rotation))


def laboratory(about):
    """Force on the plate, moment about a point and point of application, laboratory axes."""
    moment = -(WRENCH[3:] + np.cross(CENTRE - about, FORCE))
    return np.hstack([-FORCE, moment, 1e3 * POINT])[None]


@pytest.mark.parametrize(
    ("rows", "axes"),
    [
        (on_plate(WRENCH[None], CENTRE, CORNERS), LOCAL),
        (laboratory(CENTRE), LABORATORY),
        (laboratory(np.zeros(3)), LABORATORY_ORIGIN),
    ],
)
def test_the_first_load_decides_the_axes(rows, axes):
    made = reader()
    light = PlateForces(1, 69, (0.01 * rows).astype("<f4"))
    made.samples([light])
    assert made.axes is None
    found = made.samples([PlateForces(1, 70, rows.astype("<f4"))])
    assert (made.axes, found.index.tolist()) == (axes, [70])
    np.testing.assert_allclose(found.wrench[0, 0], WRENCH, atol=1e-3)
    assert np.isnan(found.wrench[0, 1]).all()


def test_laboratory_axes_are_turned_into_the_worlds():
    """y up: file (x, y, z) is world (x, −z, y)."""
    rotation = rotation_to_world("y")
    made = reader(rotation)
    rows = np.hstack([part @ rotation for part in np.split(laboratory(CENTRE)[0], 3)])[None]
    found = made.samples([PlateForces(1, 0, rows.astype("<f4"))])
    np.testing.assert_allclose(found.wrench[0, 0], WRENCH, atol=1e-3)


def test_samples_of_two_plates_are_joined_by_their_numbers():
    rows = np.repeat(on_plate(WRENCH[None], CENTRE, CORNERS), 3, axis=0).astype("<f4")
    found = reader().samples([PlateForces(1, 10, rows), PlateForces(2, 11, rows), PlateForces(9, 0, rows)])
    assert found.index.tolist() == [10, 11, 12, 13]
    assert np.isnan(found.wrench[:, :, 2]).tolist() == [
        [False, True],
        [False, False],
        [False, False],
        [True, False],
    ]


def test_counts_that_are_far_apart_are_not_joined():
    rows = on_plate(WRENCH[None], CENTRE, CORNERS).astype("<f4")
    found = reader().samples([PlateForces(1, 10, rows), PlateForces(2, 2**31, rows)])
    assert found.index.tolist() == [10]
    assert len(reader().samples([]).index) == 0
