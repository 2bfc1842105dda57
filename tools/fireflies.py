#!/usr/bin/env python3
"""Finds outliers of a PNG picture (8 bits, RGB): pixels that in some channel differ from the median of their eight
neighbours by more than four standard deviations of these neighbours plus 8 levels.

tools/fireflies.py PICTURE [REFERENCE]
tools/fireflies.py --scene SCRIPT...
tools/fireflies.py --large SCRIPT...

The reference is a picture of the same size with many samples. An outlier is no error if the pixel is as far on that side
there, less at most 8 levels: it is a detail of the scene.
With --scene, renders each path-traced scene with the OPTIONS of its first lines. It also renders the surroundings of
the outliers as a reference, without denoising, with SPP samples (default 4096). --large does so with the picture beside
the script that tools/gallery.sh has made, and the options LARGE. GRAY: the program (default ./gray); OPTIONS: more
options for all renderings ('--bloom 0' makes references quicker and a little darker). ffmpeg reads the pictures.
Prints each outlier that is an error, and exits with 1 if there is one."""
import os
import re
import struct
import subprocess
import sys
import tempfile

CELL = 12  # pixels that share a reference


def read_png(name):
    """Width, height and rows of 8-bit RGB."""
    with open(name, 'rb') as file:
        width, height = struct.unpack('>II', file.read(24)[16:])
    raw = subprocess.run(['ffmpeg', '-v', 'error', '-i', name, '-f', 'rawvideo', '-pix_fmt', 'rgb24', '-'],
                         stdout=subprocess.PIPE, check=True).stdout
    return width, height, [raw[3 * width * y:3 * width * (y + 1)] for y in range(height)]


def sides(rows, x, y):
    """For each channel: the side of the neighbours on which the pixel is an outlier, 1 or -1, else 0."""
    for channel in range(3):
        around = sorted(rows[y + j][3 * (x + i) + channel] for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j)
        difference = rows[y][3 * x + channel] - (around[3] + around[4]) / 2
        if abs(difference) <= 8:
            yield 0
            continue
        mean = sum(around) / 8
        deviation = (sum((value - mean) ** 2 for value in around) / 8) ** .5
        yield 0 if abs(difference) <= 4 * deviation + 8 else 1 if difference > 0 else -1


def outliers(width, height, rows):
    return [(x, y) for y in range(1, height - 1) for x in range(1, width - 1) if any(sides(rows, x, y))]


def is_detail(rows, at, truth, there):
    """Whether the outlier at a place is as far on its side in the reference, at another place of that."""
    own = rows[at[1]][3 * at[0]:3 * at[0] + 3]
    true = truth[there[1]][3 * there[0]:3 * there[0] + 3]
    return all(side * (own[k] - true[k]) <= 8 for k, side in enumerate(sides(rows, *at)))


def report(name, found):
    for x, y in found:
        print(f'{name}: pixel {x},{y} stands out')
    return bool(found)


def compare(picture, reference):
    width, height, rows = read_png(picture)
    found = outliers(width, height, rows)
    if reference:
        size, truth = read_png(reference)[:2], read_png(reference)[2]
        if size != (width, height):
            sys.exit(f'{reference}: is not of {width} x {height} pixels')
        found = [at for at in found if not is_detail(rows, at, truth, at)]
    return report(picture, found)


def render(script, output, options):
    command = [os.environ.get('GRAY', './gray'), '-q', *options, *os.environ.get('OPTIONS', '').split(), '-o', output,
               script]
    if subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode != 0:
        sys.exit(f'{script}: not rendered')


def check_scene(script, folder, large):
    """Whether pixels stand out that do not in the reference."""
    with open(script, encoding='utf-8') as file:
        own = re.search(r'^-- *' + ('LARGE' if large else 'OPTIONS') + ': *(.*)$', file.read(), re.M)
    options = own.group(1).split() if own else []
    picture, part, cells, left = folder + '/picture.png', folder + '/part.png', {}, []
    if large:
        picture = script[:-len('.lua')] + '.png'
    else:
        render(script, picture, options)
    width, height, rows = read_png(picture)
    found = outliers(width, height, rows)
    for x, y in found:
        cells.setdefault((x // CELL, y // CELL), []).append((x, y))
    for pixels in cells.values():
        x0, y0 = min(x for x, _ in pixels) - 1, min(y for _, y in pixels) - 1
        size = max(x for x, _ in pixels) + 2 - x0, max(y for _, y in pixels) + 2 - y0
        render(script, part, [*options, '--denoise=none', '--spp', os.environ.get('SPP', '4096'), '--seed', '1',
                              '--crop', f'{x0},{y0},{size[0]},{size[1]}'])
        truth = read_png(part)[2]
        left += [(x, y) for x, y in pixels if not is_detail(rows, (x, y), truth, (x - x0, y - y0))]
    print(f'{script}: {len(found)} pixels stand out, {len(left)} of them not in the reference', flush=True)
    return report(script, left)


def main():
    if len(sys.argv) > 2 and sys.argv[1] in ('--scene', '--large'):
        with tempfile.TemporaryDirectory() as folder:
            bad = [script for script in sys.argv[2:] if check_scene(script, folder, sys.argv[1] == '--large')]
        sys.exit(1 if bad else 0)
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith('-'):
        sys.exit(__doc__)
    sys.exit(1 if compare(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else None) else 0)


main()
