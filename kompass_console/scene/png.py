"""Palette PNG: a grid of few colours in a few kilobytes, encoded in a millisecond.

viser's own encoder takes RGBA and, at the size of a building, tens of milliseconds per picture.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from kompass_console.scene.palette import Rgba

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def encode_palette(indices: npt.NDArray[np.uint8], colours: Sequence[Rgba]) -> bytes:
    """PNG of `indices` (H, W) into `colours` (at most 256). Row 0 is the first row of the file.

    Raises ValueError when there are more than 256 colours or an index has none.
    """
    if not 0 < len(colours) <= 256:
        raise ValueError(f"colours has {len(colours)} entries; a palette holds 1 to 256")
    if indices.size and int(indices.max()) >= len(colours):
        raise ValueError(f"index {int(indices.max())} has no colour among {len(colours)}")
    height, width = indices.shape
    bits = next(b for b in (1, 2, 4, 8) if len(colours) <= 1 << b)
    rows = _packed(indices, bits)
    raw = np.zeros((height, rows.shape[1] + 1), dtype=np.uint8)  # filter byte 0 opens every row
    raw[:, 1:] = rows
    header = struct.pack(">IIBBBBB", width, height, bits, 3, 0, 0, 0)
    return b"".join(
        (
            _SIGNATURE,
            _chunk(b"IHDR", header),
            _chunk(b"PLTE", bytes(channel for colour in colours for channel in colour[:3])),
            _chunk(b"tRNS", bytes(colour[3] for colour in colours)),
            _chunk(b"IDAT", zlib.compress(raw.tobytes(), 1)),
            _chunk(b"IEND", b""),
        )
    )


def _packed(indices: npt.NDArray[np.uint8], bits: int) -> npt.NDArray[np.uint8]:
    """Pixels packed `bits` each, most significant first, rows padded to whole bytes."""
    if bits == 8:
        return np.ascontiguousarray(indices)
    per_byte = 8 // bits
    height, width = indices.shape
    padded = np.zeros((height, -(-width // per_byte) * per_byte), dtype=np.uint8)
    padded[:, :width] = indices
    packed = np.zeros((height, padded.shape[1] // per_byte), dtype=np.uint8)
    for i in range(per_byte):
        packed |= padded[:, i::per_byte] << np.uint8(8 - bits * (i + 1))
    return packed


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
