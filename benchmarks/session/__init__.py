"""Reports of sessions: a known change between two sessions is found within its interval, and powers are true."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.checks import Check, Context, information, within
from benchmarks.dynamic.methods import in_parallel
from benchmarks.session.change import recorded
from mbkf.conventions import Array
from mbkf.study.session.comparison import CurvePair, by_curve, compare
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.means import Difference

PERSONS, QUICK_PERSONS = 40, 4

COVER = (0.90, 0.98)
POWER_W_KG = 0.15

JUDGED = (
    ("knee angle", Key("angle", "knee_angle"), "deg"),
    ("knee torque", Key("torque", "knee_angle"), "N m/kg"),
)
"""What the change was made in."""

SHOWN = (
    ("hip flexion", Key("angle", "hip_flexion")),
    ("hip adduction", Key("angle", "hip_adduction")),
    ("ankle angle", Key("angle", "ankle_angle")),
    ("hip flexion torque", Key("torque", "hip_flexion")),
    ("ankle torque", Key("torque", "ankle_angle")),
    ("pelvic tilt", Key("angle", "pelvis_tilt")),
)

JOINTS = ("hip", "knee", "ankle")

MID_STANCE = slice(30, 51)
"""Per cent of the cycle in which the size of the change is told."""


@dataclass(frozen=True)
class Found:
    """One person.

    Attributes:
        change, half_width, true: (2, 101) by curve: the change found on either side, half of its interval, and the true
            change of the same cycles.
        power_rms: RMS error of each joint's power over all cycles, W/kg.
    """

    change: dict[Key, Array]
    half_width: dict[Key, Array]
    true: dict[Key, Array]
    power_rms: dict[str, float]


def run(context: Context) -> list[Check]:
    """All rows; of few persons when quick."""
    with in_parallel() as mapper:
        found: list[Found] = mapper(person, range(QUICK_PERSONS if context.quick else PERSONS))
    rows: list[Check] = []
    for name, key, unit in JUDGED:
        true, change = (_mean([one[key] for one in each]) for each in _both(found))
        rows.append(information(f"{name}, 30-50 % of the cycle: known change", true, unit))
        rows.append(information(f"{name}, 30-50 % of the cycle: change found, mean of persons", change, unit))
        rows += within(
            f"{name}: share of points whose 95 % interval holds the change", cover(found, key), *COVER
        )
    rows += [information(f"{name}: the same share", cover(found, key)) for name, key in SHOWN]
    rows += [
        Check(
            f"power of the {joint}, RMS error",
            float(np.sqrt(np.mean([one.power_rms[joint] ** 2 for one in found]))),
            POWER_W_KG,
            "<=",
            "W/kg",
        )
        for joint in JOINTS
    ]
    return rows


def person(seed: int) -> Found:
    """Both sessions of one person, as estimated and as true."""
    both = recorded(seed)
    estimated = [session_of(one.estimated, "") for one in both]
    true = [session_of(one.true, "") for one in both]
    pairs, exact = (by_curve(compare(*sessions)[0]) for sessions in (estimated, true))
    keys = [key for _, key, *_ in (*JUDGED, *SHOWN)]

    def of(
        found: Mapping[tuple[Key, int], CurvePair], part: Callable[[Difference], Array]
    ) -> dict[Key, Array]:
        return {key: np.array([part(found[(key, side)].difference) for side in range(2)]) for key in keys}

    power = {
        joint: np.concatenate(
            [
                (one.curves[Key("power", joint)].values - other.curves[Key("power", joint)].values).ravel()
                for session, other_session in zip(estimated, true, strict=True)
                for one, other in zip(session.gaits[0].sides, other_session.gaits[0].sides, strict=True)
            ]
        )
        for joint in JOINTS
    }
    return Found(
        of(pairs, lambda one: one.difference),
        of(pairs, lambda one: one.half_width),
        of(exact, lambda one: one.difference),
        {joint: float(np.sqrt(np.mean(errors**2))) for joint, errors in power.items()},
    )


def cover(found: list[Found], key: Key) -> float:
    """Share of points, of both sides and all persons, whose interval holds the change that the two motions differ by.

    The trials of a person are samples of how the motions are made; the change between the motions themselves is the
    mean of all persons' true changes.

    Args:
        found: The persons.
        key: The curve.
    """
    true = np.mean([one.true[key] for one in found], axis=0)
    held = [np.abs(one.change[key] - true) <= one.half_width[key] for one in found]
    return float(np.mean(held))


def _both(found: list[Found]) -> tuple[list[dict[Key, Array]], list[dict[Key, Array]]]:
    return [one.true for one in found], [one.change for one in found]


def _mean(changes: list[Array]) -> float:
    """Mean change in mid-stance of both sides and all persons."""
    return float(np.mean([change[:, MID_STANCE].mean() for change in changes]))
