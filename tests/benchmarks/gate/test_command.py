"""The gate from end to end on one short motion: shut by a worsened setting, which is named; open for what it was."""

from dataclasses import replace

import pytest
from rich.console import Console

from benchmarks.__main__ import main
from benchmarks.gate import command, measured, metrics
from benchmarks.gate.baseline import Baseline, held, write_baseline
from mbkf.errors import InvalidInput
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.captures import made_capture

pytestmark = pytest.mark.slow


def made_once(function):
    """Gives its first answer to the same settings again: the gate is asked, not the filter."""
    answers = {}

    def answer(*words, settings=None, **named):
        if settings not in answers:
            given = {} if settings is None else {"settings": settings}
            answers[settings] = function(*words, **given, **named)
        return answers[settings]

    return answer


@pytest.fixture
def short(monkeypatch, tmp_path):
    """One short squat, followed in two of the ways, and a baseline of it."""
    monkeypatch.setattr(measured, "TRIALS", {"squat": 1.0})
    every = metrics.variants
    monkeypatch.setattr(
        metrics, "variants", lambda *made: {name: every(*made)[name] for name in ("smoothed", "hidden")}
    )
    for name in ("synthesise", "scale", "label", "reconstruct"):
        monkeypatch.setattr(metrics, name, made_once(getattr(metrics, name)))
    monkeypatch.delenv("CI", raising=False)
    monkeypatch.setattr(measured, "library", lambda: None)  # times of steps are no metrics then
    found = list(measured.measured(tmp_path / "first", None))
    write_baseline(Baseline({one.name: held(one) for one in found}), tmp_path / "baseline.toml")
    return tmp_path


def worsened(settings):
    """Markers are weighed as if their noise were six times what it is."""
    markers = replace(settings.dynamic.markers, marker_noise_scale=6.0)
    return replace(settings, dynamic=replace(settings.dynamic, markers=markers))


def test_each_way_of_reconstructing_differs_from_the_plain_one_in_what_its_name_says():
    made = metrics.variants(made_capture(3), 1.0)
    plain = made.pop("smoothed")
    assert plain == ReconstructSettings(keep_covariance=True)
    assert made.pop("causal") == replace(plain, smooth=False)
    assert made.pop("kinematic") == replace(plain, filter="kinematic")
    assert made.pop("without plates") == replace(plain, without_plates=("1", "2"))
    (hidden,) = made.pop("hidden").hide
    assert (hidden.from_s, hidden.to_s) == pytest.approx((0.4, 0.7)) and len(hidden.names) == 9
    assert made == {}


def run(place, change=None):
    console = Console(record=True, width=120)
    opened = command.gate(console, place / "out", None, place / "baseline.toml", change)
    return opened, console.export_text()


def test_the_gate_opens_for_what_it_was_and_shuts_for_a_worsened_setting(short):
    opened, shown = run(short)
    assert opened and "WORSE" not in shown and "real captures are left out" in shown
    opened, shown = run(short, worsened)
    assert not opened
    assert (
        "the gate stays shut: " in shown and "squat, smoothed: marker RMS" in shown.split("stays shut: ")[1]
    )


def test_without_captures_the_gate_fails_in_ci_and_no_baseline_is_made(monkeypatch, tmp_path):
    monkeypatch.setenv("CI", "true")
    with pytest.raises(InvalidInput, match="reference captures"):
        command.gate(Console(), tmp_path, None)
    with pytest.raises(InvalidInput, match="reference captures"):
        command.update(Console(), tmp_path, None, "why")


def test_the_command_line_reaches_it(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(command, "gate", lambda *words: asked.append(words) or len(asked) > 1)
    monkeypatch.setattr(command, "update", lambda *words: asked.append(words))
    assert main(["--gate", "--out", str(tmp_path)]) == 1
    assert main(["--gate", "--out", str(tmp_path)]) == 0
    assert main(["--update-baseline", "why", "--out", str(tmp_path)]) == 0
    assert asked[-1][-1] == "why"
