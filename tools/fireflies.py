#!/usr/bin/env python3
"""Finds pixels of a PNG picture (8 bits, RGB) that stand out of their neighbours: in some channel they differ from the
median of the eight by more than four of their standard deviations plus 8 levels.

tools/fireflies.py PICTURE [REFERENCE]

A pixel that stands out of the reference, too (a picture of many samples of the same size), belongs there.
Prints each that does not, and exits with 1 if there is one."""
import struct
import sys
import zlib


def read_png(name):
    """Width, height and rows of 8-bit RGB."""
    with open(name, 'rb') as file:
        data = file.read()
    at, packed = 8, b''
    width = height = 0
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b'IHDR':
            width, height, depth, colour = struct.unpack('>IIBB', body[:10])
            if depth != 8 or colour != 2 or body[12] != 0:
                sys.exit(f'{name}: not a PNG file of 8-bit RGB')
        elif kind == b'IDAT':
            packed += body
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = row[i - 3] if i >= 3 else 0
            corner = above[i - 3] if i >= 3 else 0
            if kind == 1:
                row[i] = row[i] + left & 255
            elif kind == 2:
                row[i] = row[i] + above[i] & 255
            elif kind == 3:
                row[i] = row[i] + (left + above[i]) // 2 & 255
            elif kind == 4:
                guess = left + above[i] - corner
                to_left, to_above, to_corner = abs(guess - left), abs(guess - above[i]), abs(guess - corner)
                best = left if to_left <= to_above and to_left <= to_corner else \
                    above[i] if to_above <= to_corner else corner
                row[i] = row[i] + best & 255
        rows.append(row)
        above = row
    return width, height, rows


def is_outlier(rows, x, y):
    for channel in range(3):
        around = sorted(rows[y + j][3 * (x + i) + channel] for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j)
        difference = abs(rows[y][3 * x + channel] - (around[3] + around[4]) / 2)
        if difference <= 8:
            continue
        mean = sum(around) / 8
        deviation = (sum((value - mean) ** 2 for value in around) / 8) ** .5
        if difference > 4 * deviation + 8:
            return True
    return False


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    width, height, rows = read_png(sys.argv[1])
    reference = read_png(sys.argv[2]) if len(sys.argv) == 3 else None
    if reference and reference[:2] != (width, height):
        sys.exit(f'{sys.argv[2]}: is not of {width} x {height} pixels')
    found = [(x, y) for y in range(1, height - 1) for x in range(1, width - 1) if is_outlier(rows, x, y)]
    found = [(x, y) for x, y in found if not (reference and is_outlier(reference[2], x, y))]
    for x, y in found:
        print(f'{sys.argv[1]}: pixel {x},{y} stands out')
    sys.exit(1 if found else 0)


main()
