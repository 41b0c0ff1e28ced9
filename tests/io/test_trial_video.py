"""Videos belong to a trial by their name or by the session file; begins are kept to 0.01 s."""

import os

import pytest

from mbkf.errors import FileFormatError
from mbkf.io.session import SessionNotes, TrialNotes, plain_session, read_session, session_of, write_session
from mbkf.io.trial_video import TrialVideo, named_after, shown_video, videos_in

FILES = ("camera.mp4", "Walk1.mp4", "walk1-side.webm", "walk10.mp4", "walk1_front.MOV", "my walk1.mp4")


def test_videos_of_a_trial_begin_with_its_name():
    assert named_after("walk1", FILES) == ("Walk1.mp4", "walk1-side.webm", "walk1_front.MOV")
    assert named_after("walk10", FILES) == ("walk10.mp4",)
    assert named_after("squat", FILES) == ()


def test_the_first_stated_video_that_is_there_is_shown_before_the_named_one():
    stated = (TrialVideo("gone.mp4", 1.0), TrialVideo("camera.mp4", -2.5))
    assert shown_video("walk1", stated, FILES) == TrialVideo("camera.mp4", -2.5)
    assert shown_video("walk1", stated[:1], FILES) == TrialVideo("Walk1.mp4", 0.0)
    assert shown_video("squat", (), FILES) is None


def test_only_regular_files_of_the_folder_itself_are_videos(tmp_path):
    folder = tmp_path / "session"
    folder.mkdir()
    for name in ("b.webm", "a.MP4", "notes.txt", "../secret.mp4"):
        (folder / name).write_bytes(b"x")
    (folder / "folder.mp4").mkdir()
    os.mkfifo(folder / "pipe.mp4")
    (folder / "out.mp4").symlink_to(tmp_path / "secret.mp4")
    (folder / "dangling.mp4").symlink_to(folder / "missing")
    assert videos_in(folder) == ("a.MP4", "b.webm")
    assert videos_in(tmp_path / "missing") == ()


def test_a_begin_comes_back_to_a_hundredth_of_a_second(tmp_path):
    video = TrialVideo("walk1.mp4", -0.37)
    notes = SessionNotes(trials={"walk1": TrialNotes(videos=(video, TrialVideo("side.webm")))})
    write_session(notes, tmp_path / "session.toml")
    assert read_session(tmp_path / "session.toml") == notes
    typed = session_of({"trial": {"walk1": {"video": [{"file": "walk1.mp4", "begins_s": -0.3712}]}}})
    assert typed.trial("walk1").videos == (video,)
    assert plain_session(typed)["trial"]["walk1"]["video"] == [{"file": "walk1.mp4", "begins_s": -0.37}]


@pytest.mark.parametrize(
    "video", [{}, {"file": ""}, {"file": "a.mp4", "begins_s": "soon"}, {"file": "a.mp4", "x": 1}]
)
def test_a_video_that_is_not_possible_is_refused(video):
    with pytest.raises(FileFormatError):
        session_of({"trial": {"walk1": {"video": [video]}}})
