"""The page is one text that loads nothing, says only known words, and puts texts of files nowhere but into data."""

import json
import re

import pytest

from mbkf.app.trial_viewer import SCRIPTS, viewer_data, viewer_page
from mbkf.io.results_folder import write_result_files
from mbkf.io.session import EventKind, FootEvent
from mbkf.trial.gait.events import foot_events, plain_found
from mbkf.trial.results.summary import summarise
from mbkf.viz.language import words
from mbkf.viz.page import asset
from tests.recordings import walk

OWN = "\n".join(asset(name) for name in SCRIPTS if "viewer" in name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("result")
    write_result_files(walk(), summarise(walk()), place)
    return place


def test_the_data_are_the_result_s_and_tell_found_from_set(folder):
    event = FootEvent("left", EventKind.OFF, 1.25)
    data = viewer_data(folder, (event,))
    found = [FootEvent(one["side"], EventKind(one["kind"]), one["time_s"]) for one in data["found"]]
    assert tuple(found) == plain_found(foot_events(walk()))
    assert data["events"] == [{"side": "left", "kind": "off", "time_s": 1.25}]
    assert data["frame_s"] == 1.0 / walk().rate_hz
    assert data["span_s"] == [walk().times_s[0], walk().times_s[-1]]
    assert viewer_data(folder)["events"] is None


def test_the_page_is_one_text_that_loads_nothing(folder):
    name = "</script><b>x"
    page = viewer_page("P1", name, ["<i>other"], viewer_data(folder), {"files": []})
    assert "{{" not in page.split("<script>")[0] and name not in page and "<i>other" not in page
    assert re.findall(r"<(?:script|img|iframe|link)[^>]*\b(?:src|href)=[\"'](?!data:)", page) == []
    (told,) = re.findall(r'id="viewer">(.*?)</script>', page)
    assert json.loads(told) == {
        "session": "P1",
        "trial": name,
        "others": ["<i>other"],
        "videos": {"files": []},
    }


def test_texts_become_no_markup():
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", OWN)


def test_every_word_is_used_and_every_used_one_known():
    text = "\n".join(asset(name) for name in SCRIPTS if name != "app_words.js")
    known, asked = set(words("en", "viewer")), set(re.findall(r"(?:word|button)\(\s*\"(\w+)\"", text))
    made = {f"{side}_{kind}" for side in ("right", "left") for kind in ("strike", "off")}
    made |= {f"{what}_{how}" for what in ("contact", "pressure") for how in ("measured", "estimated")}
    made |= {f"from_{view}" for view in ("oblique", "front", "right", "left", "back", "top")} | {
        "side_r",
        "side_l",
    }
    page = asset("page.js")
    made |= {f"legend_{what}" for what in re.findall(r"\[\"(\w+)\", \"\S\", ", page)} | {
        "by_cycle",
        "by_time",
    }
    assert asked <= known and made <= known
    assert known <= set(re.findall(r"\b(\w+)\b", OWN + asset("panel.js"))) | made | asked


@pytest.mark.parametrize(
    ("section", "scripts"),
    [("live_page", ("live.js", "standing.js")), ("marker_set_page", ("marker_set.js", "marker_edit.js"))],
)
def test_words_of_other_pages_are_used_and_known(section, scripts):
    asked = set(re.findall(r"\"(\w+)\"", "\n".join(asset(name) for name in scripts)))
    known = set(words("en", section))
    prefix = {name.partition("_")[0] for name in known}
    assert known <= asked
    assert {one for one in asked if one.partition("_")[0] in prefix and "_" in one} <= known
    assert not known & set(words("en", "viewer"))
