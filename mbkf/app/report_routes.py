"""Requests about the report of a session: the page, what it may be compared with, its curves, and norms."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from mbkf.app import reports
from mbkf.app.replies import asked, page, told
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError
from mbkf.study.session.tables import write_session_curves
from mbkf.viz.language import ENGLISH


def report_routes(workspace: Workspace) -> list[Route]:
    """Pages and data about the report of a session."""

    async def report(request: Request) -> Response:
        session, before, norms = (asked(request, name) for name in ("session", "before", "norms"))
        language = asked(request, "language") or ENGLISH
        return await page(lambda: reports.report_of(workspace, session, before, norms, language))

    async def choices(request: Request) -> Response:
        return await told(lambda: reports.choices(workspace, asked(request, "session")))

    async def curves(request: Request) -> Response:
        session, kind = asked(request, "session"), "parquet" if asked(request, "as") == "parquet" else "csv"
        try:
            content = await run_in_threadpool(lambda: _curves(workspace, session, kind))
        except MbkfError as error:
            return PlainTextResponse(" ".join(str(error).split()), status_code=404)
        headers = {"Content-Disposition": f'attachment; filename="curves.{kind}"'}
        return Response(content, media_type="application/octet-stream", headers=headers)

    async def build(_request: Request) -> Response:
        return await told(lambda: reports.build(workspace))

    return [
        Route("/report", report),
        Route("/report/choices", choices),
        Route("/report/curves", curves),
        Route("/norms", build, methods=["POST"]),
    ]


def _curves(workspace: Workspace, session: str, kind: str) -> bytes:
    """All curves of a session as a file's content."""
    whole = reports.read_whole(workspace, session)
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"curves.{kind}"
        write_session_curves(whole, file)
        return file.read_bytes()
