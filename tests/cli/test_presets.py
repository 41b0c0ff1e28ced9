"""`mbkf presets` lists presets with their origin, shows one with its source, and lists a filter's settings."""

import json

import pytest

from mbkf.cli.main import main
from mbkf.io.preset import Preset, shipped_presets, write_preset


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """The user's presets: one called lab."""
    monkeypatch.setenv("MBKF_PRESETS", str(tmp_path))
    write_preset(Preset("lab", "dynamic", {"gate": 70.0}, tuned_on=("walk",)), tmp_path / "lab.toml")
    return tmp_path


def printed(capsys, *words):
    assert main(["presets", *words]) == 0
    return capsys.readouterr().out


def test_the_list_names_filter_origin_and_remark(capsys, folder):
    (folder / "broken.toml").write_text("filter = 3\n[values]\n")
    rows = {row["name"]: row for row in json.loads(printed(capsys, "--json"))}
    assert list(rows) == [*shipped_presets(), "broken", "lab"]
    assert rows["FD"]["origin"] == "mbkf"
    assert rows["lab"] == {
        "name": "lab", "filter": "dynamic", "origin": str(folder / "lab.toml"), "remark": "tuned on walk",
    }  # fmt: skip
    assert "filter must be a text" in rows["broken"]["remark"]
    assert "FDMC-literal-per-frame" in printed(capsys)


def test_a_preset_is_shown_with_its_values_and_source(capsys):
    text = printed(capsys, "FDMC-literal")
    assert all(part in text for part in ("integrator", "FE", "Table 4.3", "residual_spread_force_n", "inf"))
    shown = json.loads(printed(capsys, "FDMC-literal", "--json"))
    assert shown["values"]["load_force_n"] == 20.0
    assert shown["values"]["residual_spread_force_n"] == "inf"
    assert "Table 4.3" in shown["source"]


def test_the_settings_of_a_filter_have_default_and_possible_values(capsys):
    rows = {row["setting"]: row for row in json.loads(printed(capsys, "--settings", "torque", "--json"))}
    assert rows["integrator"] == {
        "setting": "integrator", "default": "TN", "values": "one of FE, HE, TF, TN, RK4",
    }  # fmt: skip
    assert rows["toe_acceleration"]["default"] == "table"
    assert "per_frame" in printed(capsys, "--settings", "torque")


def test_a_preset_that_cannot_be_used_is_refused(capsys, folder):
    write_preset(Preset("bad", "torque", {"per_frame": True}), folder / "bad.toml")
    for words, part in ((["bad"], "independent"), (["lob"], "did you mean lab")):
        assert main(["presets", *words]) == 2
        error = capsys.readouterr().err
        assert part in error
        assert error.count("\n") == 1
