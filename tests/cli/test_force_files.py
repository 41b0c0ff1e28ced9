"""Files of ground reactions go to the captures that lack plates."""

import pytest

from mbkf.cli.force_files import forces_of, forces_of_person
from mbkf.errors import InvalidInput


def test_forces_go_to_the_trials_that_lack_plates():
    assert forces_of(["a.trc", "b.C3D", "c.trc"], ["1", "2"]) == ["1", None, "2"]
    assert forces_of(["a.trc", "b.c3d"], []) == [None, None]
    with pytest.raises(InvalidInput, match="1 of the trials"):
        forces_of(["a.trc", "b.c3d"], ["1", "2"])


def test_a_static_trial_may_have_none():
    assert forces_of_person("s.trc", ["a.trc"], ["1", "2"]) == ("1", ["2"])
    assert forces_of_person("s.trc", ["a.trc"], ["1"]) == (None, ["1"])
    assert forces_of_person("s.trc", [], ["1"]) == ("1", [])
    assert forces_of_person(None, ["a.trc", "b.c3d"], ["1"]) == (None, ["1", None])
    assert forces_of_person("s.c3d", [], []) == (None, [])
    for static, trials in (("s.c3d", []), ("s.trc", ["a.c3d"]), (None, ["a.trc", "b.trc"])):
        with pytest.raises(InvalidInput, match="--forces names 3 files"):
            forces_of_person(static, trials, ["1", "2", "3"])
