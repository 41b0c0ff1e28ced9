"""Requests for a trial's result as a file of other programs."""

from __future__ import annotations

import shutil
import tempfile
import threading
from pathlib import Path

from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from mbkf.app.replies import asked
from mbkf.app.workspace import Workspace
from mbkf.errors import MbkfError, UnknownName
from mbkf.io.results_folder import read_reconstruction
from mbkf.pipelines.export import RESULT_FORMATS, export_result
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
        folder = Path(tempfile.mkdtemp(prefix="mbkf-export-"))
        try:
            file = await run_in_threadpool(lambda: exported(workspace.result(session, trial), to, folder))
        except (MbkfError, OSError) as error:
            shutil.rmtree(folder, ignore_errors=True)
            status = 400 if isinstance(error, MbkfError) else 500
            return JSONResponse({"trouble": " ".join(str(error).split())}, status_code=status)
        swept = BackgroundTask(shutil.rmtree, folder, ignore_errors=True)
        return FileResponse(file, filename=f"{trial}.{to}", background=swept)

    return [Route("/trial/export", export)]


def exported(result: Path, to: str, folder: Path) -> Path:
    """Writes a result as a file of another program, and returns that.

    Args:
        result: The folder of the result.
        to: The format.
        folder: Where to write.

    Raises:
        UnknownName: There is no such format.
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
