"""The subject file: read back exactly as written; a bad file is refused with its reason in one line."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.subject import Subject, SubjectMarker, match_names, read_subject, write_subject

# TOML cannot hold lone surrogates, nor can UTF-8.
TEXT = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=12)
LENGTH = st.floats(-1.5, 1.5)
POSITIVE = st.floats(1e-6, 1.0)
FACTOR_NAMES = st.sampled_from(["head", "right_thigh", "trunk_depth", "left_foot_width"])
PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**50), 2**50)
    | st.floats(allow_nan=False, allow_infinity=False)
    | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3),
    max_leaves=8,
)
MARKERS = st.builds(
    SubjectMarker,
    name=TEXT,
    segment=TEXT,
    position_m=st.lists(LENGTH, min_size=3, max_size=3).map(np.array),
    noise_m=POSITIVE,
    session_sd_m=POSITIVE,
    aliases=st.lists(TEXT, max_size=3).map(tuple),
)
SUBJECTS = st.builds(
    Subject,
    body=TEXT,
    mass_kg=st.floats(0.5, 500.0),
    scale_factors=st.dictionaries(FACTOR_NAMES, st.floats(0.5, 1.6), min_size=1),
    markers=st.lists(MARKERS, max_size=4, unique_by=lambda marker: marker.name).map(tuple),
    protocol=TEXT,
    height_m=st.none() | st.floats(0.5, 2.6),
    report=st.dictionaries(TEXT, PLAIN, max_size=3),
    body_text=st.just("") | TEXT | st.lists(TEXT, min_size=2).map("\n".join),
)


def plain(subject):
    """All fields as comparable values."""
    markers = [replace(m, position_m=tuple(map(float, m.position_m))) for m in subject.markers]
    return replace(subject, markers=tuple(markers))


@pytest.fixture
def subject():
    marker = SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.4]), 0.005, 0.005, ("R.Knee",))
    return Subject("human18", 70.0, {"head": 1.05}, (marker,), "reference36", 1.75, {"marker_rms_mm": 3.1})


@given(SUBJECTS)
@settings(max_examples=80, deadline=None)
def test_what_is_written_is_read_back(written):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "subject.toml"
        write_subject(written, path)
        assert plain(read_subject(path)) == plain(written)


@pytest.mark.parametrize(
    "name", ['a "b" \\ c', "línea\nnueva", "マーカー", "\t\x7f\x85\u2028", "# no comment", "🦵"]
)
def test_odd_names_survive(subject, tmp_path, name):
    odd = replace(
        subject, protocol=name, markers=(replace(subject.markers[0], name=name, aliases=(name, "x")),)
    )
    write_subject(odd, tmp_path / "s.toml")
    assert plain(read_subject(tmp_path / "s.toml")) == plain(odd)


@pytest.mark.parametrize("text", ['name = "legs"\n[roles]\n', "a = '''b'''\n", "ends with '", "a\r\nb\tc\n"])
def test_a_body_of_ones_own_is_carried_word_for_word(subject, tmp_path, text):
    write_subject(replace(subject, body_text=text), tmp_path / "s.toml")
    assert read_subject(tmp_path / "s.toml").body_text == text


def test_noise_that_stays_is_kept(subject, tmp_path):
    keypoint = replace(subject.markers[0], correlated_m=0.004, correlation_s=0.3)
    write_subject(replace(subject, markers=(keypoint,)), tmp_path / "s.toml")
    assert (
        plain(read_subject(tmp_path / "s.toml")).markers[0]
        == plain(replace(subject, markers=(keypoint,))).markers[0]
    )


def test_a_shipped_body_leaves_no_text(subject, tmp_path):
    write_subject(subject, tmp_path / "s.toml")
    assert "body_text" not in (tmp_path / "s.toml").read_text(encoding="utf-8")


def test_positions_cannot_be_written_to(subject, tmp_path):
    write_subject(subject, tmp_path / "s.toml")
    assert not read_subject(tmp_path / "s.toml").markers[0].position_m.flags.writeable


def test_writing_leaves_one_whole_file(subject, tmp_path):
    write_subject(subject, tmp_path / "s.toml")
    write_subject(replace(subject, mass_kg=80.0), tmp_path / "s.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]
    assert read_subject(tmp_path / "s.toml").mass_kg == 80.0


@pytest.mark.parametrize("numpy_mass", [np.float64(70.5), np.float32(70.5)])
def test_numpy_numbers_are_written_as_numbers(subject, tmp_path, numpy_mass):
    write_subject(replace(subject, mass_kg=numpy_mass, height_m=np.float64(1.7)), tmp_path / "s.toml")
    assert read_subject(tmp_path / "s.toml").mass_kg == 70.5


@pytest.mark.parametrize("mass", [0.0, -1.0, np.nan, np.inf])
def test_impossible_masses_are_refused(subject, mass):
    with pytest.raises(InvalidInput, match="mass must be positive"):
        replace(subject, mass_kg=mass)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("body =", "bod =", "line 2: unknown subject entry 'bod'; did you mean body"),
        ("mass_kg = 70.0", 'mass_kg = "heavy"', "mass_kg must be a number between 0.5 and 500 kg, got heavy"),
        ("mass_kg = 70.0", "mass_kg = [70.0]", "mass_kg must be a number"),
        ("mass_kg = 70.0", "mass_kg = 0.0", "mass_kg must be a number"),
        ("mass_kg = 70.0", "", "mass_kg is missing"),
        (
            "[scale_factors]",
            "[scale_factor]",
            "unknown subject entry 'scale_factor'; did you mean scale_factors",
        ),
        ("head = 1.05", 'head = "big"', "scale_factors: head must be a number between 0.2 and 2, got big"),
        ("[scale_factors]\nhead = 1.05", "scale_factors = 1.05", "scale_factors must be a table"),
        ("[scale_factors]\nhead = 1.05", "", "scale_factors is missing"),
        ("head = 1.05", "", "scale_factors is empty; it lists all of the body"),
        (
            "position_m = [0.01, -0.05, -0.4]",
            "position_m = [0.01, -0.05]",
            "marker RKNE: position_m must be 3",
        ),
        (
            "position_m = [0.01, -0.05, -0.4]",
            "position_m = [0.01, nan, 0.2]",
            "marker RKNE: position_m must be 3",
        ),
        ("noise_m = 0.005", "", "marker RKNE: noise_m is missing"),
        ("noise_m = 0.005", "noise_m = 0", "noise_m must be a number between 1e-06 and 1 m, got 0"),
        (
            "session_sd_m = 0.005",
            "session_sd_m = 0",
            "session_sd_m must be a number between 1e-06 and 1 m, got 0",
        ),
        (
            "noise_m = 0.005",
            "noise_m = 5",
            "noise_m must be .*, got 5; write noise_m = 0.05 if it is in cm, noise_m = 0.005 if it is in mm",
        ),
        (
            "noise_m = 0.005",
            "noise_m = 0.005\ncorrelated_m = 0.006",
            "correlated_m 0.006 exceeds noise_m 0.005",
        ),
        ("position_m = [0.01, -0.05, -0.4]", "position_m = [0.01, 1e9, 0.2]", "at most 1.5 m"),
        ("head = 1.05", "head = -1.0", "between 0.2 and 2"),
        (
            "head = 1.05",
            "head = 10.0",
            "line 9: scale_factors: head must be a number between 0.2 and 2, got 10",
        ),
        ("[[marker]]", "[marker]", "marker must be a list of tables"),
        ("report = ", "report = 'x' # ", "not a subject file"),
        ('\\"marker_rms_mm\\"', '\\"standing_q\\"', "report: standing_q must be a list of finite numbers"),
        (
            'segment = "right_thigh"',
            "segment = right_thigh",
            'not a subject file: .* write segment = "right_thigh"',
        ),
        ("aliases", "alias", "unknown marker entry 'alias'; did you mean aliases"),
    ],
)
def test_faulty_files_are_refused_in_one_line(subject, tmp_path, old, new, complaint):
    path = tmp_path / "s.toml"
    write_subject(subject, path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(FileFormatError, match=complaint) as caught:
        read_subject(path)
    assert "\n" not in str(caught.value)


def test_a_marker_stands_once_and_every_factor_of_the_covariance_has_its_line(subject, tmp_path):
    path, marker = tmp_path / "s.toml", subject.markers[0]
    write_subject(replace(subject, markers=(marker, replace(marker, noise_m=0.1))), path)
    with pytest.raises(FileFormatError, match="line 19: marker RKNE: it stands twice"):
        read_subject(path)
    known = BodyCovariance(("head", "right_thigh"), (), 0.01 * np.eye(2))
    write_subject(replace(subject, covariance=known), path)
    with pytest.raises(FileFormatError, match=r"right_thigh is missing, which \[covariance\] names"):
        read_subject(path)


def test_a_missing_file_a_folder_and_binary_data_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file; make it with 'mbkf scale'"):
        read_subject(tmp_path / "none.toml")
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_subject(tmp_path)
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_subject(tmp_path / "b.toml")


def test_names_are_matched_once_and_own_names_come_first():
    """A capture may hold a marker under its own name and an alias, in any order."""
    markers = [
        SubjectMarker("RASI", "pelvis", np.zeros(3), 0.005, 0.005, aliases=("R.ASIS",)),
        SubjectMarker("SACR", "pelvis", np.zeros(3), 0.005, 0.005, aliases=("S2", "V.Sacral")),
    ]
    found = match_names(["S2", "R.ASIS", "V.Sacral", "RASI", "other"], markers)
    assert {name: marker.name for name, marker in found.items()} == {"S2": "SACR", "RASI": "RASI"}
