#!/usr/bin/env python3
"""Computes the numbers of elementary_tables.h and of tests/unit/elementary_reference.h with 400-bit arithmetic.

    python3 elementary_tables.py tables    > elementary_tables.h
    python3 elementary_tables.py reference > ../../tests/unit/elementary_reference.h

Needs mpmath. Polynomials interpolate at Chebyshev nodes, which costs at most a factor of about two against the minimax
polynomial of the same degree; every degree below is one that leaves 2^-57 or better.
"""
import random
import struct
import sys
from fractions import Fraction

from mpmath import mp, mpf

mp.prec = 400


def to_double(v):
    """The double nearest to v, ties to even, subnormals and overflow included."""
    v = mpf(v)
    if not mp.isfinite(v):
        return float(v)
    if v == 0:
        return 0.0
    sign, man, exp, _ = v._mpf_
    f = Fraction(int(man)) * Fraction(2) ** int(exp)
    try:
        return float(-f if sign else f)     # Fraction to float rounds correctly
    except OverflowError:
        return float('-inf') if sign else float('inf')


def hexd(v):
    d = to_double(v)
    if d != d:
        return 'NAN'
    if d in (float('inf'), float('-inf')):
        return 'INFINITY' if d > 0 else '-INFINITY'
    return d.hex().replace('.0000000000000p', '.0p')


def truncated(v, quantum):
    """v rounded to a multiple of 2^-quantum."""
    return mp.nint(mpf(v) * mpf(2) ** quantum) / mpf(2) ** quantum


def interpolate(f, lo, hi, degree):
    """Coefficients, lowest first, of the polynomial through f at the Chebyshev nodes of [lo, hi]."""
    n = degree + 1
    lo, hi = mpf(lo), mpf(hi)
    xs = [(lo + hi) / 2 + (hi - lo) / 2 * mp.cos(mp.pi * (2 * i + 1) / (2 * n)) for i in range(n)]
    table = [f(x) for x in xs]
    for level in range(1, n):
        for i in range(n - 1, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (xs[i] - xs[i - level])
    coefficients = [mpf(0)]
    for i in range(n - 1, -1, -1):
        shifted = [mpf(0)] + coefficients
        for j, c in enumerate(coefficients):
            shifted[j] -= xs[i] * c
        shifted[0] += table[i]
        coefficients = shifted[:n]
    return coefficients


def show(name, values, comment):
    print(f'/* {comment} */')
    print(f'static const double {name}[{len(values)}] = {{')
    row = []
    for v in values:
        row.append(hexd(v))
        if len(row) == 4:
            print('    ' + ', '.join(row) + ',')
            row = []
    if row:
        print('    ' + ', '.join(row) + ',')
    print('};\n')


def define(name, v, comment):
    print(f'static const double {name} = {hexd(v)};' + (f' /* {comment} */' if comment else ''))


def tables():
    print('/* Numbers of elementary.c, written by elementary_tables.py: tables and polynomials computed with 400 bits.')
    print(' * Only elementary_lanes.h includes this file. */')
    print('/* clang-format off */')
    print('#ifndef GRAY_MATH_ELEMENTARY_TABLES_H\n#define GRAY_MATH_ELEMENTARY_TABLES_H\n\n#include <stdint.h>\n')

    ln2 = mp.log(2)
    define('exp_per_step', 128 / ln2, '128 / ln 2')
    hi = truncated(ln2 / 128, 42)
    define('exp_step_hi', hi, 'ln 2 / 128 to 35 bits: times a count below 2^18 is exact')
    define('exp_step_lo', ln2 / 128 - hi, 'the rest')
    ln2hi = truncated(ln2, 42)
    define('log_ln2_hi', ln2hi, 'ln 2 in units of 2^-42: times an exponent is exact')
    define('log_ln2_lo', ln2 - ln2hi, 'the rest')
    ln2d = to_double(ln2)
    define('ln2_double', ln2, 'ln 2')
    for name, v in (('log2_e', 1 / ln2), ('log10_e', 1 / mp.log(10)), ('log10_2', ln2 / mp.log(10))):
        h = to_double(v)
        define(name + '_hi', h, name + ', and the rest')
        define(name + '_lo', v - mpf(h), '')
    half_pi = mp.pi / 2
    define('two_over_pi', 1 / half_pi, '2 / pi')
    p1 = truncated(half_pi, 32)
    p2 = truncated(half_pi - p1, 65)
    define('half_pi_1', p1, 'pi / 2 in parts of 33, 33 and 53 bits (Cody and Waite 1980)')
    define('half_pi_2', p2, '')
    define('half_pi_3', half_pi - p1 - p2, '')
    for name, v in (('half_pi', half_pi), ('whole_pi', mp.pi), ('quarter_pi', mp.pi / 4), ('three_quarter_pi', 3 * mp.pi / 4)):
        h = to_double(v)
        define(name + '_hi', h, name.replace('_', ' '))
        define(name + '_lo', v - mpf(h), '')
    print()

    # Interval i of 128 begins 2^45 i units in the last place above 0.6875.
    print('/* 2^(j/128) as the bits of a double, and what those bits leave out relative to it. */')
    print('static const struct exp_entry { uint64_t bits; double tail; } exp_table[128] = {')
    for j in range(128):
        v = mpf(2) ** (mpf(j) / 128)
        d = to_double(v)
        bits = struct.unpack('<Q', struct.pack('<d', d))[0]
        print(f'    {{ 0x{bits:016x}, {hexd((v - mpf(d)) / mpf(d))} }},')
    print('};\n')

    print('/* inverse: 1 / (a point of the interval), a multiple of 2^-9; log_hi + log_lo = -log(inverse),')
    print(' * log_hi in units of 2^-42. The two intervals that touch 1 have inverse 1. */')
    print('static const struct log_entry { double inverse, log_hi, log_lo; } log_table[128] = {')
    worst = mpf(0)
    for i in range(128):
        def edge(k):
            return struct.unpack('<d', struct.pack('<Q', 0x3fe6000000000000 + (k << 45)))[0]
        lo, hi_edge = mpf(edge(i)), mpf(edge(i + 1))
        inverse = mpf(1) if 1 in (lo, hi_edge) else truncated(2 / (lo + hi_edge), 9)
        worst = max(worst, abs(lo * inverse - 1), abs(hi_edge * inverse - 1))
        v = -mp.log(inverse)
        vh = truncated(v, 42)
        print(f'    {{ {hexd(inverse)}, {hexd(vh)}, {hexd(v - vh)} }},')
    print('};\n')
    assert worst <= mpf(2) ** -7

    print('/* atan(i/64), and what the double leaves out. */')
    print('static const struct atan_entry { double hi, lo; } atan_table[65] = {')
    for i in range(65):
        v = mp.atan(mpf(i) / 64)
        h = to_double(v)
        print(f'    {{ {hexd(h)}, {hexd(v - mpf(h))} }},')
    print('};\n')

    def over(f, lead):
        return lambda z: f(z) if z != 0 else lead

    r = mpf(2) ** -7
    show('log_poly', interpolate(lambda x: (mp.log1p(x) - x + x * x / 2) / x ** 3, -r, r, 7),
         '(log(1+r) - r + r^2/2) / r^3, |r| <= 2^-7')
    z = (mp.pi / 4 * mpf('1.001')) ** 2
    show('sin_poly', interpolate(lambda t: (mp.sin(mp.sqrt(t)) / mp.sqrt(t) - 1) / t, 0, z, 5),
         '(sin(x)/x - 1) / x^2 in x^2, |x| <= pi/4')
    show('cos_poly', interpolate(lambda t: (mp.cos(mp.sqrt(t)) - 1 + t / 2) / (t * t), 0, z, 5),
         '(cos(x) - 1 + x^2/2) / x^4 in x^2, |x| <= pi/4')
    show('asin_poly', interpolate(lambda t: (mp.asin(mp.sqrt(t)) / mp.sqrt(t) - 1) / t, 0, mpf('0.2501'), 12),
         '(asin(x)/x - 1) / x^2 in x^2, |x| <= 1/2')
    z = mpf('0.35') ** 2
    show('sinh_poly', interpolate(lambda t: (mp.sinh(mp.sqrt(t)) / mp.sqrt(t) - 1) / t, 0, z, 5),
         '(sinh(x)/x - 1) / x^2 in x^2, |x| <= 0.35')
    show('tanh_poly', interpolate(lambda t: (mp.tanh(mp.sqrt(t)) / mp.sqrt(t) - 1) / t, 0, z, 10),
         '(tanh(x)/x - 1) / x^2 in x^2, |x| <= 0.35')

    mp.prec = 1600
    digits = int(mp.floor(2 / mp.pi * mpf(2) ** 1280))
    mp.prec = 400
    print('/* The first 1280 bits of 2/pi, after 128 zero bits so that a window may begin above the point. */')
    print('static const uint64_t two_over_pi_bits[22] = {')
    words = [0, 0] + [(digits >> (64 * (19 - i))) & (2 ** 64 - 1) for i in range(20)]
    for i in range(0, 22, 4):
        print('    ' + ', '.join(f'0x{w:016x}' for w in words[i:i + 4]) + ',')
    print('};\n')
    print('#endif')


def reference():
    rng = random.Random(20140701)

    def from_bits(b):
        return struct.unpack('<d', struct.pack('<Q', b))[0]

    def step(d, n):
        return from_bits(struct.unpack('<Q', struct.pack('<d', d))[0] + n)

    def spread(lo, hi, count):
        """Doubles whose exponents are uniform between two powers of two, of both signs."""
        return [rng.choice((-1, 1)) * rng.uniform(1, 2) * 2.0 ** rng.randint(lo, hi) for _ in range(count)]

    pi = to_double(mp.pi)
    # Arguments close to a multiple of pi/2 (Muller, Elementary Functions, table of worst cases; the first is the worst of all)
    hard_angles = [6381956970095103.0 * 2.0 ** 797, 5319372648326541.0 * 2.0 ** 849, 6411027962775774.0 * 2.0 ** -48]
    hard_angles += [to_double(mp.pi / 2 * k) for k in (1, 2, 3, 4, 5, 7, 10, 22, 355, 710, 1000, 99999, 636619, 636620, 10 ** 9)]
    angles = hard_angles + [-a for a in hard_angles[:4]] + [0.5, pi / 4, step(pi / 4, 1), step(pi / 4, -1), 1e6, 1e22, 1e300,
             1.7976931348623157e308, 5e-324, 2.0 ** -1022, 1e-9, 2.0 ** -27]
    angles += spread(-30, 20, 120) + spread(20, 1023, 50)
    units = [0.0, 1.0, 0.5, step(0.5, 1), step(0.5, -1), step(1.0, -1), 5e-324, 1e-300, 2.0 ** -27]
    units += [rng.uniform(-1, 1) for _ in range(150)] + spread(-60, -1, 40)
    exps = [0.0, 709.782712893384, 709.78271289338397, -745.1332191019411, -745.1332191019412, -708.3964185322641,
            -708.39641853226408, -740.5, -720.25, 1e-20, -1e-20, 5e-324, 1.0, -1.0]
    exps += [rng.uniform(-745, 709.7) for _ in range(120)] + [rng.uniform(-1, 1) for _ in range(40)] + spread(-40, 5, 30)
    logs = [5e-324, 2.0 ** -1022, 1.7976931348623157e308, step(1.0, 1), step(1.0, -1), 0.5, 2.0, 10.0, 1000.0, 1e22, 0.6875,
            1.375, 1 + 2.0 ** -7, 1 - 2.0 ** -8, 1 + 2.0 ** -8] + [rng.uniform(0.5, 2) for _ in range(100)]
    logs += [abs(v) for v in spread(-1074, 1023, 50)] + [1 + v for v in spread(-50, -4, 40)]
    wide = [abs(v) for v in spread(-1060, 1020, 60)] + spread(-6, 6, 130) + [5e-324, 1e308, 0.125, 27.0, 1000.0, -8.0]
    one = {
        'sin': (mp.sin, angles), 'cos': (mp.cos, angles), 'tan': (mp.tan, angles), 'asin': (mp.asin, units),
        'acos': (mp.acos, units), 'exp': (mp.exp, exps),
        'exp2': (lambda v: mpf(2) ** v, [e for e in ([-1074.0, -1074.5, -1022.0, -1022.5, 1023.9999999, 0.5] +
                 [rng.uniform(-1074, 1023) for _ in range(150)] + spread(-40, 3, 40))]),
        'expm1': (mp.expm1, [e for e in exps if e != 0.0] + spread(-10, 1, 60)), 'log': (mp.log, logs),
        'log2': (lambda v: mp.log(v) / mp.log(2), logs), 'log10': (mp.log10, logs),
        'cbrt': (lambda v: mp.cbrt(v) if v >= 0 else -mp.cbrt(-v), wide),
        'sinh': (mp.sinh, spread(-30, 8, 190) + [710.4, 0.35, 1e-300]), 'cosh': (mp.cosh, spread(-30, 8, 190) + [710.4]),
        'tanh': (mp.tanh, spread(-30, 5, 190) + [19.0, 22.5, 0.35, 1e-300]),
    }
    pows = [(2.0, 0.3), (10.0, 308.0), (10.0, -323.0), (2.0, -1074.0), (2.0, -1022.5), (0.999999999999, 1e13), (1.0000001, 7e9),
            (5e-324, 0.5), (5e-324, -0.9), (1.7976931348623157e308, 0.5), (step(1.0, 1), 2.0 ** 60), (step(1.0, -1), 2.0 ** 62),
            (-3.0, 3.0), (-2.5, 4.0), (0.5, 1074.0), (0.1, 20.0), (3.0, -600.0), (7.0, -383.0)]
    pows += [(abs(v), rng.uniform(-1, 1) * 700 / (abs(mp.log(abs(v))) + mpf('0.01'))) for v in spread(-20, 20, 100)]
    pows += [(rng.uniform(0, 1), rng.uniform(0, 60)) for _ in range(50)] + [(1 + v, w * 0.5) for v, w in
             zip(spread(-30, -3, 40), spread(2, 11, 40))]
    pows = [(b, float(e)) for b, e in pows]
    atans = [(1.0, 1.0), (-1.0, -1.0), (1.0, -1e-300), (1e-300, 1e300), (-1e300, 1e-300), (5e-324, 5e-324), (5e-324, 1.0),
             (1e308, 1e308), (1.0, 64.0), (1e-310, -1e-308)] + list(zip(spread(-8, 8, 150), spread(-8, 8, 150)))
    atans += list(zip(spread(-1070, 1022, 40), spread(-1070, 1022, 40)))
    two = {'pow': (lambda b, e: mp.power(b, e), pows), 'atan2': (mp.atan2, atans)}

    print('/* Arguments and correctly rounded results, written by src/math/elementary_tables.py with 400 bits (1600 where')
    print(' * an angle is huge). */\n/* clang-format off */')
    print('#ifndef GRAY_TESTS_ELEMENTARY_REFERENCE_H\n#define GRAY_TESTS_ELEMENTARY_REFERENCE_H\n\n#include <math.h>\n')
    print('struct reference1 { double x, want; };\nstruct reference2 { double x, y, want; };\n')
    mp.prec = 1600
    for name, (f, points) in one.items():
        print(f'static const struct reference1 reference_{name}[] = {{')
        for x in points:
            print(f'    {{ {hexd(x)}, {hexd(f(mpf(x)))} }},')
        print('};\n')
    for name, (f, points) in two.items():
        print(f'static const struct reference2 reference_{name}[] = {{')
        for x, y in points:
            print(f'    {{ {hexd(x)}, {hexd(y)}, {hexd(f(mpf(x), mpf(y)))} }},')
        print('};\n')
    print('#endif')


if __name__ == '__main__':
    {'tables': tables, 'reference': reference}[sys.argv[1]]()
