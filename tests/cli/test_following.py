"""How a live run went, in the terminal and by its exit code."""

from types import SimpleNamespace

from mbkf.cli.following import SaidVerdict, report_outcome
from mbkf.io.verdict import Reason, Verdict
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.run.session import LiveOutcome
from mbkf.viz.sentences import said


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
    lost = lacking | {"recording": "r.c3d", "frames_recorded": 0, "recording_problem": "full"}
    assert report_outcome(LiveOutcome(lost, None, None, "cut"), tmp_path) == 1
    line = capsys.readouterr().err.strip().removeprefix("mbkf: error: ")
    assert "--recover" in line and said(line, "en").count("folder") == 2
    assert said(line, "es") == (
        "la sesión en vivo terminó antes de tiempo: cut; 5 fotogramas no se grabaron y se han perdido; no se pudo "
        "escribir la grabación: full; los marcadores y las fuerzas grabados se conservan en la carpeta "
        f"{tmp_path.name}; los resultados de 4 fotogramas están en la carpeta {tmp_path.name}"
    )


def test_the_running_verdict_is_said_when_the_word_on_a_part_changes():
    spoken = []
    sink = SaidVerdict(spoken.append)

    def frame(judgement):
        return SimpleNamespace(judgement=judgement)

    def look(millimetres):
        return Verdict.of([Reason("trunk", "look", f"{millimetres} mm off", "it may be loose", "look at it")])

    sink.take(frame(None))
    for judgement in (Judgement(Verdict(), 1.0), Judgement(look(9), 1.5), Judgement(look(10), 2.0)):
        sink.take(frame(judgement))
        sink.take(frame(judgement))
    sink.take(frame(Judgement(Verdict(), 2.5)))
    sink.close()
    assert spoken == ["1.0 s: use", "1.5 s: look: trunk; 9 mm off: it may be loose; look at it", "2.5 s: use"]
