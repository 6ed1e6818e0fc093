"""LZ4's block format, unpacked: what VTK compresses with, and the standard library does not know.

A block is a row of sequences: a token with two lengths of 4 bits (15 goes on in further bytes, 255 in each but the
last), that many literal bytes, and a copy of at least 4 bytes from a distance back; the last one has literals only.
"""

from wct_plugin.errors import InputError


def unpack(block: bytes, size: int) -> bytes:
    """The ``size`` bytes that the block holds. Raises :class:`InputError` for a damaged one."""
    out = bytearray()
    at, end = 0, len(block)
    try:
        while at < end:
            token = block[at]
            at += 1
            count = token >> 4
            if count == 15:
                at, count = _longer(block, at)
            out += block[at : at + count]
            at += count
            if at >= end:
                break
            back = block[at] | block[at + 1] << 8
            at += 2
            count = token & 15
            if count == 15:
                at, count = _longer(block, at)
            if len(out) + count + 4 > size:
                raise IndexError
            _repeat(out, back, count + 4)
    except IndexError:
        at = end + 1
    if at != end or len(out) != size:
        raise InputError("has a damaged LZ4 block")
    return bytes(out)


def _longer(block: bytes, at: int) -> tuple[int, int]:
    """Where the length ends that begins here with 15, and the length."""
    count = 15
    while block[at] == 255:
        count += 255
        at += 1
    return at + 1, count + block[at]


def _repeat(out: bytearray, back: int, count: int) -> None:
    """Append ``count`` bytes from ``back`` bytes before the end on, which may run into themselves."""
    start = len(out) - back
    if back == 0 or start < 0:
        raise IndexError
    if back >= count:
        out += out[start : start + count]
    else:
        piece = bytes(out[start:])
        out += (piece * (count // back + 1))[:count]
