"""Meaning of a column of a table, or a channel of a recording, by its name: sensor, quantity, axis and unit.

Makers and people write the same in many ways: ``left_foot_acc_x [m/s^2]``, ``accX``, ``ax``, ``acc_1``,
``Shimmer_6A92_Accel_LN_X_CAL``, ``Foot Accel Sensor X LT (mG)``, ``Avanti sensor 1: ACC.X 1 [g]``. A name is cut into
words; one of them is the quantity, one the axis, the last ones may be the unit, and the rest names the sensor.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from mbkf.io.imu.units import plain_unit

_KIND = (
    r"(?P<acc>acc|accl|accel|accelero|acceleration|accelerations|accelerometer|accelerometers|specificforce"
    r"|acelerometro|aceleracion)"
    r"|(?P<gyr>gyr|gyro|gyros|gyroscope|gyroscopes|angularvelocity|angularvelocities|angularrate|angvel|rotationrate"
    r"|turnrate|omega|giro|giroscopio|giroscopo)"
    r"|(?P<mag>mag|magn|magnet|magneto|magnetic|magnetometer|magnetometers|magneticfield|magfield"
    r"|magnetometro)"
    r"|(?P<quat>q|quat|quaternion|quaternions|orientation|cuaternion)"
)
_WORD_OF_KIND = re.compile(rf"(?:{_KIND})(?P<axis>[wxyz])?", re.IGNORECASE)
_SHORT = re.compile(r"(?P<kind>[agmqw])(?P<axis>[wxyz])", re.IGNORECASE)
_SHORT_KINDS = {"a": "acc", "g": "gyr", "w": "gyr", "m": "mag", "q": "quat"}
_LETTER = re.compile(r"[A-Za-z]")
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_PAIRS = {"specific", "angular", "rotation", "turn", "magnetic", "ang", "mag"}
_BRACKETS = re.compile(r"[\s_.:\-]*[\[(](?P<unit>[^\[\]()]*(?:\([^()]*\))?[^\[\]()]*)[\])]\s*$")
_OTHER = {
    "absolute", "angle", "angles", "axis", "bias", "calibration", "cov", "covariance", "d", "delta", "derivative",
    "emg", "error", "euler", "index", "magnitude", "mat", "mean", "norm", "offset", "raw", "rms", "scale", "sd",
    "segment", "status", "std", "temp", "temperature", "total", "uncalibrated", "var", "variance", "vm",
}  # fmt: skip
"""Words of columns that are about a quantity, and not its reading."""

_COUNTS = {"lsb", "lsbs", "count", "counts", "adc", "raw"}
"""Units of readings that are not calibrated."""

_GRAVITY_LESS = {"free", "linear", "user", "gravity"}
_NOISE = {
    "cal", "calibrated", "ln", "low", "noise", "sensor", "wr", "wide", "range", "axis", "data", "is", "value",
}  # fmt: skip
_HEADS = re.compile(r"^(?:noraxon\s+)?myomotion-segments-", re.IGNORECASE)
_SEPARATORS = " _.:-\t/|"
_TIME = re.compile(
    r"(?:.*[\s_.:\-])?(?P<word>time(?:[\s_]?stamp)?(?:[\s_]?sync)?(?:[\s_]unix)?|sample[\s_]?time[\s_]?fine|t|x|seconds"
    r"|elapsed|zeit|tiempo|epoch)(?:[\s_.:\-]cal)?",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class ColumnName:
    """Meaning of a name.

    Attributes:
        sensor: The sensor, "" where the name has none.
        kind: "acc", "gyr", "mag" or "quat"; "free" for accelerations from which a filter took gravity.
        axis: 0, 1 or 2 for x, y, z; of quaternions 3 is w.
        unit: The unit as the name states it, a key of :data:`mbkf.io.imu.units.UNITS`, or an unknown word; "" where it
            states none.
        wide: The wide-range one of two accelerometers.
    """

    sensor: str
    kind: str
    axis: int
    unit: str
    wide: bool = False


def parse_column_name(name: str, kind: str = "") -> ColumnName | None:
    """Meaning of a name; None for other columns than readings of an inertial sensor.

    ``kind`` is the quantity of a name that is an axis alone ("X (m/s^2)"), by the file's own name.
    """
    if _LETTER.search(name) is None:  # most cells of a table
        return None
    plain, bracketed = split_unit(_HEADS.sub("", name.strip()))
    words = [(word[0], word.start(), word.end()) for word in _WORD.finditer(plain)]
    lower = [word.lower() for word, _, _ in words]
    if not words or _OTHER & set(lower):
        return None
    place = _kind(lower)
    if place is None:
        return _bare(words, lower, bracketed, kind)
    found, first, last, axis = place
    if found == "acc" and first and lower[first - 1] == "angular":
        return None
    free = found == "acc" and bool(_GRAVITY_LESS & set(lower))
    rest = [
        k for k in range(last + 1, len(words)) if lower[k] not in _NOISE and lower[k] not in ("quat", "q")
    ]
    unit, rest = (bracketed, rest) if bracketed else _unit_words(found, lower, rest)
    if axis is None:
        axis, rest = _axis(found, lower, rest)
    if axis is None or unit.lower() in _COUNTS:
        return None
    before = [k for k in range(first) if lower[k] not in _GRAVITY_LESS]
    sensor = _sensor(plain, words, before, rest)
    plain_found = "" if not unit else plain_unit(found, unit) if found != "quat" else ""
    return ColumnName(
        sensor,
        "free" if free else found,
        axis,
        unit if plain_found is None else plain_found,
        "wr" in lower or "wide" in lower,
    )


def in_counts(name: str) -> bool:
    """True for a column whose unit is that of readings without calibration: ``acc_x [LSB]``."""
    return split_unit(name.strip())[1].lower() in _COUNTS


def names_quantity(name: str) -> bool:
    """True for a name of a quantity, with or without an axis."""
    lower = [word[0].lower() for word in _WORD.finditer(split_unit(name.strip())[0])]
    return not _OTHER & set(lower) and _kind(lower) is not None


def time_unit(name: str) -> str | None:
    """Unit of a column of times, "" where it states none; None where the column holds no times."""
    plain, unit = split_unit(name.strip())
    tail = ""
    if not unit:
        stem, _, tail = plain.rpartition("_")
        if stem and plain_unit("time", tail):
            plain, unit = stem, tail
    found = _TIME.fullmatch(plain.strip())
    if found is None or (found["word"].lower() == "x" and plain_unit("time", unit) is None):
        return None
    if re.sub(r"[\s_]", "", found["word"].lower()) == "sampletimefine":
        return unit or "us"
    return unit


def split_unit(name: str) -> tuple[str, str]:
    """A name without the unit in brackets at its end, and the unit."""
    found = _BRACKETS.search(name)
    if found is None or found["unit"].strip().isdigit():
        return name, ""
    return name[: found.start()], found["unit"].strip()


def _kind(lower: Sequence[str]) -> tuple[str, int, int, int | None] | None:
    """Quantity, its first and last word and the axis that is written to it; the last such word counts."""
    for k in reversed(range(len(lower))):
        pair = k > 0 and lower[k - 1] in _PAIRS
        for first, text in ((k - 1, lower[k - 1] + lower[k]),) * pair + ((k, lower[k]),):
            found = _WORD_OF_KIND.fullmatch(text)
            if found is not None:
                kind = next(name for name in ("acc", "gyr", "mag", "quat") if found[name])
                twice = text == "q" and k > 0 and lower[k - 1].startswith("quat")  # Quat_q0
                return (
                    kind,
                    first - twice,
                    k,
                    None if found["axis"] is None else "xyzw".index(found["axis"].lower()),
                )
            short = _SHORT.fullmatch(text) if first == k else None
            if short is not None and (short["axis"].lower() != "w" or short["kind"].lower() == "q"):
                return _SHORT_KINDS[short["kind"].lower()], k, k, "xyzw".index(short["axis"].lower())
    return None


def _bare(
    words: Sequence[tuple[str, int, int]], lower: Sequence[str], unit: str, kind: str
) -> ColumnName | None:
    """A name that is an axis alone."""
    if not kind or len(words) != 1 or lower[0] not in tuple("xyzw"):
        return None
    quantity = "acc" if kind == "free" else kind
    plain = plain_unit(quantity, unit) if unit and quantity != "quat" else ""
    return ColumnName("", kind, "xyzw".index(lower[0]), unit if plain is None else plain)


def _axis(kind: str, lower: Sequence[str], rest: list[int]) -> tuple[int | None, list[int]]:
    """The axis among the words after the quantity, and the other words."""
    if kind == "quat" and (scalar := [k for k in rest if lower[k] == "scalar"]):
        return 3, [k for k in rest if k != scalar[0]]
    letters = [
        k for k in rest if lower[k] in ("x", "y", "z") or (kind == "quat" and lower[k] in tuple("wijk"))
    ]
    if letters:
        axis = {"i": 0, "j": 1, "k": 2}.get(lower[letters[0]], "xyzw".find(lower[letters[0]]))
        return axis, [k for k in rest if k != letters[0]]
    joined = [k for k in rest if len(lower[k]) == 2 and lower[k][0] == "q" and lower[k][1] in "wxyz"]
    if kind == "quat" and joined:
        return "xyzw".index(lower[joined[0]][1]), [k for k in rest if k != joined[0]]
    numbers = [k for k in rest if lower[k] in (("0", "1", "2", "3") if kind == "quat" else ("1", "2", "3"))]
    if not numbers:
        return None, rest
    digit = int(lower[numbers[0]])
    axis = (3, 0, 1, 2)[digit] if kind == "quat" else digit - 1
    return axis, [k for k in rest if k != numbers[0]]


def _unit_words(kind: str, lower: Sequence[str], rest: list[int]) -> tuple[str, list[int]]:
    """A unit in the last words ("gyr_x_deg_s"), and the other words."""
    if kind == "quat":
        return "", rest
    for count in (4, 3, 2, 1):
        if len(rest) > count or (len(rest) == count and len(lower) > count):
            text = "".join(lower[k] for k in rest[-count:])
            if plain_unit(kind, text) is not None:
                return text, rest[:-count]
    return "", rest


def _sensor(plain: str, words: Sequence[tuple[str, int, int]], before: list[int], after: list[int]) -> str:
    """The words that name the sensor, as they are written."""
    while before and words[before[-1]][0].lower() in ("low", "noise", "wide", "range"):
        before = before[:-1]
    start = "" if not before else plain[: words[before[-1]][2]].strip(_SEPARATORS)
    own = {words[k][0] for k in before}
    end = " ".join(words[k][0] for k in after if words[k][0] not in own)
    return f"{start} {end}".strip()
