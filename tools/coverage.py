#!/usr/bin/env python3
"""What the tests reach: lines, and the two outcomes of every condition as it stands in the source.

coverage.py FOLDER reads FOLDER/export.json and FOLDER/export.lcov (both of llvm-cov) and writes, into the same folder,
summary.md (modules, marks), files.md (files below their mark) and missing.txt (every line and outcome that was not reached).

Counted is what the source says: `a && b` has two conditions and so four outcomes, a case of a switch is one condition (that none of the cases of a closed
kind fits is none).
Not counted are conditions that clang knows the answer of (while (true), sizeof), the conditions of assert() and what
stands in a line that is UNREACHABLE, the switch of MAY_FAIL, which other builds do not have, and the answer of functions
that tell an error and always answer false (in `a || error_set(...)`).
"""
import json
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
with open(os.path.join(ROOT, "Makefile")) as makefile:
    MODULES = re.search(r"^MODULES = (.*)$", makefile.read(), re.MULTILINE).group(1).split()
# Modules that must be covered completely; all others count only for the totals.
CATEGORIES = {
    "binding": r"src/(sandbox|record|call|compat|script)/",
    "sandbox": r"src/host/confine\.c|src/base/path_policy\.c|src/sandbox/(libraries|limits|protect|files|streams)\.c",
    "checkpoint": r"src/film/tile_file\.c|src/output/checkpoint\.c",
    "readers": r"src/formats/|src/image/(png_read|jpeg_read|float_read|exr)\.c",
}
ALL_LINES, ALL_BRANCHES = 95.0, 90.0
NOT_COUNTED = re.compile(r"\b(assert|UNREACHABLE|MAY_FAIL|MAY_GIVE_NULL)\(")
# Functions that report an error and always return false; variables assigned at the same time.
REPORTS = re.compile(r"(error_\w+|wrong|refuse|tell|no_memory|\w*fail\w*)\(")
ASSIGNS = re.compile(r"\(.* = true\)")
FAULT = ("MAY_FAIL", "MAY_GIVE_NULL")


def closing(text, start):
    """The place behind the parenthesis that closes the one at start, strings and characters passed over."""
    depth, i = 0, start
    while i < len(text):
        c = text[i]
        if c in "\"'":
            i += 1
            while text[i] != c:
                i += 2 if text[i] == "\\" else 1
        elif c == "(":
            depth += 1
        elif c == ")":
            depth -= 1
            if depth == 0:
                return i + 1
        i += 1
    return len(text)


class Source:
    """A file's text and the places in it that do not count."""

    def __init__(self, path):
        self.text = open(path).read()
        self.starts = [0]
        for match in re.finditer("\n", self.text):
            self.starts.append(match.end())
        self.silent, self.silent_lines = [], set()
        for match in NOT_COUNTED.finditer(self.text):
            end = closing(self.text, match.end() - 1)
            if match.group(1) in FAULT:  # its argument is counted, its own condition is not
                self.silent.append((match.start(), match.end()))
                continue
            self.silent.append((match.start(), end))
            if match.group(1) == "UNREACHABLE":
                self.silent_lines.update(range(self.line(match.start()), self.line(end) + 1))
                # The cases that lead only there.
                cases = re.search(r"(case \w+:\s*)+(break;\s*\}\s*)?\Z", self.text[:match.start()])
                if cases:
                    self.silent.append(cases.span())
                    self.silent_lines.update(range(self.line(cases.start()), self.line(match.start())))

    def offset(self, line, column):
        return self.starts[line - 1] + column - 1

    def line(self, offset):
        lo, hi = 0, len(self.starts)
        while hi - lo > 1:
            middle = (lo + hi) // 2
            lo, hi = (middle, hi) if self.starts[middle] <= offset else (lo, middle)
        return lo + 1

    def is_silent(self, line, column):
        at = self.offset(line, column)
        return any(lo <= at < hi for lo, hi in self.silent)

    def is_closed(self, line, column):
        """Is this what a switch over a closed kind is about? That no case fits is then excluded by the compiler."""
        at = self.offset(line, column)
        if not re.search(r"\bswitch \((\(enum \w+\))?\Z", self.text[:at]):
            return False
        body = self.text.index("{", at)
        depth, end = 0, body
        while depth or end == body:
            depth += {"{": 1, "}": -1}.get(self.text[end], 0)
            end += 1
        body = self.text[body:end]
        return "default:" not in body and all(re.fullmatch(r"[A-Z0-9_]+", c) for c in re.findall(r"\bcase ([^:]+):", body))


class File:
    def __init__(self, path, name):
        self.source = Source(path)
        self.name = name
        self.lines = {}     # line -> count
        self.branches = {}  # (line, column, end line, end column, place in the macro) -> [true, false]

    def count(self):
        lines = [n for line, n in self.lines.items() if line not in self.source.silent_lines]
        outcomes = [n for pair in self.branches.values() for n in pair]
        return [sum(n > 0 for n in lines), len(lines), sum(n > 0 for n in outcomes), len(outcomes)]


def read(folder, root):
    files = {}

    def entry(path):
        name = os.path.relpath(path, root)
        if not name.startswith("src/"):
            return None
        if name not in files:
            files[name] = File(path, name)
        return files[name]

    current = None
    for row in open(os.path.join(folder, "export.lcov")):
        row = row.strip()
        if row.startswith("SF:"):
            current = entry(row[3:])
        elif row.startswith("DA:") and current:
            line, count = row[3:].split(",")[:2]
            current.lines[int(line)] = int(count)
    for function in json.load(open(os.path.join(folder, "export.json")))["data"][0]["functions"]:
        names = function["filenames"]
        # A region of kind 1 gives the place where the text of another "file" of the function (a macro) was expanded.
        site = {r[6]: r for r in function["regions"] if r[7] == 1}
        for b in function["branches"]:
            place, inner = b[:4], None
            number = b[6]
            while number in site:
                inner = inner or (names[number], *place)
                place, number = site[number][:4], site[number][5]
            file = entry(names[number])
            if file is None or place[0] > len(file.source.starts) or file.source.is_silent(place[0], place[1]) or file.source.is_closed(place[0], place[1]):
                continue
            pair = file.branches.setdefault((*place, inner), [0, 0])
            for side in (0, 1):
                # A difference of counters may be negative if a process ended in between.
                count = b[4 + side]
                pair[side] += count if 0 < count < 1 << 62 else 0
    for file in files.values():
        for key, pair in list(file.branches.items()):
            text = file.source.text[file.source.offset(key[0], key[1]):file.source.offset(key[2], key[3])]
            if REPORTS.match(text):
                pair[0] = pair[0] or pair[1]
            if ASSIGNS.fullmatch(text):
                pair[1] = pair[0] or pair[1]
            # Reached with neither outcome counted: the compiler knew the result.
            if pair == [0, 0] and file.lines.get(key[0], 0) > 0 and is_known(file.source, key):
                del file.branches[key]
    return files


def is_known(source, key):
    text = source.text[source.offset(key[0], key[1]):source.offset(key[2], key[3])]
    return re.fullmatch(r"true|false|0|1", text) or "sizeof" in text or text.isupper()


def percent(have, of):
    return 100.0 * have / of if of else 100.0


def shown(have, of):
    """Rounded down: 100.0 means all."""
    return f"{int(1000 * have / of) / 10 if of else 100.0:.1f}"


def add(counts):
    return [sum(column) for column in zip(*counts)] or [0, 0, 0, 0]


def row(name, c):
    return f"| {name} | {shown(c[0], c[1])} | {c[1] - c[0]} of {c[1]} | {shown(c[2], c[3])} | {c[3] - c[2]} of {c[3]} |"


def main():
    folder = sys.argv[1]
    files = read(folder, os.getcwd())
    head = "| lines, % | missing | branches, % | missing |\n| --- | ---: | ---: | ---: | ---: |"
    out = [f"| module {head}"]
    counts = {name: file.count() for name, file in files.items()}
    for module in MODULES:
        inside = [c for name, c in counts.items() if name.startswith(f"src/{module}/")]
        if inside:
            out.append(row(module, add(inside)))
    total = add(counts.values())
    out += [row("**all**", total), "", f"| must be complete {head}"]
    for mark, pattern in CATEGORIES.items():
        out.append(row(mark, add(c for name, c in counts.items() if re.match(pattern, name))))
    below = ["Files below the goal (100 % of branches where coverage must be complete, else 95 % of lines and 90 % of branches):",
             "", f"| file {head}"]
    for name in sorted(counts):
        c = counts[name]
        whole = any(re.match(pattern, name) for pattern in CATEGORIES.values())
        if c[2] < c[3] if whole else percent(c[0], c[1]) < ALL_LINES or percent(c[2], c[3]) < ALL_BRANCHES:
            below.append(row(f"`{name}`{' (must be complete)' if whole else ''}", c))
    open(os.path.join(folder, "summary.md"), "w").write("\n".join(out) + "\n")
    open(os.path.join(folder, "files.md"), "w").write("\n".join(below) + "\n")
    with open(os.path.join(folder, "missing.txt"), "w") as missing:
        for name in sorted(files):
            report_missing(files[name], missing)
    print("\n".join(out))


def report_missing(file, out):
    said = []
    for line, count in file.lines.items():
        if count == 0 and line not in file.source.silent_lines:
            text = file.source.text.splitlines()[line - 1].strip()
            said.append((line, 0, f"not reached: {text}"))
    for key, (true, false) in file.branches.items():
        text = file.source.text[file.source.offset(key[0], key[1]):file.source.offset(key[2], key[3])]
        text = " ".join(text.split())
        if (not true or not false) and file.lines.get(key[0], 1):
            what = "never asked" if not true and not false else "never true" if not true else "never false"
            said.append((key[0], key[1], f"{what}: {text}"))
    for line, column, text in sorted(said):
        out.write(f"{file.name}:{line}: {text}\n")


main()
