"""A remark is left away where a reason states it; another one stays."""

from mbkf.io.verdict import Reason, Verdict
from mbkf.trial.verdict.restated import stated, unstated

CLOCK = "clocks of markers and plates +21.5 ms, plates are 21 ms late"
VERDICT = Verdict.of(
    [
        Reason("trunk_loads", "look", CLOCK, "loads belong to other frames", "shift them"),
        Reason(
            "pelvis",
            "look",
            "the right hand bears up to 200 N from 1 to 2 s, which nothing measures",
            "-",
            "-",
        ),
        Reason("left_arm", "do not use", "the capture shows nothing of it", "-", "-", shown=False),
    ]
)


def test_a_check_and_a_load_are_stated_once():
    clock = "clocks of markers and plates: +21.5 ms (noise explains ± 0.9); plates are 21 ms late: shift them"
    other = "axes of plate '1': 4 (noise explains ± 1); turned by 90°"
    bearing = (
        "other parts than the feet bear load, estimated from the motion: right hand 1.00…2.00 s (up to 200 N)"
    )
    assert unstated([clock, other, bearing, other], VERDICT) == (other,)
    assert stated("clocks of markers and plates", VERDICT) and not stated("mass against plates", VERDICT)


def test_without_such_a_reason_the_remark_stays():
    bearing = (
        "other parts than the feet bear load, estimated from the motion: right hand 1.00…2.00 s (up to 200 N)"
    )
    assert unstated([bearing], Verdict()) == (bearing,)
    assert unstated(["the capture shows nothing of it"], VERDICT) == ("the capture shows nothing of it",)
