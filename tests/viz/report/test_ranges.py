"""Table of ranges: torques of the frames whose loads are known, angles of tracked ones."""

import re
from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.gait.convention import BY_CLINIC
from mbkf.viz.report.ranges import ranges
from mbkf.viz.report.reading import Reading
from tests.recordings import walk


@pytest.fixture
def ended_on_a_step():
    """A walk whose left ankle bears 6.58 N m/kg in its last frames: the foot lands where no plate reads it."""
    r = walk()
    moments, last = r.moments.copy(), np.arange(r.frames) >= r.frames - 4
    moments[last, r.coordinate_names.index("ankle_angle_l")] = -6.58 * r.subject.mass_kg
    return replace(r, moments=moments), last


def greatest(r):
    """Greatest extension moment of the left ankle in the table."""
    row = re.search(r"Ankle dorsiflexion, left.*?</tr>", ranges(r, Reading.of(r, BY_CLINIC)))[0]
    return re.findall(r"<td[^>]*>([^<]*)</td>", row)[-1].split(" ")[0]


def test_torques_of_frames_whose_loads_are_unknown_are_left_out(ended_on_a_step):
    r, last = ended_on_a_step
    every = np.ones(r.frames, dtype=bool)
    assert greatest(replace(r, valid=every)) == "6.58"
    known = -r.moment("ankle_angle_l")[~last].min() / r.subject.mass_kg
    assert greatest(replace(r, valid=~last)) == f"{known:.2f}"
    assert greatest(replace(r, valid=every, tracked=~last)) == f"{known:.2f}"
    assert greatest(replace(r, valid=~every)) == "–"
