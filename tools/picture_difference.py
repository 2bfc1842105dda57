#!/usr/bin/env python3
"""By how many levels the PNG and PFM files of two folders differ: tools/picture_difference.py OLD NEW

One line for each file that differs: its name, the pixels that differ, and the largest difference (levels of 255, or of
65535 for 16 bits; the value itself for PFM). The last line counts. Status 1 if a file differs by more than one level of
255, or is in one folder alone."""
import os
import struct
import sys
import zlib


def read_png(data):
    """Rows of samples of a PNG without interlace, as written by gray: (bits, samples a pixel, list of values)."""
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    samples = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    step = samples * bits // 8
    raw, stride = zlib.decompress(packed), width * step
    rows, before = bytearray(), bytearray(stride)
    for y in range(height):
        start = y * (stride + 1)
        method, line = raw[start], bytearray(raw[start + 1 : start + 1 + stride])
        for i in range(stride):
            left = line[i - step] if i >= step else 0
            up, corner = before[i], before[i - step] if i >= step else 0
            if method == 1:
                guess = left
            elif method == 2:
                guess = up
            elif method == 3:
                guess = (left + up) // 2
            elif method == 4:
                p = left + up - corner
                a, b, c = abs(p - left), abs(p - up), abs(p - corner)
                guess = left if a <= b and a <= c else up if b <= c else corner
            else:
                guess = 0
            line[i] = (line[i] + guess) & 255
        rows += line
        before = line
    values = rows if bits == 8 else struct.unpack(">%dH" % (len(rows) // 2), bytes(rows))
    return bits, samples, values


def read_pfm(data):
    lines = data.split(b"\n", 3)
    values = struct.unpack("<%df" % (len(lines[3]) // 4), lines[3])
    return 0, 3 if lines[0] == b"PF" else 1, values


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    return read_png(data) if path.endswith(".png") else read_pfm(data)


def main(old, new):
    names = sorted(n for n in set(os.listdir(old)) | set(os.listdir(new)) if n.endswith((".png", ".pfm")))
    different = large = 0
    for name in names:
        paths = [os.path.join(folder, name) for folder in (old, new)]
        if not all(os.path.exists(p) for p in paths):
            print("%s: only in %s" % (name, old if os.path.exists(paths[0]) else new))
            large += 1
            continue
        contents = [open(p, "rb").read() for p in paths]
        if contents[0] == contents[1]:
            continue
        different += 1
        (bits, samples, a), (bits_b, _, b) = read(paths[0]), read(paths[1])
        if bits != bits_b or len(a) != len(b):
            print("%s: another size or depth" % name)
            large += 1
            continue
        gaps = [abs(x - y) for x, y in zip(a, b)]
        pixels = sum(1 for i in range(0, len(gaps), samples) if any(gaps[i : i + samples]))
        most = max(gaps)
        large += most > {8: 1, 16: 257}.get(bits, 0)
        print("%s: %d of %d pixels, at most %g" % (name, pixels, len(gaps) // samples, most))
    print("%d of %d files differ, %d by more than one level of 255" % (different, len(names), large))
    return 1 if large else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
