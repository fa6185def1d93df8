"""LZF, the compression of .pcd files: runs of new bytes, and copies of what was there before."""

from __future__ import annotations


def decompress(packed: bytes, size: int) -> bytes | None:
    r"""The unpacked bytes, if they are exactly `size`; None for anything else.

    >>> decompress(bytes([1, 7, 8, 0x60, 1]), 7)
    b'\x07\x08\x07\x08\x07\x08\x07'
    >>> decompress(bytes([1, 7, 8, 0x60, 2]), 7) is None  # a copy from before the beginning
    True
    """
    out, at = bytearray(), 0
    try:
        while at < len(packed):
            control, at = packed[at], at + 1
            if control < 32:  # 000lllll: l + 1 new bytes follow
                out += packed[at : at + control + 1]
                at += control + 1
            else:  # llldddddd..: copy l + 2 bytes; l = 7 continues in a byte of its own
                length = control >> 5
                if length == 7:
                    length, at = 7 + packed[at], at + 1
                distance = ((control & 31) << 8 | packed[at]) + 1
                at += 1
                chunk = out[-distance:] if distance <= len(out) else b""
                copies = -(-(length + 2) // len(chunk))
                out += (chunk * copies)[: length + 2]
            if len(out) > size:
                return None
    except (IndexError, ZeroDivisionError):
        return None
    return bytes(out) if len(out) == size and at == len(packed) else None
