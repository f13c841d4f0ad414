"""PNG pictures as a browser writes them."""

import struct
import zlib


def decode_png(path):
    """Width, height and the rows of an 8-bit RGB or RGBA picture, each row as bytes of RGB."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert depth == 8 and kind in (2, 6), (depth, kind)
    channels = 3 if kind == 2 else 4
    packed, at = b"", 8
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, stride = zlib.decompress(packed), width * channels
    rows, above = [], bytes(stride)
    for y in range(height):
        begin = y * (stride + 1)
        method, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + stride])
        unfilter(method, line, above, channels)
        above = bytes(line)
        rows.append(above if channels == 3 else bytes(byte for i, byte in enumerate(above) if i % 4 != 3))
    return width, height, rows


def unfilter(method, line, above, channels):
    if method == 2:
        line[:] = bytes((a + b) & 255 for a, b in zip(line, above))
    elif method:
        for i, byte in enumerate(line):
            left = line[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            up = above[i]
            if method == 1:
                line[i] = (byte + left) & 255
            elif method == 3:
                line[i] = (byte + (left + up) // 2) & 255
            else:
                nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                              (abs(left + up - 2 * corner), 2, corner))
                line[i] = (byte + nearest[2]) & 255
