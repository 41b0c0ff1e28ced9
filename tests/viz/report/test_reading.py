"""Curves of a reading: angles of the convention, and the part of their error that varies within the trial."""

from dataclasses import replace

import numpy as np

from mbkf.trial.gait.convention import BY_CLINIC, BY_MODEL
from mbkf.trial.gait.convention_angles import convention_angles
from mbkf.viz.report.cells import leg_angle_cells, torque_cells
from mbkf.viz.report.reading import Reading, curve_of
from tests.recordings import walk


def test_clinical_charts_stand_in_the_order_of_laboratories():
    r, read = walk(), Reading.of(walk(), BY_CLINIC)
    rows = leg_angle_cells(r, (), read)
    assert [[cell.name for cell in row] for row in rows] == [list(row) for row in BY_CLINIC.rows]
    tilt, progression = rows[0][0], rows[3][2]
    assert (tilt.title, tilt.caption) == ("Anterior pelvic tilt", "clinical, Plug-in Gait axes")
    own = np.rad2deg(convention_angles(r, BY_CLINIC).of("pelvis_tilt")[0])
    for side in "rl":
        np.testing.assert_allclose(tilt.curves[side].values, own)
    assert set(progression.curves) == {"r", "l"}


def test_clinical_torques_are_positive_in_extension():
    r = walk()
    ((knee, *_),) = torque_cells(r, ("knee",), Reading.of(r, BY_CLINIC))
    np.testing.assert_allclose(knee.curves["l"].values, -r.moment("knee_angle_l") / r.subject.mass_kg)
    assert (knee.title, knee.positive, knee.caption) == (
        "Knee extensor moment",
        "",
        "clinical, the body's own axes",
    )


def test_the_varying_part_needs_a_known_offset():
    r = walk()
    values = np.ones(r.frames)
    spreads = (2 * values, values, 0.5 * values)
    assert curve_of(r, values, spreads).inner_sd is None
    known = curve_of(replace(r, angles_sd_offset=np.full(r.angles.shape, 0.01)), values, spreads)
    np.testing.assert_allclose(known.inner_sd, np.sqrt(2**2 - 1**2 + 0.5**2))
    assert Reading.of(r, BY_MODEL).caption == "mbkf, the body's own axes"
