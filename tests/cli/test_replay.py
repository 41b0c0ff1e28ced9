"""`mbkf replay` plays at the speed, with the loss it is asked for, whether somebody listens or not."""

import uuid

from mbkf.cli.main import main


def test_it_plays_to_nobody_when_told_not_to_wait(person, capsys):
    words = [
        "replay",
        person.trial_trc,
        "--forces",
        person.forces,
        "--to",
        "lsl",
        "--wait",
        "0",
        "--speed",
        "5",
    ]
    name = ["--name", f"mbkf-test-{uuid.uuid4().hex[:8]}", "--loss", "1", "--jitter", "1"]
    assert main([str(word) for word in [*words, *name]]) == 0
    assert "0 frames sent at 500 Hz, 60 left out" in capsys.readouterr().out
