"""Twenty-five kinds of faults that are put into recorded trials."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from benchmarks.verdict.faults import markers, names, plates
from benchmarks.verdict.recorded import Recorded

Put = Callable[[Recorded, np.random.Generator], tuple[Recorded, str]]
"""Puts a fault into a trial and states it."""

KINDS: Mapping[str, Put] = {
    "names within a leg": names.within_limb,
    "names across sides": names.across_sides,
    "legs exchanged": names.whole_legs,
    "names from a frame on": names.from_a_frame_on,
    "names in the static": names.in_static,
    "leg thrown": names.limb_thrown,
    "another person": markers.another_person,
    "static of another set": markers.static_of_another_set,
    "marker slipped": markers.slipped,
    "leg hidden": markers.hidden,
    "noise and ghosts": markers.ghosts,
    "wrong axes": markers.wrong_axes,
    "wrong unit": markers.wrong_unit,
    "wrong rate": markers.wrong_rate,
    "mass": plates.mass,
    "clock": plates.clock,
    "plates turned": plates.turned,
    "plates exchanged": plates.exchanged,
    "gain": plates.gain,
    "dead plate": plates.dead,
    "plates displaced": plates.displaced,
    "step beside": plates.beside,
    "harness": plates.harness,
    "pull": plates.pull,
    "chair": plates.chair,
    "box": plates.box,
}
