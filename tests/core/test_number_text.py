"""Numbers in text, as the core reads them: bit for bit those of Python, and a place where there is none."""

import numpy as np
import pytest

from wct_plugin.core import _core


def test_reals_are_those_of_python_bit_for_bit() -> None:
    random = np.random.default_rng(0)
    values = np.concatenate(
        [random.normal(size=2000), random.normal(size=2000) * 10.0 ** random.integers(-300, 300, 2000)]
    )
    for text in ("%r", "%.6g", "%.16e", "%+.9E"):
        words = [text % value for value in values.tolist()]
        found, widths, end, good = _core.read_reals("\n".join(words).encode())
        assert found.tolist() == [float(word) for word in words]
        assert (widths.tolist(), end, good) == ([1] * len(words), len("\n".join(words)), True)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (b"1d3 2D-1 .5 5. -.5e+1 +2", [1000.0, 0.2, 0.5, 5.0, -5.0, 2.0]),
        (b"1e400 -1e400 1e-400", [np.inf, -np.inf, 0.0]),
        (b"nan inf -Infinity", [np.nan, np.inf, -np.inf]),
        (b"-0.0", [-0.0]),
        (b" \t\r\n 7 \x0b8\r\n", [7.0, 8.0]),
        (b"", []),
    ],
)
def test_spellings(text: bytes, wanted: list[float]) -> None:
    found, _, _, good = _core.read_reals(text)
    assert good
    assert np.array_equal(found, wanted, equal_nan=True)
    assert np.array_equal(np.signbit(found), np.signbit(wanted))


@pytest.mark.parametrize(
    "word", [b"1.0x", b"1,5", b"0x10", b"1-5", b"--1", b"+-1", b".", b"-", b"e5", b"1 2%", b"\xff"]
)
def test_what_is_no_number_is_found(word: bytes) -> None:
    found, _, end, good = _core.read_reals(b"1 2\n3 " + word + b" 4")
    assert not good
    assert (b"1 2\n3 " + word)[end:] == word.split()[-1]
    assert found[:3].tolist() == [1.0, 2.0, 3.0]


def test_integers() -> None:
    found, widths, _, good = _core.read_integers(b"3 -7\n+5 9223372036854775807 2.0 1e3\n")
    assert good
    assert found.tolist() == [3, -7, 5, 9223372036854775807, 2, 1000]
    assert widths.tolist() == [2, 4]
    for bad in (b"1.5", b"9223372036854775808", b"1e300", b"nan", b"x"):
        assert not _core.read_integers(b"1 " + bad)[3]


def test_lines_by_their_head_and_words_up_to_a_letter() -> None:
    text = b"# 1 2\nv 1 2 3\nvn 9 9 9\n  V 4 5\nf 1/2/3 4//5 -6\nv\n"
    found, widths, _, _ = _core.read_reals(text, head=b"v")
    assert (found.tolist(), widths.tolist()) == ([1, 2, 3, 4, 5], [3, 2, 0])
    found, widths, _, _ = _core.read_integers(text, head=b"f", stop=b"/")
    assert (found.tolist(), widths.tolist()) == ([1, 4, -6], [3])


def test_some_lines_from_a_place_on() -> None:
    text = b"head\n1 2\n\n3 4\n5 6\n"
    found, widths, end, _ = _core.read_integers(text, start=5, lines=2)
    assert (found.tolist(), widths.tolist()) == ([1, 2, 3, 4], [2, 2])
    assert text[end:] == b"5 6\n"
    assert _core.read_integers(text, start=99)[0].tolist() == []
