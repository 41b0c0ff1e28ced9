"""Every setting of the thesis is reached; an unreachable one and an accepted wrong one would be seen."""

import pytest

from benchmarks.settings import inventory
from benchmarks.settings.inventory import ASKED, REFUSED, Asked, reached, refused


def test_every_setting_is_reached_by_preset_and_command(tmp_path):
    missed = [one.name for one, reach in zip(ASKED, reached(tmp_path), strict=True) if not all(reach)]
    assert missed == []


@pytest.mark.parametrize(
    "asked",
    [
        Asked("viscosity", (1.0,), "nowhere"),
        Asked("integrator", ("FE", "leapfrog"), "nowhere"),
        Asked("per_frame", (True,), "without its noise"),
    ],
)
def test_a_setting_that_is_not_there_is_seen(asked, monkeypatch, tmp_path):
    monkeypatch.setattr(inventory, "ASKED", (asked,))
    assert reached(tmp_path) == [(False, False)]


def test_wrong_settings_are_refused_and_right_ones_seen(monkeypatch, tmp_path):
    assert refused(tmp_path) == [True] * len(REFUSED)
    monkeypatch.setattr(inventory, "REFUSED", ("integrator = 'FE'",))
    assert refused(tmp_path) == [False]
