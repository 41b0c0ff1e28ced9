"""Requests for a trial's result as a file of other programs."""

from __future__ import annotations

import tempfile
import threading
from pathlib import Path
from urllib.parse import quote

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from mbkf.app.replies import asked
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError, UnknownName
from mbkf.io.results_folder import read_reconstruction
from mbkf.trial.export import RESULT_FORMATS, export_result
from mbkf.viz.film.film import FILMS, write_film

_FILMING = threading.Lock()
"""Each film has a browser of its own, which takes a processor: one at a time."""


def export_routes(workspace: Workspace) -> list[Route]:
    """Downloads of a trial.

    Args:
        workspace: The sessions.
    """

    async def export(request: Request) -> Response:
        session, trial, to = (asked(request, name) for name in ("session", "trial", "to"))

        def made() -> bytes:
            with tempfile.TemporaryDirectory(prefix="mbkf-export-") as folder:
                return exported(workspace.result(session, trial), to, Path(folder)).read_bytes()

        try:
            content = await run_in_threadpool(made)
        except (MbkfError, OSError) as error:
            status = 400 if isinstance(error, MbkfError) else 500
            return JSONResponse({"trouble": " ".join(str(error).split())}, status_code=status)
        named = {"Content-Disposition": f"attachment; filename*=utf-8''{quote(f'{trial}.{to}', safe='')}"}
        return Response(content, media_type="application/octet-stream", headers=named)

    return [Route("/trial/export", export)]


def exported(result: Path, to: str, folder: Path) -> Path:
    """Writes a result as a file of another program, and returns that.

    Args:
        result: The folder of the result.
        to: The format.
        folder: Where to write.

    Raises:
        UnknownName: The format does not exist.
        FileFormatError: The result is damaged.
        MissingDependency: A library that films need is not installed.
        InvalidInput: There is no motion in the result, or no browser draws it.
        OSError: The file cannot be written.
    """
    if to not in RESULT_FORMATS and to not in FILMS:
        raise UnknownName("format", to, (*RESULT_FORMATS, *FILMS))
    r, file = read_reconstruction(result), folder / f"trial.{to}"
    if to in RESULT_FORMATS:
        export_result(r, to, file)
    else:
        with _FILMING:
            write_film(r, to, file)
    return file
