"""No input and no file of another program is ever replaced; files that mbkf wrote are known by their content."""

import os
import struct
from pathlib import Path

import pytest

from mbkf.errors import ProtectedFile
from mbkf.io.atomic import check_file, check_folder, new_file, remove_file, replacing, write_text
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.files_read import own_files_read, read_bytes
from mbkf.io.written import (
    FORM_OF_SUFFIX,
    MARK,
    PAGE,
    SETTINGS,
    check_replaceable,
    form_of,
    overwriting,
)

OURS = "# Something, written by mbkf.\n"


@pytest.fixture
def task():
    with own_files_read() as files:
        yield files


@pytest.mark.parametrize("by", ["itself", "symbolic link", "hard link", "relative path", "dots"])
@pytest.mark.parametrize("permitted", [False, True])
def test_a_file_that_was_read_is_never_replaced(by, permitted, tmp_path, task, monkeypatch):
    source = tmp_path / "walk.toml"
    source.write_text(OURS)
    read_bytes(source)
    target = {"itself": source, "dots": tmp_path / "x" / ".." / "walk.toml"}.get(by, tmp_path / "other.toml")
    (tmp_path / "x").mkdir()
    if by == "symbolic link":
        target.symlink_to(source)
    if by == "hard link":
        os.link(source, target)
    if by == "relative path":
        monkeypatch.chdir(tmp_path)
        target = type(source)("walk.toml")
    with overwriting(permitted):
        for write in (
            lambda: write_text(target, "lost"),
            lambda: new_file(target),
            lambda: check_file(target),
            lambda: remove_file(target),
        ):
            with pytest.raises(ProtectedFile, match="input"):
                write()
    assert source.read_text() == OURS


def test_an_input_that_a_linked_folder_holds_stays(tmp_path, task):
    lab = tmp_path / "lab"
    lab.mkdir()
    (lab / "trial.c3d").write_bytes(b"raw")
    (tmp_path / "out").symlink_to(lab)
    read_bytes(lab / "trial.c3d")
    with pytest.raises(ProtectedFile), overwriting(), replacing_folder(tmp_path / "out") as partial:
        (partial / "trial.c3d").write_text("new")
        (partial / "other.c3d").write_text("new")
    assert [path.name for path in lab.iterdir()] == ["trial.c3d"]
    assert (lab / "trial.c3d").read_bytes() == b"raw"
    with pytest.raises(ProtectedFile):
        check_folder(tmp_path / "out", ["trial.c3d"])


def test_a_file_of_another_program_is_replaced_only_when_asked(tmp_path, task):
    target = tmp_path / "notes.toml"
    target.write_text("mass = 70\n")
    with pytest.raises(ProtectedFile, match="--overwrite"):
        write_text(target, "new")
    with pytest.raises(ProtectedFile, match="--overwrite"):
        check_file(target)
    assert target.read_text() == "mass = 70\n"
    with overwriting():
        write_text(target, "new")
    assert target.read_text() == "new"


def test_a_file_that_comes_into_being_while_another_is_written_stays(tmp_path, task):
    target = tmp_path / "notes.txt"
    with pytest.raises(ProtectedFile), replacing(target) as partial:
        partial.write_text("new")
        target.write_text("from elsewhere")
    assert target.read_text() == "from elsewhere"


def test_a_file_that_comes_into_a_folder_while_it_is_exchanged_stays(tmp_path, task, monkeypatch):
    from mbkf.io import atomic_folder

    target = tmp_path / "result"
    with replacing_folder(target) as partial:
        (partial / "a.txt").write_text("old")
    (target / "kept").mkdir()
    exchange = atomic_folder._exchange

    def late(first, second):
        (target / "late.c3d").write_text("raw")
        (target / "kept" / "late.c3d").write_text("raw")
        return exchange(first, second)

    monkeypatch.setattr(atomic_folder, "_exchange", late)
    with replacing_folder(target) as partial:
        (partial / "a.txt").write_text("new")
    assert (target / "a.txt").read_text() == "new"
    assert (target / "late.c3d").read_text() == "raw"
    assert (target / "kept" / "late.c3d").read_text() == "raw"


def test_what_a_task_wrote_itself_it_may_read_and_replace(tmp_path, task):
    target = tmp_path / "table.txt"
    write_text(target, "first")
    read_bytes(target)
    write_text(target, "second")
    assert target.read_text() == "second"
    target.write_text("changed by hand")
    with pytest.raises(ProtectedFile):
        write_text(target, "third")


def test_a_later_task_may_replace_what_an_earlier_one_read(tmp_path):
    target = tmp_path / "a.toml"
    target.write_text(OURS)
    with own_files_read():
        read_bytes(target)
    with own_files_read():
        write_text(target, "new")
    assert target.read_text() == "new"


def test_an_inode_that_is_used_again_is_another_file(tmp_path, task):
    first, second = tmp_path / "a", tmp_path / "b"
    first.write_text(OURS)
    read_bytes(first)
    first.rename(second)
    first.write_text(OURS)
    with pytest.raises(ProtectedFile):  # by its place
        check_replaceable(first)
    second.unlink()
    third = tmp_path / "c"
    third.write_text(OURS)
    check_replaceable(third)


def test_a_file_that_is_edited_on_purpose_may_have_been_read(tmp_path, task):
    target = tmp_path / "session.toml"
    target.write_text("mine = 1\n")
    read_bytes(target)
    write_text(target, "mine = 2\n", edits=True)
    assert target.read_text() == "mine = 2\n"


@pytest.mark.parametrize("edits", [False, True])
def test_pipes_and_devices_are_no_files_to_write(edits, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for target in (tmp_path / "pipe", "/dev/null"):
        with pytest.raises(ProtectedFile, match=r"is a (pipe|device)"), overwriting():
            write_text(target, "text", edits=edits)
    assert Path("/dev/null").is_char_device()


FOREIGN = {
    "session.toml": b"# A session, as 'mbkf app' and 'mbkf batch' read it.\nmass_kg = 70\n",
    "notes.toml": b"# for mbkf\nmass_kg = 70\n",
    "walk.trc": b"PathFileType\t4\t(X/Y/Z)\twalk.trc\nDataRate\tCameraRate\n100.00\t100.00\t1\t1\tmm\n",
    "forces.mot": b"forces\nversion=1\nnRows=1\nnColumns=2\ninDegrees=no\nendheader\ntime\ta\n0\t1\n",
    "imus.csv": b"time [s],pelvis acc_x [m/s^2]\n0,1\n",
    "plain.json": b'{"name": "walk", "written": "by hand"}',
    "page.html": b"<!DOCTYPE html>\n<html><title>Gait of mbkf</title></html>",
    "walk.bvh": b"HIERARCHY\nROOT hips\n{\n",
    "walk.c3d": b"\x02P" + bytes(600) + b"MANUFACTURER" + b"Qualisys",
    "raw.h5": b"\x89HDF\r\n\x1a\n" + bytes(300),
    "a.gif": b"GIF89a" + bytes(40),
    "a.parquet": b"PAR1" + bytes(40) + b"PAR1",
    "a.glb": b"glTF" + struct.pack("<IIII", 2, 50, 30, 0x4E4F534A) + b'{"asset":{"generator":"Blender"}}',
    "a.xml": b'<?xml version="1.0"?>\n<mujoco model="a"/>',
    "text.txt": b"written by mbkf is a text that anyone may write into the middle of a file",
}


@pytest.mark.parametrize("name", FOREIGN)
def test_files_of_others_are_not_taken_for_our_own(name, tmp_path):
    (tmp_path / name).write_bytes(FOREIGN[name])
    assert form_of(tmp_path / name) is None


EARLIER = {
    "subject.toml": b"# A scaled subject, written by mbkf. Lengths in m, mass in kg\nbody = 'x'\n",
    "preset.toml": b"# Settings of a filter of mbkf; use them with 'mbkf reconstruct --preset'.\nname = 'x'\n",
    "norms.toml": b"# Reference bands of a laboratory.\nformat = 'x'\n",
    "motion.h5": b"mbkf: 9000 bytes after this block, CRC-32 01234567\nrun 00\n",
    "ik.mot": b"Coordinates\nversion=1\nnRows=1\nnColumns=2\ninDegrees=no\nRun="
    + b"0f" * 16
    + b"\nendheader\n",
    "summary.json": b'{\n  "run_id": "' + b"0f" * 16 + b'",\n  "trial": "walk"\n}\n',
    "markers.trc": b"PathFileType\t4\t(X/Y/Z)\tmarkers.trc\nDataRate\n100.0\t100.0\t1\t1\tmm\t100.0\t1\t1\n"
    b"Frame#\tTime\ta\n\t\tX1\tY1\tZ1\n\n1\t0.00000000\t1.000000\t2.000000\t3.000000\n",
    "strides.csv": b"foot,stride,start_s,end_s,length_m\n",
    "report.html": b"<!DOCTYPE html>\n<html><title>walk</title><body>\n<nav><b>mbkf</b></nav>",
    "live.json": b"{}\n" + b" " * 1000,
    "runs.json": b'{\n "P1": {\n  "state": "running",\n  "trials": {}}}',
    "empty": b"",
}


@pytest.mark.parametrize("name", EARLIER)
def test_files_of_earlier_versions_are_known(name, tmp_path):
    (tmp_path / name).write_bytes(EARLIER[name])
    assert form_of(tmp_path / name) is not None


def test_the_permission_ends_with_its_block(monkeypatch):
    from mbkf.io.written import overwrite_permitted

    with overwriting(), overwriting(False):
        assert overwrite_permitted()
    assert not overwrite_permitted()
    assert MARK in OURS


REPORT = '<!DOCTYPE html>\n<meta name="generator" content="mbkf 1">'


def test_a_file_of_ours_in_another_format_is_replaced_with_leave_only(tmp_path):
    target = tmp_path / "report.html"
    target.write_text(REPORT)
    check_file(target, form=PAGE)
    with pytest.raises(ProtectedFile, match=r"holds a page \(HTML\) that mbkf wrote, not settings \(TOML\)"):
        check_file(target, form=SETTINGS)
    with pytest.raises(ProtectedFile, match="page"):
        write_text(target, OURS + "mass_kg = 70\n")
    with pytest.raises(ProtectedFile, match="page"), replacing_folder(tmp_path) as partial:
        (partial / target.name).write_text(OURS + "mass_kg = 70\n")
    assert target.read_text() == REPORT
    write_text(target, REPORT + "2")
    assert target.read_text() == REPORT + "2"
    with overwriting():
        write_text(target, OURS + "mass_kg = 70\n")
    assert target.read_text() == OURS + "mass_kg = 70\n"


def test_settings_and_tables_are_told_apart_by_what_follows_the_heading(tmp_path):
    for text, suffix in ((OURS + "\n[[curve]]\n", ".toml"), (OURS + "\n# a = 1\na,b = c\n", ".csv")):
        (tmp_path / "file").write_text(text)
        assert form_of(tmp_path / "file") == FORM_OF_SUFFIX[suffix]


@pytest.mark.parametrize("name", EARLIER)
def test_the_format_of_a_file_of_ours_is_that_of_its_suffix(name, tmp_path):
    (tmp_path / name).write_bytes(EARLIER[name])
    assert form_of(tmp_path / name) == FORM_OF_SUFFIX.get(Path(name).suffix, form_of(tmp_path / name))


def test_an_output_that_is_not_ours_is_not_removed(tmp_path, task):
    target = tmp_path / "subject.json"
    remove_file(target)
    target.write_text("a photo")
    with pytest.raises(ProtectedFile, match="not written by mbkf"):
        remove_file(target)
    assert target.read_text() == "a photo"
    target.write_text("")
    remove_file(target)
    assert not target.exists()
