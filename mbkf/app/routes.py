"""All addresses of the page's server, and their replies."""

from __future__ import annotations

import json
import time
from dataclasses import asdict

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from mbkf.app import answers, reports
from mbkf.app.arranging import Arranging
from mbkf.app.bodies import plain, stated_size, stream_body
from mbkf.app.exports import export, session_curves
from mbkf.app.failures import failed, language_of
from mbkf.app.foot_events import set_events
from mbkf.app.laboratory import change_laboratory, plain_laboratory
from mbkf.app.live_command import live_offer, live_options, recording_folder, recording_options
from mbkf.app.live_run import LiveRun
from mbkf.app.marker_sets import MarkerSets
from mbkf.app.norm_files import import_norms
from mbkf.app.notes import change_notes
from mbkf.app.pages import help_page, live_frame_page, start_page, trial_report
from mbkf.app.replies import Query, action, change, data, download, page
from mbkf.app.runs import Runs
from mbkf.app.several_persons import separate
from mbkf.app.trial_viewer import viewer_data, viewer_page
from mbkf.app.videos import linked_video, set_videos, video_data, video_route
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.discovery import find_streams
from mbkf.viz.language import ENGLISH


def routes(workspace: Workspace, runs: Runs, live: LiveRun) -> list[BaseRoute]:
    """All routes.

    Args:
        workspace: The sessions.
        runs: Their runs.
        live: The live run.
    """
    arranging = Arranging(workspace, runs, live)
    return [
        page("/", lambda _: start_page()),
        page("/help", lambda query: help_page(query["language"] or ENGLISH)),
        *_session_routes(workspace, runs, arranging),
        *_trial_routes(workspace, runs),
        *_arranging_routes(arranging),
        *_report_routes(workspace),
        *_marker_set_routes(workspace),
        *_live_routes(workspace, live),
    ]


def _session_routes(workspace: Workspace, runs: Runs, arranging: Arranging) -> list[BaseRoute]:
    def noted(query: Query, sent: object, version: str) -> object:
        found = change_notes(workspace, query["session"], sent, version)
        return {**answers.session(workspace, runs, query["session"]), **found}

    def run(query: Query, _body: bytes) -> object:
        name = query["session"]
        workspace.folder(name)
        (runs.cancel if query["do"] == "cancel" else runs.start)(name)
        return {"run": answers.run_state(runs.state(name))}

    def run_all(query: Query, _body: bytes) -> object:
        if query["do"] == "cancel":
            runs.cancel(*workspace.sessions())
        else:
            runs.start_all()
        return answers.sessions(workspace, runs, arranging.listed())

    def apart(query: Query, _body: bytes) -> object:
        folder, state = workspace.folder(query["session"]), runs.state(query["session"])
        if state is None or not state.persons:
            raise InvalidInput("run the session first: that shows whose captures its folder holds")
        separate(workspace.root, folder, state.persons)
        return {"sessions": list(state.persons)}

    async def put(request: Request) -> Response:
        name = request.query_params.get("file", "")
        try:
            await stream_body(request, workspace.putting(name, stated_size(request)))
        except (MbkfError, OSError) as error:
            return failed(error, language_of(request))
        return JSONResponse({"put": name})

    return [
        data("/sessions", lambda _: answers.sessions(workspace, runs, arranging.listed())),
        data("/session", lambda query: answers.session(workspace, runs, query["session"])),
        change("/session", noted),
        action("/run", run),
        action("/run/all", run_all),
        action("/separate", apart),
        Route("/put", put, methods=["POST"]),
    ]


def _trial_routes(workspace: Workspace, runs: Runs) -> list[BaseRoute]:
    def shown(query: Query) -> dict[str, object]:
        session, trial = query["session"], query["trial"]
        events = workspace.events(session, trial)
        return viewer_data(workspace.result(session, trial), events, query["language"] or ENGLISH)

    def viewer(query: Query) -> str:
        session, trial = query["session"], query["trial"]
        others = [name for name in workspace.with_results(session) if name != trial]
        return viewer_page(session, trial, others, shown(query), video_data(workspace, session, trial))

    def report(query: Query) -> str:
        session, trial = query["session"], query["trial"]
        charts = workspace.charts.chosen(query)
        events = workspace.events(session, trial)
        video = linked_video(workspace, session, trial, bool(query["save"]))
        language = query["language"] or ENGLISH
        return trial_report(workspace.result(session, trial), charts, events, language, video)

    def events(query: Query, sent: object, version: str) -> object:
        return set_events(workspace, runs, query["session"], query["trial"], sent, version)

    def videos(query: Query, sent: object, version: str) -> object:
        return set_videos(workspace, query["session"], query["trial"], sent, version)

    def exported(query: Query) -> tuple[str, bytes]:
        content = export(workspace.result(query["session"], query["trial"]), query["to"])
        return f"{query['trial']}.{query['to']}", content

    return [
        page("/trial/look", viewer),
        page("/trial/report", report),
        data("/trial/recording", shown),
        change("/trial/events", events),
        change("/trial/videos", videos),
        video_route("/trial/video", workspace),
        download("/trial/export", exported),
    ]


def _arranging_routes(arranging: Arranging) -> list[BaseRoute]:
    def arrange(query: Query, _body: bytes) -> object:
        session, trial = query["session"], query["trial"]
        if query["do"] == "delete":
            return arranging.delete(session, trial)
        if query["do"] == "undo":
            return arranging.undo(query["key"])
        if query["do"] == "move":
            return arranging.move(session, trial, query["to_session"], query["to_trial"])
        raise InvalidInput("the page asked neither to delete nor to move nor to undo; load the page again")

    return [action("/arrange", arrange), data("/bin", lambda _: {"moved": arranging.listed()})]


def _report_routes(workspace: Workspace) -> list[BaseRoute]:
    def report(query: Query) -> str:
        language = query["language"] or ENGLISH
        charts = workspace.charts.chosen(query)
        return reports.report_of(
            workspace,
            query["session"],
            query["before"],
            query["norms"],
            language,
            charts,
            trend=bool(query["trend"]),
            straight=bool(query["straight"]),
        )

    def selection(query: Query) -> object:
        return reports.norms_selection(workspace, query["session"], query["language"] or ENGLISH)

    def norms(query: Query, _body: bytes) -> object:
        return reports.build(workspace, query["session"], workspace.charts.chosen(query).read)

    def curves(query: Query) -> tuple[str, bytes]:
        charts = workspace.charts.chosen(query)
        kind = "parquet" if query["as"] == "parquet" else "csv"
        return f"curves.{kind}", session_curves(
            reports.read_whole(workspace, query["session"], charts.read, bool(query["straight"])), kind
        )

    return [
        page("/report", report),
        data("/laboratory", lambda _: plain_laboratory(workspace)),
        action("/laboratory", lambda _, body: change_laboratory(workspace, plain(body))),
        data("/report/choices", lambda query: reports.choices(workspace, query["session"])),
        download("/report/curves", curves),
        data("/norms/selection", selection),
        action("/norms", norms),
        action("/norms/import", lambda query, body: import_norms(workspace, query, body)),
    ]


def _marker_set_routes(workspace: Workspace) -> list[BaseRoute]:
    sets = MarkerSets(workspace)

    def say(query: Query, body: bytes) -> object:
        text = body.decode("utf-8", errors="replace")
        return json.loads(sets.say(query["session"], query["page"], text))

    return [page("/marker_set", lambda query: sets.open(query["session"])), action("/marker_set/say", say)]


def _live_routes(workspace: Workspace, live: LiveRun) -> list[BaseRoute]:
    def run(query: Query, body: bytes) -> object:
        if query["do"] == "stop":
            live.stop()
        else:
            session, wanted, stamp = query["session"], plain(body), time.strftime("%Y-%m-%d-%H%M%S")
            options = live_options(workspace, session, wanted)
            options += recording_options(workspace, session, wanted, stamp)
            live.start(session, options, recording_folder(workspace, session, stamp))
        return answers.live_state(live)

    def frame(query: Query) -> str:
        now = live.state()
        if now is None or not now.goes_on or now.port is None:
            raise InvalidInput("No live run has a page now.")
        return live_frame_page(now.port, query["language"])

    return [
        data("/live", lambda query: {**live_offer(workspace, query["session"]), **answers.live_state(live)}),
        action("/live", run),
        data("/live/state", lambda _: answers.live_state(live)),
        data("/live/streams", lambda _: {"streams": [asdict(one) for one in find_streams().streams]}),
        page("/live/page", frame),
    ]
