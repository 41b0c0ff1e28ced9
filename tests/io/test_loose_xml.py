"""XML that is right is read as any reader reads it; damaged XML is read all the same; nothing else is ever read."""

import time
import xml.etree.ElementTree as ET
from xml.sax.saxutils import escape, quoteattr

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.loose_xml import MOST_DEPTH, parse_loose_xml, read_loose_xml

tags = st.sampled_from(["a", "b", "c", "Marker", "x.y", "x-y"])
words = st.text(st.characters(min_codepoint=32, exclude_categories=["Cs", "Cc"])).map(str.strip)


@st.composite
def trees(draw, depth=3):
    inside = "".join(draw(st.lists(trees(depth=depth - 1), max_size=3))) if depth else ""
    content = inside or escape(draw(words))
    tag = draw(tags)
    comment = draw(st.sampled_from(["", "<!-- said -->", "<?pi?>"]))
    return (
        f"<{tag} name={quoteattr(draw(words).replace('>', '').replace('<', ''))}>{comment}{content}</{tag}>"
    )


def same(one, other):
    assert one.tag == other.tag
    assert one.attributes == other.attrib
    assert one.text == (other.text or "").strip() or other.text is None or len(other)
    assert len(one.children) == len(other)
    for a, b in zip(one.children, other, strict=True):
        same(a, b)


@given(trees())
def test_what_is_right_is_read_as_by_any_reader(text):
    (root,) = parse_loose_xml(text).children
    same(root, ET.fromstring(text.replace("<?pi?>", "").replace("<!-- said -->", "")))


@given(st.text())
def test_anything_is_read_without_a_failure(text):
    parse_loose_xml(text)


def leaves(text, *never_nested):
    root = parse_loose_xml(text, frozenset(never_nested))
    return [
        (marker.name, marker.child_text("body"), marker.child_text("location"))
        for marker in root.every("Marker")
    ]


WHOLE = [("A", "pelvis", "1 2 3"), ("B", "femur_r", "4 5 6")]


@pytest.mark.parametrize(
    "text",
    [
        "<M><Marker name='A'><body>pelvis</body><location>1 2 3</location></Marker>"
        "<Marker name='B'><body>femur_r</body><location>4 5 6</location></Marker></M>",
        # ends are lost: of a text, of an element, of all
        "<M><Marker name='A'><body>pelvis<location>1 2 3</Marker>"
        "<Marker name='B'><body>femur_r</body><location>4 5 6</location></Marker></M>",
        "<M><Marker name='A'><body>pelvis</body><location>1 2 3</location>"
        "<Marker name='B'><body>femur_r</body><location>4 5 6</location></M>",
        "<M><Marker name='A'><body>pelvis</body><location>1 2 3</location></Marker>"
        "<Marker name='B'><body>femur_r</body><location>4 5 6",
        # ends that nothing began, quotes that are lost, a comment with dashes, one before the file's head
        "</x><M><Marker name=A></y><body>pelvis</body><location>1 2 3</location></Marker>"
        '<!-- a -- b --><Marker name="B><body>femur_r</body><location>4 5 6</location></Marker></M>',
        "<!-- made by hand --><?xml version='1.0'?><!DOCTYPE M [<!ENTITY x 'y'>]>"
        "<M><Marker name='A'><body> pelvis </body><location><![CDATA[1 2 3]]></location></Marker>"
        "<Marker name='B'><body>femur_r</body><location>4 5 6</location></Marker></M>",
    ],
)
def test_damage_is_borne(text):
    assert leaves(text, "Marker") == WHOLE


def test_characters_and_bare_ampersands():
    (root,) = parse_loose_xml(
        "<a name='R&amp;D &#65;&#x42; &lt;&unknown; &'>AT&T &amp; &#xD800;&#1114112;</a>"
    ).children
    assert root.name == "R&D AB <&unknown; &"
    assert root.text == "AT&T & \ufffd\ufffd"


def test_no_entity_is_expanded_and_no_file_read(tmp_path):
    (tmp_path / "secret").write_text("secret", encoding="utf-8")
    bomb = "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(9))
    text = (
        f'<!DOCTYPE a [<!ENTITY e0 "x">{bomb}<!ENTITY out SYSTEM "{(tmp_path / "secret").as_uri()}">]>'
        "<a>&e9; &out;</a>"
    )
    (root,) = parse_loose_xml(text).children
    assert root.text == "&e9; &out;"


def test_a_long_file_takes_no_long_time():
    begun = time.perf_counter()
    for text in (
        "<" * 100_000,
        "<" + "a" * 200_000,
        "<a " * 50_000,
        "<a>" * 50_000,
        '<a b="' * 50_000,
        "<!--" * 50_000,
        "<!DOCTYPE [" * 500,
    ):
        parse_loose_xml(text)
    assert time.perf_counter() - begun < 20.0


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1", "cp1252"]
)
def test_encodings_are_found(encoding, tmp_path):
    """Also where the head of the file claims UTF-8 and is wrong."""
    path = tmp_path / "a.xml"
    path.write_bytes('<?xml version="1.0" encoding="UTF-8"?><a name="Müller"/>'.encode(encoding))
    assert read_loose_xml(path).children[0].name == "Müller"


@pytest.mark.parametrize("content", [b"", b"name,x,y\n1,2,3\n", bytes(range(256)).replace(b"<", b"")])
def test_what_is_no_xml_is_refused(content, tmp_path):
    (tmp_path / "a.osim").write_bytes(content)
    with pytest.raises(FileFormatError, match="not XML"):
        read_loose_xml(tmp_path / "a.osim")
    with pytest.raises(FileFormatError, match="no such file"):
        read_loose_xml(tmp_path / "b.osim")


@pytest.mark.parametrize(
    "bomb",
    [
        200_000 * "<",
        100_000 * "<a>" + 100_000 * "</b>",
        20_000 * "<!DOCTYPE[",
        20_000 * "<!DOCTYPE a[]",
        f"<a {400_000 * 'x'}>",
        50_000 * "x<b/>",
        50_000 * "<a",
        50_000 * "<![CDATA[x]]>",
    ],
    ids=["brackets", "ends", "types", "closed types", "attribute", "texts", "starts", "raw"],
)
def test_what_costs_quadratic_time_elsewhere_is_read(bomb):
    root = parse_loose_xml(f"<all>{bomb}")
    assert root.children[0].tag == "all"


def test_depth_is_bounded():
    one, depth = parse_loose_xml(10 * MOST_DEPTH * "<a>"), 0
    while one.children:
        one, depth = one.children[0], depth + 1
    assert depth == MOST_DEPTH + 1
