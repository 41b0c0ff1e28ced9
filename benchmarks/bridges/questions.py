"""Ten questions that somebody asks who knows nothing of mbkf, each answered by ``motion.h5`` alone and checked.

The file is that of a synthetic walk with known truth. An answer is read from names, labels and attributes of the file,
and then compared with what is true: an answer that is missing or wrong counts 0.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

import mbkf
from benchmarks.checks import Check

if TYPE_CHECKING:
    import xarray

MOTION = "motion.h5"

RATE_HZ, SECONDS = 100.0, 2.0

Answer: TypeAlias = "Callable[[xarray.Dataset], bool]"


def questions_rows(out: Path) -> Iterator[Check]:
    """A row a question: 1 for an answer that is right.

    Args:
        out: Folder for the result.
    """
    import xarray

    subject, recorded = mbkf.synthesise("walk", seconds=SECONDS)
    result = mbkf.reconstruct(recorded.trial, subject)
    mbkf.write_reconstruction(result, mbkf.summarise(result), out / "result")
    with xarray.open_dataset(out / "result" / MOTION, engine="h5netcdf") as file:
        right = {question: _answered(answer, file) for question, answer in QUESTIONS.items()}
    for question, answered in right.items():
        yield Check(question, float(answered), 1.0, ">=")
    yield Check("questions answered", float(sum(right.values())), float(len(QUESTIONS)), ">=")


def _answered(answer: Answer, file: xarray.Dataset) -> bool:
    try:
        return answer(file)
    except (KeyError, ValueError, AttributeError):
        return False


def _foot(file: xarray.Dataset) -> bool:
    """The label "right" belongs to the foot whose pressure is on the right of the other's, y being left."""
    place = file.foot_cop_m.sel(xyz="y").mean("times_s")
    return (
        bool(place.sel(foot="right") < place.sel(foot="left")) and "foot: right, left" in file.foot_cop_m.axes
    )


def _axes(file: xarray.Dataset) -> bool:
    words = file.xyz.attrs["long_name"]
    head, heel = (file.predicted_m.sel(marker_names=name, xyz="z").mean() for name in ("C7", "RHEE"))
    return "x forward, y left, z up" in words and bool(head > heel + 1.0)


def _units(file: xarray.Dataset) -> bool:
    numbers = [one for one in file.variables.values() if one.dtype.kind in "fi"]
    mixed = [one for one in numbers if ";" in one.attrs["units"] or "," in one.attrs["units"]]
    sizes = [len(one.attrs["component_units"].split(", ")) == one.shape[-1] for one in mixed]
    return all(one.attrs["units"] for one in numbers) and all(sizes) and bool(mixed)


def _codes(file: xarray.Dataset) -> bool:
    one = file.foot_source
    meaning = dict(zip(one.attrs["flag_values"], one.attrs["flag_meanings"].split(), strict=True))
    loaded = np.asarray(file.foot_wrench.sel(wrench="force_z")) > 200.0
    words = {meaning[code] for code in np.unique(one.values[loaded])}
    return words <= {"measured", "estimated"} and "measured" in words and meaning[0] == "none"


def _times(file: xarray.Dataset) -> bool:
    stated = file.times_s.attrs
    first, last = float(file.times_s[0]), float(file.times_s[-1])
    return (
        first == 0.0
        and abs(last - SECONDS) < 0.5 / RATE_HZ
        and stated["units"] == "s"
        and "first frame" in stated["long_name"]
    )


def _rate(file: xarray.Dataset) -> bool:
    return bool(file.attrs["rate_hz"] == RATE_HZ)


def _sides(file: xarray.Dataset) -> bool:
    names = set(file.coordinate_names.values)
    senses = json.loads(file.attrs["positive_senses"])
    return {name[:-1] + "l" for name in names if name.endswith("_r")} <= names and names == set(senses)


def _sign(file: xarray.Dataset) -> bool:
    """The ground pushes up on a standing foot; a knee bends to the buttock; moments are internal."""
    knee = json.loads(file.attrs["positive_senses"])["knee_angle_r"]
    up = bool(file.foot_wrench.sel(wrench="force_z").max() > 500.0)
    bent = bool(file.angles.sel(coordinate_names="knee_angle_r").max() > 0.5)
    words = file.attrs["axes"]
    return up and bent and "flexion" in knee and "ground on the body" in words and "internal" in words


def _frame(file: xarray.Dataset) -> bool:
    wrench, angles = file.foot_wrench.attrs, file.angles.attrs["long_name"]
    world = "world's origin" in wrench["units"] and "world axes" in file.wrench.attrs["long_name"]
    return (
        world and file.attrs["direction"] in {"progression", "heading", "laboratory"} and "frame of" in angles
    )


def _spread(file: xarray.Dataset) -> bool:
    beside = file.angles.attrs["ancillary_variables"]
    whole, part = (file[name].attrs["long_name"] for name in (beside, f"{beside}_offset"))
    return (
        "1 sd" in whole
        and "whole error of angles" in whole
        and "repeats" in part
        and "NaN" in file.attrs["missing"]
    )


QUESTIONS: Mapping[str, Answer] = {
    "order of the feet": _foot,
    "directions of the axes": _axes,
    "unit of each number": _units,
    "meaning of the codes": _codes,
    "time of a frame and its clock": _times,
    "frame rate": _rate,
    "side of a coordinate": _sides,
    "sign of angles, moments, forces": _sign,
    "frame of reference": _frame,
    "kind of spread, and missing numbers": _spread,
}
