"""The directive ``public-surface``: every name of ``mbkf.__all__`` with its docstring, by topic."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import mbkf

TOPICS: Mapping[str, tuple[str, ...]] = {
    "From a capture to a result": (
        "read_capture", "scale", "label", "reconstruct", "ReconstructSettings", "Hidden", "summarise", "batch",
        "orient", "synthesise",
    ),
    "Files": (
        "read_subject", "write_subject", "read_reconstruction", "write_reconstruction", "read_imu", "Capture",
        "MarkerTrajectories", "PlateReadings", "CaptureOptions", "ImuReadings", "overwriting",
    ),
    "Other programs and pictures": (
        "export_result", "export_onto", "casadi_dynamics", "CasadiDynamics", "show", "play",
    ),
    "Bodies and marker sets": (
        "load_body", "load_protocol", "HumanModel", "ClinicalAngles", "estimate_inertia", "InertiaEstimate",
    ),
    "Frame by frame": ("Tracker", "Estimate", "Filter", "standard_blocks", "plate_wrenches"),
    "Sensors, plants and readers of your own": (
        "Block", "Frame", "OperatingPoint", "Rows", "Notes", "Information", "Layout", "ExtraState", "Plant",
        "register_reader", "register_force_reader", "register_imu_reader",
    ),
    "Errors": ("MbkfError",),
}  # fmt: skip
"""Public names by the topic under which they stand."""


class PublicSurface(SphinxDirective):
    """Writes a section for each topic, and one inside it for each of its names."""

    def run(self) -> list[nodes.Node]:
        """The sections."""
        lines = [
            line for topic, names in TOPICS.items() for line in (*_heading(topic, "-"), *map(_section, names))
        ]
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def _heading(title: str, mark: str) -> tuple[str, ...]:
    return (title, mark * len(title), "")


def _section(name: str) -> str:
    """A heading and the autodoc directive that fits the object."""
    value = getattr(mbkf, name)
    if inspect.isclass(value):
        directive, options = "autoclass", "   :members:\n"
    elif inspect.isroutine(value):
        directive, options = "autofunction", ""
    else:
        directive, options = "autodata", "   :no-value:\n"
    return "\n".join([*_heading(name, "~"), f".. {directive}:: mbkf.{name}", options, ""])


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive."""
    app.add_directive("public-surface", PublicSurface)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
