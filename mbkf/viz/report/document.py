"""One self-contained page about a reconstruction: quality first, then gait, motion, loads and settings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from mbkf.errors import FileFormatError
from mbkf.io.files_read import SETTINGS_BYTES, read_text
from mbkf.io.plain_data import parse_json
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import LABELS_FILE
from mbkf.io.session import FootEvent
from mbkf.study.scaling.report import scaled_from
from mbkf.trial.gait.convention import Convention, convention_of_result
from mbkf.trial.gait.cycles import find_gait
from mbkf.trial.results.progression import LABORATORY
from mbkf.trial.results.summary import progression_summary
from mbkf.trial.verdict.judge import verdict_of
from mbkf.viz.language import ENGLISH
from mbkf.viz.markup import Html, folded, paragraph, section, table
from mbkf.viz.page import BLUE_RED, document, report_style
from mbkf.viz.report.contacts import contact_section
from mbkf.viz.report.emg import emg_section
from mbkf.viz.report.gait import gait_section
from mbkf.viz.report.motion import motion_section, reaction_section
from mbkf.viz.report.quality import quality_section
from mbkf.viz.report.trunk import trunk_section
from mbkf.viz.report.verdict import verdict_banner
from mbkf.viz.report.video import MEDIA, LinkedVideo, video_section
from mbkf.viz.sentences import said

ANGLES_READ = {
    "model": "Angles are about the body's own axes, in the order of the ISB recommendations",
    "isb": "Angles are read in the ISB's axes, torques about the body's own",
    "pig": "Angles are read in Plug-in Gait's axes, torques about the body's own",
}

NAVIGATION = (
    ("quality", "Quality"), ("gait", "Gait"), ("motion", "Angles and torques"), ("trunk", "Trunk"),
    ("reactions", "Reactions"), ("contacts", "Contacts"), ("emg", "EMG"), ("video", "Video"),
    ("settings", "Settings"),
)  # fmt: skip


def report_page(
    reconstruction: Reconstruction,
    summary: Mapping[str, object],
    labels: Mapping[str, object] | None = None,
    by_hand: Iterable[FootEvent] | None = None,
    convention: Convention | None = None,
    colours: str = BLUE_RED,
    language: str = ENGLISH,
    video: LinkedVideo | None = None,
) -> str:
    """The report.

    Args:
        reconstruction: The results.
        summary: Its summary.json.
        labels: The JSON of ``mbkf label`` for the labelled capture, or None.
        by_hand: Strikes and toe-offs set by hand; None for the detected ones.
        convention: Axes and signs of curves; None: the one that the result was reconstructed with.
        colours: Of right and left, one of :data:`mbkf.viz.page.COLOURS`.
        language: Code of the language; texts are written in English here, and said in it by the page.
        video: A video to show; None without.
    """
    r, convention = reconstruction, convention or convention_of_result(reconstruction)
    gait = find_gait(r, by_hand) if r.tracked.any() else None
    sections = [quality_section(r, summary, labels)]
    if r.tracked.any():
        sections += [gait_section(gait, r.times_s), motion_section(r, gait, convention), trunk_section(r)]
        sections += [reaction_section(r, gait), contact_section(r), emg_section(r)]
    sections += [] if video is None else [video_section(video, language)]
    sections.append(_settings(r, summary))
    there = [entry for entry in NAVIGATION if any(f'<section id="{entry[0]}"' in s for s in sections)]
    body = _heading(r) + verdict_banner(verdict_of(r)) + "".join(sections)
    media = "'none'" if video is None else MEDIA
    return document(
        language,
        f"{r.trial} · {said('report', language)}",
        report_style(colours, "report.css"),
        there,
        body,
        media,
    )


def read_labels(path: str | Path) -> dict[str, object]:
    """The JSON that ``mbkf label`` writes beside a labelled capture.

    Raises:
        FileFormatError: The file is missing, no JSON, or no report of ``mbkf label``.
    """
    source = Path(path)
    try:
        found = parse_json(read_text(source, SETTINGS_BYTES))
    except (OSError, ValueError) as error:
        raise FileFormatError(source, f"cannot be read ({error}); make it with 'mbkf label'") from error
    if "ghosts_dropped" not in found:
        raise FileFormatError(source, "is no report of 'mbkf label'")
    return dict(found)


def labels_of(folder: str | Path, trial: str) -> dict[str, object] | None:
    """A trial's label report or None: labels.json of a batch, or TRIAL.json of ``mbkf label`` there or beside."""
    place = Path(folder)
    for path in (place / LABELS_FILE, place / f"{trial}.json", place.absolute().parent / f"{trial}.json"):
        if path.is_file():
            try:
                return read_labels(path)
            except FileFormatError:
                continue  # another program's file of that name
    return None


def _heading(r: Reconstruction) -> str:
    height = f", {r.subject.height_m:.2f} m" if r.subject.height_m else ""
    duration = r.frames / r.rate_hz
    facts = (
        f"{r.subject.mass_kg:.1f} kg{height}",
        f"{r.frames} frames at {r.rate_hz:g} Hz, {duration:.2f} s",
        f"{len(r.marker_names)} markers, protocol {r.protocol}",
        f"{r.filter} filter, {r.later_frames}",
        f"mbkf {r.version}",
    )
    return f"<h1 translate='no'>{escape(r.trial)}</h1><p class='facts'>{' · '.join(escape(fact) for fact in facts)}</p>"


def _settings(r: Reconstruction, summary: Mapping[str, object]) -> str:
    speed = summary.get("realtime_factor")
    seconds = summary.get("step_seconds_median")
    run = [("filter", r.filter), ("later frames", r.later_frames), ("version", r.version)]
    if speed and isinstance(speed, int | float) and isinstance(seconds, int | float):
        text = f"{1e3 * seconds:.2f} ms a frame (median), {speed:.1f} times real time"
        run.append(("computing time", f"{text}; smoothing not counted" if r.smoothed else text))
    factors = [(name.replace("_", " "), f"{value:.3f}") for name, value in r.subject.scale_factors.items()]
    scaled = "".join(paragraph(line[0].upper() + line[1:] + ".") for line in scaled_from(r.subject.report))
    chosen = r.settings.get(r.filter, {})
    others = {k: v for k, v in r.settings.items() if k not in ("kinematic", "dynamic", "torque", "filter")}
    return section(
        "settings",
        "Settings",
        table(("this run", ""), run, "small"),
        folded(f"Settings of the {r.filter} filter", table(("setting", "value"), _code(chosen), "small")),
        folded("Other settings", table(("setting", "value"), _code(others), "small")),
        folded("Subject", table(("scale factor", "value"), factors, "small") + scaled),
        paragraph(
            f"Files of the result: {ANGLES_READ[r.angles_read]}; pelvis: {_pelvis_frame(r)}; "
            "world axes: x forward, y left, z up."
        ),
    )


def _pelvis_frame(r: Reconstruction) -> str:
    """The axes of the pelvis's angles, in words."""
    frame = progression_summary(r.direction, r.heading_rad)
    if r.direction == LABORATORY:
        return "the laboratory's axes"
    return f"frame of progression ({frame['kind']}, {frame['heading_deg']:z.0f}° from the x axis)"


def _code(value: Any) -> list[tuple[str, str]]:
    """Settings as rows of name and value, as files and scripts spell them."""
    return [
        (Html(f"<code>{escape(name)}</code>"), Html(f"<code>{escape(text)}</code>"))
        for name, text in _flat(value)
    ]


def _flat(value: Any, prefix: str = "") -> list[tuple[str, str]]:
    """Nested plain data as rows of name and text."""
    if isinstance(value, Mapping):
        return [row for k, v in value.items() for row in _flat(v, f"{prefix} · {k}" if prefix else str(k))]
    if isinstance(value, float):
        return [(prefix.replace("_", " "), f"{value:g}")]
    return [(prefix.replace("_", " "), "–" if value in (None, (), []) else str(value))]
