#!/usr/bin/env python3
"""Moves files and renames identifiers as maps say; tools/rename.sh describes the maps.

Every text is read once and written once: the file names in it first, then its identifiers. The result depends on the
tree and the maps alone, so the same map gives the same names on every branch (tools/carry.sh).
"""
import concurrent.futures
import fnmatch
import hashlib
import os
import re
import subprocess
import sys
import threading

C_ENDINGS = ('.c', '.h', '.cc')
TEXT_ENDINGS = C_ENDINGS + ('.md', '.sh', '.py', '.txt', '.lua', '.yml', '.run', '.allow')
PATH_ENDINGS_ONLY = ('.lua', '.py', '.txt', '.yml')  # in these only whole paths are replaced
TOKEN = re.compile(
    r'(?P<include>\#[ \t]*include[ \t]*<[^>\n]*>)|(?P<comment>/\*.*?\*/|//[^\n]*)|(?P<string>"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')'
    r'|(?P<word>[A-Za-z_]\w*)|(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)', re.S)
PATH = re.compile(r'[A-Za-z0-9_](?:[A-Za-z0-9_./-]*[A-Za-z0-9_])?')
WORD = re.compile(r'[A-Za-z_]\w*')
OWN = ('tools/rename.sh', 'tools/rename.py', 'tools/carry.sh', 'tools/names.sh', 'tools/names.list')
ROOTS = ('src/', 'tests/', 'tools/', 'docs/', 'bench/', 'lua/', 'data/')


def fail(text):
    sys.exit('rename: ' + text)


def git(*arguments):
    return subprocess.run(('git',) + arguments, check=True, stdout=subprocess.PIPE).stdout.decode()


class Map:
    def __init__(self):
        self.files, self.folds, self.rules, self.keep, self.texts = [], [], [], [], []

    def read(self, name):
        for number, line in enumerate(open(name, encoding='utf-8'), 1):
            fields = [a if a else b for a, b in re.findall(r'"([^"]*)"|(\S+)', re.sub(r'(^|\s)#.*', '', line))]
            if not fields:
                continue
            verb, _, scope = fields.pop(0).partition('@')
            scope = scope.split(',') if scope else []
            if verb == 'file' and len(fields) == 2:
                self.files.append((fields[0].rstrip('/'), fields[1].rstrip('/')))
            elif verb == 'fold' and (len(fields) == 2 or fields[2:] == ['first']):
                self.folds.append((fields[0], fields[1], len(fields) == 3))
            elif verb in ('word', 'part', 'tag') and (len(fields) == 2 or fields[2:] == ['merge']):
                if verb == 'part' and re.search(r'(^|_)%s(_|$)' % re.escape(fields[0]), fields[1]):
                    fail('%s:%d: the new name has the old one as a part' % (name, number))
                self.rules.append((verb, scope, fields[0], fields[1], len(fields) == 3))
            elif verb == 'keep' and len(fields) == 1:
                self.keep.append(fields[0])
            elif verb in ('text', 'comment') and len(fields) == 2:
                self.texts.append((verb, scope, fields[0], fields[1]))
            else:
                fail('%s:%d: not a line of a map: %s' % (name, number, line.strip()))


def in_scope(scope, paths):
    return not scope or any(fnmatch.fnmatchcase(path, pattern) for path in paths for pattern in scope)


def apply_rule(verb, old, new, word):
    """What a rule makes of an identifier."""
    if verb in ('word', 'tag'):
        if '*' not in old:
            return new if word == old else word
        before, _, after = old.partition('*')
        if not (word.startswith(before) and word.endswith(after) and len(word) >= len(before) + len(after)):
            return word
        return new.replace('*', word[len(before):len(word) - len(after)])
    for o, n in ((old, new), (old.upper(), new.upper())):
        word = re.sub(r'(?<![A-Za-z0-9])%s(?![A-Za-z0-9])' % re.escape(o), n, word)
    return word


class Renamer:
    def __init__(self, maps):
        self.map = maps
        self.tests, self.known = set(), {}
        self.changed = {}  # (old, new, merge, scoped) -> paths

    def concerned(self, word):
        """Some line changes this word somewhere."""
        if word not in self.known:
            self.known[word] = any(apply_rule(verb, old, new, word) != word for verb, _, old, new, _ in self.map.rules)
        return self.known[word]

    def word(self, paths, word, is_test=False, is_tag=False):
        if not self.concerned(word) or any(fnmatch.fnmatchcase(word, pattern) for pattern in self.map.keep):
            return word
        for verb, scope, old, new, merge in self.map.rules:
            if verb == 'part' and (is_test or word in self.tests) or verb == 'tag' and not is_tag:
                continue
            if in_scope(scope, paths):
                made = apply_rule(verb, old, new, word)
                if made != word:
                    # Parts may follow one another in one identifier; a word is complete.
                    if verb == 'part':
                        made = self.word(paths, made, is_test, is_tag)
                    self.changed.setdefault((word, made, merge, bool(scope)), set()).add(paths[0])
                    return made
        return word

    def prose(self, paths, text, comment):
        """Identifiers in comments and documents: words that can be nothing else."""
        def one(match):
            word, start, end = match.group(), match.start(), match.end()
            if not self.concerned(word):
                return word
            before, after = text[max(0, start - 8):start], text[end:end + 6]
            if re.search(r'(gr\.|--|\w-|\$[{(]?)$', before) or re.match(r'\.(png|lua|md|sh|json|obj|[ch]\b)', after):
                return word
            sure = '_' in word or after.startswith('(') or re.search(r'\b(struct|enum|union) $', before)
            if comment and not sure:
                sure = (before.endswith('`') and after.startswith('`')) or after.startswith('->') or before.endswith('->')
            is_tag = re.search(r'\b(struct|enum|union) $', before) is not None
            return self.word(paths, word, False, is_tag) if sure else word
        return WORD.sub(one, text)

    def code(self, paths, text):
        out, last, previous = [], 0, ''
        for match in TOKEN.finditer(text):
            kind = match.lastgroup
            out.append(text[last:match.start()])
            piece = match.group()
            if kind == 'word':
                is_test = text[last:match.start()].strip() == '(' and previous.startswith('TEST')
                is_tag = previous in ('struct', 'enum', 'union') and not text[last:match.start()].strip()
                previous = piece
                piece = self.word(paths, piece, is_test, is_tag)
            elif kind == 'comment':
                piece = self.prose(paths, piece, True)
                for verb, scope, old, new in self.map.texts:
                    if verb == 'comment' and in_scope(scope, paths):
                        piece = re.sub(r'\b%s\b' % re.escape(old), lambda _: new, piece)
            out.append(piece)
            last = match.end()
        out.append(text[last:])
        return ''.join(out)


def moves_of(maps, tracked):
    """Old path -> new path for every tracked file, and for what the lines name though it is gone."""
    moves = {}
    for old, new in maps.files:
        below = [path for path in tracked if path.startswith(old + '/')]
        for path in below:
            moves[path] = new + path[len(old):]
        if not below:
            moves[old] = new
    for old, new, _ in maps.folds:
        if old in tracked and new not in tracked:
            fail('%s: there is no such file' % new)
        moves[old] = moves.get(new, new)
    folded = {old for old, _, _ in maps.folds}
    for old, new in moves.items():
        if old not in folded and old in tracked and (new in tracked and new not in moves or os.path.exists(new) and new not in tracked):
            fail('%s: there is such a file already' % new)
    return moves


class Mentions:
    """The names under which texts mention files that moved."""
    def __init__(self, maps, moves, tracked):
        self.whole, self.base = dict(moves), {}
        stems = {}
        for old, new in moves.items():
            if old.endswith('.c'):
                self.whole[old[:-2] + '.o'] = new[:-2] + '.o'
            stems.setdefault(os.path.splitext(old)[0], set()).add(os.path.splitext(new)[0])
        for old, new in stems.items():
            # base/arena without an ending: where all files of that name go to the same one
            stay = [path for path in tracked if os.path.splitext(path)[0] == old and path not in moves]
            if len(new) == 1 and not stay:
                self.whole[old] = next(iter(new))
        for old, new in maps.files:
            if any(path.startswith(old + '/') for path in moves):
                self.whole[old] = new
        for old, new in list(self.whole.items()):
            if old.startswith('src/') and old.count('/') > 1:
                self.whole[old[4:]] = new[4:] if new.startswith('src/') else new
        names = {}
        for path in tracked | set(moves):
            names.setdefault(os.path.basename(path), set()).add(path)
        for old, new in moves.items():
            name = os.path.basename(old)
            if name != os.path.basename(new) and '.' in name:
                self.base[(name, os.path.dirname(old))] = os.path.basename(new)
                if len(names[name]) == 1:
                    self.base[(name, None)] = os.path.basename(new)

    def replace(self, path, text, bare):
        folder = os.path.dirname(path)

        def one(match):
            token = match.group()
            if token in self.whole and ('/' in token):
                return self.whole[token]
            if bare and '/' not in token and (match.start() == 0 or text[match.start() - 1] != '/'):
                return self.base.get((token, folder), self.base.get((token, None), token))
            for root in ROOTS:
                at = token.find('/' + root)
                if at >= 0 and token[at + 1:] in self.whole:
                    return token[:at + 1] + self.whole[token[at + 1:]]
            return token
        return PATH.sub(one, text)

    def apply(self, path, text):
        if not path.endswith(C_ENDINGS):
            return self.replace(path, text, not path.endswith(PATH_ENDINGS_ONLY))

        def one(match):
            return self.replace(path, match.group(), True) if match.lastgroup in ('comment', 'string') else match.group()
        return TOKEN.sub(one, text)


def needles_of(maps, moves):
    """What a text has somewhere if anything in it can change."""
    needles = {os.path.splitext(os.path.basename(path))[0] for path in moves} | {old for old, _ in maps.files}
    needles |= {old for _, _, old, _ in maps.texts}
    for _, _, old, _, _ in maps.rules:
        needles.add(max(old.split('*'), key=len))
    return re.compile('|'.join(sorted(map(re.escape, needles))), re.I)


def guard_of(path):
    path = path[4:] if path.startswith('src/') else path
    return 'GRAY_' + re.sub(r'[^A-Za-z0-9]', '_', path).upper()


PREAMBLE = re.compile(r'(?P<comment>/\*.*?\*/\n+)?(?P<defines>(?:#define [^\n]*\n+)*)'
                      r'(?P<includes>(?:(?:#[ \t]*include[^\n]*)?\n)*)', re.S)
GUARD = re.compile(r'(\A(?:/\*.*?\*/\n+)?)#ifndef (\w+)\n#define \2\n(.*)\n#endif[^\n]*\n*\Z', re.S)


class Parts:
    """A C file as its opening comment, blocks of includes, and the rest."""
    def __init__(self, text):
        guard = GUARD.match(text)
        self.guard = guard and guard.group(2)
        match = PREAMBLE.match(guard.group(1) + guard.group(3) if guard else text)
        self.comment, self.defines = (match.group('comment') or '').rstrip('\n'), match.group('defines')
        self.comment += '\n' if self.comment else ''
        self.blocks = [block.split('\n') for block in re.split(r'\n{2,}', match.group('includes').strip('\n')) if block]
        self.body = match.string[match.end():].strip('\n')

    def text(self):
        pieces = ['\n'.join(block) for block in self.blocks] + [self.body]
        text = self.defines + '\n\n'.join(pieces) + '\n'
        if self.guard:
            text = '#ifndef %s\n#define %s\n\n%s\n#endif\n' % (self.guard, self.guard, text)
        return self.comment + text

    def include(self, line, own):
        """Adds an include to the block of its kind, which stands behind that of the file's own header."""
        if any(line in block for block in self.blocks):
            return
        mine = [block for block in self.blocks if block[0][-1] == line[-1] and own not in block]
        if mine:
            mine[-1].append(line)
        elif line[-1] == '>':
            self.blocks.append([line])
        else:
            at = next((i + 1 for i, block in enumerate(self.blocks) if own in block), 0)
            self.blocks.insert(at, [line])


def fold(path, into, what, first):
    """The text of a file with another one's at its end; a header that it included goes first. What the other file opened
    with heads its part, unless it only names its header."""
    to, part = Parts(without_repeats(into)), Parts(what)
    itself = '#include "%s"' % re.sub(r'^src/', '', path)
    own = itself[:-2] + 'h"'
    first = first or any(itself in block for block in to.blocks)
    for side in (to, part):
        side.blocks = [[line for line in block if line != itself] for block in side.blocks]
        side.blocks = [block for block in side.blocks if block]
    for block in part.blocks:
        for line in block:
            to.include(line, own)
    body = part.body
    if part.comment and not re.match(r'/\* See [\w/]+\.h\. \*/', part.comment):
        body = part.comment + '\n' + body
    to.body = body + '\n\n' + to.body if first else to.body + '\n\n' + body
    to.defines += ''.join(line + '\n' for line in part.defines.split('\n') if line and line not in to.defines)
    return to.text()


def without_repeats(text):
    """Every include once, the first time; a block that is empty then goes."""
    parts, seen = Parts(text), set()
    blocks = []
    for block in parts.blocks:
        block = [line for line in block if not (line in seen or seen.add(line))]
        if block:
            blocks.append(block)
    if blocks == parts.blocks:
        return text
    parts.blocks = blocks
    return parts.text()


def is_text(path):
    base = os.path.basename(path)
    if path.startswith(('tools/renames/', 'tests/fuzz/corpus/', 'tests/fuzz/found/')) or path in OWN:
        return False
    return path.endswith(TEXT_ENDINGS) or base in ('Makefile', 'run', '.gitignore')


class Formatter:
    """clang-format, whose results are kept by content beside the repository's objects: carrying many commits, or the
    same one in another worktree, meets the same texts again."""
    def __init__(self):
        self.folder = os.path.join(git('rev-parse', '--git-common-dir').strip(), 'rename-cache')
        os.makedirs(self.folder, exist_ok=True)
        with open('.clang-format', 'rb') as style:
            self.style = style.read() + subprocess.run(['clang-format', '--version'], stdout=subprocess.PIPE).stdout

    def format(self, path, text):
        data = text.encode('utf-8', 'surrogateescape')
        name = self.name(path, data)
        try:
            with open(name, 'rb') as file:
                made = file.read() or data
        except FileNotFoundError:
            made = subprocess.run(['clang-format', '--assume-filename=' + path], input=data, stdout=subprocess.PIPE,
                                  check=True).stdout
            self.store(name, made, data)
            self.store(self.name(path, made), made, made)
        return made.decode('utf-8', 'surrogateescape')

    def name(self, path, data):
        return os.path.join(self.folder, hashlib.sha1(self.style + os.path.splitext(path)[1].encode() + data).hexdigest())

    def store(self, name, made, data):
        with open('%s.%d.%d' % (name, os.getpid(), threading.get_ident()), 'wb') as file:
            file.write(b'' if made == data else made)  # empty: formatted already
        os.rename(file.name, name)


def main():
    arguments = sys.argv[1:]
    force = '-f' in arguments
    names = [name for name in arguments if name != '-f']
    maps = Map()
    for name in names:
        maps.read(name)
    tracked = {path for path in git('ls-files', '-z', '-co', '--exclude-standard').split('\0')
               if path and os.path.isfile(path) and not os.path.islink(path)}
    moves = moves_of(maps, tracked)
    mentions = Mentions(maps, moves, tracked)
    renamer = Renamer(maps)
    texts = {}
    for path in sorted(tracked):
        if is_text(path):
            with open(path, encoding='utf-8', errors='surrogateescape', newline='') as file:
                texts[path] = file.read()
    for path, text in texts.items():
        if path.endswith('.c'):
            renamer.tests.update(re.findall(r'\bTEST\w*\(\s*(\w+)', text))

    results = {}
    needles = needles_of(maps, moves)
    for path, text in texts.items():
        if path not in moves and not needles.search(text):
            continue
        paths = [path] + ([moves[path]] if path in moves else [])
        made = mentions.apply(path, text) if moves else text
        if path in moves and path.endswith('.h'):
            made = re.sub(r'\b%s\b' % guard_of(path), guard_of(moves[path]), made)
        if maps.rules or maps.texts:
            if path.endswith(C_ENDINGS):
                made = renamer.code(paths, made)
            elif not path.endswith(PATH_ENDINGS_ONLY):
                made = renamer.prose(paths, made, False)
        for verb, scope, old, new in maps.texts:
            if verb == 'text' and in_scope(scope, paths):
                made = made.replace(old, new)
        if made != text:
            results[path] = made

    for old, new, first in maps.folds:
        if old in texts:
            results[new] = fold(moves.get(new, new), results.get(new, texts[new]), results.pop(old, texts[old]), first)
    if maps.folds:
        for path in results:
            if path.endswith(C_ENDINGS):
                results[path] = without_repeats(results[path])

    # A new name that exists would make two things one.
    identifiers = {}
    wanted = {new for _, new, merge, _ in renamer.changed if not merge and not force}
    for path, text in texts.items():
        if path.endswith(C_ENDINGS) and wanted and not wanted.isdisjoint(WORD.findall(text)):
            for match in TOKEN.finditer(text):
                if match.lastgroup == 'word':
                    identifiers.setdefault(match.group(), set()).add(path)
    clashes = 0
    for (old, new, merge, scoped), paths in sorted(renamer.changed.items()):
        again = renamer.word(sorted(paths)[:1], new)
        if again != new:
            fail('%s becomes %s, which the map would rename again to %s' % (old, new, again))
        there = identifiers.get(new, set()) & (paths if scoped else identifiers.get(new, set()))
        if there and not merge and not force:
            clashes += 1
            print('rename: %s: %s exists already, in %s' % (old, new, ' '.join(sorted(there)[:4])), file=sys.stderr)
    if clashes:
        fail('%d new names exist already; "merge" at the end of a line allows it' % clashes)

    formatter = Formatter()

    def finish(path):
        made = results[path]
        if path.endswith(C_ENDINGS) and formatter.format(path, texts[path]) == texts[path]:
            made = formatter.format(path, made)
        with open(path, 'w', encoding='utf-8', errors='surrogateescape', newline='') as file:
            file.write(made)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(finish, results))
    folded = {old for old, _, _ in maps.folds}
    for old, new in moves.items():
        if old in folded and old in tracked:
            os.remove(old)
        elif old in tracked:
            os.makedirs(os.path.dirname(new) or '.', exist_ok=True)
            os.rename(old, new)
            folder = os.path.dirname(old)
            while folder and not os.listdir(folder):
                os.rmdir(folder)
                folder = os.path.dirname(folder)
    print('rename: %d files moved, %d changed, %d identifiers' %
          (sum(old in tracked for old in moves), len(results), len({change[0] for change in renamer.changed})))
    if os.environ.get('RENAME_LIST'):
        for (old, new, _, _), paths in sorted(renamer.changed.items()):
            print('  %s -> %s (%d)' % (old, new, len(paths)))


main()
