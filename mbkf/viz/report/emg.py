"""The report's electromyograms: the envelope of each muscle against time, with bars while the muscle is active."""

from __future__ import annotations

from mbkf.conventions import SIDES
from mbkf.io.results import Reconstruction
from mbkf.study.session.emg import trial_emg
from mbkf.trial.emg.envelope import upper_hz
from mbkf.viz.language import ENGLISH, words
from mbkf.viz.markup import grid, key, paragraph, section
from mbkf.viz.report.motion import BROAD, is_long
from mbkf.viz.svg import WIDTH, Line, Span, chart

MICROVOLTS = 1e6


def emg_section(r: Reconstruction) -> str:
    """Filters, and a chart of each muscle with right and left; an empty text without electromyograms."""
    emg = trial_emg(r)
    if emg is None:
        return ""
    chosen = emg.settings
    note = (
        f"EMG of {len(emg.peaks_v)} channels: offset removed, band-passed {chosen.low_hz:g}–"
        f"{upper_hz(emg.rate_hz, chosen):g} Hz and rectified; the envelope is its low-pass at "
        f"{chosen.envelope_hz:g} Hz. Bars above a chart: the muscle is active."
    )
    muscles = dict.fromkeys(_parted(name)[0] for name in r.muscle_names)
    return section(
        "emg",
        "EMG",
        paragraph(note),
        key(("swatch r", "right"), ("swatch l", "left")),
        grid((_chart(r, muscle) for muscle in muscles), columns=1 if is_long(r) else 3),
    )


def _parted(name: str) -> tuple[str, str]:
    """A muscle and its side, "" where the channel names none."""
    muscle, _, side = name.rpartition("_")
    return (muscle, side) if side in SIDES else (name, "")


def _chart(r: Reconstruction, muscle: str) -> str:
    assert r.emg_envelope is not None
    own = [k for k, name in enumerate(r.muscle_names) if _parted(name)[0] == muscle]
    lines, spans = [], []
    for k in own:
        side = _parted(r.muscle_names[k])[1] or "m"
        lines.append(Line(r.times_s, MICROVOLTS * r.emg_envelope[:, k], None, side))
        spans += [Span(b.from_s, b.to_s, side) for b in r.muscle_bursts if b.muscle == r.muscle_names[k]]
    title = words(ENGLISH, "muscles").get(muscle, muscle.replace("_", " ").upper())
    span = (float(r.times_s[0]), float(max(r.times_s[-1], r.times_s[0] + 1e-3)))
    width = BROAD if is_long(r) else WIDTH
    return chart(title, "µV", lines, span, "s", spans=spans, level=0.0, width=width)
