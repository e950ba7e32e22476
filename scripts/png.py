"""PNG files of 8 bits, for the generators beside this file."""

import struct
import zlib


def encode(width, height, channels, pixel):
    """A file's bytes; `pixel` gives 3 or 4 bytes for a column and a row."""
    rows = b"".join(
        b"\0" + bytes(byte for column in range(width) for byte in pixel(column, row)) for row in range(height)
    )

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
