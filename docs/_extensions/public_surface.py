"""The directive ``public-surface``: names of one topic of ``mbkf.__all__`` with their docstrings, in reading order."""

from __future__ import annotations

import inspect
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import mbkf

TOPICS: dict[str, tuple[str, ...]] = {
    "captures": (
        "read_capture", "Capture", "MarkerTrajectories", "PlateReadings", "plate_wrenches", "overwriting",
        "register_reader", "register_force_reader", "CaptureOptions",
    ),
    "scaling": ("scale", "read_subject", "write_subject", "estimate_inertia", "InertiaEstimate"),
    "reconstruction": (
        "reconstruct", "ReconstructSettings", "Hidden", "summarise", "read_reconstruction", "write_reconstruction",
        "export_result", "export_onto",
    ),
    "filters": (
        "Tracker", "Estimate", "standard_blocks", "Filter", "Plant", "Block", "Rows", "Frame", "OperatingPoint",
        "Notes", "Layout", "ExtraState", "Information",
    ),
    "labelling": ("label", "load_protocol"),
    "inertial": ("read_imu", "ImuReadings", "orient", "register_imu_reader"),
    "body": ("HumanModel", "load_body", "ClinicalAngles", "casadi_dynamics", "CasadiDynamics"),
    "studies": ("batch", "synthesise"),
    "viewing": ("show", "play"),
    "errors": ("MbkfError",),
}  # fmt: skip
"""Public names by the page of ``docs/api`` that explains them."""


class PublicSurface(SphinxDirective):
    """Writes one section per public name of a topic."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The sections."""
        found: list[nodes.Node] = []
        for name in TOPICS[self.arguments[0]]:
            found += self.parse_text_to_nodes(_section(name), allow_section_headings=True)
        return found


def _section(name: str) -> str:
    """A heading and the autodoc directive that fits the object."""
    value = getattr(mbkf, name)
    if inspect.isclass(value):
        directive, options = "autoclass", "   :members:\n"
    elif inspect.isroutine(value):
        directive, options = "autofunction", ""
    else:
        directive, options = "autodata", "   :no-value:\n"
    return f"{name}\n{'-' * len(name)}\n\n.. {directive}:: mbkf.{name}\n{options}"


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive."""
    app.add_directive("public-surface", PublicSurface)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
