"""Lines of entries, and mistakes of syntax in words that say how to mend them."""

import pytest

from mbkf.io.plain_data import parse_toml
from mbkf.io.toml_lines import TomlMistake, line_of

TEXT = """\
# a = 1
a = 1
"b c".d = 2
long = '''
a = 9
[[list]]
'''
[table]   # with a comment
a = 1
[table."in.ner"]
x = 1
[[list]]
a = 1
[[list]]
a = 2
[list.sub]
a = 3
[[list.deep]]
a = 4
"""


@pytest.mark.parametrize(
    ("place", "line"),
    [
        (("a",), 2),
        (("b c", "d"), 3),
        (("b c",), 3),
        (("table",), 8),
        (("table", "a"), 9),
        (("table", "in.ner", "x"), 11),
        (("list", 0, "a"), 13),
        (("list", 1), 14),
        (("list", 1, "a"), 15),
        (("list", 1, "sub", "a"), 17),
        (("list", 1, "deep", 0, "a"), 19),
        (("list", 2), None),
        (("nothing",), None),
    ],
)
def test_an_entry_is_found_on_its_line(place, line):
    assert line_of(TEXT, place) == line


@pytest.mark.parametrize(
    ("text", "line", "advice"),
    [
        ("a = 1\nmass_kg = 71,9", 2, "decimals have a point, write mass_kg = 71.9"),
        ("mass_kg = 71.9 kg # by plates", 1, "a number stands without its unit, write mass_kg = 71.9"),
        ("sex = female", 1, 'a text stands in quotation marks, write sex = "female"'),
        ("sex = \u201cfemale\u201d", 1, "quotation marks must be straight"),
        ("mass kg = 71.9", 1, "an entry's name has no spaces"),
        ("mass_kg: 71.9", 1, "an entry has an equals sign, write mass_kg = …"),
        ("a = 1\na = 2", 2, "this entry stands above already; keep one of them"),
        ("[t]\n[t]", 2, "this entry stands above already; keep one of them"),
        ('p = "C:\\x"', 1, "a backslash is not possible in a text, write / instead"),
        ("a = [1, 2", 1, "'a = [1, 2': "),
        ("a = 1\n]", 2, "']': "),
        ("a = '\u2028\x85'\nb = 1,5", 2, "write b = 1.5"),
        ("a = b" + " " * 100_000 + "c", 1, "'a = b"),
    ],
)
def test_a_mistake_is_said_with_its_line_and_mend(text, line, advice):
    with pytest.raises(TomlMistake) as caught:
        parse_toml(text)
    assert caught.value.line == line and advice in caught.value.reason
    assert str(caught.value) == f"line {line}, {caught.value.reason}"
