"""Everything that the study measures, in one record."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from benchmarks.madgwick.accuracy import Accuracy, measure_accuracy
from benchmarks.madgwick.behaviour import Behaviour, measure_behaviour
from benchmarks.madgwick.first_base import FirstBase, measure_first_base
from benchmarks.madgwick.second_base import SecondBase, measure_second_base
from benchmarks.madgwick.third_base import ThirdBase, measure_third_base
from benchmarks.madgwick.timing import Times, measure_times


@dataclass(frozen=True)
class Measured:
    """Results of each part; ``second`` is None without the public captures."""

    accuracy: Accuracy
    behaviour: Behaviour
    times: Times
    first: FirstBase
    second: SecondBase | None
    third: ThirdBase


def measure(folder: Path, data: Path | None) -> Measured:
    """Measures all.

    Args:
        folder: For files in between.
        data: Folder of the public captures, or None.
    """
    accuracy = measure_accuracy()
    there = data is not None and (data / "imu_broad").is_dir()
    return Measured(
        accuracy,
        measure_behaviour(),
        measure_times(),
        measure_first_base(folder),
        measure_second_base(data) if there and data is not None else None,
        measure_third_base(folder, accuracy.direction_sd),
    )
