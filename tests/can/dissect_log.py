#!/usr/bin/python3
"""Has Wireshark's dissector read a run's can0.log as CANopen: dissect_log.py RUN_DIR. No project code inside.

No frame may be malformed, each with data is CANopen to it, and it names the services that the identifiers mean (CiA 301).
"""
import collections
import pathlib
import subprocess
import sys

# tshark's function codes: the upper four bits of the identifier.
NAMES = {0x0: "NMT", 0x1: "SYNC or EMCY", 0x3: "TPDO1", 0x4: "RPDO1", 0xB: "SDO answer", 0xC: "SDO request", 0xE: "heartbeat"}


def fields(log, *names):
    command = ["tshark", "-n", "-r", str(log), "-d", "can.subdissector,canopen", "-T", "fields", "-E", "separator=;", "-E", "occurrence=f"]
    for name in names:
        command += ["-e", name]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
    assert result.returncode == 0, result.stderr
    return [line.split(";") for line in result.stdout.splitlines()]


def main():
    log = pathlib.Path(sys.argv[1]) / "can0.log"
    lines = log.read_text(encoding="ascii").splitlines()
    identifiers = [int(line.split()[2].split("#")[0], 16) for line in lines]
    empty = [line.endswith("#") for line in lines]
    rows = fields(log, "frame.protocols", "_ws.malformed", "_ws.expert.severity", "canopen.function_code", "canopen.sdo.abort_code",
                  "canopen.em.err_code")
    assert len(rows) == len(lines), f"{len(rows)} frames dissected of {len(lines)}"
    seen, aborts, emergencies = collections.Counter(), 0, 0
    for number, (row, identifier, no_data) in enumerate(zip(rows, identifiers, empty), 1):
        protocols, malformed, severity, function, abort, emergency = row
        assert not malformed, f"frame {number} is malformed"
        assert not severity or int(severity) < 0x600000, f"frame {number}: severity {severity}"  # PI_WARN
        if no_data:  # nothing for a dissector to dissect
            assert identifier == 0x080, f"frame {number} is empty and no SYNC"
            seen["SYNC"] += 1
            continue
        assert protocols.endswith("canopen"), f"frame {number}: {protocols}"
        assert int(function, 16) == identifier >> 7, f"frame {number}: function {function} of {identifier:03X}"
        seen[NAMES[identifier >> 7]] += 1
        aborts += bool(abort)
        emergencies += bool(emergency)
    print(dict(seen), f"{aborts} aborts, {emergencies} emergencies")
    assert set(seen) == set(NAMES.values()) | {"SYNC"}, "a kind of frame is missing"
    assert emergencies > 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
