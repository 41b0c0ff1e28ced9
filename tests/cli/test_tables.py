"""Text is printed as it is, and numbers of a table are aligned right."""

from mbkf.cli.tables import table, terminal
from mbkf.cli.terminal import PIPED_WIDTH


def test_markers_named_like_markup_are_printed_as_they_are(capsys):
    shown = table("Markers [bold]", "name of the marker", "mm")
    shown.add_row("[x]:a:", "5")
    console = terminal()
    console.print(shown)
    console.print("[red] udp:a:")
    out = capsys.readouterr().out
    assert all(text in out for text in ("Markers [bold]", "[x]:a:", "[red] udp:a:"))


def test_words_are_left_and_numbers_right():
    assert [column.justify for column in table("", "a", "b", "c", words=2).columns] == [
        "left",
        "left",
        "right",
    ]


def test_a_pipe_is_wider_than_a_terminal_of_80_characters():
    assert terminal().width == PIPED_WIDTH
