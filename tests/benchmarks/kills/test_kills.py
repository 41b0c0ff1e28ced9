"""What a command does with files is counted and can be killed at; what is found afterwards is told apart."""

import random
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import kills
from benchmarks.kills.jobs import NOTE, OLD_FRAMES, Job, Kill, result_state
from benchmarks.kills.killed import Steps
from mbkf.io.results_folder import write_reconstruction
from tests.io.reconstructions import made_up


def job(**more):
    return Job("reconstruct", lambda place: [], Path(), lambda place, ended: "new", **more)


def test_steps_are_changes_in_the_folder(tmp_path):
    steps = Steps(tmp_path, 0)
    inside, outside = str(tmp_path / "a"), "/elsewhere/a"
    for event, args, counted in (
        ("open", (inside, "w", 0o101), True),
        ("open", (inside, "r", 0), False),
        ("open", (3, "w", 0o101), False),
        ("os.rename", (inside, outside, -1, -1), True),
        ("os.rename", (outside, inside, -1, -1), False),
        ("os.mkdir", (outside, 0o777, -1), False),
        ("ctypes.dlsym", (None, "renameat2"), True),
        ("ctypes.dlsym", (None, "malloc"), False),
        ("os.listdir", (inside,), False),
    ):
        before = steps.count
        steps(event, args)
        assert (steps.count > before) == counted, (event, args)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_command_kills_itself_before_a_step(tmp_path):
    def ended(step):
        command = [sys.executable, "-m", "benchmarks.kills.killed", str(tmp_path), str(step)]
        return subprocess.run([*command, "preset", "--bad"], capture_output=True, check=False).returncode

    assert ended(0) == 2
    text = "import sys; from pathlib import Path; from benchmarks.kills.killed import Steps\n"
    text += "folder = Path(sys.argv[1]); sys.addaudithook(Steps(folder, 2))\n"
    text += "(folder / 'a').write_text('x'); (folder / 'b').write_text('x')"
    assert subprocess.run([sys.executable, "-c", text, str(tmp_path)], check=False).returncode == -9
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_kills_come_after_a_time_or_before_a_step():
    draw = random.Random(1)
    found = [kills.random_kill(job(steps=7, span_s=(0.5, 2.0)), draw) for _ in range(200)]
    steps = {kill.step for kill in found}
    assert steps == set(range(8))
    assert all(0.5 <= kill.after_s <= 2.0 for kill in found if kill.step == 0)
    assert all(kills.random_kill(job(span_s=(0.5, 2.0)), draw).step == 0 for _ in range(20))


def test_what_is_neither_old_nor_new_breaks_the_bound():
    known = job(steps=3)
    checks = kills.rows([Kill(known, step=k) for k in (1, 2, 3)], ["old", "new", "OSError: gone"])
    assert [check.passed for check in checks] == [False, True, True]
    assert checks[0].value == 1.0 and "before step 3" in checks[2].name


def test_a_mixed_folder_and_a_missing_note_are_told(tmp_path):
    result = made_up(frames=OLD_FRAMES)
    write_reconstruction(result, {"frames": result.frames}, tmp_path)
    with pytest.raises(FileNotFoundError):
        result_state(tmp_path)
    (tmp_path / NOTE).write_text(NOTE)
    assert result_state(tmp_path) == "old"
    table = tmp_path / "torques.sto"
    table.write_text(table.read_text().replace("Run=", "Run=x"))
    with pytest.raises(AssertionError, match="files of 2 runs"):
        result_state(tmp_path)
