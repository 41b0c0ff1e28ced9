"""Commands load the libraries that they use and no other: what a command does not need, its start does not wait for."""

import subprocess
import sys

UNUSED = {
    "casadi", "matplotlib", "meshcat", "pyarrow", "pylsl", "rich.progress", "scipy.interpolate", "scipy.io",
    "scipy.ndimage", "scipy.optimize", "scipy.signal", "scipy.spatial", "scipy.special", "scipy.stats", "sphinx",
    "websockets", "yourdfpy",
}  # fmt: skip
"""What no reconstruction of a C3D file needs; ``rich.progress`` is for terminals."""

REPORT = "\nprint(*sorted(set(sys.modules)), file=sys.stderr)"


def loaded_by(code, *words):
    """Modules that a Python of its own has loaded once the code is done."""
    command = [sys.executable, "-c", "import sys\n" + code + REPORT, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stderr.split())


def test_the_command_line_itself_needs_the_standard_library_alone():
    loaded = loaded_by("import mbkf.cli.main")
    assert not (UNUSED | {"h5py", "numpy", "pinocchio", "rich", "scipy"}) & loaded


def test_a_reconstruction_loads_nothing_that_it_does_not_use(person, tmp_path):
    code = "from mbkf.cli.main import main\nassert main(sys.argv[1:]) == 0"
    words = ["reconstruct", person.trial, "--subject", person.subject, "--out", tmp_path / "out"]
    loaded = loaded_by(code, *words)
    assert {"mbkf.io.c3d", "h5py", "pinocchio", "rich.table"} <= loaded, "it was looked after the work"
    assert not (UNUSED | {"mbkf.io.imu.files", "mbkf.model.urdf_body"}) & loaded


LISTENING = """\
import mbkf.cli.live
from mbkf.cli.main import main

class Listening(BaseException):
    pass

def follow(args, source, begin, waiting):
    source.close()
    raise Listening

mbkf.cli.live.follow = follow
try:
    main(sys.argv[1:])
except Listening:
    print("listening")
"""


def test_a_live_run_listens_before_the_filter_is_loaded(person, tmp_path):
    words = ["live", "--from", "udp:0", "--subject", person.subject, "--out", tmp_path / "out"]
    loaded = loaded_by(LISTENING, *words)
    assert "mbkf.stream.udp.source" in loaded
    assert not (UNUSED | {"mbkf.stream.run.session", "mbkf.stream.run.standing"}) & loaded


def test_a_live_run_of_named_markers_loads_no_labelling(person, tmp_path):
    code = "from mbkf.cli.main import main\nassert main(sys.argv[1:]) == 0"
    stream = ["--from", f"file:{person.trial}", "--speed", "0", "--seconds", "0.3"]
    loaded = loaded_by(code, "live", *stream, "--subject", person.subject, "--out", tmp_path / "out")
    assert "mbkf.stream.run.session" in loaded
    assert (UNUSED | {"mbkf.trial.live.labels"}) & loaded == set()
