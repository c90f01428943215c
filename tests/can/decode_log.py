#!/usr/bin/python3
"""Decodes a run's can0.log with canmatrix and python-can, and compares: decode_log.py DBC URDF RUN_DIR. No project code inside.

- Every frame of the log is one that the DBC has, with its length.
- Each joint's angle, from the drive's decoded position, is the one in joints.csv: geared joints as they are, screws by their triangle (URDF).
- What the log says of the outputs is what the master asked for, one SYNC later.
"""
import csv
import math
import pathlib
import sys
import xml.etree.ElementTree

import can
import canmatrix.formats

LANTERNFISH = "{https://lanternfish.invalid/urdf}"


def screws(urdf):
    """(a, b, offset, limits) of each joint with a screw, by name."""
    found = {}
    for joint in xml.etree.ElementTree.parse(urdf).getroot().findall("joint"):
        for child in joint:
            if child.tag.endswith("screw"):
                a, b, offset = (float(child.get(k)) for k in ("pivot_a_m", "pivot_b_m", "offset_rad"))
                found[joint.get("name")] = (a, b, offset)
    return found


def angle(screw, growth_m):
    """The triangle's angle: length^2 = a^2 + b^2 - 2 a b cos(q + offset)."""
    a, b, offset = screw
    length = math.sqrt(a * a + b * b - 2 * a * b * math.cos(offset)) + growth_m
    return math.acos((a * a + b * b - length * length) / (2 * a * b)) - offset


def joints_of(run):
    """The names in the header of joints.csv."""
    with open(run / "joints.csv", encoding="ascii") as stream:
        return [name.removesuffix("_target_rad") for name in stream.readline().strip().split(",") if name.endswith("_target_rad")]


def decode(matrix, run, joints):
    """Per joint a list of (time, angle source value); checks frames on the way."""
    frames = {frame.arbitration_id.id: frame for frame in matrix.frames}
    series = {name: [] for name in joints}
    units, count, kinds = {}, 0, set()
    outputs_asked, outputs_seen = None, []
    for message in can.LogReader(str(run / "can0.log")):
        frame = frames.get(message.arbitration_id)
        assert frame is not None, f"{message.arbitration_id:03X} is not in the DBC"
        assert frame.size == message.dlc, f"{frame.name}: {message.dlc} bytes, {frame.size} in the DBC"
        count += 1
        kinds.add(frame.name)
        if not message.data:
            continue
        signals = frame.decode(bytes(message.data))
        node, _, what = frame.name.rpartition("_")
        if what == "tpdo1" and node in series:
            position = signals["position"]
            units[node] = position.signal.unit
            series[node].append((message.timestamp, float(position.phys_value)))
        if frame.name == "outputs_rpdo1":
            outputs_asked = (int(signals["laser"].raw_value), int(signals["lamps"].raw_value))
        if frame.name == "outputs_tpdo1" and outputs_asked is not None:
            outputs_seen.append((int(signals["laser_actual"].raw_value), int(signals["lamps_actual"].raw_value)))
    return series, units, count, kinds, outputs_seen


def main():
    dbc, urdf, run = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    matrix = canmatrix.formats.loadp_flat(dbc)
    joints = joints_of(run)
    assert len(joints) >= 5, joints
    series, units, count, kinds, outputs_seen = decode(matrix, run, joints)
    screw = screws(urdf)
    assert all(units[name] == ("m" if name in screw else "rad") for name in joints), units
    assert {name + "_tpdo1" for name in joints} <= kinds, sorted(kinds)
    assert {"nmt", "sync", "master_heartbeat", "elbow_emcy", "elbow_sdo_answer", "outputs_rpdo1"} <= kinds, sorted(kinds)
    assert outputs_seen

    with open(run / "joints.csv", encoding="ascii") as stream:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream) if all(row.values())]  # empty before the drives answer
    compared, worst, travelled = 0, 0.0, 0.0
    at = {name: 0 for name in joints}
    for row in rows:
        for name in joints:
            frames = series[name]
            # The newest frame that was there at this tick.
            while at[name] + 1 < len(frames) and frames[at[name] + 1][0] < row["t_s"] - 1e-6:
                at[name] += 1
            if not frames or frames[at[name]][0] >= row["t_s"] - 1e-6 or row["t_s"] - frames[at[name]][0] > 0.004:
                continue
            value = frames[at[name]][1]
            decoded = angle(screw[name], value) if name in screw else value
            worst = max(worst, abs(decoded - row[name + "_rad"]))
            compared += 1
    for name in joints:
        values = [row[name + "_rad"] for row in rows]
        travelled = max(travelled, max(values) - min(values))
    print(f"{count} frames of {len(kinds)} kinds; {compared} joint values compared, worst difference {worst:.2e} rad, longest way {travelled:.2f} rad")
    assert compared > 300 and travelled > 0.2, "too little to compare"
    # joints.csv has seven digits, and a drive with units of its own stands half a unit off the arm's count: 2.7e-6 rad of a C5-E's. A wrong scale is far above.
    assert worst < 3e-6, "joint values differ"
    return 0


if __name__ == "__main__":
    sys.exit(main())
