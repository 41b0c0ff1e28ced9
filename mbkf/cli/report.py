"""Write a page about a result or a session: quality, gait, angles, torques, reactions.

The page holds everything and loads nothing, except a video of the trial that lies beside it. Of one trial: markers,
residuals, gaps and remarks first, then gait, angles, torques, reactions and settings. Of a session (a folder with
several results, or several folders): every gait cycle with means, powers, jumps and squats, the laboratory's norms
('mbkf norms build'), and changes against an earlier session with 95 % intervals. It
begins with two printed pages that state the visit ([visit] of session.toml).

Examples:
  mbkf report result                         one trial: writes result/report.html
  mbkf report result --labels labelled.json  with the numbers of 'mbkf label'
  mbkf report results/P1/monday              a session of 'mbkf batch': writes report.html there
  mbkf report results/P1/monday --laboratory ours/laboratory.toml      with the laboratory's head
  mbkf report friday --against monday --norms norms.toml --language es
  mbkf report results/P1 --curves curves.csv
  mbkf report results/P1 --emg-reference mvc          EMG in per cent of the trial mvc's largest envelope
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.options import add_chart_options, add_out

if TYPE_CHECKING:
    from mbkf.study.session.records import Session
    from mbkf.trial.gait.convention import Convention


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "folders",
        metavar="DIR",
        nargs="+",
        help="written by 'mbkf reconstruct', 'mbkf live' or 'mbkf batch'; several make one session",
    )
    add_out(parser, "FILE.html", "file to write (report.html in the first DIR)")
    parser.add_argument(
        "--labels",
        metavar="FILE.json",
        help="one trial: numbers of 'mbkf label' (default: TRIAL.json in DIR or beside it, if there is one)",
    )
    add_chart_options(parser)
    parser.add_argument("--language", metavar="CODE", help="language of the page: en, es (en)")
    session = parser.add_argument_group("for a session")
    session.add_argument("--against", metavar="DIR", nargs="+", help="an earlier session to compare with")
    session.add_argument(
        "--visits",
        metavar="DIR",
        nargs="+",
        help="other visits of the person, each with its date: their trend",
    )
    session.add_argument("--norms", metavar="FILE.toml", help="reference bands of 'mbkf norms build'")
    session.add_argument(
        "--emg-reference",
        metavar="WORD",
        help="100 %% of EMG: peak or mean of the session's cycles, or the peak of the trial of that name (peak)",
    )
    session.add_argument(
        "--session", metavar="FILE", help="session.toml (that beside the results, else beside the captures)"
    )
    session.add_argument(
        "--laboratory",
        metavar="FILE",
        help="laboratory.toml with name, address and logo (that in the folder of results or above it)",
    )
    session.add_argument(
        "--straight",
        action="store_true",
        help="leave out gait cycles in which the pelvis turns (by more than 15°)",
    )
    add_out(session, "FILE", "write every curve, too: .csv or .parquet", option="--curves")
    session.add_argument("--name", metavar="TEXT", help="heading of the page (the folder's name)")


def run(args: argparse.Namespace) -> int:
    """Writes the report.

    Raises:
        InvalidInput: An option for one trial is given for a session.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.results_folder import MOTION_FILE

    folders = [Path(folder) for folder in args.folders]
    for_session = [args.against, args.norms, args.curves, args.name, args.emg_reference]
    for_session += [args.session, args.laboratory, args.visits]
    for_session += [args.straight or None]
    one = len(folders) == 1 and ((folders[0] / MOTION_FILE).is_file() or not folders[0].is_dir())
    if one and not any(option is not None for option in for_session):
        return _trial(args, folders[0])
    if args.labels is not None:
        raise InvalidInput("--labels is for the report of one trial; give its folder alone")
    return _session(args, folders)


def _convention(args: argparse.Namespace) -> Convention | None:
    """The convention that is asked for; None: the result's."""
    from mbkf.errors import InvalidInput
    from mbkf.trial.gait.convention import CLINICAL, EXTERNAL, INTERNAL, convention_of

    if args.convention is None and args.moments == INTERNAL:
        return None
    if args.moments == EXTERNAL and args.convention not in (None, CLINICAL):
        raise InvalidInput(
            f"external moments belong to the clinical convention, not to {args.convention}; give --convention clinical"
        )
    if args.convention is None:
        print("convention: clinical, to which external moments belong")
    return convention_of(args.convention or CLINICAL, args.moments)


def _trial(args: argparse.Namespace, folder: Path) -> int:
    from mbkf.io.atomic import write_text
    from mbkf.io.results_folder import read_reconstruction, read_summary
    from mbkf.viz.language import ENGLISH
    from mbkf.viz.report.document import labels_of, read_labels, report_page
    from mbkf.viz.report.video import video_beside

    result = read_reconstruction(folder)
    labels = labels_of(folder, result.trial) if args.labels is None else read_labels(args.labels)
    out = Path(args.out) if args.out else folder / "report.html"
    page = report_page(
        result,
        read_summary(folder),
        labels,
        convention=_convention(args),
        colours=args.colours,
        language=args.language or ENGLISH,
        video=video_beside(out.parent, result.trial),
    )
    write_text(out, page)
    print(out)
    return 0


def _session(args: argparse.Namespace, folders: list[Path]) -> int:
    from mbkf.io.atomic import write_text
    from mbkf.io.laboratory import laboratory_above, read_laboratory
    from mbkf.io.norms import read_norms
    from mbkf.io.session import read_session
    from mbkf.io.utf8 import storable
    from mbkf.study.session.emg import PEAK
    from mbkf.study.session.gather import results_in, session_from
    from mbkf.study.session.statements import MOST_ABOVE, stated_on_results
    from mbkf.viz.language import ENGLISH
    from mbkf.viz.session.document import session_page

    norms = None if args.norms is None else read_norms(args.norms)
    if args.curves is not None:
        from mbkf.study.session.tables import check_curves_file, write_session_curves

        check_curves_file(Path(args.curves))
    out = Path(args.out) if args.out else folders[0] / "report.html"

    def read(places: list[Path], name: str | None, file: str | None = None) -> Session:
        results = [result for place in places for result in results_in(place)]
        notes = read_session(file) if file else stated_on_results(places[0], results[0])
        return session_from(
            results, name or storable(places[0].absolute().name), notes, convention, args.straight
        )

    convention = _convention(args)
    session = read(folders, args.name, args.session)
    convention = session.convention
    before = None if args.against is None else read([Path(place) for place in args.against], None)
    language, reference = args.language or ENGLISH, args.emg_reference or PEAK
    first = folders[0].absolute()
    laboratory = (
        read_laboratory(args.laboratory)
        if args.laboratory
        else laboratory_above([first, *first.parents][:MOST_ABOVE])
    )
    visits = [read([Path(place)], None) for place in args.visits or ()]
    page = session_page(session, before, norms, language, reference, args.colours, laboratory, visits)
    write_text(out, page)
    print(out)
    if args.curves is not None:
        write_session_curves(session, args.curves)
        print(args.curves)
    return 0
