"""MATLAB files of two public sets: BROAD (one sensor with optical truth) and the qmt full-body example."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, ShapeError
from mbkf.io.files_read import check_input
from mbkf.io.imu.readings import ImuReadings, rate_of
from mbkf.io.mat5 import Variable, read_mat5

_XYZW = [1, 2, 3, 0]


def read_imu_mat(path: str | Path) -> tuple[ImuReadings, ...]:
    """Read either set.

    BROAD (Laidig et al. 2021): ``imu_acc`` m/s², ``imu_gyr`` rad/s, ``imu_mag`` µT, ``opt_quat`` (w, x, y, z) sensor →
    ENU, ``movement`` the samples that count.
    qmt: a struct of ``acc``, ``gyr``, ``quat`` per segment and times ``t``; no field, headings arbitrary.

    Raises:
        FileFormatError: The file is missing, no MATLAB file, or neither set.
    """
    path = Path(path)
    check_input(path, "name a MATLAB file of BROAD or qmt")
    try:
        return _sensors(path, read_mat5(path))
    except (ShapeError, ValueError, IndexError) as error:
        raise FileFormatError(path, f"damaged, or no MATLAB file of BROAD or qmt ({error})") from error


def _sensors(path: Path, content: Mapping[str, Variable]) -> tuple[ImuReadings, ...]:
    arrays = {name: one for name, one in content.items() if isinstance(one, np.ndarray)}
    if {"imu_acc", "imu_gyr", "sampling_rate"} <= arrays.keys():
        force, rate, truth = arrays["imu_acc"], float(arrays["sampling_rate"].item()), arrays.get("opt_quat")
        if not rate > 0.0:
            raise ValueError(f"sampling_rate is {rate:g} Hz")
        return (
            ImuReadings(
                path.stem,
                np.arange(len(np.atleast_1d(force))) / rate,
                force,
                arrays["imu_gyr"],
                arrays.get("imu_mag"),
                rate,
                "optical orientation in ENU",
                None if truth is None else _xyzw(truth),
                None if "movement" not in arrays else np.ravel(arrays["movement"]) != 0,
            ),
        )
    segments = {
        name: one
        for name, one in content.items()
        if not isinstance(one, np.ndarray) and {"acc", "gyr"} <= one.keys()
    }
    if segments and "t" in arrays:
        times = np.atleast_1d(arrays["t"])
        rate = rate_of(times, str(path))
        note = "orientation by six axes, z up, heading arbitrary"
        return tuple(
            ImuReadings(
                name, times, one["acc"], one["gyr"], None, rate, note,
                _xyzw(one["quat"]) if "quat" in one else None,
            )
            for name, one in segments.items()
        )  # fmt: skip
    raise FileFormatError(
        path, "no sensor found; BROAD has imu_acc and imu_gyr, qmt a struct per segment and t"
    )


def _xyzw(wxyz: Array) -> Array:
    """(T, 4) quaternions with their scalar last, from (T, 4) with it first."""
    if wxyz.ndim != 2 or wxyz.shape[1] != 4:
        raise ShapeError("quaternions", "(T, 4)", wxyz.shape)
    return wxyz[:, _XYZW]
