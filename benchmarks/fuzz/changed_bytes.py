"""Bytes of a file, changed at random: as faults of disks and networks change them, and as an attacker would."""

import base64
import gzip
import random
import re
from collections.abc import Callable
from contextlib import suppress

#: What stands where a number should: out of range of every kind, no number, or one in another spelling.
HOSTILE = (
    b"-1", b"0", b"1", b"2", b"128", b"255", b"256", b"65536", b"2147483647", b"2147483648",
    b"-2147483649", b"4294967296", b"9223372036854775807", b"9223372036854775808", b"-9223372036854775808",
    b"18446744073709551615", b"18446744073709551616", b"9" * 400, b"nan", b"-nan", b"inf", b"-inf", b"1e400", b"1e-400",
    b"1e308", b"-1e308", b"", b"-", b"+", b".", b"e", b"0x10", b"1.5", b"1_0", b"1,2", b"1d3", b"1.-3",
    b"True", b"None", b"x", b"\xff", b"\xc2\xa0", b"\xe0\xa5\xa7", b"\x00", b"'", b'"', b"<", b"&", b"%s", b"{}",
    b"../x", b"*", b"$", b" " * 300, b"a" * 5000,
)  # fmt: skip
#: Whole numbers that stand in bytes, by their width.
_INTS = (0, 1, 2, -1, 127, 128, 255, 32767, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, 2**63, 2**64 - 1)
_FLOATS = tuple(bytes.fromhex(text) for text in (
    "000000000000f87f", "000000000000f07f", "000000000000f0ff", "0000c07f", "0000807f", "ffffffffffffef7f",
    "0100000000000000",
))  # fmt: skip

_TOKEN = re.compile(rb"[^\s,<>=\"'/]+")
_NUMBER = re.compile(rb"[-+]?\d[\d.eEdD+-]*")
_BASE64 = re.compile(rb"[A-Za-z0-9+/]{16,}={0,2}")

Change = Callable[[random.Random, bytes], bytes]


def _place(draw: random.Random, data: bytes) -> int:
    """Some place; heads decide more than bodies, so they are hit more often."""
    return draw.randrange(min(len(data), draw.choice((64, 400, 1 << 30)))) if data else 0


def _flip(draw: random.Random, data: bytes) -> bytes:
    made = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 2, 8))):
        if made:
            made[_place(draw, data)] ^= 1 << draw.randrange(8)
    return bytes(made)


def _overwrite(draw: random.Random, data: bytes) -> bytes:
    """A number of a hostile value, of 1 to 8 bytes, where one may stand."""
    width = draw.choice((1, 2, 4, 8))
    value = draw.choice(_INTS) % (1 << 8 * width)
    put = draw.choice(_FLOATS) if draw.random() < 0.2 else value.to_bytes(width, draw.choice(("little", "big")))
    at = _place(draw, data)
    at -= at % len(put) if draw.random() < 0.5 else 0
    return data[:at] + put + data[at + len(put) :]


def _insert(draw: random.Random, data: bytes) -> bytes:
    at = _place(draw, data)
    return (
        data[:at]
        + draw.choice((bytes([draw.randrange(256)]), draw.randbytes(draw.randrange(1, 40)), b"\n", b" "))
        + data[at:]
    )


def _delete(draw: random.Random, data: bytes) -> bytes:
    at = _place(draw, data)
    return data[:at] + data[at + draw.choice((1, 1, 4, 8, 50, 400)) :]


def _double(draw: random.Random, data: bytes) -> bytes:
    at, size = _place(draw, data), draw.choice((1, 8, 40, 400))
    return data[:at] + data[at : at + size] * draw.choice((2, 2, 3, 50)) + data[at + size :]


def _truncate(draw: random.Random, data: bytes) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


def _hostile_token(pattern: re.Pattern[bytes]) -> Change:
    def change(draw: random.Random, data: bytes) -> bytes:
        found = [match.span() for match in pattern.finditer(data)]
        if not found:
            return _flip(draw, data)
        first, last = draw.choice(found[: draw.choice((12, 60, 1 << 30))])
        return data[:first] + draw.choice(HOSTILE) + data[last:]

    return change


def _nudge(draw: random.Random, data: bytes) -> bytes:
    """A whole number one off, or of another size: counts, numbers of points, tags."""
    found = [match.span() for match in re.finditer(rb"(?<![\w.])\d{1,9}(?![\w.])", data)]
    if not found:
        return _overwrite(draw, data)
    first, last = draw.choice(found[: draw.choice((12, 60, 1 << 30))])
    value = int(data[first:last])
    made = draw.choice((value + 1, value - 1, -value, 2 * value, 10 * value, value + 1000, 0))
    return data[:first] + str(made).encode() + data[last:]


def _swap_tokens(draw: random.Random, data: bytes) -> bytes:
    found = [match.span() for match in _TOKEN.finditer(data)]
    if len(found) < 2:
        return _flip(draw, data)
    (a, b), (c, d) = sorted(draw.sample(found, 2))
    return data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def _lines(draw: random.Random, data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    at, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    match draw.randrange(6):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            del lines[min(at, other) : max(at, other)]
        case 4:
            lines[at] = lines[at].rstrip(b"\r\n")
        case 5:
            lines[at:at] = [draw.choice((b"\n", b"   \n", b"# said\n", b"\x00\n", b"0\n", b"$\n", b"*END\n"))]
    return b"".join(lines)


def _encoding(draw: random.Random, data: bytes) -> bytes:
    match draw.randrange(5):
        case 0:
            return data.decode("latin-1").encode(draw.choice(("utf-16", "utf-16-le", "utf-32")))
        case 1:
            return b"\xef\xbb\xbf" + data
        case 2:
            return data.replace(b"\n", b"\r\n")
        case 3:
            return data.replace(b"\n", b"\r")
    return data.replace(b" ", draw.choice((b"\t", b"  ", b"", b",", b"\x0b")))


def _within_base64(draw: random.Random, data: bytes) -> bytes:
    found = [match.span() for match in _BASE64.finditer(data)]
    if not found:
        return _overwrite(draw, data)
    first, last = draw.choice(found)
    with suppress(ValueError):
        inner = base64.b64decode(data[first:last])
        return data[:first] + base64.b64encode(draw.choice((_flip, _overwrite, _overwrite))(draw, inner)) + data[last:]
    return _flip(draw, data)


_BINARY: tuple[Change, ...] = (_flip, _overwrite, _overwrite, _overwrite, _insert, _delete, _double, _truncate)
_TEXT: tuple[Change, ...] = (
    *(_hostile_token(_NUMBER), _hostile_token(_NUMBER), _hostile_token(_TOKEN), _nudge, _nudge, _swap_tokens, _lines),
    *(_lines, _encoding, _within_base64, _flip, _insert, _delete, _double, _truncate),
)


def changed(draw: random.Random, data: bytes, another: bytes) -> bytes:
    """The bytes after one to five changes; now and then a piece of ``another`` file stands in them."""
    if data[:2] == b"\x1f\x8b" and draw.random() < 0.7:  # within what gzip packed
        return gzip.compress(changed(draw, gzip.decompress(data), another), mtime=0)
    binary = sum(byte < 9 or byte > 126 for byte in data[:4000]) > len(data[:4000]) // 20
    for _ in range(draw.choice((1, 1, 1, 2, 3, 5))):
        mixed = draw.random() < 0.1
        data = draw.choice(_TEXT if binary == mixed else _BINARY)(draw, data)
    if another and draw.random() < 0.04:
        at, start = _place(draw, data), draw.randrange(len(another))
        data = data[:at] + another[start : start + draw.randrange(1, 400)] + data[at:]
    return data
