"""An error's text stays short and steers no terminal, whatever a damaged file put into it."""

from mbkf.errors import MOST_LETTERS, FileFormatError, InvalidInput, UnknownName


def test_texts_are_cut_and_letters_that_steer_terminals_are_shown_as_codes():
    assert str(InvalidInput("the mass is 3 kg; give µT, «x»")) == "the mass is 3 kg; give µT, «x»"
    assert str(FileFormatError("a.trc", "\x1b[2Jhello\x07", 3)) == r"a.trc, line 3: \x1b[2Jhello\x07"
    assert str(InvalidInput("two\nlines\r\nand more")) == "two lines and more"
    long = str(UnknownName("marker", 10_000 * "x" + "!", ["end"]))
    assert MOST_LETTERS < len(long) < MOST_LETTERS + 10
    assert long.startswith("unknown marker 'xxx") and long.endswith("!'; known are end")
