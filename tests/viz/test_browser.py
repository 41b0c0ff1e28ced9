"""The pages in a real browser: something is drawn, it moves, it stops, strangers stay outside, nothing is fetched."""

import io
import json
import time
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread

from mbkf.io.atomic import write_text
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.verdict import Reason, Verdict
from mbkf.stream.results.judgement import Judgement
from mbkf.trial.results.summary import summarise
from mbkf.viz.live.page import LivePage
from mbkf.viz.report.document import report_page
from mbkf.viz.scene.recording import playback_page
from tests.recordings import PLATE, SEAT, broken_walk, leaning_walk, walk, walker
from tests.viz.browsing import PATIENCE_S, until
from tests.viz.streams import feeding

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def live():
    made = LivePage(walker()[1], walk().marker_names, PLATE[None], title="a walk", token="sesame")
    with feeding(made):
        yield made
    made.close()


def picture(page, selector):
    return imread(io.BytesIO(page.locator(selector).first.screenshot()))[..., :3]


def colours(image):
    """How many clearly different colours cover at least a thousandth of a picture each."""
    coarse = (image * 7.99).astype(int).reshape(-1, 3) @ [64, 8, 1]
    return int((np.bincount(coarse) > coarse.size / 1000).sum())


def until_plotted_anew(page, before):
    ends = time.monotonic() + PATIENCE_S
    while plotted(page) == before:
        assert time.monotonic() < ends, "the plot never changed"
        page.wait_for_timeout(30)


def once_still(page):
    """The plot as it is once two looks 300 ms apart see the same."""
    ends, before = time.monotonic() + PATIENCE_S, None
    while (now := plotted(page)) != before:
        assert time.monotonic() < ends, "the plot never stood still"
        before = now
        page.wait_for_timeout(300)
    return now


def followed(page):
    until(page, "Boolean(window.mbkf && mbkf.view && mbkf.view.seenPelvis)")
    page.wait_for_timeout(200)


def plotted(page):
    return page.evaluate("document.querySelector('.card canvas').toDataURL()")


def arrows(page):
    """Of each load's arrow: whether it is seen, whether its shaft is whole, whether it is dashed, and its foot."""
    return page.evaluate(
        "mbkf.view.arrows.map(({arrow, whole, dashed}) =>"
        " [arrow.visible, whole.visible, dashed.visible, arrow.position.toArray()])"
    )


def test_arrows_act_where_loads_do_and_tell_measured_from_estimated(opened, tmp_path):
    r = leaning_walk()
    write_text(tmp_path / "walk.html", playback_page(r))
    with opened((tmp_path / "walk.html").as_uri()) as page:
        followed(page)
        page.evaluate(f"mbkf.go({SEAT.start + 5})")
        right, left, pelvis, hand = arrows(page)
        assert (right[:3], pelvis[:3]) == ([True, True, False], [True, False, True])
        assert not left[0] and not hand[0], "neither bears then"
        seat = r.support_point_m[SEAT.start + 5, r.support_names.index("pelvis")]
        np.testing.assert_allclose(pelvis[3], seat, atol=1e-3)
        np.testing.assert_allclose(right[3], r.foot_cop_m[SEAT.start + 5, 0], atol=1e-3)
        page.get_by_label("Force, estimated").uncheck()
        assert [shown for shown, *_ in arrows(page)] == [True, False, False, False]


def test_a_recording_plays_from_a_file_without_any_request(opened, tmp_path):
    write_text(tmp_path / "walk.html", playback_page(broken_walk()))
    with opened((tmp_path / "walk.html").as_uri()) as page:
        followed(page)
        assert page.title() == "walk <1> · mbkf"
        assert colours(picture(page, "#scene")) >= 6, "a person, markers and a floor have several colours"
        page.select_option("#speed", "0.5")
        page.click("#play")
        until(page, "mbkf.frame > 3")
        page.click("#play")
        stopped = page.evaluate("mbkf.frame")
        before = plotted(page)
        page.wait_for_timeout(300)
        assert page.evaluate("mbkf.frame") == stopped
        page.locator("#scrub").fill("150")
        assert page.evaluate("mbkf.frame") == 150
        assert page.text_content("#clock").startswith("1.50 s")
        assert plotted(page) != before, "the playhead stands elsewhere"
        knee = float(np.rad2deg(walk().angle("knee_angle_r")[150]))
        assert float(page.text_content(".value").split()[0].replace("−", "-")) == pytest.approx(
            knee, abs=0.06
        )
        page.locator("#scrub").fill("35")
        until(page, "mbkf.view.markers.hidden.count === 2 && mbkf.view.markers.refused.count === 0")
        page.locator("#scrub").fill("62")
        until(page, "mbkf.view.markers.hidden.count === 0 && mbkf.view.markers.refused.count === 1")
        page.locator("#scrub").fill("105")
        assert page.evaluate("mbkf.view.segments.some((s) => s.visible)") is False, "the body is lost here"
        assert page.requested == [page.url]


def test_a_recording_opens_on_the_first_tracked_frame(opened, tmp_path):
    r = walk()
    write_text(tmp_path / "late.html", playback_page(replace(r, tracked=np.arange(r.frames) >= 37)))
    with opened((tmp_path / "late.html").as_uri()) as page:
        followed(page)
        assert page.evaluate("mbkf.frame") == 37
        assert page.text_content("#clock").startswith("0.37 s")
        assert page.input_value("#scrub") == "37"
        assert page.evaluate("mbkf.view.segments.some((s) => s.visible)") is True
        page.locator("#scrub").fill("0")
        assert page.evaluate("mbkf.frame") == 0, "the frames before are there"


def test_the_live_page_moves_and_pauses_and_trains(opened, live):
    with opened(live.url) as page:
        followed(page)
        assert colours(picture(page, "#scene")) >= 6
        until(page, "document.getElementById('state').textContent === 'live'")
        assert page.text_content("#lost") == "3"
        assert page.text_content("#latency") == "1.5 ms"
        before = plotted(page)
        until_plotted_anew(page, before)
        page.click("#pause")
        until(page, "document.getElementById('state').textContent === 'paused'")
        held, frozen = once_still(page), page.evaluate("mbkf.stream.rows.length")
        page.wait_for_timeout(400)
        assert (plotted(page), page.evaluate("mbkf.stream.rows.length")) == (held, frozen)
        assert page.text_content("#state") == "paused"
        page.click("#pause")
        until_plotted_anew(page, held)
        page.locator(".card select").first.select_option("reaction:vertical_l")
        assert "upward" in page.text_content(".card .positive")
        low, high = page.locator(".card").first.locator("input").all()
        low.fill("-5000")
        high.fill("5000")
        until(page, "document.querySelector('.card .verdict').textContent === '✓ in target'")
        low.fill("4000")
        until(page, "document.querySelector('.card .verdict').textContent === '▼ below target'")


def test_the_live_page_is_closed_and_opened_again_and_strangers_stay_outside(opened, live):
    for _ in range(2):
        with opened(live.url) as page:
            followed(page)
            until(page, "document.getElementById('state').textContent === 'live'")
    with opened(live.url.replace("sesame", "simsalabim")) as page:
        assert page.answer.status == 403
        assert "Refused" in page.text_content("body")
        opened.errors.clear()  # the browser itself tells of the refusal


def test_a_page_whose_server_ends_says_so(opened):
    made = LivePage(walker()[1], walk().marker_names)
    with opened(made.url) as page:
        until(page, "document.getElementById('state').textContent.startsWith('waiting')")
        made.close()
        until(page, "document.getElementById('state').textContent.startsWith('not connected')")
        opened.errors.clear()  # the lost connection


def test_the_report_opens_from_a_file_without_any_request(opened, tmp_path):
    r = broken_walk()
    write_text(tmp_path / "report.html", report_page(r, summarise(r)))
    with opened((tmp_path / "report.html").as_uri()) as page:
        assert page.requested == [page.url]
        for name in ("quality", "gait", "motion", "reactions", "settings"):
            box = page.locator(f"#{name}").bounding_box()
            assert box["width"] > 600 and box["height"] > 100
        assert colours(picture(page, "svg.chart >> nth=4")) >= 3
        page.click("summary >> nth=0")
        assert page.locator("details >> nth=0").locator("svg.chart").first.bounding_box()["height"] > 50
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_the_live_page_shows_the_running_verdict_and_limbs_set_right(opened, live):
    reason = Reason("left_leg_loads", "do not use", "<b>29</b> times", "plates are turned", "correct them")
    doubt = LimbDoubt("left_thigh", "turned over", 0.4, 0.5, mended=True, right_from_s=0.5)
    bad = Judgement(Verdict.of([reason]), 1.5, (doubt,), ("two persons are in view",))
    with opened(live.url) as page:
        until(page, "Boolean(window.mbkf && mbkf.view)")
        assert page.locator("#judgement").count() == 0
        for found in (bad, Judgement(Verdict(), 2.5)):
            page.evaluate(f"mbkf.read({json.dumps({'judgement': found.plain()})})")
            shown = page.locator("#judgement")
            assert shown.get_attribute("data-word") == found.verdict.overall
            assert shown.locator("summary").inner_text() == found.verdict.line
            assert shown.locator("li").count() == (3 if found is bad else 0)
            if found is bad:
                shown.locator("summary").click()
                assert shown.locator("li.limb").inner_text() == doubt.sentence
