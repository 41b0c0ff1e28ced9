"""The page of a marker set in a browser: every marker in its segment's colour, doubts marked, no name does harm."""

import re
from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.atomic import write_text
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.trial.protocol.standing import Standing, neutral_on_floor, stand_beside
from mbkf.viz.protocol.colours import segment_colours
from mbkf.viz.protocol.page import UNKNOWN, set_data, show_page
from tests.captures import made_capture
from tests.viz.browsing import until

HARM = "<img src=x onerror=window.harmed=1>"
PROTOCOL = load_protocol("plug_in_gait")
FIRST, SECOND = PROTOCOL.markers[:2]
DOUBTFUL = replace(
    PROTOCOL,
    title="</script><b>title</b>",
    source=HARM,
    markers=(
        replace(FIRST, name=HARM),
        replace(SECOND, probability=0.5, alternatives=(("torso", 0.5),)),
        *PROTOCOL.markers[2:],
    ),
    ignored={"ghost": "a reflection"},
)


def alone(protocol):
    model = HumanModel.scaled(None, None, protocol.body)
    return Standing((), np.empty((0, 3)), model, neutral_on_floor(model), None)


def test_the_data_has_every_marker_where_the_reference_body_carries_it():
    data = set_data(PROTOCOL, alone(PROTOCOL))
    assert [one["name"] for one in data["markers"]] == [marker.name for marker in PROTOCOL.markers]
    heights = {one["name"]: one["at"][2] for one in data["markers"]}
    assert 1.4 < heights["C7"] < 1.6
    assert 0.0 <= heights["RTOE"] < 0.12
    sides = {one["name"]: one["at"][1] for one in data["markers"]}
    assert sides["RKNE"] == pytest.approx(-sides["LKNE"])
    assert None not in data["row"][data["scene"]["parts"]["segments"][0] :][: 7 * 18]


def test_markers_that_the_set_lacks_are_there_as_unknown_ones():
    capture = made_capture(3, 0.0)
    protocol = load_protocol("reference36")
    cut = replace(protocol, markers=protocol.markers[2:], ignored={protocol.markers[0].name: "loose"})
    data = set_data(cut, stand_beside(capture, cut))
    told = {one["name"]: one for one in data["markers"]}
    assert set(told) == set(capture.markers.names)
    assert told[protocol.markers[0].name]["ignored"] == "loose"
    assert told[protocol.markers[1].name]["ignored"] == UNKNOWN
    assert all(one["seen"] for one in data["markers"])


def test_the_page_is_whole():
    text = show_page(DOUBTFUL)
    assert "{{" not in text.split("<script>")[0]
    assert re.findall(r"\b(?:src|href)=[\"'](?!data:)", text.split("<script")[0]) == []
    assert "connect-src 'none'" in text
    assert "</script><b>" not in text


@pytest.mark.slow
@pytest.mark.parametrize("width", [1300, 800])
def test_a_browser_shows_every_marker_in_the_colour_of_its_segment(opened, tmp_path, width):
    write_text(tmp_path / "set.html", show_page(DOUBTFUL))
    colours = segment_colours(segment.name for segment in DOUBTFUL.body.segments)
    with opened((tmp_path / "set.html").as_uri()) as page:
        page.set_viewport_size({"width": width, "height": 850})
        until(page, "document.querySelectorAll('.dot[data-marker]').length > 0 && mbkf.labels.seen !== ''")
        assert page.requested == [page.url]
        for kind in ("dot", "tag"):
            shown = page.evaluate(
                f"[...document.querySelectorAll('.{kind}[data-marker]')].map("
                "(e) => [e.dataset.marker, e.dataset.segment, e.style.getPropertyValue('--own'), e.className])"
            )
            assert {name: segment for name, segment, _, _ in shown} == {
                marker.name: marker.segment for marker in DOUBTFUL.markers
            }
            assert all(colours[segment] == own for _, segment, own, _ in shown)
            assert [name for name, _, _, classes in shown if "doubtful" in classes] == [SECOND.name]
        box = page.locator("#scene").bounding_box()
        for dot in page.locator(".dot[data-marker]").all():
            place = dot.bounding_box()
            assert box["x"] < place["x"] < box["x"] + box["width"]
            assert box["y"] < place["y"] < box["y"] + box["height"]
        assert f"{len(DOUBTFUL.markers)} markers, 1 in doubt" in page.text_content("#count")
        assert "ghost" in page.text_content("#column") and "a reflection" in page.text_content("#column")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        # names are text, wherever they stand
        assert page.evaluate("window.harmed") is None
        assert page.locator("img, b").count() == 0
        assert page.text_content("#trial") == DOUBTFUL.title
        assert page.locator(".item").filter(has_text=HARM).count() == 1


@pytest.mark.slow
def test_markers_are_chosen_by_mouse_and_keyboard_and_seen_from_all_sides(opened, tmp_path):
    write_text(tmp_path / "set.html", show_page(PROTOCOL))
    with opened((tmp_path / "set.html").as_uri()) as page:
        page.set_viewport_size({"width": 1300, "height": 850})
        until(page, "Boolean(window.mbkf && mbkf.labels.seen !== '')")
        page.click('.item[data-item="RKNE"]')
        until(page, "document.querySelector('.tag.chosen')?.dataset.marker === 'RKNE'")
        page.keyboard.press("ArrowDown")
        page.keyboard.press("Enter")
        until(page, "document.querySelector('.tag.chosen')?.dataset.marker !== 'RKNE'")
        page.keyboard.press("Escape")
        until(page, "document.querySelector('.tag.chosen') === null")
        where = "document.querySelector('.dot[data-marker=RKNE]').getBoundingClientRect().x"
        middle = "document.querySelector('.dot[data-marker=SACR]').getBoundingClientRect().x"
        assert page.evaluate(f"{where} < {middle}")  # from the front, right is on the left
        page.click("#views >> text=back")
        until(page, f"{where} > {middle}")
        page.uncheck("#views label:has-text('names') input")
        until(page, "[...document.querySelectorAll('.tag')].every((tag) => tag.hidden)")
