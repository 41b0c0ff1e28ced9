"""Damaged persons, marker sets, bodies, presets, lists and models are refused: bombs, hostile names, wild numbers."""

import shutil

import numpy as np
import pytest

from mbkf.conventions import data_folder
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.imu.mount import ImuMount, read_mounts, write_mounts
from mbkf.io.osim import read_osim
from mbkf.io.preset import read_preset
from mbkf.io.subject import Subject, SubjectMarker, read_subject, write_subject
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.study.batch.run import plan_of
from mbkf.trial.protocol.from_osim import import_osim
from tests.io.damaged.refusal import refusal


def _subject():
    marker = SubjectMarker("A", "pelvis", np.array([0.1, 0.0, 0.0]), 0.005, 0.01)
    return Subject("human18", 70.0, {"head": 1.0}, (marker,), "reference36")


def plan_of_list(path):
    """The plan of a list or folder; the first fault of a row as its error."""
    plan = plan_of(path)
    for trial in plan.trials:
        if trial.fault:
            raise InvalidInput(trial.fault)
    return plan


def plan_of_session(path):
    (path.parent / "walk.c3d").touch()
    return plan_of_list(path.parent)


PROTOCOL = 'name = "P"\n[[marker]]\nname = "A"\nlandmark = "c7"\nnoise_mm = 5\n'
PRESET = 'name = "own"\nfilter = "dynamic"\n[values]\ngate = 5.0\n'
LIST = '[[subject]]\nname = "P"\nmass_kg = 70.0\ntrials = ["a.c3d"]\n'
SESSION = 'mass_kg = 70.0\nheight_m = 1.8\nprotocol = "reference36"\n'


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    """Reader and text of each kind of file."""
    folder = tmp_path_factory.mktemp("samples")
    write_subject(_subject(), folder / "subject.toml")
    write_mounts(
        [ImuMount("A", "pelvis", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))], folder / "mounts.toml"
    )
    return {
        "subject": (read_subject, (folder / "subject.toml").read_text()),
        "mounts": (read_mounts, (folder / "mounts.toml").read_text()),
        "protocol": (load_protocol, PROTOCOL), "preset": (read_preset, PRESET), "list": (plan_of_list, LIST),
        "session": (plan_of_session, SESSION),
        "body": (load_body, (data_folder("models") / "human18.toml").read_text()[:4000]),
    }  # fmt: skip


KINDS = ("subject", "mounts", "protocol", "preset", "list", "session")


def named(folder, kind):
    return folder / ("session.toml" if kind == "session" else f"{kind}.toml")


@pytest.mark.parametrize("kind", KINDS)
def test_the_undamaged_sample_is_read_with_a_mark_and_any_end_of_line(samples, tmp_path, kind):
    read, text = samples[kind]
    path = named(tmp_path, kind)
    for content in (text.encode(), b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()):
        path.write_bytes(content)
        assert read(path) is not None


@pytest.mark.parametrize("kind", [*KINDS, "body"])
@pytest.mark.parametrize(
    "head",
    [
        b"x = " + b"[" * 3900, b"x = " + b"{a=" * 1200, b"a." * 1500 + b"a = 1\n", b"[" + b"a." * 1500 + b"a]\n",
        b"x = " + b"9" * 400 + b"\n", b"x = 0x" + b"f" * 3000 + b"\n", b"x = \x00\n", b"\xff\xfe", b"x = '''\n",
        b"x = 1\nx = 2\n", b"x = 1e\n", b"= 1\n", b'x = "\\ud800"\n', b"x = 2024-99-99\n",
    ],
    ids=[
        "arrays", "tables", "key", "header", "digits", "hexadecimals", "zero byte", "UTF-16", "open text", "twice",
        "half a number", "no name", "surrogate", "date",
    ],
)  # fmt: skip
def test_bombs_and_what_is_no_toml_are_refused(samples, tmp_path, kind, head):
    read, text = samples[kind]
    refusal(read, named(tmp_path, kind), (head + text.encode())[:4096])


@pytest.mark.parametrize("kind", ["subject", "mounts", "protocol", "preset", "list", "body"])
@pytest.mark.parametrize("content", [b"", b"\n", None, b"\x00" * 100, b"x = 1\n", bytes(range(256))])
def test_what_holds_nothing_is_refused(samples, tmp_path, kind, content):
    refusal(samples[kind][0], named(tmp_path, kind), content)


CASES = [
    ("subject", "mass_kg = 70.0", "mass_kg = 1e9", "mass_kg"),
    ("subject", "mass_kg = 70.0", "mass_kg = nan", "mass"),
    ("subject", "mass_kg = 70.0", "mass_kg = true", ""),
    ("subject", "head = 1.0", "head = inf", "head"),
    ("subject", "[0.1, 0.0, 0.0]", "[1e9, 0.0, 0.0]", "position_m must be 3 numbers of at most 1.5 m"),
    ("subject", "[0.1, 0.0, 0.0]", "[[0.1], 0.0, 0.0]", ""),
    ("subject", "[0.1, 0.0, 0.0]", '["x", 0.0, 0.0]', ""),
    ("subject", "noise_m = 0.005", "noise_m = -1", "noise_m"),
    ("subject", 'protocol = "reference36"', 'protocol = "x"\nreport = "' + "[" * 2000 + '"', "nested"),
    ("subject", 'protocol = "reference36"', 'protocol = "x"\nreport = "[1]"', "no table"),
    ("subject", 'protocol = "reference36"', 'protocol = "x"\nreport = 5', ""),
    ("mounts", "rotation = [0.0, 0.0, 0.0, 1.0]", "rotation = [0, 0, 0, 0]", "quaternion"),
    ("mounts", "rotation = [0.0, 0.0, 0.0, 1.0]", "rotation = [nan, 0, 0, 1]", "rotation must be 4 numbers"),
    ("mounts", "rotation = [0.0, 0.0, 0.0, 1.0]", "rotation = [inf, 0, 0, 1]", "rotation must be 4 numbers"),
    (
        "mounts",
        "rotation = [0.0, 0.0, 0.0, 1.0]",
        "rotation = [1e308, 0, 0, 1]",
        "rotation must be 4 numbers",
    ),
    ("mounts", "rotation = [0.0, 0.0, 0.0, 1.0]", "rotation = [1, 0, 0]", "rotation must be 4 numbers"),
    ("mounts", "position_m = [0.0, 0.0, 0.0]", "position_m = [1e9, 0.0, 0.0]", "position"),
    ("protocol", 'landmark = "c7"', 'segment = "pelvis"\nposition_m = [0.0, 1e9, 0.0]', "at most 3 m"),
    ("protocol", 'landmark = "c7"', 'landmark = ["c7"]', ""),
    ("protocol", 'landmark = "c7"', 'landmark = "../../etc/passwd"', "unknown landmark"),
    ("protocol", "noise_mm = 5", "noise_mm = -1", "noise_mm"),
    ("protocol", "noise_mm = 5", "noise_mm = inf", "noise_mm"),
    ("protocol", "noise_mm = 5", "placement_sd_mm = nan", "placement_sd_mm"),
    ("protocol", "noise_mm = 5", "noise_mm = 0", "noise_mm must be a number between 0.001 and 1000"),
    ("protocol", "noise_mm = 5", "placement_sd_mm = 0", "placement_sd_mm must be a number between 0.001"),
    ("protocol", "noise_mm = 5", "probability = 2", "probability"),
    ("protocol", "noise_mm = 5", "aliases = [1, 2]", "strings"),
    ("protocol", 'name = "A"', "name = 5", "strings"),
    ("protocol", 'name = "A"', 'name = "A"\n"\\u001b[2J" = 1', "\\x1b[2J"),
    ("protocol", 'name = "P"', "name = [1]", "strings"),
    ("protocol", 'name = "P"', 'name = "P"\nbody = "../nowhere.toml"', "nowhere.toml"),
    ("protocol", 'name = "P"', 'name = "P"\nbody = "' + "x" * 200 + '"', "unknown body"),
    ("preset", "gate = 5.0", "gate = nan", "gate"),
    ("preset", "gate = 5.0", 'gate = [5.0, "5"]', "gate"),
    ("preset", 'name = "own"', "name = 1", "name must be a text"),
    ("preset", 'filter = "dynamic"', 'fliter = "dynamic"', "fliter"),
    ("list", "mass_kg = 70.0", "mass_kg = 1e300", "mass_kg"),
    ("list", '["a.c3d"]', "[1]", "a trial is a file"),
    ("list", '["a.c3d"]', '["a\\u0000.c3d"]', "zero byte"),
    ("list", 'name = "P"', "name = 1", "name must be a text"),
    ("list", "[[subject]]", "[subject]", "[[subject]]"),
    ("session", "mass_kg = 70.0", "mass_kg = nan", "mass_kg"),
    ("session", "height_m = 1.8", "height_m = true", "height_m"),
    ("session", 'protocol = "reference36"', "protocol = []", "protocol"),
]


@pytest.mark.parametrize(("kind", "old", "new", "reason"), CASES)
def test_a_damaged_entry_is_refused_for_its_reason(samples, tmp_path, kind, old, new, reason):
    read, text = samples[kind]
    assert old in text
    path = named(tmp_path, kind)
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(MbkfError) as caught:
        read(path)
    assert reason in str(caught.value) and "\n" not in str(caught.value) and "\x1b" not in str(caught.value)


@pytest.mark.parametrize(
    "content",
    [
        b"", None, b"\0" * 200, b"<a>" * 1000, b"<Model>", b"<Marker>" * 400,
        b'<!DOCTYPE a [<!ENTITY x "y">]><a>&x;</a>',
        b'<Model><Marker name="A"><body>pelvis</body><location>1e300 nan 0</location></Marker></Model>',
        b'<Model><Marker name="A"><body></body><location>0 0 0</location></Marker></Model>',
        b"PK\x03\x04" + bytes(100), "<Model>".encode("utf-16"),
    ],
)  # fmt: skip
def test_models_without_a_marker_that_can_be_read_are_refused(tmp_path, content):
    refusal(read_osim, tmp_path / "a.osim", content)


def test_a_model_whose_lengths_are_no_metres_is_refused(tmp_path):
    text = '<Model><Marker name="A"><body>pelvis</body><location>0 0 120</location></Marker></Model>'
    assert "metres" in refusal(import_osim, tmp_path / "a.osim", text.encode())


def test_a_session_beside_no_capture_is_no_study(tmp_path):
    (tmp_path / "session.toml").write_text(SESSION)
    with pytest.raises(MbkfError):
        plan_of(tmp_path)
    shutil.rmtree(tmp_path)
