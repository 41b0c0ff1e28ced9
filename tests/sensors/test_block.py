"""The protocol of blocks as a user meets it: bound to layout and body, and written in a few lines."""

from types import SimpleNamespace

import numpy as np

import mbkf
from mbkf.filters.filter import Filter
from tests.blocks import goniometer
from tests.motions import reference_model
from tests.straight import StraightPlant


class Bound(mbkf.Block):
    """Keeps what it is bound to."""

    def bind(self, layout, body):
        self.bound = layout, body

    def decide(self, at, frame, memory, notes):
        return None

    def linearise(self, at, decision):
        return None


def test_a_filter_binds_its_blocks_to_its_layout_and_the_plant_s_body():
    plant, block = StraightPlant(2), Bound()
    plant.model = object()
    Filter(plant, [block])
    assert block.bound[0] is plant.layout
    assert block.bound[1] is plant.model


def test_a_goniometer_takes_fifteen_lines_and_one_import_of_mbkf():
    lines = [line.strip() for line in goniometer.block_source().splitlines() if line.strip()]
    assert len(lines) <= 15
    assert [line for line in lines if "import" in line and "mbkf" in line] == ["import mbkf"]


def test_the_goniometer_is_whitened_and_silent_without_a_reading():
    block, model = goniometer.Goniometer(sd_rad=0.05), reference_model()
    block.bind(None, model)
    q = model.integrate(model.neutral(), 0.2 * np.sin(np.arange(model.nv)))
    at, angle = SimpleNamespace(state=SimpleNamespace(q=q)), mbkf.ClinicalAngles(model)
    said = block.linearise(at, angle.value("knee_angle_r", q) + np.array([0.1]))
    np.testing.assert_allclose(said.innovation, [2.0], rtol=1e-12)
    np.testing.assert_allclose(said.jacobian, [angle.jacobian("knee_angle_r", q) / 0.05], rtol=1e-12)
    assert block.linearise(at, np.array([np.nan])) is None
