"""Progress is drawn on a terminal's stderr and nowhere else."""

import io
import sys

from mbkf.cli.progress import progress, stages


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_silent_when_stderr_is_not_a_terminal(capsys):
    with progress("Filtering", 3) as advance:
        advance(1)
        advance(2)
    with stages() as report:
        report("Scaling", 1, 2)
    assert capsys.readouterr() == ("", "")


def test_terminal_shows_title_and_count(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with progress("Filtering", 3) as advance:
        advance(1)
        advance(2)
    assert "Filtering" in screen.getvalue()
    assert "3/3" in screen.getvalue()


def test_each_stage_has_its_bar_and_may_change_its_total(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with stages() as report:
        report("Scaling", 0, 2)
        report("Filtering", 4, 5)
        report("Scaling", 7, 7)
    for text in ("Scaling", "7/7", "Filtering", "4/5"):
        assert text in screen.getvalue()
