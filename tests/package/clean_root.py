#!/usr/bin/env python3
"""Makes a root folder with nothing but Debian's essential packages and what the given .deb files depend on.

Usage: clean_root.py ROOT [--with PACKAGE]... DEB...    --with: this package of the machine's, too, and what it depends on

The packages' files are copied from this machine, where all of them are installed since the programs were built here; nothing is downloaded. A library
that a program needs and its package does not depend on is therefore missing in ROOT, as it would be on a user's machine.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

DPKG = pathlib.Path("/var/lib/dpkg")


def stanzas(text):
    for block in text.strip().split("\n\n"):
        fields = {}
        for line in block.split("\n"):
            if not line.startswith((" ", "\t")) and ":" in line:
                name, value = line.split(":", 1)
                fields[name] = value.strip()
        yield fields, block


def installed():
    """Name -> (fields, text of the status file) of the packages of this architecture, and the packages that provide a name."""
    native = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=True).stdout.strip()
    packages, providers = {}, {}
    for fields, block in stanzas((DPKG / "status").read_text()):
        if fields.get("Status") != "install ok installed" or fields.get("Architecture") not in (native, "all"):
            continue
        packages[fields["Package"]] = (fields, block)
        for provided in names(fields.get("Provides", "")):
            providers.setdefault(provided[0], []).append(fields["Package"])
    return packages, providers


def names(relation):
    """"a (>= 1) | b, c" -> [[a, b], [c]]"""
    return [[re.split(r"[\s(:]", option.strip())[0] for option in group.split("|")] for group in relation.split(",") if group.strip()]


def closure(wanted, packages, providers):
    chosen, waiting = set(), list(wanted)
    while waiting:
        group = waiting.pop()
        found = next((n for option in group for n in [option, *providers.get(option, [])] if n in packages), None)
        if found is None:
            sys.exit(f"clean_root: none of {' | '.join(group)} is installed on this machine")
        if found in chosen:
            continue
        chosen.add(found)
        fields = packages[found][0]
        waiting += names(fields.get("Depends", "")) + names(fields.get("Pre-Depends", ""))
    return chosen


def copy(path, root):
    target = root / path.lstrip("/")
    if os.path.islink(path):
        if not os.path.lexists(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            os.symlink(os.readlink(path), target)
    elif os.path.isdir(path):
        target.mkdir(parents=True, exist_ok=True)
    elif os.path.isfile(path):
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, target)


def file_lists(name):
    return [p for p in DPKG.glob(f"info/{name}.list")] + [p for p in DPKG.glob(f"info/{name}:*.list")]


def link_alternatives(root):
    """update-alternatives' links are made by maintainer scripts: those whose end is in the root."""
    for choice in pathlib.Path("/etc/alternatives").iterdir():
        end = os.path.realpath(choice)
        if os.path.exists(str(root) + end):
            copy(str(choice), root)
    for folder in ["/usr/bin", *map(str, pathlib.Path("/usr/lib").glob("*-linux-gnu"))]:
        for entry in os.scandir(folder):
            if entry.is_symlink() and os.readlink(entry.path).startswith("/etc/alternatives/") and os.path.exists(str(root) + os.path.realpath(entry.path)):
                copy(entry.path, root)


def main():
    root = pathlib.Path(sys.argv[1])
    packages, providers = installed()
    wanted, ours = [], set()
    debs = sys.argv[2:]
    while "--with" in debs:
        at = debs.index("--with")
        wanted.append([debs[at + 1]])
        del debs[at:at + 2]
    for deb in debs:
        fields = next(stanzas(subprocess.run(["dpkg-deb", "-f", deb], capture_output=True, text=True, check=True).stdout))[0]
        ours.add(fields["Package"])
        wanted += names(fields.get("Depends", ""))
    wanted = [group for group in wanted if not ours.intersection(group)]
    wanted += [[name] for name, (fields, _) in packages.items() if fields.get("Essential") == "yes"] + [["base-passwd"], ["passwd"]]
    chosen = closure(wanted, packages, providers)

    for merged in ("bin", "sbin", "lib", "lib64"):
        if os.path.islink("/" + merged):
            (root / "usr" / merged).mkdir(parents=True, exist_ok=True)
            os.symlink("usr/" + merged, root / merged)
    database = root / "var/lib/dpkg"
    for folder in ("info", "updates", "triggers", "parts"):
        (database / folder).mkdir(parents=True, exist_ok=True)
    # Kept apart: what only a reader would open.
    unread = re.compile(r"/usr/share/(doc|man|locale|info|gir-1.0)/.")
    for name in chosen:
        for listing in file_lists(name):
            shutil.copy(listing, database / "info")
            for path in listing.read_text().split("\n"):
                if path not in ("", "/.") and not unread.match(path):
                    copy(path, root)
    (database / "status").write_text("\n\n".join(packages[name][1] for name in sorted(chosen)) + "\n\n")
    link_alternatives(root)
    for file in ("passwd", "group"):
        shutil.copy(root / f"usr/share/base-passwd/{file}.master", root / "etc" / file)
    for file in ("shadow", "gshadow", "ld.so.conf"):
        (root / "etc" / file).touch()
    for folder in ("dev", "proc", "sys", "tmp", "run", "root"):
        (root / folder).mkdir(exist_ok=True)
    print(f"{len(chosen)} packages")


if __name__ == "__main__":
    main()
