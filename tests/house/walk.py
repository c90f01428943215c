#!/usr/bin/env python3
"""Walks a page as its reader would: walk.py PAGE LANTERNFISH SHARE. In a folder of its own every line of a block that begins with `lanternfish ` is carried out by
the shell, in the page's order, and has to end with status 0. A block that begins with `version: ` is the file that was written last, as the page has it. There lie
my_arm.urdf, the shipped arm with a tool that is 6 mm longer, and a copy of the shipped limits, my_limits.yaml: `check machine` has to tell the longer reach, and that the
arm can do the job, as it does not of a file that nobody reads.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def blocks(page):
    """Indented blocks, unindented."""
    block = []
    for line in page.read_text().splitlines() + [""]:
        if line.startswith("    "):
            block.append(line[4:])
        elif block:
            yield block
            block = []


def main():
    page, program, share = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    commands = 0
    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)
        (here / "bin").mkdir()
        (here / "bin" / "lanternfish").symlink_to(program.resolve())
        shipped = (share / "arm" / "arm5e.urdf").read_text()
        assert 'xyz="0 0 0.1485"' in shipped
        (here / "my_arm.urdf").write_text(shipped.replace('xyz="0 0 0.1485"', 'xyz="0 0 0.1545"'))
        shutil.copy(share / "safety" / "limits.yaml", here / "my_limits.yaml")
        environment = dict(os.environ, PATH=f"{here / 'bin'}:{os.environ['PATH']}")
        written = None
        for block in blocks(page):
            if block[0].startswith("version: "):
                if written is None:
                    print(f"{page}: a file's text, and no command has written one before")
                    return 1
                written.write_text("\n".join(block) + "\n")
                continue
            for line in block:
                if not line.startswith("lanternfish "):
                    continue
                run = subprocess.run(["bash", "-c", line], cwd=here, env=environment, capture_output=True, text=True)
                commands += 1
                print(f"{run.returncode}  {line}")
                if run.returncode != 0:
                    print(run.stdout[-2000:] + run.stderr[-2000:])
                    return 1
                if written and "my_arm.urdf" in written.read_text() and line.startswith("lanternfish run"):
                    said = subprocess.run(["lanternfish", "check", "machine", written.name], cwd=here, env=environment, capture_output=True, text=True).stdout
                    if "1029 mm from the slew's axis" not in said or "it can do the default scenario's job" not in said:
                        print(f"the machine of the page is not the one that is checked:\n{said}")
                        return 1
                if made := re.match(r"lanternfish new \w+ (\S+)", line):
                    written = here / (made[1] if made[1].endswith(".yaml") else made[1] + ".yaml")
    if commands == 0:
        print(f"{page}: has no command")
        return 1
    print(f"{page.name}: {commands} commands")
    return 0


if __name__ == "__main__":
    sys.exit(main())
