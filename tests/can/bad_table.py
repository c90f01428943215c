#!/usr/bin/env python3
"""The generator refuses a table that makes no sense, with file and line, and writes nothing: bad_table.py SOURCE_DIR"""
import pathlib
import subprocess
import sys
import tempfile

# (what is replaced, with what, what the message has to say)
CASES = [
    ("bitrate: 1000000", "bitrate: [", "expected"),
    ("bus:\n", "buss:\n", "unknown key 'buss'"),
    ("type: u16, access: rw, value: 400", "type: u17, access: rw, value: 400", "'u17' is none of"),
    ("access: rw, value: 100}", "acces: rw, value: 100}", "unknown key 'acces'"),
    ("value: 0, low: velocity_back", "value: 0, low: velocity_sideways", "no figure 'velocity_sideways'"),
    ("{signal: torque, object: 0x6077", "{signal: torque, object: 0x6076", "cannot stand in this PDO"),
    ("{signal: torque_offset, object: 0x60B2, scale: torque}", "{signal: a, object: 0x607A}\n      - {signal: b, object: 0x60B0}", "more than a frame holds"),
    ("  2: {name: shoulder", "  1: {name: shoulder", "stands twice"),
    ("6: {name: outputs, device: output_node}", "6: {name: outputs, device: output_nodes}", "no device 'output_nodes'"),
    ("6: {name: outputs", "127: {name: outputs", "outside 1 to 126"),
    ("0x6041: {name: Statusword, type: u16, access: ro, pdo: tx", "0x6041: {name: Statusword, type: u16, access: ro, pdo: rx", "cannot stand in such a PDO"),
    ("    0x2080: ", "    0x1001: ", "object 1001 stands twice"),
]


def main():
    source = pathlib.Path(sys.argv[1])
    good = (source / "shared/can/can_map.yaml").read_text(encoding="utf-8")
    failures = 0
    for old, new, message in CASES:
        assert good.count(old) >= 1, f"the table has no '{old}'"
        with tempfile.TemporaryDirectory() as folder:
            table, out = pathlib.Path(folder) / "table.yaml", pathlib.Path(folder) / "out"
            table.write_text(good.replace(old, new, 1), encoding="utf-8")
            run = subprocess.run([sys.executable, "-B", str(source / "shared/can/generate_can_files.py"), str(table),
                                  str(source / "shared/arm/arm5e.urdf"), str(out), str(out)],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
            lines = run.stderr.splitlines()
            where = lines[0].split(":")[:2] if lines else []
            fine = (run.returncode == 2 and len(lines) == 1 and message in lines[0] and where[0] == str(table) and where[1].isdigit()
                    and not out.exists())
            failures += not fine
            print("ok " if fine else "BAD", run.returncode, run.stderr.replace(folder, "").strip())
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
