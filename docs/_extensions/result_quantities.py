"""The directives ``result-quantities`` and ``result-attributes``: tables of a result's declared quantities."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from mbkf.io.dimensions import AXES
from mbkf.io.quantities import Quantity, attributes, quantities
from mbkf.io.quantities_h5 import PLAIN
from mbkf.io.result_groups import GROUPS
from mbkf.io.results import QUANTITIES

TITLES = {
    "Provenance": "trial",
    "Measurements": "markers and plates",
    "Estimates": "estimates of the filter",
    "Motion": "clinical motion",
    "Torques": "generalised forces",
    "Moments": "moments",
    "Reactions": "feet",
    "SupportLoads": "other parts that may bear load",
    "TrunkMoments": "moments of the trunk",
    "Muscles": "electromyograms",
    "Quality": "frames that count",
}
"""Headings of the groups."""

NAMES = re.compile(rf"\b({'|'.join(name for name in QUANTITIES if '_' in name or name == 'nis')})\b")
"""Names that are no English words."""


class ResultQuantities(SphinxDirective):
    """Datasets with shape, unit and meaning; standard deviations and offsets beside their array."""

    def run(self) -> list[nodes.Node]:
        """The table."""
        for module in ("estimates", "quantities", "result_groups"):
            self.env.note_dependency(f"../mbkf/io/{module}.py")
        return self.parse_text_to_nodes("\n".join(self.rows()))

    def rows(self) -> list[str]:
        """Lines of the table."""
        return ["| dataset | shape | unit | meaning |", "|---|---|---|---|", *quantity_rows()]


class ResultAttributes(ResultQuantities):
    """Attributes of the file with their meaning."""

    def rows(self) -> list[str]:
        """Lines of the table."""
        return ["| attribute | meaning |", "|---|---|", *attribute_rows()]


def quantity_rows() -> Iterator[str]:
    """Lines of the table of datasets, by group."""
    for group in GROUPS:
        yield f"| *{TITLES[group.__name__]}* | | | |"
        for one in quantities(group).values():
            if one.written and not _beside(one):
                yield _row(one)


def attribute_rows() -> Iterator[str]:
    """Lines of the table of attributes."""
    for group in GROUPS:
        for one in attributes(group):
            kept = "" if one.read in PLAIN else " (JSON)"
            yield f"| `{one.name}` | {_worded(one.meaning)}{kept} |"


def _beside(one: Quantity) -> bool:
    """True for a spread or a part of one that stands in the row of its array."""
    total = QUANTITIES.get(one.beside)
    return total is not None and total.axes == one.axes


def _row(one: Quantity) -> str:
    named = [one]
    for each in named:
        named += _beside_it(each)
    names = [f"`{each.key}`" for each in named]
    if one.key != one.name:
        names.append(f"(in Python `{one.name}`)")
    shape = ", ".join(AXES[axis].symbol for axis in one.axes)
    meaning = _worded(one.meaning)
    if one.codes:
        meaning += ": " + ", ".join(f"{code} {word.replace('_', ' ')}" for code, word in one.codes.items())
    if one.section:
        meaning += f" ({{ref}}`more <{one.section}>`)"
    unit = "" if one.is_text or one.unit.text == "1" else one.unit.text.replace("*", "\\*")
    return f"| {' '.join(names)} | {f'${shape}$' if shape else ''} | {unit} | {meaning} |"


def _beside_it(one: Quantity) -> list[Quantity]:
    """The spread of an array, or the parts of a spread, that stand in its row."""
    return [other for other in QUANTITIES.values() if other.beside == one.name and other.axes == one.axes]


def _worded(meaning: str) -> str:
    """A meaning with the names of datasets in it marked."""
    return NAMES.sub(lambda match: f"`{QUANTITIES[match[1]].key}`", meaning)


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directives."""
    app.add_directive("result-quantities", ResultQuantities)
    app.add_directive("result-attributes", ResultAttributes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
