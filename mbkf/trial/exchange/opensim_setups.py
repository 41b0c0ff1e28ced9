"""Loads and set-ups of OpenSim's tools, with paths inside the folder of a result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from xml.etree import ElementTree as ET

from mbkf.errors import InvalidInput
from mbkf.io.results import Reconstruction
from mbkf.io.results_opensim import REACTIONS_FILE, load_columns, opensim_table
from mbkf.io.storage import Table
from mbkf.io.written import MARK
from mbkf.model.osim import VERSION

MODEL, MOTION = "model.osim", "motion.mot"
LOADS_DATA, LOADS = "external_loads.mot", "ExternalLoads.xml"
ACTUATORS = "actuators.xml"
SETUP_ID, TORQUES_OUT = "setup_id.xml", "inverse_dynamics.sto"
"""Files of every folder, and the one that OpenSim's inverse dynamics writes."""

NAME = "mbkf"
"""Name of the tools, with which the files of analyses begin; the trial's may hold characters that OpenSim refuses."""


def loads_table(r: Reconstruction) -> Table:
    """The loads of a result whose places are known, as reactions.mot has them."""
    table = opensim_table(r, REACTIONS_FILE)
    names = tuple(name for part in _known_parts(r, table).values() for name in _columns(part))
    columns = table.columns[:, [table.names.index(name) for name in names]]
    return replace(table, names=names, columns=columns, title="External loads")


def _known_parts(r: Reconstruction, table: Table) -> dict[str, tuple[str, str, str]]:
    """Beginnings of the columns of each part whose load is known at any time."""
    return {
        part: begins for part, begins in load_columns(r).items() if set(_columns(begins)) <= set(table.names)
    }


def _columns(begins: tuple[str, str, str]) -> tuple[str, ...]:
    return tuple(f"{begin}{axis}" for begin in begins for axis in "xyz")


def common_span(motion: Table, loads: Table) -> tuple[float, float]:
    """First and last time of the motion at which the loads are known, too.

    Raises:
        InvalidInput: There are fewer than two frames with both.
    """
    known = motion.times_s
    if len(loads.times_s):
        known = known[(known >= loads.times_s[0]) & (known <= loads.times_s[-1])]
    if len(known) < 2 or not len(loads.names):
        raise InvalidInput(
            f"the body is followed in {len(motion.times_s)} frames and the loads on it are known in "
            f"{len(loads.times_s) if loads.names else 0}; OpenSim's tools need two frames with both: give force "
            "plates, or reconstruct by the dynamic filter"
        )
    return float(known[0]), float(known[-1])


def external_loads(r: Reconstruction, loads: Table, bodies: Mapping[str, str]) -> ET.Element:
    """Each load on its body, as ExternalLoads.

    Args:
        r: The result.
        loads: Its loads.
        bodies: Body of OpenSim's model by the part that bears load; the loads of other parts are left out.
    """
    root = ET.Element("ExternalLoads", name=NAME)
    root.append(ET.Comment(_sources(r, bodies)))
    objects = ET.SubElement(root, "objects")
    for part, begins in _known_parts(r, loads).items():
        if part not in bodies:
            continue
        one = ET.SubElement(objects, "ExternalForce", name=part)
        texts(
            one,
            applied_to_body=bodies[part],
            force_expressed_in_body="ground",
            point_expressed_in_body="ground",
            force_identifier=begins[0],
            point_identifier=begins[1],
            torque_identifier=begins[2],
        )
    texts(root, datafile=LOADS_DATA)
    return root


def _sources(r: Reconstruction, bodies: Mapping[str, str]) -> str:
    """A comment that states how each load is known, and lists the forces that the file leaves out."""
    lines = [f"{c.part}: {c.how} from {c.from_s:.3f} to {c.to_s:.3f} s" for c in r.contacts]
    lines += [
        f"{part}: the model has no such body, not applied" for part in r.loads.names if part not in bodies
    ]
    lines += [
        f"unexplained, not applied: {one.force_n:.0f} N {one.direction} from {one.from_s:.3f} to {one.to_s:.3f} s"
        for one in r.unexplained
    ]
    return "\n".join(
        ["", *lines, "Forces without a place act on no body here: pelvis_t*_force bears them.", ""]
    )


def inverse_dynamics(span: tuple[float, float]) -> ET.Element:
    """Set-up of the inverse dynamics tool between two times, s."""
    root = ET.Element("InverseDynamicsTool", name=NAME)
    texts(
        root,
        results_directory=".",
        model_file=MODEL,
        time_range=_times(span),
        forces_to_exclude="Muscles",
        external_loads_file=LOADS,
        coordinates_file=MOTION,
        lowpass_cutoff_frequency_for_coordinates="-1",
        output_gen_force_file=TORQUES_OUT,
    )
    return root


def actuators(motors: Mapping[str, tuple[str, float]]) -> ET.Element:
    """Motors without limits, each on a coordinate, as a ForceSet.

    Args:
        motors: Coordinate, and force or moment at control 1, by the motor's name.
    """
    root = ET.Element("ForceSet", name=NAME)
    objects = ET.SubElement(root, "objects")
    for name, (coordinate, force) in motors.items():
        motor = ET.SubElement(objects, "CoordinateActuator", name=name)
        texts(motor, coordinate=coordinate, optimal_force=f"{force:g}", min_control="-inf", max_control="inf")
    return root


def analysis(
    span: tuple[float, float], out: str, kinds: Mapping[str, Mapping[str, str]], controls: str = ""
) -> ET.Element:
    """Set-up of the analysis tool, with the actuators beside the model.

    Args:
        span: First and last time, s.
        out: Folder for its results.
        kinds: Settings of the analyses by their class.
        controls: File of the controls that drive all actuators.
    """
    root = driven_tool("AnalyzeTool", span, out)
    texts(
        root,
        solve_for_equilibrium_for_auxiliary_states="false",
        coordinates_file=MOTION,
        lowpass_cutoff_frequency_for_coordinates="-1",
    )
    analyses = ET.SubElement(ET.SubElement(root, "AnalysisSet", name="Analyses"), "objects")
    for kind, settings in kinds.items():
        texts(ET.SubElement(analyses, kind, name=kind), on="true", **settings)
    if controls:
        held = ET.SubElement(ET.SubElement(root, "ControllerSet", name="Controllers"), "objects")
        controller = ET.SubElement(held, "ControlSetController", name="controls")
        texts(controller, actuator_list="ALL", controls_file=controls)
    return root


def driven_tool(kind: str, span: tuple[float, float], out: str) -> ET.Element:
    """A tool of this class on the folder's model, with the loads and the actuators beside its own forces.

    Args:
        kind: Class of the tool.
        span: First and last time, s.
        out: Folder for its results.
    """
    root = ET.Element(kind, name=NAME)
    texts(
        root,
        model_file=MODEL,
        replace_force_set="false",
        force_set_files=ACTUATORS,
        results_directory=out,
        initial_time=repr(span[0]),
        final_time=repr(span[1]),
        external_loads_file=LOADS,
    )
    return root


def _times(span: tuple[float, float]) -> str:
    return f"{span[0]!r} {span[1]!r}"


def texts(parent: ET.Element, **values: str) -> None:
    """Adds elements with a text, by their names."""
    for tag, text in values.items():
        ET.SubElement(parent, tag).text = text


def document(element: ET.Element) -> str:
    """An element as the text of a file."""
    root = ET.Element("OpenSimDocument", Version=VERSION)
    root.append(element)
    ET.indent(root)
    head = f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {MARK} -->\n'
    return head + ET.tostring(root, encoding="unicode") + "\n"
