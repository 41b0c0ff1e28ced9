"""Set-ups of OpenSim for excitations of muscles along a motion: computed muscle control, and Moco's inverse problem.

Computed muscle control integrates the model forward and corrects each coordinate towards the motion. MocoInverse keeps
the motion and solves for all instants at once, with muscles of the form that its solver differentiates.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

from mbkf.trial.exchange.opensim_setups import LOADS, MODEL, MOTION, NAME, driven_tool, texts

SETUP_CMC, TASKS, CMC_OUT = "setup_cmc.xml", "cmc_tasks.xml", "cmc"
SETUP_MOCO = "setup_moco.xml"
"""Files of the folder, and the folder that computed muscle control writes."""

STIFFNESS_S2 = 100.0
"""Acceleration per error of a coordinate, 1/s²; an error e fades as ë + 20 ė + 100 e = 0, critically damped
(D. G. Thelen, F. C. Anderson, J. Biomech. 39 (2006) 1107-1115)."""

MESH_S = 0.02
"""Time between instants of MocoInverse."""


def cmc_tasks(coordinates: Sequence[str]) -> ET.Element:
    """Coordinates that computed muscle control follows, all weighing alike.

    Args:
        coordinates: Their names.
    """
    root = ET.Element("CMC_TaskSet", name=NAME)
    objects = ET.SubElement(root, "objects")
    for name in coordinates:
        texts(
            ET.SubElement(objects, "CMC_Joint", name=name),
            on="true",
            weight="1 1 1",
            active="true false false",
            kp=f"{STIFFNESS_S2:g} 1 1",
            kv=f"{2.0 * STIFFNESS_S2**0.5:g} 1 1",
            ka="1 1 1",
            coordinate=name,
        )
    return root


def muscle_control(span: tuple[float, float]) -> ET.Element:
    """Set-up of computed muscle control between two times, s."""
    root = driven_tool("CMCTool", span, CMC_OUT)
    texts(
        root,
        solve_for_equilibrium_for_auxiliary_states="true",
        desired_kinematics_file=MOTION,
        task_set_file=TASKS,
        lowpass_cutoff_frequency="-1",
        use_fast_optimization_target="true",
    )
    return root


def moco_inverse(span: tuple[float, float], reserve_nm: float, residual_n: float) -> ET.Element:
    """MocoInverse between two times: excitations whose summed squares are least.

    Args:
        span: First and last time, s.
        reserve_nm: Force or moment at control 1 of an actuator at a joint, N m.
        residual_n: That of an actuator at the root, N and N m.
    """
    root = ET.Element("MocoInverse", name=NAME)
    texts(root, initial_time=repr(span[0]), final_time=repr(span[1]), mesh_interval=f"{MESH_S:g}")
    model = ET.SubElement(root, "ModelProcessor", name="model")
    texts(model, filepath=MODEL)
    steps = ET.SubElement(model, "operators")
    texts(ET.SubElement(steps, "ModOpAddExternalLoads"), filepath=LOADS)
    for step in (
        "ModOpIgnoreTendonCompliance",
        "ModOpReplaceMusclesWithDeGrooteFregly2016",
        "ModOpIgnorePassiveFiberForcesDGF",
    ):
        ET.SubElement(steps, step)
    residuals = {f"{kind}_optimal_force": f"{residual_n:g}" for kind in ("rotational", "translational")}
    texts(ET.SubElement(steps, "ModOpAddResiduals"), **residuals)
    texts(ET.SubElement(steps, "ModOpAddReserves"), optimal_force=f"{reserve_nm:g}")
    motion = ET.SubElement(root, "TableProcessor", name="kinematics")
    texts(motion, filepath=MOTION)
    ET.SubElement(ET.SubElement(motion, "operators"), "TabOpUseAbsoluteStateNames")
    texts(root, kinematics_allow_extra_columns="true")
    return root
