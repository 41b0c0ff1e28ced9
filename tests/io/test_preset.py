"""Preset files: written and read alike, in the folder the user names, and refused in one line when broken."""

import math
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.preset import Preset, preset_folder, read_preset, saved_presets, value_of, write_preset

PRESET = Preset(
    "lab",
    "dynamic",
    {
        "acceleration_scale": 0.4,
        "noise": "independent",
        "per_frame": True,
        "spread": math.inf,
        "pair": (1.0, 2.5),
    },
    "0.1.0",
    'a "note" \x7f with ü',
    ("walk 1", "walk 2"),
    ("run",),
    {"acceleration_scale": 0.3},
    {"held_out_before": 2.9, "held_out_after": -3.1},
    "thesis Table 4.3",
)
SMALL = 'filter = "dynamic"\n[values]\n'


@pytest.mark.parametrize("preset", [PRESET, Preset("x", "kinematic", {})], ids=["full", "bare"])
def test_what_is_written_is_read(preset, tmp_path):
    path = tmp_path / "new" / "preset.toml"
    write_preset(preset, path)
    assert read_preset(path) == preset


def test_a_preset_written_by_hand_needs_filter_and_values_only(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(SMALL + "acceleration_scale = 2\n")
    assert read_preset(path) == Preset("mine", "dynamic", {"acceleration_scale": 2.0})


def test_the_folder_is_the_users(monkeypatch, tmp_path):
    monkeypatch.delenv("MBKF_PRESETS", raising=False)
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    assert preset_folder() == tmp_path / ".config" / "mbkf" / "presets"
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "x"))
    assert preset_folder() == tmp_path / "x" / "mbkf" / "presets"
    monkeypatch.setenv("MBKF_PRESETS", str(tmp_path))
    assert preset_folder() == tmp_path
    assert saved_presets() == {}
    write_preset(PRESET, tmp_path / "lab.toml")
    assert saved_presets() == {"lab": tmp_path / "lab.toml"}


@pytest.mark.parametrize(
    ("content", "fragment"),
    [
        (None, "no such file"),
        ("filter =", "not a preset file"),
        ("\x00", "not a preset file"),
        ("[values]\n", "filter"),
        ('filter = "dynamic"\n', "values"),
        ("filter = 3\n[values]\n", "filter must be a text"),
        (SMALL + "gate = nan\n", "gate must be a number, a word, true or false, or a list of numbers"),
        (SMALL + 'gate = ""\n', "gate"),
        (SMALL + 'gate = [1, "2"]\n', "gate"),
        (SMALL + "gate = {a = 1}\n", "gate"),
        (SMALL + 'gate = 1\n[found]\ngate = "wide"\n', "gate"),
    ],
)
def test_broken_files_are_refused(content, fragment, tmp_path):
    path = tmp_path / "p.toml"
    if content is not None:
        path.write_text(content)
    with pytest.raises(FileFormatError, match=fragment):
        read_preset(path)


def test_a_folder_is_no_preset(tmp_path):
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_preset(tmp_path)


def test_an_unknown_entry_is_named(tmp_path):
    path = tmp_path / "p.toml"
    path.write_text('fliter = "dynamic"\n')
    with pytest.raises(UnknownName, match=r"'fliter'.*filter"):
        read_preset(path)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("FE", "FE"),
        ("'FE'", "FE"),
        ("true", True),
        ("inf", math.inf),
        ("2", 2.0),
        ("[2, 8.5]", (2.0, 8.5)),
        ("nan", None),
        ("", None),
        ("2 mm", None),
        ("1\nx = 2", None),
        ("[" * 5000, None),
    ],
)
def test_values_of_commands(text, value):
    assert value_of(text) == value
