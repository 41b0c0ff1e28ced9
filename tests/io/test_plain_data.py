"""Tables of plain data are read as they are, and refused where they are too large, too deep or beyond 64 bits."""

import pytest

from mbkf.errors import FileFormatError
from mbkf.io import plain_data
from mbkf.io.plain_data import MOST_PARTS, parse_json, parse_toml, read_toml

DEEP = 20_000


def test_toml_is_read_with_any_end_of_line_and_mark(tmp_path):
    path = tmp_path / "a.toml"
    for content in (b"a = 1\nb = [2.5]\n", b"\xef\xbb\xbfa = 1\r\nb = [2.5]\r\n"):
        path.write_bytes(content)
        assert read_toml(path) == {"a": 1, "b": [2.5]}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a = " + "[" * DEEP, "nested too deep"),
        ("a = " + "{a=" * DEEP, "nested too deep"),
        (".".join("a" * DEEP) + " = 1", "parts between dots"),
        ("\n[" + " . ".join(['"a"'] * DEEP) + "]", r"parts between dots \(at line 2\)"),
        (f"a = [1, {{b = {2**63}}}]", "64 bits"),
        (f"a = -{10**400}", "64 bits"),
        ("a = " + "9" * 5000, "4300"),
        ("a = ]", "line 1"),
    ],
)
def test_toml_bombs_are_refused(text, reason):
    with pytest.raises(ValueError, match=reason):
        parse_toml(text)


def test_the_most_that_is_allowed_is_read():
    assert parse_toml(f"a = [{2**63 - 1}, {-(2**63)}]") == {"a": [2**63 - 1, -(2**63)]}
    found = parse_toml(".".join("a" * MOST_PARTS) + " = 1")
    for _ in range(MOST_PARTS):
        found = found["a"]
    assert found == 1
    assert parse_toml('a = "One. Two. Three. ' + "1.0, " * 100 + '"')["a"].startswith("One. Two.")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[" * DEEP, "nested too deep"),
        ('{"a": ' * DEEP, "nested too deep"),
        ("[1, 2]", "no table"),
        (f'{{"a": [{2**63}]}}', "64 bits"),
        ("", "Expecting value"),
    ],
)
def test_json_bombs_are_refused(text, reason):
    with pytest.raises(ValueError, match=reason):
        parse_json(text)


def test_json_is_read():
    assert parse_json('{"a": [1, null, "x"]}') == {"a": [1, None, "x"]}


def test_large_files_and_other_encodings_are_refused(tmp_path, monkeypatch):
    path = tmp_path / "a.toml"
    path.write_bytes("a = 1".encode("utf-16"))
    with pytest.raises(UnicodeError, match="UTF-16"):
        read_toml(path)
    monkeypatch.setattr(plain_data, "SETTINGS_BYTES", 4)
    path.write_text("a = 1")
    with pytest.raises(FileFormatError, match="larger than"):
        read_toml(path)
