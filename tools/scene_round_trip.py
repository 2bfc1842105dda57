#!/usr/bin/env python3
"""tools/scene_round_trip.py GRAY FOLDER [WORD...]: writes the scenes of the tests as JSON and as scripts and compares
their pictures. The scenes are the scripts below tests and the text inside of tests/unit and of the documents that a
program can render, without those that use pairs, which has no fixed order; with words, those of files with such a
name. FOLDER must be empty. Prints each difference and the number of scenes; the status is 1 if there is a
difference."""
import glob
import os
import re
import subprocess
import sys

ROOT = os.getcwd()
GRAY, FOLDER, WORDS = sys.argv[1], sys.argv[2], sys.argv[3:]
LITERALS = re.compile(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+')
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
SMALL = ['-q', '--size', '32x24', '-ss', '1', '--spp', '1', '--script-time', '20']
# What JSON cannot have (docs/json.md), and scenes that are too large for a test.
LACKS = ('not UTF-8', 'not recorded', 'saved edits', 'gr.transform_order changes', 'after it; write the scene',
         'as a script', 'too slow')


def texts():
    for name in sorted(glob.glob('tests/unit/*/*.c')):
        for run in LITERALS.finditer(open(name).read()):
            text = ''.join(LITERAL.findall(run.group(0))).replace('\\?', '?')
            try:
                yield name, text.encode().decode('unicode_escape').encode('latin1').decode()
            except UnicodeError:
                pass
    for name in sorted(glob.glob('tests/*/*.lua')):
        if not name.startswith(('tests/errors', 'tests/hostile')):
            yield name, open(name, errors='replace').read()
    for name in sorted(glob.glob('docs/*.md')):
        for block in re.findall(r'```lua\n(.*?)```', open(name).read(), re.S):
            yield name, block


def gray(*arguments):
    """The first line of the errors, or '' without one."""
    try:
        run = subprocess.run([GRAY, *arguments], cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=60)
    except subprocess.TimeoutExpired:
        return 'too slow'
    return (run.stderr.decode(errors='replace').split('\n')[0] or 'an error') if run.returncode else ''


def same(a, b):
    return open(f'{FOLDER}/{a}', 'rb').read() == open(f'{FOLDER}/{b}', 'rb').read()


def check():
    """What is wrong with s.lua; None if it is no scene, has more than 20 pictures, or cannot be written."""
    if gray(*SMALL, 's.lua', '-o', 'out/a%d.png') or len(os.listdir(f'{FOLDER}/out')) not in range(1, 21):
        return None
    for pattern, kind in (('out/x%d.json', 'json'), ('out/l%d.lua', 'lua')):
        error = gray('-q', 's.lua', '-o', pattern)
        if error:
            return None if any(word in error for word in LACKS) else error
        for a in sorted(glob.glob(f'{FOLDER}/out/a*.png')):
            number = re.search(r'a(\d+)\.png', a).group(1)
            scene = pattern.replace('%d', number)
            error = gray(*SMALL, scene, '-o', 'out/b.png')
            if error or not same(f'out/a{number}.png', 'out/b.png'):
                return error or f'another picture of {scene}'
            if kind == 'json' and (gray('-q', scene, '-o', 'out/again.json') or not same(scene, 'out/again.json')):
                return f'{scene} is not written again'
    # A part of the first picture, with other threads.
    crop = ['--crop', '7,5,16,12']
    if not gray(*SMALL, *crop, '-j', '1', 's.lua', '-o', 'out/c%d.png'):
        error = gray(*SMALL, *crop, '-j', '3', 'out/x1.json', '-o', 'out/d.png')
        if error or not same('out/c1.png', 'out/d.png'):
            return error or 'another part'
    return ''


def main():
    seen, count, bad = set(), 0, 0
    for folder in ('data', 'textures'):
        os.symlink(f'{ROOT}/{folder}', f'{FOLDER}/{folder}')
    for name, text in texts():
        if text in seen or not re.search(r'gr\.(render|light_field|frames)', text) or ' pairs' in text or \
                (WORDS and not any(word in name for word in WORDS)):
            continue
        seen.add(text)
        subprocess.run(['rm', '-rf', f'{FOLDER}/out'], check=True)
        os.mkdir(f'{FOLDER}/out')
        open(f'{FOLDER}/s.lua', 'w').write(text)
        wrong = check()
        count += wrong == ''
        bad += bool(wrong)
        if wrong:
            print(f'{name}: {wrong}\n{text}')
    print(f'{count} scenes are the same')
    sys.exit(bad > 0)


main()
