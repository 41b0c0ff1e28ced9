"""XML with the faults of daily use: lost end tags, bare ampersands, wrong encodings and odd comments are read over.

For files that hold either text or elements in an element, never both, as OpenSim's do. Nothing outside the file is
ever read and no entity is expanded but the five of XML and numbered characters, so a file cannot make this reader
fetch, execute or swell anything.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes

_TOKEN = re.compile(
    r"<!--.*?(?:-->|\Z)|<!\[CDATA\[(?P<raw>.*?)(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)"
    r"|<!DOCTYPE[^\[>]*(?:\[[^\]]*\]?\s*)?>?"
    r"|</\s*(?P<end>[\w.:-]+)[^<>]*>?"
    r"|<(?P<start>[A-Za-z_][\w.:-]*+)(?P<attributes>[^<>]*)>"
    r"|(?P<text>[^<]+|<)",
    re.DOTALL | re.IGNORECASE,
)
_ATTRIBUTE = re.compile(r"(?<![\w.:-])([\w.:-]++)\s*+=\s*(?:\"([^\"]*)\"|'([^']*)'|[\"']?([^\s\"']+))")
MOST_DEPTH = 200
"""Depth of nesting; deeper elements count as side by side."""

_CHARACTER = re.compile(r"&(?:#(\d{1,7})|#x([0-9a-fA-F]{1,6})|(amp|lt|gt|quot|apos));")
_NAMED = {"amp": "&", "lt": "<", "gt": ">", "quot": '"', "apos": "'"}
_DECLARED = re.compile(rb"<\?xml[^>]*encoding\s*=\s*[\"']([\w.-]+)[\"']", re.IGNORECASE)
_MARKS = (
    (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"),
)  # fmt: skip


@dataclass
class Element:
    """An element of a file.

    Attributes:
        tag: Its name.
        attributes: Its attributes.
        text: Its own text, without white space around it.
        children: The elements in it, in their order.
    """

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    text: str = ""
    children: list[Element] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Its attribute ``name``, "" where it has none."""
        return self.attributes.get("name", "").strip()

    def every(self, *tags: str) -> Iterator[Element]:
        """The elements below it of these names, in the order of the file."""
        waiting = list(reversed(self.children))
        while waiting:
            one = waiting.pop()
            if one.tag in tags:
                yield one
            waiting.extend(reversed(one.children))

    def child(self, *tags: str) -> Element | None:
        """Its first own child of one of these names; names that come first are preferred."""
        return next((one for tag in tags for one in self.children if one.tag == tag), None)

    def child_text(self, *tags: str) -> str:
        """The text of that child, "" without one."""
        found = self.child(*tags)
        return "" if found is None else found.text


def read_loose_xml(path: str | Path, never_nested: frozenset[str] = frozenset()) -> Element:
    """The elements of a file, below one that stands for the file itself.

    A second element of a ``never_nested`` name within one of that name ends the first.

    Raises:
        FileFormatError: The file does not exist, or no element in it.
    """
    path = Path(path)
    root = parse_loose_xml(xml_text(path), never_nested)
    if not root.children:
        raise FileFormatError(path, "not XML: it holds no element")
    return root


def xml_text(path: str | Path) -> str:
    """The characters of a file in UTF-8, UTF-16 or the encoding that it declares, without a byte order mark.

    Raises:
        FileFormatError: The file does not exist.
    """
    check_input(path, "name an OpenSim model (.osim) or a marker set (.xml)")
    return _decoded(read_bytes(path))


def parse_loose_xml(text: str, never_nested: frozenset[str] = frozenset()) -> Element:
    """The elements of a text, below one that stands for the text itself, as of :func:`read_loose_xml`."""
    root = Element("")
    open_: list[Element] = [root]
    pieces: list[str] = []
    for token in _TOKEN.finditer(text):
        if token["start"] or token["end"]:
            _give_text(open_, pieces)
        if token["start"]:
            _open(open_, token["start"], never_nested)
            pairs = _ATTRIBUTE.findall(token["attributes"])
            made = Element(token["start"], {key: _plain("".join(values)) for key, *values in pairs})
            open_[-1].children.append(made)
            if not token["attributes"].endswith("/") and len(open_) <= MOST_DEPTH:
                open_.append(made)
        elif token["end"]:
            _close(open_, token["end"])
        elif token["text"] or token["raw"]:
            pieces.append(token["raw"] or _plain(token["text"]))
    _give_text(open_, pieces)
    waiting = [root]
    while waiting:
        one = waiting.pop()
        one.text = one.text.strip()
        waiting.extend(one.children)
    return root


def _give_text(open_: list[Element], pieces: list[str]) -> None:
    """Gives the innermost element its pieces of text; between elements there is white space only."""
    text = "".join(pieces)
    pieces.clear()
    if len(open_) > 1 and (open_[-1].text or text.strip()):
        open_[-1].text += text


def _open(open_: list[Element], tag: str, never_nested: frozenset[str]) -> None:
    """Ends what must have ended before this element starts."""
    while len(open_) > 1 and open_[-1].text.strip():
        open_.pop()
    if tag in never_nested:
        depth = next((k for k, one in enumerate(open_) if one.tag == tag), None)
        if depth is not None:
            del open_[depth:]


def _close(open_: list[Element], tag: str) -> None:
    """Ends the innermost element of that name with all in it; an end without a start is passed over."""
    for depth in range(len(open_) - 1, 0, -1):
        if open_[depth].tag == tag:
            del open_[depth:]
            return


def _plain(text: str) -> str:
    return _CHARACTER.sub(_character, text)


def _character(found: re.Match[str]) -> str:
    decimal, hexadecimal, named = found.groups()
    if named:
        return _NAMED[named]
    code = int(decimal) if decimal else int(hexadecimal, 16)
    return chr(code) if code < 0x110000 and not 0xD800 <= code < 0xE000 else "\ufffd"


def _decoded(data: bytes) -> str:
    """Text of bytes: by their mark, as UTF-8, as declared, or byte by byte."""
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data[len(mark) :].decode(encoding, "replace")
    if data[:2] in (b"<\0", b"\0<"):
        return data.decode("utf-16-le" if data[0] else "utf-16-be", "replace")
    declared = _DECLARED.search(data[:200])
    for encoding in ("utf-8", declared[1].decode("ascii") if declared else "cp1252", "cp1252"):
        try:
            return data.decode(encoding)
        except (UnicodeDecodeError, LookupError):
            continue
    return data.decode("latin-1")
