#!/usr/bin/env python3
"""Damages the files that users write, and looks at what `lanternfish check` makes of it: never a crash, and of what cannot be meant a refusal with file, line and cause.

mutations.py PROGRAM SHARED [--each N] [--seed S]: N mutants of each file, drawn with the seed."""
import argparse
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"(?<![\w.#-])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])")
KEY = re.compile(r"([A-Za-z_]{3,})(?=:| ?=)")
# May stand twice.
REPEATED = re.compile(r"<visual|<collision|<origin|</|<joint |<link |<robot|<material")


class Mutant:
    def __init__(self, what, text, wrong):
        self.what, self.text, self.wrong = what, text, wrong  # wrong: it has to be refused


def code_of(line, yaml):
    return line.split("#")[0] if yaml else line


def mutants_of(text, yaml):
    lines = text.split("\n")
    comment = False
    for i, line in enumerate(lines):
        comment = comment or (not yaml and "<!--" in line)
        inside, comment = comment, comment and "-->" not in line
        code = code_of(line, yaml)
        if inside or not code.strip() or code.startswith("<?"):
            continue

        def put(changed):
            return "\n".join(lines[:i] + changed + lines[i + 1:])

        for number in NUMBER.finditer(code):
            for value, wrong in ((".nan" if yaml else "nan", True), ("-1e30", True), ("1e300", True), ("word", True), ("0", False),
                                 ("-" + number.group().lstrip("-"), False)):
                changed = line[:number.start()] + value + line[number.end():]
                yield Mutant(f"line {i + 1}: {number.group()} is {value}", put([changed]), wrong)
        for key in KEY.finditer(code):
            changed = line[:key.start()] + key.group() + "x" + line[key.end():]
            named = "xmlns" in code or key.group() in ("xmlns", "name", "material", "lanternfish", "visual", "http", "https")
            yield Mutant(f"line {i + 1}: {key.group()} is {key.group()}x", put([changed]), not named)
        yield Mutant(f"line {i + 1} is missing", put([]), False)
        yield Mutant(f"line {i + 1} is there twice", put([line, line]), not REPEATED.search(code))
        ends = len("\n".join(lines[:i])) + len(line) // 2
        yield Mutant(f"it ends in line {i + 1}", text[:ends], not yaml)


class File:
    def __init__(self, name, source, kind, beside, names):
        self.name, self.source, self.kind, self.beside, self.names = name, source, kind, beside, names


def files(shared):
    machine = (shared / "machines/oberon7.yaml").read_text()
    urdf, limits = "arm/oberon7/oberon7.urdf", "safety/oberon7.yaml"
    small = (shared / "machines/arm5e.yaml").read_text()
    meshes = {path.name: path.read_bytes() for path in (shared / "scenes").iterdir() if path.is_file() and path.suffix != ".yaml"}
    return [
        File("a machine", shared / "machines/oberon7.yaml", "machine", {}, "mutant.yaml"),
        File("the default machine", shared / "machines/arm5e.yaml", "machine", {}, "mutant.yaml"),
        File("a panel", shared / "panels/pandora.yaml", "panel", {}, "mutant.yaml"),
        File("a scene", shared / "scenes/clutter.yaml", "scene", meshes, "mutant.yaml"),
        File("an arm", shared / urdf, "machine", {"machine.yaml": machine.replace(urdf, "mutant.urdf").encode()}, "mutant.urdf"),
        File("the default arm", shared / "arm/arm5e.urdf", "machine", {"machine.yaml": small.replace("arm/arm5e.urdf", "mutant.urdf").encode()},
             "mutant.urdf"),
        File("limits", shared / limits, "machine", {"machine.yaml": machine.replace(limits, "mutant.yaml").encode()}, "mutant.yaml"),
    ]


def check(program, file, mutant, folder):
    for name, content in file.beside.items():
        (folder / name).write_bytes(content)
    (folder / file.names).write_text(mutant.text)
    checked = "machine.yaml" if "machine.yaml" in file.beside else file.names
    ran = subprocess.run([program, "check", file.kind, checked], cwd=folder, capture_output=True, text=True, timeout=60)
    said = ran.stdout + ran.stderr
    if ran.returncode not in (0, 2):
        return f"exit status {ran.returncode}: {said[:300]}"
    if ran.returncode == 0:
        return "it is taken" if mutant.wrong else ""
    if re.search(re.escape(file.names) + r":\d+: ", said) or re.search(r"'\w+\.[\w.\[\]-]+'|scene: '", said):
        return ""
    return f"neither line nor key: {said[:300]}"


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("program", type=pathlib.Path)
    options.add_argument("shared", type=pathlib.Path)
    options.add_argument("--each", type=int, default=12)
    options.add_argument("--seed", type=int, default=20261128)
    given = options.parse_args()
    draw = random.Random(given.seed)
    looked = failed = 0
    with tempfile.TemporaryDirectory() as made:
        for file in files(given.shared):
            text = file.source.read_text()
            every = [m for m in mutants_of(text, file.source.suffix == ".yaml") if m.text != text]
            for mutant in draw.sample(every, min(given.each, len(every))):
                folder = pathlib.Path(made) / "here"
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                looked += 1
                problem = check(given.program.resolve(), file, mutant, folder)
                if problem:
                    failed += 1
                    print(f"{file.name}, {mutant.what}: {problem}")
    print(f"{looked} mutants, {failed} not as they should be (seed {given.seed})")
    return 1 if failed or looked < 80 else 0


if __name__ == "__main__":
    sys.exit(main())
