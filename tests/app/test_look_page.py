"""The page is one text that loads nothing, says only known words, and puts texts of files nowhere but into data."""

import json
import re

import pytest

from mbkf.app.look_page import SCRIPTS, look_data, look_page
from mbkf.io.results_folder import write_result_files
from mbkf.io.session import EventKind, FootEvent
from mbkf.pipelines.gait.events import foot_events, plain_found
from mbkf.pipelines.results.summary import summarise
from mbkf.viz.language import words
from mbkf.viz.page import asset
from tests.recordings import walk

OWN = "\n".join(asset(name) for name in SCRIPTS if name.startswith("look"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("result")
    write_result_files(walk(), summarise(walk()), place)
    return place


def test_the_data_are_the_result_s_and_tell_found_from_set(folder):
    event = FootEvent("left", EventKind.OFF, 1.25)
    data = look_data(folder, (event,))
    found = [FootEvent(one["side"], EventKind(one["kind"]), one["time_s"]) for one in data["found"]]
    assert tuple(found) == plain_found(foot_events(walk()))
    assert data["events"] == [{"side": "left", "kind": "off", "time_s": 1.25}]
    assert data["frame_s"] == 1.0 / walk().rate_hz
    assert data["span_s"] == [walk().times_s[0], walk().times_s[-1]]
    assert look_data(folder)["events"] is None


def test_the_page_is_one_text_that_loads_nothing(folder):
    name = "</script><b>x"
    page = look_page("P1", name, ["<i>other"], look_data(folder))
    assert "{{" not in page.split("<script>")[0] and name not in page and "<i>other" not in page
    assert re.findall(r"<(?:script|img|iframe|link)[^>]*\b(?:src|href)=[\"'](?!data:)", page) == []
    (told,) = re.findall(r'id="look">(.*?)</script>', page)
    assert json.loads(told) == {"session": "P1", "trial": name, "others": ["<i>other"]}


def test_texts_become_no_markup():
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", OWN)


def test_every_word_is_used_and_every_used_one_known():
    known, asked = set(words("en", "look")), set(re.findall(r"(?:word|button)\(\s*\"(\w+)\"", OWN))
    made = {f"{side}_{kind}" for side in ("right", "left") for kind in ("strike", "off")}
    made |= {f"{what}_{how}" for what in ("contact", "pressure") for how in ("measured", "estimated")}
    assert asked <= known
    assert known <= set(re.findall(r"\"(\w+)\"", OWN)) | made | {"by_cycle", "by_time"}
