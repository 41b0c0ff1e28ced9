"""Exchanged names of static trials: mended, refused, or left in silence; clean statics that are renamed or refused.

Limits of :mod:`mbkf.scaling.standing_names` were set on some captures ("chosen on") and changed on none of the others
("shown on"). Each is spoilt by some thirty exchanges of names within a limb, across sides and anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.checks import Check, Context, information
from benchmarks.dynamic.methods import in_parallel
from benchmarks.statics.captures import CHOSEN, SHOWN, Static
from benchmarks.statics.judged import Judged, judged


def run(context: Context) -> list[Check]:
    """Rows of the captures that limits were chosen on, and of the others."""
    data = context.require_data()
    found: list[Check] = []
    for kind, captures in (("chosen on", CHOSEN), ("shown on", SHOWN)):
        statics = [Static(data, one) for one in (captures[:2] if context.quick else captures)]
        with in_parallel() as mapper:
            found += rows(kind, [one for some in mapper(judged, statics) for one in some])
    return found


def rows(kind: str, found: Sequence[Judged]) -> Iterator[Check]:
    """Shares of crossed statics that are left in silence, and of clean ones that are not left alone.

    Args:
        kind: "chosen on" or "shown on".
        found: The statics, clean and crossed.
    """
    clean, crossed = [one for one in found if one.clean], [one for one in found if not one.clean]
    for one in found:
        if (one.clean and one.outcome != "kept") or (
            not one.clean and one.outcome not in ("mended", "refused")
        ):
            yield information(f"{kind}: {one.label}: {one.outcome}", one.misfit)
    for outcome in ("mended", "refused"):
        count = sum(one.outcome == outcome for one in crossed)
        yield information(f"crossed statics ({kind}, {len(crossed)}) {outcome}", count)
    silent = sum(one.outcome in ("kept", "renamed otherwise") for one in crossed)
    yield Check(f"crossed statics ({kind}, {len(crossed)}) neither mended nor refused", silent, 0, "<=")
    accused = sum(one.outcome != "kept" for one in clean)
    yield Check(f"clean statics ({kind}, {len(clean)}) renamed or refused", accused, 0, "<=")
