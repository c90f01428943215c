#!/usr/bin/env python3
"""Makes C++, EDS files and a DBC of the CAN map: generate_can_files.py TABLE URDF CODE_DIR FILES_DIR

CODE_DIR gets can_map.hpp and object_tables.cpp, FILES_DIR an EDS a node and lanternfish.dbc. Drives' figures come of the URDF's joints.
Bad input: one line "file:line: message" on stderr, exit status 2, and no files.
"""
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "arm"))

import generate_arm_geometry as arm
from can_table import BadTable, read_table
from motor_figures import Motor
from write_code import header, object_tables
from write_dbc import dbc
from write_eds import eds, file_name


def files_of(table_path, urdf_path):
    """(file name, text) of the C++ and of the rest."""
    table, robot = read_table(table_path), arm.parse(urdf_path)
    motors = {node.number: Motor(arm.read_joint(robot, node.joint)) for node in table.nodes if node.joint}
    code = {"can_map.hpp": header(table), "object_tables.cpp": object_tables(table)}
    rest = {"lanternfish.dbc": dbc(table, motors)}
    for node in table.nodes:
        rest[file_name(node)] = eds(table, node, motors[node.number].figures() if node.joint else {})
    return code, rest


def write(folder, files):
    os.makedirs(folder, exist_ok=True)
    for name, text in files.items():
        path = os.path.join(folder, name)
        with open(path, "w", encoding="ascii", newline="\r\n" if name.endswith(".eds") else "\n") as stream:
            stream.write(text)


def main():
    if len(sys.argv) != 5:
        print("usage: generate_can_files.py TABLE URDF CODE_DIR FILES_DIR", file=sys.stderr)
        return 2
    try:
        code, rest = files_of(sys.argv[1], sys.argv[2])
        write(sys.argv[3], code)
        write(sys.argv[4], rest)
    except (BadTable, arm.BadUrdf) as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
