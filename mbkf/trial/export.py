"""A scaled subject as a model file of another program, and a result as a motion file of one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.atomic import write_text
from mbkf.io.atomic_folder import replacing_beside
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.mjcf import to_mjcf
from mbkf.model.osim import osim_files
from mbkf.model.urdf import to_urdf
from mbkf.model.urdf_body import side_path
from mbkf.model.urdf_side import urdf_side_text
from mbkf.trial.exchange.result_bids import write_results_bids
from mbkf.trial.exchange.result_bvh import write_result_bvh
from mbkf.trial.exchange.result_c3d import write_result_c3d
from mbkf.trial.exchange.result_csv import write_result_csv
from mbkf.trial.exchange.result_glb import write_result_glb
from mbkf.trial.exchange.result_mjcf import write_result_mjcf
from mbkf.trial.exchange.result_opensim import write_result_opensim
from mbkf.trial.exchange.result_plates import trial_of
from mbkf.trial.exchange.result_v3d import write_result_v3d
from mbkf.trial.exchange.summary_table import write_summary_csv


def _urdf(subject: Subject, model: HumanModel, name: str) -> dict[str, str]:
    beside = urdf_side_text(model, _height_m(subject, model))
    return {name: to_urdf(model, subject.markers), side_path(Path(name)).name: beside}


def _mjcf(subject: Subject, model: HumanModel, name: str) -> dict[str, str]:
    return {name: to_mjcf(model, subject.markers)}


def _osim(subject: Subject, model: HumanModel, name: str) -> dict[str, str]:
    return osim_files(model, subject.markers, name)


FORMATS = {"urdf": _urdf, "mjcf": _mjcf, "osim": _osim}
"""Formats of a subject, by name: texts by the names of the files that stand beside each other."""


def _bids(reconstruction: Reconstruction, folder: str | Path) -> None:
    write_results_bids([reconstruction], folder)


RESULT_FORMATS = {
    "c3d": write_result_c3d,
    "csv": write_result_csv,
    "v3d": write_result_v3d,
    "summary": write_summary_csv,
    "mjcf": write_result_mjcf,
    "bvh": write_result_bvh,
    "glb": write_result_glb,
}
"""Formats of a result that are one file, by name."""

RESULT_FOLDERS = {"opensim": write_result_opensim, "bids": _bids}
"""Formats of a result that are a folder, by name."""


def export_subject(subject: Subject, kind: str, path: str | Path) -> None:
    """Writes a subject's body with its markers, whole or not at all.

    Beside a URDF file stands its side file, so that :func:`mbkf.load_body` reads the body back; beside an OpenSim model
    the surfaces of its segments (VTP).

    Args:
        subject: The scaled person.
        kind: A key of :data:`FORMATS`.
        path: The file to write.

    Raises:
        UnknownName: The format, the body, or a marker's segment is unknown.
        FileFormatError: The path is a folder.
        OSError: The file cannot be written.
    """
    _check(kind, FORMATS, path)
    path = Path(path)
    texts = FORMATS[kind](subject, HumanModel.of(subject), path.name)
    with replacing_beside(path) as partial:
        for name, text in texts.items():
            write_text(partial / name, text)


def _height_m(subject: Subject, model: HumanModel) -> float:
    """The person's height; by the scale factors where it is not known."""
    return subject.height_m or model.description.reference_height_m * float(model.scale.mean())


def export_result(
    reconstruction: Reconstruction,
    kind: str,
    path: str | Path,
    *,
    trial: str | Path | None = None,
    forces: str | Path | None = None,
) -> None:
    """Writes a reconstruction as a file of other programs, whole or not at all.

    Args:
        reconstruction: The result, e.g. of :func:`mbkf.reconstruct` or :func:`mbkf.read_reconstruction`.
        kind: "c3d" (Mokka, Visual3D, Nexus: markers, angles, moments, powers, joint centres, reactions, events), "bvh"
            (animation: the segments' rotations, cm, y up), "glb" (glTF 2.0: the moving body, m, y up), "csv" (a row a
            frame), "v3d" (Visual3D's text table), "summary" (key numbers for spreadsheets), "mjcf" (the body with the
            motion as key frames), "bids" (a folder, Motion-BIDS) or "opensim" (a folder with model, motion, external
            loads and set-ups of OpenSim's tools).
        path: The file to write, or the folder; the name of a C3D file ends in ``.c3d``.
        trial: File of the capture that the result was made from: a C3D file then has its plates and analog channels.
        forces: File of ground reactions, where the result was made with one beside the capture.

    Raises:
        UnknownName: The format or the subject's body is unknown.
        FileFormatError: The path is a folder.
        InvalidInput: The result holds no motion (for OpenSim, no loads), the name of a C3D file ends otherwise,
            ``trial`` is another one, or it is given for another format, or ``forces`` without it.
        OSError: The file cannot be written.
    """
    if trial is not None and kind != "c3d":
        raise InvalidInput(
            f"the trial's plates and channels are of the format c3d; leave trial out for {kind}"
        )
    if forces is not None and trial is None:
        raise InvalidInput("forces belong to a trial; give its file as well")
    if kind in RESULT_FOLDERS:
        RESULT_FOLDERS[kind](reconstruction, path)
        return
    _check(kind, (*RESULT_FORMATS, *RESULT_FOLDERS), path)
    if kind == "c3d":
        capture = None if trial is None else trial_of(reconstruction, trial, forces)
        write_result_c3d(reconstruction, path, capture)
    else:
        RESULT_FORMATS[kind](reconstruction, path)


def _check(kind: str, formats: Iterable[str], path: str | Path) -> None:
    if kind not in formats:
        raise UnknownName("format", kind, formats)
    if Path(path).is_dir():
        raise FileFormatError(path, "is a folder; give a file name")
