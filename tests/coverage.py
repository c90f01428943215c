#!/usr/bin/env python3
"""What the core's tests execute of firmware/, from gcov's counts.

Usage: coverage.py SOURCE_DIR BUILD_DIR EXCEPTIONS [--whole] [--json FILE]

Counts of a line are added over all objects it was compiled into. A line of EXCEPTIONS is "file | text of the line | reason"; one such line counts as executed where it
was not, and an exception that is not needed any more is an error. Exit status: 0; 1 when a bound is missed: all lines of canopen/ and safety/, 95 % of all
(executed, not excepted); with --whole every line of the others, too.
"""
import argparse
import collections
import json
import pathlib
import subprocess
import sys

WHOLE = ("canopen", "safety")
OVERALL = 0.95


def gcov(files):
    """The JSON documents that gcov makes of some .gcda files."""
    for file in files:
        said = subprocess.run(["gcov", "--json-format", "--branch-probabilities", "--stdout", str(file)], cwd=file.parent, check=True, capture_output=True).stdout
        for line in said.splitlines():
            yield file, json.loads(line)


class Source:
    def __init__(self):
        self.lines = collections.Counter()
        self.branches = {}  # of the object that is the file's own: (line, number) -> taken


def collect(root, build):
    """Path within firmware/ -> Source."""
    sources = collections.defaultdict(Source)
    for file, document in gcov(sorted(build.rglob("*.gcda"))):
        for entry in document["files"]:
            path = pathlib.Path(document.get("current_working_directory", "."), entry["file"]).resolve()
            if not path.is_relative_to(root / "firmware"):
                continue
            source = sources[str(path.relative_to(root))]
            own = file.name.startswith(path.name) or path.suffix == ".hpp"
            for line in entry["lines"]:
                number = line["line_number"]
                source.lines[number] += line["count"]
                if own:
                    for i, branch in enumerate(line["branches"]):
                        key = (number, i)
                        source.branches[key] = source.branches.get(key, 0) + branch["count"]
    return sources


def not_linked(root, sources):
    """Files of firmware/ with code that no object counts."""
    return sorted(path for file in (root / "firmware").rglob("*.cpp") if (path := str(file.relative_to(root))) not in sources)


def read_exceptions(path):
    """(file, text) -> how many lines of this text are excepted."""
    found = collections.Counter()
    for line in path.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            file, text, reason = (part.strip() for part in line.split(" | "))
            if not reason:
                raise SystemExit(f"{path}: no reason for {file}: {text}")
            found[file, text] += 1
    return found


def judge(sources, texts, exceptions):
    """(table of folders, lines not executed and not excepted, exceptions not needed). `texts`: path -> list of lines."""
    folders = collections.defaultdict(lambda: [0, 0, 0, 0, 0])  # lines, executed, excepted, branches, taken
    missing, needed = [], collections.Counter()
    for path, source in sorted(sources.items()):
        folder = folders[path.split("/")[1] if path.count("/") > 1 else "(front)"]
        folder[3] += len(source.branches)
        folder[4] += sum(count > 0 for count in source.branches.values())
        for number, count in sorted(source.lines.items()):
            folder[0] += 1
            text = texts[path][number - 1].strip() if number <= len(texts[path]) else ""
            if count > 0:
                folder[1] += 1
            elif needed[path, text] < exceptions.get((path, text), 0):
                folder[2] += 1
                needed[path, text] += 1
            else:
                missing.append(f"{path}:{number}: {text}")
    return dict(folders), missing, sorted(key for key, lines in exceptions.items() if needed[key] < lines)


def bounds_missed(folders, whole=WHOLE):
    """What is under its bound, in words. `whole`: the folders of which every line counts."""
    found = []
    for name in whole:
        lines, executed, excepted = folders.get(name, [0] * 5)[:3]
        if lines == 0 or executed + excepted < lines:
            found.append(f"{name}/: {lines - executed - excepted} of {lines} lines are not executed")
    lines, executed = (sum(folder[i] for folder in folders.values()) for i in range(2))
    if executed < OVERALL * lines:
        found.append(f"all: {100 * executed / max(lines, 1):.1f} % of {lines} lines, {100 * OVERALL:.0f} are wanted")
    return found


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("exceptions", type=pathlib.Path)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    asked = parser.parse_args()
    root = asked.source.resolve()
    sources = collect(root, asked.build.resolve())
    texts = {path: (root / path).read_text().splitlines() for path in sources}
    folders, missing, useless = judge(sources, texts, read_exceptions(asked.exceptions))
    print("| folder | lines | executed | excepted | branches | taken |\n|---|---|---|---|---|---|")
    for name, (lines, executed, excepted, branches, taken) in sorted(folders.items()):
        print(f"| {name} | {lines} | {100 * executed / max(lines, 1):.1f} % | {excepted} | {branches} | {100 * taken / max(branches, 1):.1f} % |")
    for line in missing:
        print(f"not executed: {line}")
    for file, text in useless:
        print(f"exception not needed: {file}: {text}")
    if asked.json:
        asked.json.write_text(json.dumps({"folders": folders, "missing": missing}, indent=1))
    failed = [f"no test program links {path}" for path in (not_linked(root, sources) if asked.whole else [])]
    failed += bounds_missed(folders, sorted(set(folders) | set(WHOLE)) if asked.whole else WHOLE)
    for line in failed:
        print(line)
    return 1 if failed or useless else 0


if __name__ == "__main__":
    sys.exit(main())
