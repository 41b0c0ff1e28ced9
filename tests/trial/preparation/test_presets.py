"""Presets become settings of a reconstruction, by name or by file; what they cannot say is refused."""

import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.filters.torque.settings import preset as torque_preset
from mbkf.io.preset import Preset, write_preset
from mbkf.trial.preparation.presets import BUILT_IN, check_name, place_of, with_preset
from mbkf.trial.preparation.settings import ReconstructSettings

PLAIN = ReconstructSettings(smooth=True)


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """The user's presets: one called lab."""
    monkeypatch.setenv("MBKF_PRESETS", str(tmp_path))
    values = {"acceleration_scale": 0.4, "innovation_share": 0.0}
    write_preset(Preset("lab", "dynamic", values), tmp_path / "lab.toml")
    return tmp_path


@pytest.mark.parametrize("name", BUILT_IN)
def test_the_theses_filters_come_along(name):
    found = with_preset(PLAIN, name)
    assert (found.filter, found.smooth) == ("torque", True)
    assert found.torque == torque_preset(name.removesuffix("-literal"), literal="literal" in name)


@pytest.mark.parametrize("wanted", [None, "dynamic"])
def test_a_saved_preset_changes_its_filter_alone(wanted, folder):
    for name in ("lab", str(folder / "lab.toml")):
        found = with_preset(PLAIN, name, wanted)
        assert found.filter == "dynamic"
        assert (found.dynamic.motion.acceleration_scale, found.dynamic.markers.innovation_share) == (0.4, 0.0)
        assert (found.kinematic, found.torque, found.smooth) == (PLAIN.kinematic, PLAIN.torque, True)


def test_whole_numbers_stay_whole(folder):
    write_preset(Preset("k", "kinematic", {"min_markers": 8.0}), folder / "k.toml")
    found = with_preset(PLAIN, "k").kinematic.min_markers
    assert (found, type(found)) == (8, int)


def test_unknown_presets_are_refused(folder):
    with pytest.raises(UnknownName, match=r"'lob'.*lab"):
        with_preset(PLAIN, "lob")
    with pytest.raises(UnknownName, match="FDMC"):
        with_preset(PLAIN, "FDCM")
    with pytest.raises(FileFormatError, match="no such file"):
        with_preset(PLAIN, str(folder / "lob.toml"))


@pytest.mark.parametrize(("name", "wanted"), [("lab", "kinematic"), ("FD", "dynamic")])
def test_a_preset_of_another_filter_is_refused(name, wanted):
    with pytest.raises(InvalidInput, match=f"not the {wanted} one"):
        with_preset(PLAIN, name, wanted)


@pytest.mark.parametrize(
    ("preset", "error", "fragment"),
    [
        (Preset("p", "magic", {}), UnknownName, "'magic'"),
        (Preset("p", "dynamic", {"acceleration_scal": 1.0}), UnknownName, "acceleration_scale"),
        (Preset("p", "dynamic", {"noise_range": 1.0}), UnknownName, "noise_range"),
        (Preset("p", "torque", {"per_frame": 1.0}), UnknownName, "per_frame"),
        (Preset("p", "dynamic", {"gate": 0.0}), InvalidInput, "gate must be positive"),
        (Preset("p", "dynamic", {"gate": -1.0}), InvalidInput, "gate must be positive"),
    ],
)
def test_what_cannot_be_is_refused(preset, error, fragment, folder):
    write_preset(preset, folder / "p.toml")
    with pytest.raises(error, match=fragment):
        with_preset(PLAIN, "p")


@pytest.mark.parametrize("name", ["", "a/b", "..", "-x", "walk.toml", "a b", "FD", "FDMC-literal"])
def test_names_that_cannot_be_saved(name):
    with pytest.raises(InvalidInput, match="--name"):
        check_name(name)


def test_where_a_preset_goes(folder):
    assert place_of(check_name("walk-2.b"), None) == folder / "walk-2.b.toml"
    assert place_of("x", folder / "y.toml") == folder / "y.toml"
    with pytest.raises(FileFormatError, match="is a folder"):
        place_of("x", folder)
