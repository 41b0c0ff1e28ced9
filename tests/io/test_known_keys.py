"""Keys of nested tables: known ones and remarks pass, others are refused with their line."""

from pathlib import Path

import pytest

from mbkf.errors import UnknownEntry
from mbkf.io.known_keys import refuse_unknown
from mbkf.io.plain_data import parse_toml

KNOWN = {"": ("name", "part", "free"), "part": ("size", "inner"), "part.inner": ("depth",)}
TEXT = "name = 1\n[[part]]\nsize = 1\nsize_source = 2\n[[part]]\n[part.inner]\ndepth = 3\n[free]\nany = 4\n"


def check(text):
    refuse_unknown(parse_toml(text), KNOWN, Path("a.toml"), text, ("_source",))


def test_known_keys_remarks_and_tables_that_are_not_listed_pass():
    check(TEXT)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name", "nam", "a.toml, line 1: unknown entry 'nam'; did you mean name"),
        ("size =", "sise =", "a.toml, line 3: unknown part entry 'sise'; did you mean size"),
        ("depth", "Depth_", "a.toml, line 7: unknown part.inner entry 'Depth_'; did you mean depth"),
        ("[free]", "[fre]", "a.toml, line 8: unknown entry 'fre'; did you mean free"),
    ],
)
def test_another_key_is_refused_with_its_line(old, new, message):
    with pytest.raises(UnknownEntry) as caught:
        check(TEXT.replace(old, new, 1))
    assert str(caught.value) == message
