"""What a result was made from: contents count, names and times do not."""

import pytest

from mbkf.errors import FileFormatError
from mbkf.study.batch.inputs import fingerprint, is_made_from, read_record, write_record


@pytest.fixture
def files(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).write_text(name)
    return [tmp_path / "a", tmp_path / "b"]


def test_a_record_is_read_back(files, tmp_path):
    made_from = fingerprint(files, {"filter": "dynamic", "sizes": (1, 2)})
    write_record(tmp_path / "record.json", made_from)
    assert is_made_from(tmp_path / "record.json", made_from)


def test_any_change_of_contents_settings_or_order_is_seen_and_another_name_is_not(files, tmp_path):
    made_from = fingerprint(files, {"filter": "dynamic"})
    write_record(tmp_path / "record.json", made_from)
    assert not is_made_from(tmp_path / "record.json", fingerprint(files, {"filter": "kinematic"}))
    assert not is_made_from(tmp_path / "record.json", fingerprint(files[::-1], {"filter": "dynamic"}))
    assert not is_made_from(tmp_path / "record.json", fingerprint(files[:1], {"filter": "dynamic"}))
    moved = files[1].rename(tmp_path / "elsewhere")
    assert is_made_from(tmp_path / "record.json", fingerprint([files[0], moved], {"filter": "dynamic"}))
    moved.write_text("c")
    assert not is_made_from(tmp_path / "record.json", fingerprint([files[0], moved], {"filter": "dynamic"}))


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"files": 3, "settings": {}, "version": "x"}'])
def test_a_damaged_record_says_nothing(files, tmp_path, text):
    (tmp_path / "record.json").write_text(text)
    assert not is_made_from(tmp_path / "record.json", fingerprint(files, {}))
    assert not is_made_from(tmp_path / "missing.json", fingerprint(files, {}))


def test_a_missing_input_is_told(tmp_path):
    with pytest.raises(FileNotFoundError):
        fingerprint([tmp_path / "missing"], {})


def test_a_record_is_told_or_said_to_be_damaged(files, tmp_path):
    made_from = {**fingerprint(files, {}), "events": [{"side": "right", "kind": "off", "time_s": 0.1}]}
    write_record(tmp_path / "record.json", made_from)
    assert read_record(tmp_path / "record.json") == made_from
    assert is_made_from(tmp_path / "record.json", fingerprint(files, {})), (
        "events are not what a result is made from"
    )
    (tmp_path / "record.json").write_text("{")
    with pytest.raises(FileFormatError, match="run the batch again"):
        read_record(tmp_path / "record.json")
