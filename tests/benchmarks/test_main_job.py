"""The main job's small helpers, and that a capture that does not run is a failed check, not a crash."""

import math

import numpy as np
import pytest

from benchmarks import main_job
from benchmarks.checks import Check, Context
from benchmarks.commands import mbkf, scale_and_reconstruct
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.storage import Table
from tests.captures import write_person

TIMES = np.arange(200) / 100.0
SINE = np.sin(2 * np.pi * TIMES)


def table(values) -> Table:
    return Table(("knee_angle_r", "knee_angle_l"), TIMES, np.column_stack([values, values]), True)


def test_angle_checks_forgive_another_zero_and_a_known_sign():
    agree, difference = main_job.angle_checks(
        table(20 * SINE), table(7 - 20 * SINE), {"knee_angle": -1.0}, 0.97
    )
    assert (agree.name, difference.name, difference.unit) == ("knee, r", "knee, RMS difference", "°")
    assert agree.value == pytest.approx(1.0)
    assert difference.value == pytest.approx(0.0, abs=1e-9)
    wrong = main_job.angle_checks(table(20 * SINE), table(-20 * SINE), {"knee_angle": 1.0}, 0.97)
    assert [check.passed for check in wrong] == [False, False]


def test_an_unknown_number_passes_no_bound():
    assert math.isnan(main_job.number(None))
    assert not Check("c", main_job.number(None), 1.0, "<=").passed


def test_information_has_no_bound_and_fails_nothing():
    check = Check("c", 5.0, main_job.INFORMATION, "<=")
    assert check.passed
    assert not check.bounded


def test_a_capture_that_does_not_run_fails_its_row_only(monkeypatch, tmp_path):
    def broken(data, out):
        raise InvalidInput("no such luck")

    monkeypatch.setattr(main_job, "rajagopal_walk", broken)
    monkeypatch.setattr(main_job, "synthetic", lambda data, out, motion: [Check(motion, 0.1, 0.5, "<=")])
    first, second = main_job.run(Context(tmp_path, tmp_path, quick=True))
    assert first.name == "rajagopal walk: does not run: no such luck"
    assert not first.passed
    assert (second.name, second.passed) == ("synth squat: squat", True)


def test_commands_are_run_quietly_and_read_back(tmp_path, capsys):
    person = write_person(tmp_path / "person")
    capsys.readouterr()
    found = scale_and_reconstruct(person.trial, (person.static, "--mass", "75"), tmp_path / "out")
    assert found.summary["marker_rms_mm"] < 2.0
    assert found.seconds > 0.0
    assert "knee_angle_r" in found.angles.names
    assert "knee_angle_r_moment" in found.torques.names
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("fresh", [False, True])
def test_a_failing_command_tells_why(fresh, tmp_path):
    with pytest.raises(MbkfError, match=r"mbkf info ended with 2: .*no such file"):
        mbkf("info", tmp_path / "none.c3d", fresh=fresh)
    with pytest.raises(MbkfError, match="ended with 2"):
        mbkf("info", fresh=fresh)
