#!/usr/bin/env python3
"""The mask of blue noise in src/image/blue_noise_internal.h, by void-and-cluster.

R. Ulichney, "The void-and-cluster method for dither array generation", SPIE 1913 (1993). Ties go to the first place, so
every run prints the same header.

    tools/blue_noise.py >src/image/blue_noise_internal.h
"""
import math
import random

SIDE = 64
COUNT = SIDE * SIDE
SIGMA = 1.5
ONES = COUNT // 10  # of the first pattern

# The weight of a point at each place of the torus.
near = [min(i, SIDE - i) for i in range(SIDE)]
weight = [[math.exp(-(near[y] ** 2 + near[x] ** 2) / (2 * SIGMA**2)) for x in range(SIDE)] for y in range(SIDE)]


class Pattern:
    def __init__(self):
        self.has = [False] * COUNT
        self.energy = [0.0] * COUNT

    def copy(self):
        other = Pattern()
        other.has, other.energy = self.has[:], self.energy[:]
        return other

    def put(self, place, value):
        self.has[place] = value
        sign = 1 if value else -1
        py, px = divmod(place, SIDE)
        for y in range(SIDE):
            row = weight[(y - py) % SIDE]
            shifted = row[-px:] + row[:-px] if px else row
            at = y * SIDE
            for x in range(SIDE):
                self.energy[at + x] += sign * shifted[x]

    def tightest_cluster(self):
        return max((i for i in range(COUNT) if self.has[i]), key=lambda i: (round(self.energy[i], 9), -i))

    def largest_void(self):
        return min((i for i in range(COUNT) if not self.has[i]), key=lambda i: (round(self.energy[i], 9), i))


def first_pattern():
    pattern = Pattern()
    for place in random.Random(1993).sample(range(COUNT), ONES):
        pattern.put(place, True)
    while True:
        cluster = pattern.tightest_cluster()
        pattern.put(cluster, False)
        void = pattern.largest_void()
        pattern.put(void, True)
        if void == cluster:
            return pattern


def ranks():
    rank = [0] * COUNT
    first = first_pattern()
    pattern = first.copy()
    for number in range(ONES - 1, -1, -1):
        place = pattern.tightest_cluster()
        pattern.put(place, False)
        rank[place] = number
    # The energy of the zeros is a constant minus that of the ones: the tightest cluster of zeros is the largest void
    # of ones, so phases 2 and 3 of the paper are one loop.
    pattern = first
    for number in range(ONES, COUNT):
        place = pattern.largest_void()
        pattern.put(place, True)
        rank[place] = number
    return rank


rank = ranks()
print("/* Made by tools/blue_noise.py: the ranks of a mask of blue noise, row by row, by R. Ulichney, \"The void-and-cluster")
print(" * method for dither array generation\", SPIE 1913 (1993). */")
print("#ifndef GRAY_IMAGE_BLUE_NOISE_INTERNAL_H")
print("#define GRAY_IMAGE_BLUE_NOISE_INTERNAL_H\n")
print("#include <stdint.h>\n")
print("/* clang-format off */")
print(f"enum {{ BLUE_NOISE_SIDE = {SIDE} }};")
print("static const uint16_t blue_noise[BLUE_NOISE_SIDE * BLUE_NOISE_SIDE] = {")
for start in range(0, COUNT, 16):
    print("    " + ", ".join(str(r) for r in rank[start : start + 16]) + ",")
print("};")
print("/* clang-format on */\n")
print("#endif")
