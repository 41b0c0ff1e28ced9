"""Messages that stand in the code of the library and may reach a page: each has its sentence in every language."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import mbkf
from mbkf.viz.sentences import said

ROOT = Path(mbkf.__file__).parent

ELSEWHERE = {
    "cli": "the command line's own output",
    "kernel": "arithmetic",
    "synthesis": "made motions",
    "imu": "commands for inertial sensors",
    "model/body": "body files of one's own",
    "model/clinical": "body files of one's own",
    "model/human": "programming",
    "model/joint_centres.py": "programming",
    "model/layout.py": "programming",
    "model/osim": "body files of one's own",
    "model/protocol_file.py": "written into files",
    "model/spread_tables.py": "body files of one's own",
    "model/symbolic": "programming",
    "model/trunk_levels.py": "body files of one's own",
    "model/urdf": "body files of one's own",
    "sensors/body_sensors.py": "programming",
    "sensors/contact/causal.py": "programming",
    "io/imu": "commands for inertial sensors",
    "io/amass.py": "made motions",
    "io/bvh.py": "programming",
    "io/glb.py": "programming",
    "io/mat5.py": "commands for inertial sensors",
    "io/osim.py": "body files of one's own",
    "io/loose_xml.py": "body files of one's own",
    "io/inertia.py": "programming",
    "io/installed.py": "programming",
    "io/readers.py": "programming",
    "io/frame_log.py": "programming",
    "io/c3d_write.py": "programming",
    "io/c3d_encode.py": "programming",
    "io/dimensions.py": "meanings in result files",
    "io/estimates.py": "meanings in result files",
    "io/quantities.py": "meanings in result files",
    "io/result_groups.py": "meanings in result files",
    "io/results.py": "meanings in result files",
    "io/results_h5.py": "meanings in result files",
    "io/results_opensim.py": "meanings in result files",
    "io/truth.py": "meanings in result files",
    "io/body_covariance.py": "meanings in subject files",
    "io/spread": "meanings in subject files",
    "io/preset": "presets",
    "io/units": "presets",
    "io/osim_joints.py": "body files of one's own",
    "io/norm_files/written.py": "written into exported files",
    "study/survey/problems.py": "said by its key, from the section problems",
    "study/batch/plan.py": "options of a command",
    "trial/live/filter.py": "programming",
    "__init__.py": "programming",
    "errors.py": "parts of sentences",
    "trial/demo.py": "the demonstration",
    "trial/exchange": "written into exported files",
    "trial/export.py": "options of a command",
    "trial/filter_observability.py": "programming",
    "trial/inertia": "a command of its own",
    "trial/inertial": "commands for inertial sensors",
    "trial/live/worn.py": "commands for inertial sensors",
    "trial/labelling/score.py": "a command of its own",
    "trial/observability.py": "programming",
    "trial/preparation/presets.py": "options of a command",
    "trial/preparation/settings.py": "options of a command",
    "trial/preparation/filters.py": "options of a command",
    "trial/synth.py": "made motions",
    "trial/results/summary.py": "made motions",
    "study/tun": "a command of its own",
    "study/batch/list": "lists for a command",
    "study/batch/cluster.py": "options of a command",
    "study/batch/worker_process.py": "programming",
    "stream/libraries.py": "settings of a library",
    "stream/found.py": "a list of a command",
    "stream/played.py": "replay to other programs",
    "stream/natnet/player.py": "replay to other programs",
    "stream/natnet/packets.py": "replay to other programs",
    "stream/results/websocket.py": "options of a command",
    "stream/run/sensor_standing.py": "commands for inertial sensors",
    "stream/lsl/sensor": "commands for inertial sensors",
    "filters/given_settings.py": "settings files",
    "filters/torque/settings.py": "settings files",
    "filters/torque/filter.py": "programming",
    "filters/filter.py": "programming",
    "numerics/discretisation.py": "programming",
    "numerics/smoothing.py": "programming",
    "labelling": "programming",
    "marker_sets/spelling.py": "the dictionary of names",
    "marker_sets/sides.py": "the dictionary of names",
    "viz": "pages, which are looked at as such",
}
"""Places whose texts reach no page, and the reason."""

DECLARED = "fields."
"""Functions that declare the entries of a file; their texts are its documentation."""

NO_TEXTS = frozenset(
    (
        "export frame rate", "capture frame rate", "total exported frames", "total frames in take",
        "attachment; filename*=utf-8''71", "Reference bands of a laboratory, written by mbkf",
        "A laboratory, for the head of its reports", "day of the visit", "the person's day of birth",
        "condition of walking: 71, or a text of your own", "diagnosis, or reason of the visit", "notes for the report",
        "person who signs the report", "GetParameters General 3D Force", "QTM RT Interface connected",
        "number of persons", "gait cycles that count",
        "A session, as 'mbkf app' and 'mbkf batch' read it",
        "A scaled subject, written by mbkf. Lengths in m, mass in kg; positions in the segment's frame",
    )
)  # fmt: skip
"""Entries and headings of files, which stay as they are."""

LEAST_WORDS = 3


def unsaid() -> tuple[int, list[str]]:
    """Number of messages, and those that no Spanish sentence says."""
    count, found = 0, []
    for path in sorted(ROOT.rglob("*.py")):
        place = path.relative_to(ROOT).as_posix()
        if place.startswith(tuple(ELSEWHERE)):
            continue
        for line, text in messages(path):
            count += 1
            shown = said(text, "es")
            if shown == text or re.search(r"\b(?:the|of|is|are|and|with|from|which)\b", shown):
                found.append(f"{place}:{line}: {text}")
    return count, found


def messages(path: Path) -> Iterator[tuple[int, str]]:
    """Lines and texts of a module with three words or more, with a name or number in each place."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    silent = {id(part) for node in ast.walk(tree) for part in _silent(node)}
    for node in ast.walk(tree):
        if id(node) in silent or not isinstance(node, ast.Constant | ast.JoinedStr):
            continue
        text = _filled(node)
        if (
            text is not None
            and len(re.findall(r"[^\W\d_]{2,}", text)) >= LEAST_WORDS
            and _is_sentence(text)
            and text not in NO_TEXTS
        ):
            yield node.lineno, text


def _silent(node: ast.AST) -> Iterator[ast.AST]:
    """Parts of the tree that are no messages: documentation, declarations, places of f-strings."""
    body = getattr(node, "body", None)
    if isinstance(body, list):
        yield from (one.value for one in body if isinstance(one, ast.Expr))
    if isinstance(node, ast.JoinedStr):
        yield from node.values
    if isinstance(node, ast.Call) and ast.unparse(node.func).startswith(DECLARED):
        yield from ast.walk(node)


def _filled(node: ast.Constant | ast.JoinedStr) -> str | None:
    """A text with a part of the body after an article and numbers elsewhere; None of another constant."""
    if isinstance(node, ast.Constant):
        parts = [node.value] if isinstance(node.value, str) else None
        made = None if parts is None else parts[0]
    else:
        made = ""
        for k, one in enumerate(node.values):
            if isinstance(one, ast.Constant):
                made += str(one.value)
            else:
                made += (
                    "right foot" if made.endswith("the ") else f", 7{k}" if made.endswith("\0") else f"7{k}\0"
                )
        made = made.replace("\0", "")
    return None if made is None else re.sub(r"\{[^{}]*\}", "73", made).strip(" ;:,.\n")


def _is_sentence(text: str) -> bool:
    """False for markup, patterns and code."""
    return not re.search(r"[<>\\^]|\bimport\b|=\s*\S+;", text) and " " in text
