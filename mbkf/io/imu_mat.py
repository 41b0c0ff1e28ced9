"""MATLAB files of two public sets: BROAD (one sensor with optical truth) and the qmt full-body example."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from mbkf.errors import FileFormatError
from mbkf.io.imu import ImuReadings, rate_of

_XYZW = [1, 2, 3, 0]


def read_imu_mat(path: str | Path) -> tuple[ImuReadings, ...]:
    """Read either set.

    BROAD (Laidig et al. 2021): ``imu_acc`` m/s², ``imu_gyr`` rad/s, ``imu_mag`` µT, ``opt_quat`` (w, x, y, z) sensor →
    ENU. qmt: a struct of ``acc``, ``gyr``, ``quat`` per segment and times ``t``; no field, headings arbitrary.

    Raises:
        FileFormatError: The file is missing, no MATLAB file, or neither set.
    """
    path = Path(path)
    if not path.is_file():
        raise FileFormatError(path, "no such file; name a MATLAB file of BROAD or qmt")
    try:
        return _sensors(path, _content(path))
    except (AttributeError, IndexError, TypeError, ValueError, OverflowError, MemoryError) as error:
        raise FileFormatError(path, f"damaged ({error})") from error


def _content(path: Path) -> dict[str, Any]:
    try:
        content = scipy.io.loadmat(path, squeeze_me=True, struct_as_record=False)
    except Exception as error:  # scipy tells damage by whatever its parser then comes upon
        raise FileFormatError(path, f"not a MATLAB 5 file ({error})") from error
    return dict(content)


def _sensors(path: Path, content: dict[str, Any]) -> tuple[ImuReadings, ...]:
    if {"imu_acc", "imu_gyr", "sampling_rate"} <= content.keys():
        force, rate = np.asarray(content["imu_acc"], dtype=float), float(content["sampling_rate"])
        truth = content.get("opt_quat")
        return (
            ImuReadings(
                path.stem,
                np.arange(len(force)) / rate,
                force,
                content["imu_gyr"],
                content.get("imu_mag"),
                rate,
                "optical orientation in ENU",
                None if truth is None else np.asarray(truth, dtype=float)[:, _XYZW],
            ),
        )
    segments = {name: one for name, one in content.items() if hasattr(one, "acc") and hasattr(one, "gyr")}
    if segments and "t" in content:
        times = np.asarray(content["t"], dtype=float)
        rate = rate_of(times, str(path))
        note = "orientation by six axes, z up, heading arbitrary"
        return tuple(
            ImuReadings(
                name, times, one.acc, one.gyr, None, rate, note,
                np.asarray(one.quat, dtype=float)[:, _XYZW] if hasattr(one, "quat") else None,
            )
            for name, one in segments.items()
        )  # fmt: skip
    raise FileFormatError(
        path, "no sensor found; BROAD has imu_acc and imu_gyr, qmt a struct per segment and t"
    )
