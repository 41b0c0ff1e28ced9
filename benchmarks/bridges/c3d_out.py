"""Plates and analog channels of a result's C3D file as ezc3d reads them: forces, centres of pressure, every bit.

Measured plates are compared with the readings that the filter got, estimated ones with the loads of the result.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, left_out
from benchmarks.dynamic.captures import SOURCES, load
from benchmarks.needs import installed
from mbkf.conventions import Array
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.trial.export import export_result
from mbkf.trial.reconstruct import reconstruct

FORCE_N, PRESSURE_MM, LOADED_N = 0.1, 0.1, 20.0
TRIALS = ("biomechzoo HC032A", "gaitalytics", "rajagopal walk")


def c3d_out_rows(data: Path, out: Path, quick: bool = False) -> Iterator[Check]:
    """Rows of all trials.

    Args:
        data: Folder of the reference captures.
        out: Folder for the exported files.
        quick: One trial.
    """
    if not installed("ezc3d"):
        yield left_out("plates and analog channels", "needs ezc3d: pip install '.[test]'")
        return
    for name in TRIALS[: 1 if quick else None]:
        source, person = SOURCES[name], load(name, data)
        result = reconstruct(person.capture, person.subject)
        folder = data / source.folder
        trial = folder / source.trial
        forces = None if source.forces is None else folder / source.forces
        export_result(result, "c3d", out / "with.c3d", trial=trial, forces=forces)
        export_result(result, "c3d", out / "without.c3d")
        for label, path in (("with its trial", out / "with.c3d"), ("alone", out / "without.c3d")):
            apart = np.array(list(_apart(path, person.capture, result))).max(axis=0)
            yield Check(f"{name}, {label}: force read back", apart[0], FORCE_N, "<=", "N")
            yield Check(f"{name}, {label}: centre of pressure read back", apart[1], PRESSURE_MM, "<=", "mm")
        if trial.suffix == ".c3d":
            changed = _changed_samples(trial, out / "with.c3d")
            yield Check(f"{name}: analog samples that are not those of the source", changed, 0.0, "<=")


def _apart(path: Path, capture: Capture, result: Reconstruction) -> Iterator[tuple[float, float]]:
    """Largest difference of force, N, and of the centre of pressure, mm, of each plate of a file."""
    import ezc3d

    file = ezc3d.c3d(str(path), extract_forceplat_data=True)
    described = file["parameters"]["FORCE_PLATFORM"]["DESCRIPTIONS"]["value"]
    plates = {plate.name: plate for plate in capture.plates}
    for words, plate in zip(described, file["data"]["platform"], strict=True):
        force, point = plate["force"].T, plate["center_of_pressure"].T
        if words.startswith("measured"):
            read = plates[words.split("plate ")[1].split(",")[0]]
            n = min(len(force), len(read.force_n))
            wanted, places = read.force_n[:n], read.centre_of_pressure_m[:n]
            force, point = force[:n], point[:n]
        else:
            wanted, places = _load(result, words)
            step = len(force) // result.frames
            force, point = force[::step], point[::step]
        far = np.abs(force - wanted).max()
        loaded = (wanted[:, 2] > LOADED_N) & np.isfinite(places).all(axis=1)
        yield float(far), float(np.abs(point - 1e3 * places)[loaded].max(initial=0.0))


def _load(result: Reconstruction, words: str) -> tuple[Array, Array]:
    """(T, 3) force and (T, 3) place of the load that a plate is described to hold."""
    loads = result.loads
    at = loads.names.index(words.split("load on ")[1].split(",", maxsplit=1)[0])
    own = loads.source[:, at] == 3 if "no plate" in words else loads.source[:, at] != 0
    return np.where(own[:, None], loads.wrench[:, at, :3], 0.0), np.where(
        own[:, None], loads.point_m[:, at], np.nan
    )


def _changed_samples(source: Path, path: Path) -> float:
    import ezc3d

    theirs, ours = (ezc3d.c3d(str(one))["data"]["analogs"][0] for one in (source, path))
    ours = ours[len(ours) - len(theirs) :]
    if ours.shape != theirs.shape:
        return float(theirs.size)
    return float(np.count_nonzero(~((ours == theirs) | (np.isnan(ours) & np.isnan(theirs)))))
