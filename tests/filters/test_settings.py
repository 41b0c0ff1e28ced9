"""Settings by the names of their leaves: every name occurs once, and changing one changes nothing else."""

from dataclasses import fields, is_dataclass

import pytest

from mbkf.errors import UnknownName
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.settings import changed, flat


def leaves(settings):
    for one in fields(settings):
        value = getattr(settings, one.name)
        if is_dataclass(value):
            yield from leaves(value)
        else:
            yield one.name, value


@pytest.mark.parametrize("settings", [DynamicSettings(), KinematicSettings()], ids=["dynamic", "kinematic"])
def test_every_leaf_has_a_name_of_its_own(settings):
    found = list(leaves(settings))
    assert len(found) == len(dict(found))
    assert flat(settings) == dict(found)


def test_leaves_change_wherever_they_stand_and_nothing_else():
    before = DynamicSettings()
    after = changed(before, plate_force_n=7.0, posture_scale=2.0, decay_s=0.1)
    assert (after.contact.plate_force_n, after.posture.posture_scale, after.motion.decay_s) == (7.0, 2.0, 0.1)
    assert {name for name, value in flat(after).items() if flat(before)[name] != value} == {
        "plate_force_n",
        "posture_scale",
        "decay_s",
    }
    assert changed(before) == before == DynamicSettings()


def test_an_unknown_leaf_is_refused_with_the_nearest():
    with pytest.raises(UnknownName, match="plate_force_n"):
        changed(DynamicSettings(), plate_force=1.0)
    with pytest.raises(UnknownName):
        changed(DynamicSettings(), contact=1.0)
