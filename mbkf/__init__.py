"""Human movement from optical markers and force plates: angles, torques and reactions with standard deviations.

The public surface: read a capture, scale the body to a person, reconstruct a trial. Loading this module is quick;
the libraries behind a name are loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from mbkf.errors import MbkfError
from mbkf.version import __version__

if TYPE_CHECKING:
    from mbkf.filters.filter import Filter
    from mbkf.filters.plant import Plant
    from mbkf.io.capture import read_capture, register_force_reader, register_reader
    from mbkf.io.capture_options import CaptureOptions
    from mbkf.io.imu.files import read_imu, register_imu_reader
    from mbkf.io.imu.readings import ImuReadings
    from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
    from mbkf.io.results_folder import read_reconstruction, write_reconstruction
    from mbkf.io.subject import read_subject, write_subject
    from mbkf.io.written import overwriting
    from mbkf.model.body_file import load_body
    from mbkf.model.casadi_dynamics import CasadiDynamics, casadi_dynamics
    from mbkf.model.clinical import ClinicalAngles
    from mbkf.model.human import HumanModel
    from mbkf.model.layout import ExtraState, Layout
    from mbkf.model.protocol import load_protocol
    from mbkf.numerics.kalman import Information
    from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
    from mbkf.sensors.contact.plates import plate_wrenches
    from mbkf.study.batch.run import batch
    from mbkf.trial.exchange.onto.result_onto import export_onto
    from mbkf.trial.export import export_result
    from mbkf.trial.inertia.estimate import InertiaEstimate, estimate_inertia
    from mbkf.trial.inertial.orient import orient
    from mbkf.trial.label import label
    from mbkf.trial.preparation.settings import Hidden, ReconstructSettings
    from mbkf.trial.reconstruct import reconstruct
    from mbkf.trial.results.summary import summarise
    from mbkf.trial.scale import scale
    from mbkf.trial.synth import synthesise
    from mbkf.trial.tracker import Estimate, Tracker, standard_blocks
    from mbkf.viz.meshcat.playing import play
    from mbkf.viz.meshcat.visualiser import show

_HOMES = {
    "Block": "mbkf.sensors.block",
    "Capture": "mbkf.io.records",
    "CaptureOptions": "mbkf.io.capture_options",
    "CasadiDynamics": "mbkf.model.casadi_dynamics",
    "ClinicalAngles": "mbkf.model.clinical",
    "Estimate": "mbkf.trial.tracker",
    "ExtraState": "mbkf.model.layout",
    "Filter": "mbkf.filters.filter",
    "Frame": "mbkf.sensors.block",
    "Hidden": "mbkf.trial.preparation.settings",
    "HumanModel": "mbkf.model.human",
    "ImuReadings": "mbkf.io.imu.readings",
    "InertiaEstimate": "mbkf.trial.inertia.estimate",
    "Information": "mbkf.numerics.kalman",
    "Layout": "mbkf.model.layout",
    "MarkerTrajectories": "mbkf.io.records",
    "Notes": "mbkf.sensors.block",
    "OperatingPoint": "mbkf.sensors.block",
    "Plant": "mbkf.filters.plant",
    "PlateReadings": "mbkf.io.records",
    "ReconstructSettings": "mbkf.trial.preparation.settings",
    "Rows": "mbkf.sensors.block",
    "Tracker": "mbkf.trial.tracker",
    "batch": "mbkf.study.batch.run",
    "casadi_dynamics": "mbkf.model.casadi_dynamics",
    "estimate_inertia": "mbkf.trial.inertia.estimate",
    "export_onto": "mbkf.trial.exchange.onto.result_onto",
    "export_result": "mbkf.trial.export",
    "label": "mbkf.trial.label",
    "load_body": "mbkf.model.body_file",
    "load_protocol": "mbkf.model.protocol",
    "orient": "mbkf.trial.inertial.orient",
    "overwriting": "mbkf.io.written",
    "plate_wrenches": "mbkf.sensors.contact.plates",
    "play": "mbkf.viz.meshcat.playing",
    "read_capture": "mbkf.io.capture",
    "read_imu": "mbkf.io.imu.files",
    "read_reconstruction": "mbkf.io.results_folder",
    "read_subject": "mbkf.io.subject",
    "reconstruct": "mbkf.trial.reconstruct",
    "register_force_reader": "mbkf.io.capture",
    "register_imu_reader": "mbkf.io.imu.files",
    "register_reader": "mbkf.io.capture",
    "scale": "mbkf.trial.scale",
    "show": "mbkf.viz.meshcat.visualiser",
    "standard_blocks": "mbkf.trial.tracker",
    "summarise": "mbkf.trial.results.summary",
    "synthesise": "mbkf.trial.synth",
    "write_reconstruction": "mbkf.io.results_folder",
    "write_subject": "mbkf.io.subject",
}

__all__ = [
    "Block",
    "Capture",
    "CaptureOptions",
    "CasadiDynamics",
    "ClinicalAngles",
    "Estimate",
    "ExtraState",
    "Filter",
    "Frame",
    "Hidden",
    "HumanModel",
    "ImuReadings",
    "InertiaEstimate",
    "Information",
    "Layout",
    "MarkerTrajectories",
    "MbkfError",
    "Notes",
    "OperatingPoint",
    "Plant",
    "PlateReadings",
    "ReconstructSettings",
    "Rows",
    "Tracker",
    "__version__",
    "batch",
    "casadi_dynamics",
    "estimate_inertia",
    "export_onto",
    "export_result",
    "label",
    "load_body",
    "load_protocol",
    "orient",
    "overwriting",
    "plate_wrenches",
    "play",
    "read_capture",
    "read_imu",
    "read_reconstruction",
    "read_subject",
    "reconstruct",
    "register_force_reader",
    "register_imu_reader",
    "register_reader",
    "scale",
    "show",
    "standard_blocks",
    "summarise",
    "synthesise",
    "write_reconstruction",
    "write_subject",
]


def __getattr__(name: str) -> object:
    """Loads a public name's module on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mbkf' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
