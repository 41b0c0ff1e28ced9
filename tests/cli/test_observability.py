"""The tables of `mbkf observability`."""

import pytest

from mbkf.cli.main import main
from mbkf.model.protocol import protocol_names


@pytest.fixture(autouse=True)
def wide_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")


def test_the_reference_protocol_is_complete(capsys):
    assert main(["observability", "reference36"]) == 0
    shown = capsys.readouterr().out
    assert "52 of 52" in shown
    assert "104 of 104" in shown
    assert "All 52 degrees of freedom" in shown


def test_undetermined_dofs_are_listed_with_their_share(capsys):
    assert main(["observability", "plug_in_gait"]) == 0
    shown = capsys.readouterr().out
    assert "48 of 52" in shown
    (row,) = (line for line in shown.splitlines() if "right_toes_y" in line)
    assert row.count("100 %") == 2


def test_lost_markers_take_dofs(capsys):
    assert main(["observability", "reference36", "--lost", "RHAL, LHAL"]) == 0
    shown = capsys.readouterr().out
    assert "34 markers" in shown
    assert "Lost with these markers: right_toes_y, left_toes_y." in shown


def test_a_loss_that_takes_nothing_says_so(capsys):
    assert main(["observability", "reference36", "--lost", "RTHI"]) == 0
    assert "Lost with these markers: nothing." in capsys.readouterr().out


def test_without_a_protocol_all_are_listed(capsys):
    assert main(["observability"]) == 0
    shown = capsys.readouterr().out
    for name in protocol_names():
        assert name in shown
    assert "hand (r, l)" in shown


def test_torques_and_reactions_of_a_filter_without_a_plate(capsys):
    words = ["--preset", "FDMC-literal", "--without-plate", "left", "--without-plate", "1"]
    assert main(["observability", "reference36", *words]) == 0
    shown = capsys.readouterr().out
    assert "no plate under the right foot, no plate under the left foot" in shown
    assert "state of 166" in shown
    (row,) = (line for line in shown.splitlines() if "simplified F" in line)
    assert row.count("154 of 166") == 2
    assert "12 directions of the state do not show" in shown
    assert any("torque" in line and "right_foot x, y, z" in line for line in shown.splitlines())


def test_a_determined_state_is_called_so(capsys):
    assert main(["observability", "reference36", "--filter", "dynamic"]) == 0
    shown = capsys.readouterr().out
    assert "a plate under each foot" in shown
    assert "All 174 components of the state are determined." in shown


def test_a_plate_option_without_a_name_takes_both(capsys):
    assert main(["observability", "reference36", "--filter", "dynamic", "--without-plate"]) == 0
    assert "162 of 174" in capsys.readouterr().out


def test_a_rank_that_hangs_on_the_bound_is_called_doubtful(capsys):
    """Newton's law shows the markerless hands of this set a little, and their turns hardly at all."""
    assert main(["observability", "plug_in_gait", "--filter", "dynamic"]) == 0
    assert "hardly observed either way" in capsys.readouterr().out


def test_a_load_that_is_an_input_is_missing_without_its_plate(capsys):
    words = ["--preset", "FDMC", "--set", "plates=inputs", "--without-plate", "2"]
    assert main(["observability", "reference36", *words]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "state of 154" in shown
    assert "Wrenches of the feet are known inputs; without a plate that of a foot counts as 0" in shown


def test_all_protocols_are_listed_for_a_filter(capsys, monkeypatch):
    monkeypatch.setattr("mbkf.model.protocol.protocol_names", lambda: ("reference36", "plug_in_gait"))
    assert main(["observability", "--filter", "torque", "--without-plate", "both"]) == 0
    shown = capsys.readouterr().out
    assert "154 of 166" in shown
    assert "load on right foot" in shown
    assert "toes (r, l)" in shown


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["reference36", "--filter", "torque", "--without-plate", "rigth"], "did you mean right"),
        (["reference36", "--filter", "torque", "--lost", "RKNEE"], "did you mean RKNE"),
        (["reference36", "--without-plate", "right"], "the kinematic filter reads no plate"),
        (["reference36", "--filter", "dynamic", "--preset", "FDMC"], "FDMC"),
        (["plug_in_gate"], "did you mean plug_in_gait"),
        (["reference36", "--lost", "XYZ"], "unknown marker 'XYZ'"),
        (["missing.toml"], "missing.toml"),
        (["--lost", "RASI"], "--lost needs the protocol"),
    ],
)
def test_mistakes_are_one_line(capsys, words, complaint):
    assert main(["observability", *words]) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1


def test_help_gives_an_example(capsys):
    with pytest.raises(SystemExit) as leaving:
        main(["observability", "--help"])
    assert leaving.value.code == 0
    assert "mbkf observability reference36" in capsys.readouterr().out
