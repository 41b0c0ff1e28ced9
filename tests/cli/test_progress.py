"""Progress is drawn on a terminal's stderr and nowhere else."""

import io
import sys

from mbkf.cli.progress import stages


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_silent_when_stderr_is_not_a_terminal(capsys):
    with stages() as report:
        report("Scaling", 1, 2)
    assert capsys.readouterr() == ("", "")


def test_each_stage_has_its_bar_and_may_change_its_total(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with stages() as report:
        report("Scaling", 0, 2)
        report("Filtering", 4, 5)
        report("Scaling", 7, 7)
    for text in ("Scaling", "7/7", "Filtering", "4/5"):
        assert text in screen.getvalue()


def test_a_bar_goes_after_its_stage(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with stages() as report:
        report("Scaling", 2, 2)
        report("Filtering", 1, 5)
        before = len(screen.getvalue())
        report("Filtering", 2, 5)
        report("Writing", 0, 1)
    assert "Filtering" in screen.getvalue()[before:] and "Scaling" not in screen.getvalue()[before:]
