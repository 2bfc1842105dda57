#!/usr/bin/env python3
"""Writes src/math/spectrum_tables_internal.h, tables for src/math/spectrum.c, which names the observer and the white.

    tools/spectrum.py >src/math/spectrum_tables_internal.h
"""
import math

FROM, TO = 0.38, 0.76  # micrometres
QUANTILES, NODES, STEPS = 64, 40, 38000

RGB = [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]


def lobe(x, middle, below, above):
    t = (x - middle) * (below if x < middle else above)
    return math.exp(-t * t / 2)


def colour(x):
    """The colour matching functions in linear sRGB; x in nanometres."""
    xyz = (0.362 * lobe(x, 442.0, 0.0624, 0.0374) + 1.056 * lobe(x, 599.8, 0.0264, 0.0323)
           - 0.065 * lobe(x, 501.1, 0.0490, 0.0382),
           0.821 * lobe(x, 568.8, 0.0213, 0.0247) + 0.286 * lobe(x, 530.9, 0.0613, 0.0322),
           1.217 * lobe(x, 437.0, 0.0845, 0.0278) + 0.681 * lobe(x, 459.0, 0.0385, 0.0725))
    return [sum(row[k] * xyz[k] for k in range(3)) for row in RGB]


step = (TO - FROM) / STEPS
samples = [colour(1000 * (FROM + (i + 0.5) * step)) for i in range(STEPS)]
white = [sum(s[c] for s in samples) * step for c in range(3)]

# Wavelengths below which lies the same share of the length of the colour, and of a little that keeps the intervals at
# the ends short.
lengths = [math.sqrt(sum((s[c] / white[c]) ** 2 for c in range(3))) for s in samples]
lengths = [length + 0.03 * max(lengths) for length in lengths]
whole, done, quantiles = sum(lengths), 0.0, [FROM]
for i, length in enumerate(lengths):
    while len(quantiles) < QUANTILES and done + length >= whole * len(quantiles) / QUANTILES:
        quantiles.append(FROM + step * (i + (whole * len(quantiles) / QUANTILES - done) / length))
    done += length
quantiles.append(TO)

# The middles of equal steps of the inverse wavelength; the factor is the change of the wavelength there.
first, last = 1 / TO, 1 / FROM
waves = [first + (i + 0.5) * (last - first) / NODES for i in range(NODES)]
nodes = [[v / (w * w) for v in colour(1000 / w)] for w in waves]
sums = [sum(n[c] for n in nodes) for c in range(3)]

print("/* Written by tools/spectrum.py. */\n/* clang-format off */")
print("static const double white[3] = {%.12g, %.12g, %.12g};" % tuple(white))
print("static const double quantiles[%d] = {" % (QUANTILES + 1))
for i in range(0, QUANTILES + 1, 8):
    print("    " + " ".join("%.7f," % q for q in quantiles[i:i + 8]))
print("};\nstatic const struct colour node_weights[SPECTRUM_NODES] = {")
for n in nodes:
    print("    {%.12g, %.12g, %.12g}," % tuple(n[c] / sums[c] for c in range(3)))
print("};")
