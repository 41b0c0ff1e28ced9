"""How a live run went, in the terminal and by its exit code."""

from mbkf.cli.following import report_outcome
from mbkf.stream.run.session import LiveOutcome


def test_a_failed_run_exits_with_1_and_says_why(tmp_path, capsys):
    report = {
        "frames_in": 9,
        "frames_lost": 0,
        "lag_ms": 0.0,
        "latency_ms_median": 1.0,
        "latency_ms_p99": 2.0,
    }
    report |= {"ended_by": "x", "frames_written": 9, "frames_not_written": 0, "log": None}
    assert report_outcome(LiveOutcome(report, None, None), tmp_path) == 0
    capsys.readouterr()
    assert report_outcome(LiveOutcome(report, None, None, "reading the stream failed"), tmp_path) == 1
    assert "ended early: reading the stream failed" in capsys.readouterr().err
    lacking = report | {"frames_written": 4, "frames_not_written": 5}
    assert report_outcome(LiveOutcome(lacking, None, None), tmp_path) == 1
    assert "5 frames were never logged and cannot be recovered" in capsys.readouterr().err
    assert (
        report_outcome(LiveOutcome(report, None, None, None, "writing the report failed: full"), tmp_path)
        == 1
    )
    assert "writing the report failed: full" in capsys.readouterr().err
