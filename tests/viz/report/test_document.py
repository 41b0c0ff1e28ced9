"""The report as a whole: its parts, well-formed, small, and as the inputs say."""

import json
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.trial.results.summary import summarise
from mbkf.viz.report.document import labels_of, read_labels, report_page
from tests.recordings import broken_walk, walk

VOID = {"meta", "link"}
LABELS = {"assigned_fraction": 0.998, "ghosts_dropped": 12, "swaps_repaired": 1, "first_labelled_frame": 0}


class Outline(HTMLParser):
    """Checks that every element is closed in order, and collects sections, headings and texts."""

    def __init__(self, text):
        super().__init__()
        self.open, self.sections, self.texts = [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        if tag == "section":
            self.sections.append(dict(attrs)["id"])

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def report(r, labels=None):
    return report_page(r, summarise(r), labels)


def test_it_says_in_which_axes_the_pelvis_is_told():
    assert "pelvis: the laboratory&#x27;s axes" in report(walk())
    along = replace(walk(), direction="progression", heading_rad=np.full(walk().frames, np.pi / 2))
    assert "direction of walking (straight path, 90° from the x axis)" in report(along)


def test_sections_come_in_order_quality_first():
    text = report(broken_walk())
    outline = Outline(text)
    assert outline.sections == ["quality", "gait", "motion", "reactions", "contacts", "settings"]
    assert len(text) < 5_000_000
    whole = " ".join(outline.texts)
    for words in ("walk <1>", "a remark with <b>markup</b>", "dynamic filter, as live", "jerk"):
        assert words in whole


def test_which_later_frames_are_known_is_told():
    lagged, smoothed = (
        report(replace(walk(), settings={"lag_ms": 60.0})),
        report(replace(walk(), smoothed=True)),
    )
    assert "dynamic filter, fixed lag 60 ms" in lagged
    assert "dynamic filter, smoothed (with all later frames)" in smoothed
    assert ("smoothing not counted" in smoothed, "smoothing not counted" in lagged) == (True, False)


def test_the_page_loads_nothing_and_runs_nothing():
    text = report(walk())
    assert "<script" not in text and "http://" not in text and "https://" not in text
    assert "default-src 'none'" in text


def test_numbers_that_are_not_known_do_not_appear_as_nan():
    r = walk()
    unknown = np.full_like(r.moments, np.nan)
    nothing = np.full_like(r.residual_force_n, np.nan)
    bare = replace(
        r, filter="kinematic", moments=unknown, moments_sd=unknown, angles_sd=unknown, foot_wrench_sd=None,
        foot_contact=None, foot_wrench=0.0 * r.foot_wrench, residual_force_n=nothing, residual_moment_nm=nothing,
        plate_corners_m=None, measured=np.zeros(r.frames, bool),
    )  # fmt: skip
    for page in (report(bare), report(broken_walk())):
        words = " ".join(Outline(page).texts).lower()
        assert "nan" not in words.split()
        assert 'd="m nan' not in page.lower() and "nan " not in page.lower()


def test_a_body_never_followed_is_reported_without_curves():
    r = walk()
    lost = replace(r, tracked=np.zeros(r.frames, bool), measured=np.zeros(r.frames, bool))
    assert Outline(report(lost)).sections == ["quality", "settings"]


@pytest.mark.parametrize("frames", [0, 1, 2])
def test_very_short_results(frames):
    r = walk()
    cut = {
        name: value[:frames]
        for name in r.__dataclass_fields__
        if isinstance(value := getattr(r, name), np.ndarray) and name != "plate_corners_m"
    }
    assert "quality" in Outline(report(replace(r, **cut))).sections


def test_a_report_tells_how_the_trial_was_labelled():
    text = report(walk(), LABELS)
    assert "12 reflections dropped" in text and "99.80 %" in text


def test_labels_are_found_beside_the_result(tmp_path):
    folder = tmp_path / "result"
    folder.mkdir()
    assert labels_of(folder, "walk") is None
    (tmp_path / "walk.json").write_text(json.dumps(LABELS))
    assert labels_of(folder, "walk") == LABELS
    (folder / "walk.json").write_text('{"other": 1}')
    assert labels_of(folder, "walk") == LABELS, "another program's file is passed over"


@pytest.mark.parametrize("content", [None, "no json", "[1]", "{}"])
def test_other_files_are_no_labels(content, tmp_path):
    path = tmp_path / "labels.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(FileFormatError, match="mbkf label"):
        read_labels(path)
