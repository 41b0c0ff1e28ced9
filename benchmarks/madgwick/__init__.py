"""The bachelor's thesis on Madgwick's filter as a study: its three data bases, its plots, a verdict for each claim.

Writes tables (CSV), the source's figures redrawn, and one page with text and measurement side by side.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.checks import Check, Context, information
from benchmarks.madgwick.accuracy import DIRECTION_SDS
from benchmarks.madgwick.claims import claims
from benchmarks.madgwick.drawings import drawings
from benchmarks.madgwick.measured import Measured, measure
from benchmarks.madgwick.scenes import CHOSEN_ON, SHOWN_ON
from benchmarks.madgwick.second_base import SHOWN_TRIALS
from benchmarks.thesis_report.contents import OPEN, Band, Claim, Row, Sheet
from benchmarks.thesis_report.page import Report, Texts
from mbkf.numerics.threads import single_threaded


def run(context: Context) -> list[Check]:
    """Measures everything; BROAD is left out where the public captures are not at hand."""
    with TemporaryDirectory() as folder, single_threaded():
        found = measure(Path(folder), context.data)
    bands, judged = bands_of(found), claims(found)
    _print(judged)
    Report(_texts(), context.quick, bands, judged, sheets(found, judged), list(drawings(found))).write(
        context.out
    )
    return [*(check for band in bands for check in band.checks(context.quick)), *shown(found, judged)]


def _print(judged: list[Claim]) -> None:
    """The claims, each with its measurement and verdict; the page shows them side by side."""
    for one in judged:
        print(f"{one.verdict:13} {one.source}: {one.statement}\n{'':13}   {one.measured}")


def bands_of(found: Measured) -> list[Band]:
    """Numbers that a correct implementation keeps."""
    times, b = found.times, found.behaviour
    python = times.madgwick_python / min(times.plain_python, times.ekf_python)
    angles = max(value for (name, _), value in found.first.angle_rms_deg.items() if name == "madgwick")
    made = [
        Band("AMASS", "joint rotations, file to body", found.first.joints_rad, -OPEN, 1e-6, "rad", False),
        Band("AMASS", "sensors, Madgwick, angles: largest RMS", angles, -OPEN, 6.0, "deg", False),
        Band("Technaid tables", "readings written and read", found.third.read, -OPEN, 1e-6, "SI", False),
        Band(
            "filter", "by the letter (ζ 0) and ours, largest angle", b.printed_deg, -OPEN, 1e-6, "deg", False
        ),
        Band(
            "Madgwick eqs. 39 to 43",
            "angular velocity over the true one",
            found.first.rate_factor,
            1.95,
            2.05,
            "",
            False,
        ),
        Band("time", "Madgwick over the quicker EKF, both in Python", python, -OPEN, 1.0, "", False),
    ]
    if times.ekf_c == times.ekf_c:
        made.append(
            Band(
                "time", "Madgwick over EKF, both in C", times.madgwick_c / times.ekf_c, -OPEN, 1.0, "", False
            )
        )
    return made


def shown(found: Measured, judged: list[Claim]) -> list[Check]:
    """Errors for information, and how many claims have which verdict."""
    a = found.accuracy
    rows = [
        information(f"persons {SHOWN_ON}: {name}, error", value, "deg") for name, value in a.overall.items()
    ]
    rows += [
        information(f"{movement}, {sensor}, {name}", value, "deg")
        for (name, movement, sensor), value in a.by_movement.items()
    ]
    if found.second is not None:
        trials = " and ".join(name[:2] for name in SHOWN_TRIALS)
        rows += [
            information(f"BROAD {trials}, {name}", value, "deg")
            for name, value in found.second.errors.items()
        ]
    verdicts = [one.verdict for one in judged]
    return [
        *rows,
        *(
            information(f"claims: {verdict}", float(verdicts.count(verdict)))
            for verdict in ("reproduced", "differs", "cannot be had")
        ),
    ]


def sheets(found: Measured, judged: list[Claim]) -> list[Sheet]:
    """Tables of the errors, the sweeps and the claims."""
    a, times = found.accuracy, found.times
    errors: tuple[Row, ...] = tuple(
        (movement, sensor, *(a.by_movement[name, movement, sensor] for name in a.filters))
        for movement, sensor in dict.fromkeys((movement, sensor) for _, movement, sensor in a.by_movement)
    )
    sweeps = {"first": found.third.first, "second": found.third.second, "small gains": found.third.wide}
    made = [
        Sheet(
            "errors",
            "Error against the truth (RMS, degrees)",
            ("movement", "sensor", *a.filters),
            errors,
            f"Persons {SHOWN_ON}; β {a.beta:g} and the spread {a.direction_sd:g} of the plain EKF (of "
            f"{len(DIRECTION_SDS)}) were chosen on person {CHOSEN_ON[0]} over all movements.",
        ),
        Sheet(
            "time",
            "Time per sample (µs), one sensor with magnetometer",
            ("in", "Madgwick", "plain EKF", "EKF"),
            (
                ("Python", times.madgwick_python, times.plain_python, times.ekf_python),
                ("C", times.madgwick_c, float("nan"), times.ekf_c),
            ),
        ),
        Sheet(
            "sweeps",
            "Sweeps of β and ζ against the sensor's own quaternions",
            ("sweep", "β", "ζ", "difference (deg)"),
            tuple((name, *trial) for name, sweep in sweeps.items() for trial in sweep.trials),
        ),
        Sheet(
            "claims",
            "Claims",
            ("where", "claim", "measured", "verdict"),
            tuple((one.source, one.statement, one.measured, one.verdict) for one in judged),
        ),
    ]
    if found.second is not None:
        rows = tuple(
            (zeta, beta, error) for zeta, curve in found.second.curves.items() for beta, error in curve
        )
        made.insert(1, Sheet("broad", "BROAD 16: error over β and ζ", ("ζ", "β", "error (deg)"), rows))
    return made


def _texts() -> Texts:
    return Texts(
        title="Madgwick's filter: source and measurement",
        introduction="The bachelor's thesis of P. de Miguel Pueyo (Universidad Rey Juan Carlos, 2024) on virtual "
        "sensors, a public set and tables as its own sensors export them. Truth is known here, which the source did "
        "not have.",
        trials=(str(len(CHOSEN_ON) + len(SHOWN_ON)), "persons, three movements each"),
        command="python -m benchmarks madgwick",
        bands="Intervals that a correct implementation keeps.",
        claims="The source's claims, and the measurements",
        figures="Madgwick orange, EKF blue, truth black, unless the legend says otherwise.",
        source="source",
    )
