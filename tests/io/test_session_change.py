"""Changes of a session file by several writers: none is lost, whoever writes between."""

import multiprocessing
from dataclasses import replace

import pytest

from mbkf.errors import FileFormatError
from mbkf.io import session_change as module
from mbkf.io.session import SessionNotes, TrialNotes, read_session, write_session
from mbkf.io.session_change import change_session, current_session, session_version

EMPTY = SessionNotes()


@pytest.fixture
def file(tmp_path):
    return tmp_path / "session.toml"


def test_versions_follow_the_content(file):
    one = SessionNotes(name="A", trials={"walk1": TrialNotes(excluded="fell"), "walk2": TrialNotes()})
    same = SessionNotes(name="A", trials={"walk1": TrialNotes(excluded="fell")})
    assert session_version(one) == session_version(same) != session_version(EMPTY)
    write_session(one, file)
    assert session_version(current_session(file)) == session_version(one)
    assert current_session(file.with_name("none.toml")) == EMPTY


def test_changes_of_different_fields_are_merged(file):
    first = change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    second = change_session(file, EMPTY, SessionNotes(trials={"walk1": TrialNotes(excluded="fell")}))
    assert first.differences == second.differences == ()
    assert read_session(file) == second.notes
    assert second.notes == SessionNotes(mass_kg=70.0, trials={"walk1": TrialNotes(excluded="fell")})


def test_a_field_that_was_changed_twice_is_reported(file):
    change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    found = change_session(file, EMPTY, SessionNotes(mass_kg=71.0, age=30.0))
    (difference,) = found.differences
    assert (difference.field, difference.mine, difference.theirs) == (("mass_kg",), 71.0, 70.0)
    assert read_session(file) == SessionNotes(mass_kg=70.0, age=30.0)


def test_an_editor_that_writes_between_reading_and_writing_loses_nothing(file, monkeypatch):
    original, writes = module.flush, []

    def flush(path):
        if len(writes) < 3:  # a person saves the file by hand at the worst moment, three times
            writes.append(path)
            file.write_text(f"age = {30 + len(writes)}\n", encoding="utf-8")
        original(path)

    monkeypatch.setattr(module, "flush", flush)
    found = change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    assert found.notes == read_session(file) == SessionNotes(mass_kg=70.0, age=33.0)
    assert [path.name for path in file.parent.iterdir()] == ["session.toml"]


def test_an_endless_writer_is_reported(file, monkeypatch):
    count = iter(range(1000))
    monkeypatch.setattr(
        module, "flush", lambda _: file.write_text(f"age = {next(count)}\n", encoding="utf-8")
    )
    with pytest.raises(FileFormatError, match="again and again"):
        change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    assert read_session(file).mass_kg is None


@pytest.mark.parametrize("text", ["mass_kg = 'x'", "name = ", "\udcff"])
def test_a_damaged_file_is_left_as_it_is(file, text):
    file.write_text(text, encoding="utf-8", errors="surrogateescape")
    before = file.read_bytes()
    with pytest.raises(FileFormatError):
        change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    assert file.read_bytes() == before


def test_a_change_that_is_there_already_writes_nothing(file):
    file.write_text("# by hand\nmass_kg = 70.0\n", encoding="utf-8")
    change_session(file, EMPTY, SessionNotes(mass_kg=70.0))
    assert file.read_text(encoding="utf-8").startswith("# by hand")


def _exclude(file, k):
    for number in range(5):
        change_session(file, EMPTY, SessionNotes(trials={f"t{k}_{number}": TrialNotes(excluded="fell")}))


def test_processes_write_one_after_the_other(file):
    start = multiprocessing.get_context("spawn")
    workers = [start.Process(target=_exclude, args=(file, k)) for k in range(3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(read_session(file).trials) == 15
    assert replace(read_session(file), trials={}) == EMPTY


def test_comments_of_people_outlive_a_change(file):
    file.write_text('# after the operation\nname = "Anna"  # as in the record\nmass_kg = 70.0\n', "utf-8")
    change_session(file, current_session(file), SessionNotes(name="Anna", mass_kg=71.0))
    assert file.read_text("utf-8") == (
        '# after the operation\nname = "Anna"  # as in the record\nmass_kg = 71.0\n'
    )
