"""Side and muscle by the names that laboratories give to channels of EMG, such as "R_TibAnt" or "Voltage.LGAS".

Names follow the recommendations of SENIAM (H. J. Hermens et al., J. Electromyogr. Kinesiol. 10 (2000) 361-374); short
forms are those of captures and of the makers' software (Delsys, Noraxon, Myon, Cometa).
"""

from __future__ import annotations

import re
from functools import cache
from typing import NamedTuple

SIDE_WORDS = {
    **dict.fromkeys(("r", "right", "rt", "dx"), "r"),
    **dict.fromkeys(("l", "left", "lt", "sx"), "l"),
}
"""Words that name a side; dx and sx are Italian laboratories'."""

MAKERS = frozenset(
    {
        "voltage",
        "volt",
        "analog",
        "channel",
        "sensor",
        "raw",
        "signal",
        "delsys",
        "trigno",
        "avanti",
        "noraxon",
    }
    | {"desktop", "dts", "myon", "cometa", "btsfreeemg", "btsemg", "zerowire", "aurion", "mini"}
)
"""Words of makers and of their software, besides the muscle's name."""

OTHER_SENSORS = frozenset(
    ["acc", "accel", "accelerometer", "gyro", "gyroscope", "mag", "magnetometer", "imu", "im", "orientation"]
)
"""Words of channels that the same sensors record besides EMG."""

EMG_WORD = "emg"

_GAS = r"gas(t(ro(c(nemius)?)?)?)?"

_PATTERNS = {
    "tibialis_anterior": r"ta|tib|tiba|tib(ialis)?ant(erior)?",
    "tibialis_posterior": r"tp|tibp|tib(ialis)?post(erior)?",
    "soleus": r"sol|soleus",
    "gastrocnemius": rf"gc|{_GAS}",
    "gastrocnemius_medialis": rf"mg|med(ial(is)?)?{_GAS}|{_GAS}m(ed(ial(is)?)?)?",
    "gastrocnemius_lateralis": rf"lg|gl|lat(eral(is)?)?{_GAS}|{_GAS}l(at(eral(is)?)?)?",
    "peroneus_longus": r"pl|per|peron?l?|(peroneus|fibularis)(long(us)?)?",
    "vastus_medialis": r"vm|vmo|vasm|vastm|vast?(us)?med(ial(is)?)?",
    "vastus_lateralis": r"vl|vlo|vasl|vastl|vast?(us)?lat(eral(is)?)?",
    "rectus_femoris": r"rf|rect|recf|rect?(us)?fem(oris)?",
    "biceps_femoris": r"bf|bflh|bicf|bic?(eps)?fem(oris)?(c(aput)?)?(l(ong[a-z]*)?h?(ead)?)?",
    "semitendinosus": r"st|semit|semiten[a-z]*",
    "semimembranosus": r"sm|semim|semimem[a-z]*",
    "hamstrings": r"ham|hams|hamstrings?",
    "medial_hamstrings": r"mh|mham|(med(ial)?)ham(s|strings?)?",
    "lateral_hamstrings": r"lh|lham|(lat(eral)?)ham(s|strings?)?",
    "quadriceps": r"quad|quads|quadriceps(femoris)?",
    "gluteus_maximus": r"gmax|glmax|glut?(eus|eal)?max(imus)?",
    "gluteus_medius": r"gmed|glmed|glut?(eus|eal)?med(ius)?",
    "adductors": r"add|adds|adductors?",
    "adductor_longus": r"al|addl|add(uctor)?long(us)?",
    "gracilis": r"gra|grac|gracilis",
    "sartorius": r"sar|sart|sartorius",
    "tensor_fasciae_latae": r"tfl|tensor(fasciae?)?(latae?)?",
    "iliopsoas": r"ilps|iliopsoas|psoas",
    "erector_spinae": r"es|ers|erec|erector(spinae)?|longissimus[a-z]*|multifidus",
    "rectus_abdominis": r"ra|rectabd|rectusabd(ominis)?",
    "external_oblique": r"eo|extobl(ique)?|external(abdominal)?obliques?|obliquus(externus)?[a-z]*",
    "trapezius": r"trap|trapezius[a-z]*|[ul]trap",
    "deltoid": r"delt|deltoid(eus)?[a-z]*",
    "biceps_brachii": r"bb|bic|biceps|bicepsbr(achii)?",
    "triceps_brachii": r"tb|tri|tric|triceps(br(achii)?)?",
    "latissimus_dorsi": r"ld|lat(issimus)?dors?i?",
    "pectoralis_major": r"pm|pec|pect|pectoralis(major)?",
    "gm": r"gm|glm",
}


@cache
def muscles() -> dict[str, re.Pattern[str]]:
    """Pattern of each muscle's name without spaces, in small letters.

    GM stays as written: it abbreviates three muscles. The patterns are compiled when a trial has channels to name.
    """
    return {name: re.compile(pattern) for name, pattern in _PATTERNS.items()}


class Muscle(NamedTuple):
    """A channel's muscle: its name, and its side, "r", "l" or "" where the name states none."""

    name: str
    side: str


def muscle_of(label: str) -> Muscle | None:
    """The muscle of a channel by its label; None for a channel that is not named as EMG.

    A channel with the word EMG and without a known muscle keeps its own name.

    Args:
        label: Label of the channel.
    """
    words = _words(label)
    if OTHER_SENSORS & set(words):
        return None
    is_emg = EMG_WORD in words
    named = [word for word in words if word not in MAKERS and word != EMG_WORD]
    sides = [SIDE_WORDS[word] for word in named if word in SIDE_WORDS]
    side = sides[0] if len(set(sides)) == 1 else ""
    rest = [word for word in named if word not in SIDE_WORDS]
    letters = "".join(word for word in rest if not word.isdigit())
    known = _known(letters, side)
    if known is not None:
        return known
    if not is_emg:
        return None
    return Muscle("_".join(dict.fromkeys([EMG_WORD, *rest])), side)


def _known(letters: str, side: str) -> Muscle | None:
    """The muscle of a name without spaces; the side may be its first or last letter."""
    if not letters:
        return None
    tried = [(letters, side)]
    if not side:
        tried += [(letters[1:], letters[0]), (letters[:-1], letters[-1])]
        tried += [(letters.removeprefix(word), one) for word, one in SIDE_WORDS.items() if len(word) > 2]
    for name, of_side in tried:
        if of_side in ("", "r", "l"):
            for muscle, pattern in muscles().items():
                if pattern.fullmatch(name):
                    return Muscle(muscle, of_side)
    return None


def _words(label: str) -> list[str]:
    """Words of a label in small letters: separated by signs, digits, or a capital after a small letter."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", label)]
