"""A report shows the video that lies beside it, by a relative address, and loads nothing without one."""

import re

from mbkf.io.session import SessionNotes, TrialNotes, write_session
from mbkf.io.trial_video import TrialVideo
from mbkf.trial.results.summary import summarise
from mbkf.viz.report.document import report_page
from mbkf.viz.report.video import video_beside, video_section
from tests.recordings import walk


def test_the_video_of_the_session_file_or_of_the_name_is_linked(tmp_path):
    assert video_beside(tmp_path, "walk1") is None
    for name in ("walk1.mp4", 'a "b"&c?.webm'):
        (tmp_path / name).write_bytes(b"x")
    assert video_beside(tmp_path, "walk1").address == "./walk1.mp4"
    assert video_beside(tmp_path, "walk2") is None
    chosen = TrialVideo('a "b"&c?.webm', -0.37)
    write_session(SessionNotes(trials={"walk2": TrialNotes(videos=(chosen,))}), tmp_path / "session.toml")
    shown = video_section(video_beside(tmp_path, "walk2"), "es")
    assert 'src="./a%20%22b%22%26c%3F.webm"' in shown and "empieza en -0.37 s" in shown
    assert "a &quot;b&quot;&amp;c?.webm</a>" in shown


def test_only_a_report_with_a_video_may_load_one(tmp_path):
    (tmp_path / "walk.mp4").write_bytes(b"x")
    linked, facts = video_beside(tmp_path, "walk"), summarise(walk())
    pages = [report_page(walk(), facts), report_page(walk(), facts, video=linked)]
    assert [re.findall(r"media-src ([^\"]+)\"", page) for page in pages] == [["'none'"], ["'self' file:"]]
    assert ["<video" in page for page in pages] == [False, True]
    assert 'href="#video"' in pages[1] and 'href="#video"' not in pages[0]
