#!/usr/bin/env python3
"""Installs the shared files of a build into a folder, and checks that what the shipped scenarios name is among them.

Usage: tests/house/shipped_files.py SOURCE_FOLDER BUILD_FOLDER
"""
import pathlib
import re
import subprocess
import sys
import tempfile


def main() -> int:
    source, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        for script in sorted(build.glob("shared/*/cmake_install.cmake")):
            subprocess.run(["cmake", f"-DCMAKE_INSTALL_PREFIX={folder}", "-P", str(script)], check=True, stdout=subprocess.DEVNULL)
        share = pathlib.Path(folder) / "share" / "lanternfish"
        wanted = {"arm/arm5e.urdf", "safety/limits.yaml", "homing/simulator.yaml", "drives/objects.csv", "drives/lanternfish.yaml"}
        for scenario in (source / "shared" / "scenarios").glob("*.yaml"):
            wanted.add(f"scenarios/{scenario.name}")
            wanted.update(re.findall(r"^scene: (\S+)", scenario.read_text(), re.MULTILINE))
        wanted.update(f"panels/{panel.name}" for panel in (source / "shared" / "panels").glob("*.yaml"))
        wanted.update(f"machines/{machine.name}" for machine in (source / "shared" / "machines").glob("*.yaml"))
        for scene in (source / "shared" / "scenes").glob("*.yaml"):
            wanted.update(f"scenes/{mesh}" for mesh in re.findall(r"file: (\S+)", scene.read_text()))
        missing = sorted(name for name in wanted if not (share / name).is_file())
    for name in missing:
        print(f"not installed: {name}")
    print(f"{len(wanted) - len(missing)} of {len(wanted)} shipped files are installed")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
