#!/usr/bin/env python3
"""Writes src/material/metals.h, the reflectances of metals in linear sRGB.

    tools/metals.py >src/material/metals.h

From measured indices of refraction n + ik follow Fresnel's reflectances head on and at the cosine 1/7 (82 degrees),
for light without polarisation. They are seen under D65 (CIE, relative power at 10 nm) with the colour matching
functions of 1931 as fitted by C. Wyman, P.-P. Sloan and P. Shirley, "Simple Analytic Approximations to the CIE XYZ
Color Matching Functions", JCGT 2013, such that a reflectance of 1 is white, and cut to 0 .. 1. The second colour is
the reflectance at 82 degrees over that of Schlick's formula, the F82 tint of OpenPBR Surface.

The indices are those of refractiveindex.info (M. N. Polyanskiy, Scientific Data 11, 94, 2024; public domain, CC0):
  JC72  P. B. Johnson and R. W. Christy, Phys. Rev. B 6, 4370 (1972)
  JC74  P. B. Johnson and R. W. Christy, Phys. Rev. B 9, 5056 (1974)
  R98   A. D. Rakic, A. B. Djurisic, J. M. Elazar and M. L. Majewski, Appl. Opt. 37, 5271 (1998)
  Q85   M. R. Querry, Contractor Report CRDC-CR-85034 (1985): 70 % copper, 30 % zinc
  W75   J. H. Weaver, C. G. Olson and D. W. Lynch, Phys. Rev. B 12, 1293 (1975)
  W09   W. S. M. Werner, K. Glantschnig and C. Ambrosch-Draxl, J. Phys. Chem. Ref. Data 38, 1013 (2009)
"""
import math

JC72 = "0.3815 0.3974 0.4133 0.4305 0.4509 0.4714 0.4959 0.5209 0.5486 0.5821 0.6168 0.6595 0.7045 0.7560 0.8211"
JC74 = "0.381 0.397 0.413 0.431 0.451 0.471 0.496 0.521 0.549 0.582 0.617 0.659 0.704 0.756 0.821"

# Name, source, wavelengths in micrometres, n, k.
METALS = [
    ("aluminium", "R98", "0.37211 0.38795 0.40446 0.42167 0.43962 0.45833 0.47783 0.49817 0.51937 0.54147 0.56452 0.58855"
     " 0.61359 0.63971 0.66693 0.69532 0.72491 0.75576 0.78793",
     "0.39330 0.43317 0.47790 0.52788 0.58336 0.64439 0.71074 0.78186 0.85697 0.93525 1.0162 1.1005 1.1911 1.2952 1.4286"
     " 1.6203 1.9115 2.3052 2.6523",
     "4.3726 4.5661 4.7659 4.9717 5.1830 5.3994 5.6203 5.8455 6.0750 6.3099 6.5519 6.8042 7.0711 7.3576 7.6672 7.9931"
     " 8.2933 8.4555 8.3611"),
    ("brass", "Q85", "0.38 0.40 0.41 0.42 0.43 0.44 0.45 0.46 0.47 0.48 0.49 0.50 0.51 0.52 0.53 0.54 0.55 0.56 0.57 0.58"
     " 0.60 0.62 0.64 0.66 0.68 0.70 0.72 0.74 0.76 0.78",
     "1.487 1.445 1.405 1.350 1.278 1.191 1.094 0.994 0.900 0.816 0.745 0.686 0.639 0.602 0.573 0.549 0.527 0.505 0.484"
     " 0.468 0.450 0.449 0.444 0.445 0.444 0.446 0.450 0.455 0.458 0.464",
     "1.818 1.805 1.794 1.786 1.784 1.797 1.829 1.883 1.957 2.046 2.145 2.250 2.358 2.464 2.568 2.668 2.765 2.860 2.958"
     " 3.059 3.253 3.434 3.609 3.778 3.943 4.106 4.266 4.424 4.579 4.737"),
    ("chromium", "JC74", JC74, "1.92 2.00 2.08 2.19 2.33 2.51 2.75 2.94 3.18 3.22 3.17 3.09 3.05 3.08 3.20",
     "2.74 2.83 2.93 3.04 3.14 3.24 3.30 3.33 3.33 3.30 3.30 3.34 3.39 3.42 3.48"),
    ("cobalt", "JC74", JC74, "1.53 1.57 1.61 1.67 1.74 1.81 1.88 1.97 2.05 2.13 2.19 2.25 2.31 2.40 2.53",
     "2.82 2.93 3.05 3.17 3.28 3.41 3.55 3.68 3.82 3.96 4.11 4.27 4.45 4.64 4.88"),
    ("copper", "JC72", JC72, "1.33 1.32 1.28 1.25 1.24 1.25 1.22 1.18 1.02 0.70 0.30 0.22 0.21 0.24 0.26",
     "2.045 2.116 2.207 2.305 2.397 2.483 2.564 2.608 2.577 2.704 3.205 3.747 4.205 4.665 5.180"),
    ("gold", "JC72", JC72, "1.46 1.47 1.46 1.45 1.38 1.31 1.04 0.62 0.43 0.29 0.21 0.14 0.13 0.14 0.16",
     "1.933 1.952 1.958 1.948 1.914 1.849 1.833 2.081 2.455 2.863 3.272 3.697 4.103 4.542 5.083"),
    ("iron", "JC74", JC74, "2.12 2.24 2.35 2.48 2.59 2.67 2.74 2.86 2.95 2.94 2.88 2.92 2.86 2.87 2.94",
     "2.50 2.58 2.65 2.71 2.77 2.82 2.88 2.91 2.93 2.99 3.05 3.10 3.19 3.28 3.39"),
    ("manganese", "JC74", JC74, "1.92 1.96 2.00 2.06 2.11 2.19 2.25 2.32 2.39 2.47 2.51 2.56 2.62 2.70 2.83",
     "2.67 2.74 2.82 2.90 2.98 3.06 3.14 3.23 3.33 3.43 3.54 3.65 3.78 3.91 4.03"),
    ("nickel", "JC74", JC74, "1.72 1.72 1.70 1.71 1.73 1.78 1.82 1.85 1.92 1.96 1.99 1.99 2.06 2.13 2.26",
     "2.48 2.57 2.69 2.82 2.95 3.09 3.25 3.42 3.61 3.80 4.02 4.26 4.50 4.73 4.97"),
    ("palladium", "JC74", JC74, "1.26 1.30 1.33 1.37 1.41 1.46 1.52 1.57 1.64 1.68 1.75 1.80 1.86 1.95 2.06",
     "2.83 2.93 3.03 3.14 3.26 3.39 3.54 3.68 3.84 4.02 4.21 4.42 4.65 4.89 5.19"),
    ("platinum", "R98", "0.37470 0.39746 0.41340 0.42998 0.44722 0.46515 0.48381 0.50321 0.52339 0.54437 0.56620 0.58891"
     " 0.61252 0.63709 0.66263 0.68920 0.71684 0.74559 0.79088",
     "1.6643 1.7225 1.7611 1.7998 1.8390 1.8796 1.9222 1.9676 2.0166 2.0699 2.1281 2.1917 2.2607 2.3354 2.4155 2.5006"
     " 2.5903 2.6837 2.8294",
     "2.6963 2.8323 2.9253 3.0210 3.1204 3.2240 3.3320 3.4447 3.5618 3.6830 3.8079 3.9358 4.0661 4.1979 4.3305 4.4633"
     " 4.5958 4.7276 4.9238"),
    ("silver", "JC72", JC72, "0.05 0.05 0.05 0.04 0.04 0.05 0.05 0.05 0.06 0.05 0.06 0.05 0.04 0.03 0.04",
     "1.864 2.070 2.275 2.462 2.657 2.869 3.093 3.324 3.586 3.858 4.152 4.483 4.838 5.242 5.727"),
    ("titanium", "JC74", JC74, "1.99 2.08 2.14 2.21 2.27 2.32 2.36 2.44 2.54 2.60 2.67 2.76 2.86 3.00 3.21",
     "2.93 2.95 2.98 3.01 3.04 3.10 3.19 3.30 3.43 3.58 3.72 3.84 3.96 4.01 4.01"),
    ("tungsten", "W75", "0.3790 0.4002 0.4115 0.4253 0.4426 0.4650 0.4921 0.5111 0.5298 0.5489 0.5705 0.5997 0.6260 0.6524"
     " 0.6712 0.7008 0.7314 0.7528 0.7938",
     "3.459 3.406 3.379 3.346 3.317 3.325 3.380 3.433 3.490 3.522 3.524 3.557 3.607 3.680 3.746 3.871 3.891 3.862 3.705",
     "2.556 2.415 2.416 2.439 2.489 2.574 2.664 2.700 2.716 2.739 2.787 2.860 2.906 2.937 2.937 2.879 2.828 2.788 2.733"),
    ("vanadium", "JC74", JC74, "2.87 3.07 3.31 3.52 3.59 3.81 3.92 3.86 4.00 3.83 3.54 3.25 3.18 3.20 3.16",
     "3.45 3.48 3.49 3.49 3.46 3.38 3.26 3.18 3.04 3.00 3.02 3.09 3.15 3.20 3.25"),
    ("zinc", "W09", "0.354241 0.381490 0.413281 0.450852 0.495937 0.551041 0.619921 0.708481 0.826561",
     "0.5240 0.5508 0.6029 0.6794 0.7858 0.9322 1.1356 1.4247 1.8489",
     "2.9907 3.2986 3.6376 4.0209 4.4636 4.9850 5.6116 6.3811 7.3486"),
]

# CIE standard illuminant D65 from 380 nm on, every 10 nm.
D65 = [49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354,
       107.802, 104.79, 107.689, 104.405, 104.046, 100, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886,
       83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087, 63.5927, 46.4182,
       66.8054, 63.3828]
SRGB = [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]


def lobe(nm, middle, below, above):
    t = (nm - middle) / (below if nm < middle else above)
    return math.exp(-t * t / 2)


def matching(nm):
    return (1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) - 0.065 * lobe(nm, 501.1, 20.4, 26.2),
            0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1),
            1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8))


def linear_srgb(spectrum):
    xyz = [0, 0, 0]
    for i, power in enumerate(D65):
        for c, weight in enumerate(matching(380 + 10 * i)):
            xyz[c] += weight * power * spectrum(380 + 10 * i)
    return [sum(m * v for m, v in zip(row, xyz)) for row in SRGB]


WHITE = linear_srgb(lambda nm: 1)


def reflectance(n, k, cosine):
    index = complex(n, k)
    other = (1 - (1 - cosine * cosine) / (index * index)) ** 0.5
    s = (cosine - index * other) / (cosine + index * other)
    p = (index * cosine - other) / (index * cosine + other)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


def interpolated(xs, ys, x):
    for i in range(len(xs) - 1):
        if x <= xs[i + 1]:
            t = (x - xs[i]) / (xs[i + 1] - xs[i])
            return ys[i] + t * (ys[i + 1] - ys[i])
    return ys[-1]


def colour(metal, cosine):
    um, n, k = ([float(x) for x in column.split()] for column in metal[2:])
    assert len(um) == len(n) == len(k), metal[0]
    seen = linear_srgb(lambda nm: reflectance(interpolated(um, n, nm / 1000), interpolated(um, k, nm / 1000), cosine))
    return [min(max(c / w, 0), 1) for c, w in zip(seen, WHITE)]


def numbers(values):
    return "{" + ", ".join("%.4f" % v for v in values) + "}"


print("/* Written by tools/metals.py, which names the sources: name, reflectance head on and F82 tint in linear sRGB. */")
print("/* clang-format off */\n#ifndef GRAY_MATERIAL_METALS_H\n#define GRAY_MATERIAL_METALS_H\n\n#define METALS(X) \\")
for metal in METALS:
    head_on, grazing = colour(metal, 1), colour(metal, 1 / 7)
    fifth = (6 / 7) ** 5
    tint = [g / (f + (1 - f) * fifth) for g, f in zip(grazing, head_on)]
    end = "" if metal is METALS[-1] else " \\"
    values = ", ".join("%.4f" % v for v in head_on + tint)
    print('    X("%s", %s)%s /* %s */' % (metal[0], values, "", metal[1]) + end)
print("\n#endif")
