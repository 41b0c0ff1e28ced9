"""Presets become settings of a reconstruction, by name or by file; what they cannot say is refused."""

from dataclasses import replace

import pytest

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.filters.torque.settings import preset as torque_preset
from mbkf.io.preset import Preset, read_preset, shipped_presets, write_preset
from mbkf.trial.preparation.presets import check_name, place_of, with_preset, with_set
from mbkf.trial.preparation.settings import ReconstructSettings, recorded

PLAIN = ReconstructSettings(smooth=True)


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """The user's presets: one called lab."""
    monkeypatch.setenv("MBKF_PRESETS", str(tmp_path))
    values = {"acceleration_scale": 0.4, "innovation_share": 0.0}
    write_preset(Preset("lab", "dynamic", values), tmp_path / "lab.toml")
    return tmp_path


@pytest.mark.parametrize("name", ["FD", "FDMC", "FD-literal", "FDMC-literal"])
def test_the_theses_filters_come_along(name):
    found = with_preset(PLAIN, name)
    assert (found.filter, found.smooth, found.preset) == ("torque", True, name)
    assert found.torque == torque_preset(name.removesuffix("-literal"), literal="literal" in name)


@pytest.mark.parametrize("name", ["FD", "FDMC"])
def test_the_table_of_the_thesis_is_read_per_frame_by_name(name):
    found = with_preset(PLAIN, f"{name}-literal-per-frame").torque
    assert found == replace(torque_preset(name, literal=True), per_frame=True)


@pytest.mark.parametrize("name", shipped_presets())
def test_every_preset_that_comes_along_can_be_used_and_has_a_source(name):
    shipped = read_preset(shipped_presets()[name])
    assert with_preset(PLAIN, name).filter == shipped.filter
    assert shipped.name == name
    assert shipped.note
    assert shipped.source


@pytest.mark.parametrize("wanted", [None, "dynamic"])
def test_a_saved_preset_changes_its_filter_alone(wanted, folder):
    for name in ("lab", str(folder / "lab.toml")):
        found = with_preset(PLAIN, name, wanted)
        assert (found.filter, found.preset) == ("dynamic", name.rpartition("/")[2])
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
        (Preset("p", "dynamic", {"noise_range": 1.0}), InvalidInput, "p.toml: noise_range must be 2 numbers"),
        (Preset("p", "torque", {"per_frame": 1.0}), InvalidInput, "per_frame must be true or false, got 1"),
        (Preset("p", "dynamic", {"gate": 0.0}), InvalidInput, "gate must be a positive number, got 0"),
        (Preset("p", "dynamic", {"gate": -1.0}), InvalidInput, "gate must be a positive number, got -1"),
        (Preset("p", "torque", {"per_frame": True}), InvalidInput, "p.toml: per_frame .*independent"),
    ],
)
def test_what_cannot_be_is_refused(preset, error, fragment, folder):
    write_preset(preset, folder / "p.toml")
    with pytest.raises(error, match=fragment):
        with_preset(PLAIN, "p")


def test_single_settings_follow_the_preset():
    found = with_set(
        with_preset(PLAIN, "FD-literal"), ["integrator=HE", "per_frame = true", "load_force_n=30"]
    )
    wanted = torque_preset("FD", literal=True)
    scheme = replace(wanted.scheme, integrator="HE")
    assert found.torque == replace(wanted, scheme=scheme, per_frame=True, load_force_n=30.0)
    record = recorded(found)
    assert record["preset"] == "FD-literal"
    assert record["given"] == {"integrator": "HE", "per_frame": True, "load_force_n": 30.0}


def test_lists_of_numbers_are_settings_as_well():
    assert with_set(PLAIN, ["busy_shares=[1, 3.5]"]).dynamic.motion.busy_shares == (1.0, 3.5)


@pytest.mark.parametrize(
    ("given", "error", "fragment"),
    [
        (["gate"], InvalidInput, "write NAME=VALUE"),
        (["=3"], InvalidInput, "write NAME=VALUE"),
        (["gate="], InvalidInput, "write NAME=VALUE"),
        (["gate=1\nmin_markers = 2"], InvalidInput, "write NAME=VALUE"),
        (["gate=3", "gate=4"], InvalidInput, "gate is given twice"),
        (["gat=3"], UnknownName, "unknown setting 'gat'; did you mean gate"),
        (["integrator=HE"], InvalidInput, "setting of the torque filter.*--filter torque"),
        (["integrater=HE"], InvalidInput, "this setting; integrator is a setting of the torque filter"),
        (["gate=wide"], InvalidInput, '--set: gate must be a positive number, got "wide"'),
    ],
)
def test_wrong_single_settings_are_refused(given, error, fragment):
    with pytest.raises(error, match=fragment):
        with_set(PLAIN, given)


@pytest.mark.parametrize("name", ["", "a/b", "..", "-x", "walk.toml", "a b", "FD", "FDMC-literal"])
def test_names_that_cannot_be_saved(name):
    with pytest.raises(InvalidInput, match="--name"):
        check_name(name)


def test_where_a_preset_goes(folder):
    assert place_of(check_name("walk-2.b"), None) == folder / "walk-2.b.toml"
    assert place_of("x", folder / "y.toml") == folder / "y.toml"
    with pytest.raises(FileFormatError, match="is a folder"):
        place_of("x", folder)
