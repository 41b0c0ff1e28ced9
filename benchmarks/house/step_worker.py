"""Follows a synthetic squat with the mbkf of the tree that PYTHONPATH names, block by block on command.

Run as a file of its own, not as a module, so that it works in older trees. First it prints the folder of the mbkf that
it uses. Then it reads lines ``filter steps`` and answers each with the median time of a step in s.

    python -P step_worker.py FOLDER      # of a synthetic capture: trial.c3d, subject.toml
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import mbkf
from mbkf.numerics.threads import single_threaded

FILTERS = ("dynamic", "kinematic")

PART = "mbkf.trial.preparation."
NOW = f"{PART}filters", f"{PART}inputs", f"{PART}settings", f"{PART}selection"
QUESTION = "mbkf.pipelines.reconstruct"
BEFORE = "mbkf.pipelines.trial.filters", "mbkf.pipelines.trial.inputs", QUESTION, QUESTION
"""Modules of filters, inputs, settings and the choice of markers, in this tree and in one from before it had places."""


def followed(folder: Path) -> tuple[Any, dict[str, Any]]:
    """The trial's recording and a filter for it by name, from where this tree keeps them."""
    homes = NOW if (Path(mbkf.__file__).parent / "trial").is_dir() else BEFORE
    filters, inputs_of, settings, selection = (import_module(home) for home in homes)
    capture = mbkf.read_capture(folder / "trial.c3d")
    subject = mbkf.read_subject(folder / "subject.toml")
    shown = selection.subject_markers(capture.markers, subject)
    inputs, recording = inputs_of.trial_inputs(shown, capture.plates, subject, settings.ReconstructSettings())
    made = getattr(filters, "tracking_filter", None) or filters.follower
    return recording, {name: made(name, inputs) for name in FILTERS}


def main(folder: Path) -> None:
    """Answers commands until the input ends."""
    with single_threaded():
        recording, filters = followed(folder)
        starts = {name: one.start(recording, 0, None) for name, one in filters.items()}
        print(Path(mbkf.__file__).resolve().parent, flush=True)
        for line in sys.stdin:
            name, steps = line.split()
            estimate, times = starts[name], []
            for t in range(1, int(steps)):
                before = perf_counter()
                estimate = filters[name].step(estimate, recording, t)
                times.append(perf_counter() - before)
            print(median(times), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
