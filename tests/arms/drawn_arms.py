#!/usr/bin/env python3
"""Flies the docked mission with arms that nobody chose: drawn_arms.py LANTERNFISH ARM5E_URDF LIMITS FOLDER [--arms N] [--seed S] [--json FILE]

Each arm is the shipped one, larger or smaller, with other ranges, gears, screws, strengths and pads, and the robot around it: limits, the laser's place on the
forearm and the panel's distance go with its size. A mission succeeds, ends safely with its reason, or is refused before it begins. Exit status 1 where one reports a success
that the world does not show, or ends without a reason, and where fewer than the share asked for succeed of those that were not refused.
"""
import argparse
import json
import pathlib
import random
import re
import subprocess
import sys

MOUNT_M = (-0.090, 0.0, -0.365)  # of the laser, in the tool frame of the shipped arm
PANEL_M = (0.440, 0.592)  # ahead of the shipped arm's base, and below it; the handle stands 0.1 m before it


def numbers(text):
    return [float(word) for word in text.split()]


def replaced(text, pattern, new):
    """Every match anew; a pattern without one draws nothing, and would not be missed."""
    text, count = re.subn(pattern, new, text)
    if count == 0:
        sys.exit(f"{pattern!r} is not in the URDF: it has changed, and this program has not")
    return text


def scaled(text, attribute, factor):
    return replaced(text, rf'(?<=[\s<]){attribute}="([^"]*)"', lambda m: f'{attribute}="' + " ".join(repr(v * factor) for v in numbers(m[1])) + '"')


def draw_arm(urdf, draw):
    """The URDF's text, and by how much the arm is larger."""
    size = draw(0.88, 1.12)
    text = replaced(urdf, r'<origin xyz="([^"]*)"', lambda m: '<origin xyz="' + " ".join(repr(v * size) for v in numbers(m[1])) + '"')
    for attribute in ("size", "radius", "length", "pivot_a_m", "pivot_b_m"):
        text = scaled(text, attribute, size)
    text = scaled(text, "counts_per_m", 1 / size * draw(0.8, 1.3))
    text = replaced(text, r'<mass value="([^"]*)"', lambda m: f'<mass value="{float(m[1]) * size**3!r}"')
    text = replaced(text, r'\bn="([^"]*)"', lambda m: f'n="{float(m[1]) * size**3!r}"')
    for attribute in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
        text = scaled(text, attribute, size**5)
    # Ranges, the roll's and the jaw's among them.
    text = replaced(text, 'lower="-1.5708" upper="0.5488"', f'lower="{draw(-1.57, -0.6)!r}" upper="{draw(0.45, 0.56)!r}"')
    text = replaced(text, 'lower="0" upper="1.58665"', f'lower="0" upper="{draw(1.50, 1.62)!r}"')
    text = replaced(text, 'lower="0" upper="2.15294"', f'lower="0" upper="{draw(2.10, 2.25)!r}"')
    text = replaced(text, 'lower="-3.141592653589793" upper="3.141592653589793"', f'lower="{draw(-3.14, -2.6)!r}" upper="{draw(2.6, 3.14)!r}"')
    opens = draw(0.9, 1.35)
    text = replaced(text, 'upper="1.3377"', f'upper="{opens!r}"')
    # Gears, and what the drives give.
    text = replaced(text, 'rad_per_count="3.14e-3"', f'rad_per_count="{draw(1e-3, 4e-3)!r}"')
    text = replaced(text, 'rad_per_count="5.37e-4"', f'rad_per_count="{draw(3e-4, 9e-4)!r}"')
    stronger = draw(0.8, 1.4)
    text = replaced(text, r'effort="([^"]*)"', lambda m: f'effort="{float(m[1]) * stronger!r}"')
    text = replaced(text, r'rated_torque_nm="([^"]*)"', lambda m: f'rated_torque_nm="{float(m[1]) * stronger!r}"')
    # Wider or narrower pads.
    wide = draw(0.8, 1.3)
    text = replaced(text, r'(<collision name="pad">.*?<box size="\S+ )(\S+)', lambda m: f"{m[1]}{float(m[2]) * wide!r}")
    return text, size


def draw_limits(limits, text, size):
    """The file of limits that goes with the drawn arm, but for its checksum."""
    drawn = limits
    for joint in ("slew", "shoulder", "elbow", "roll", "jaw"):
        element = re.search(rf'<joint name="{joint}".*?</joint>', text, re.S)[0]
        limit = {key: float(re.search(rf'{key}="([^"]*)"', element)[1]) for key in ("lower", "upper", "effort", "velocity")}
        margin = -0.02 if joint == "jaw" else 0.02
        peak = re.search(rf'{joint}: .*?max_torque_nm: ([0-9.]+)', limits)[1]
        torque = 1.1 * limit["effort"] if joint == "jaw" else float(peak)
        line = (f"{joint}: {{min_rad: {limit['lower'] + margin:.5f}, max_rad: {limit['upper'] - margin:.5f}, "
                f"max_speed_rad_s: {1.2 * limit['velocity']:.3f}, max_torque_nm: {torque:.3f}}}")
        drawn = re.sub(rf'{joint}: +{{.*?}}', line, drawn)
    for corner in ("min_m", "max_m"):
        drawn = re.sub(rf'{corner}: \[(.*?)\]', lambda m: f"{corner}: [" + ", ".join(f"{float(v) * size:.4f}" for v in m[1].split(",")) + "]", drawn)
    return drawn


def with_checksum(options, folder, text):
    """The program refuses a wrong one and names the right one."""
    file = folder / "limits.yaml"
    file.write_text(text)
    said = subprocess.run([options.program, "scenarios", "default", "--set", f"safety.limits={file}"], capture_output=True, text=True).stderr
    right = re.search(r"0x[0-9a-f]{8}(?=[^0-9a-f]*$)", said.strip().splitlines()[0]) if said else None
    if right:
        file.write_text(re.sub(r"checksum: 0x[0-9a-f]+", f"checksum: {right[0]}", text))


def mission(options, folder, number):
    rng = random.Random(options.seed * 1000 + number)
    text, size = draw_arm(pathlib.Path(options.urdf).read_text(), rng.uniform)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "arm.urdf").write_text(text)
    with_checksum(options, folder, draw_limits(pathlib.Path(options.limits).read_text(), text, size))
    laser = [round(v * size, 6) for v in MOUNT_M]
    machine = f"version: 1\narm: {{urdf: arm.urdf}}\nsafety: {{limits: limits.yaml}}\nlaser: {{position_m: {laser}}}\n"
    (folder / "machine.yaml").write_text(machine)
    command = [options.program, "run", "default", "--seed", str(number), "--set", f"machine={folder / 'machine.yaml'}",
               "--set", f"panel.ahead_m={0.1 + (PANEL_M[0] - 0.1) * size:.4f}", "--set", f"panel.down_m={PANEL_M[1] * size:.4f}",
               "--out", str(folder / "run"), "--json"]
    run = subprocess.run(command, capture_output=True, text=True)
    row = {"arm": number, "size": round(size, 3), "status": run.returncode}
    if run.returncode == 2:
        row["end"], row["why"] = "refused", run.stderr.strip()
        return row
    result = json.loads(run.stdout)
    row["end"] = "false success" if result.get("false_success") else "success" if result.get("success") else "failure"
    row["why"] = (result.get("failure") or {}).get("message") or (result.get("failure") or {}).get("reason") or ""
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("urdf")
    parser.add_argument("limits")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--least", type=float, default=0.9, help="share of the missions that begin which have to succeed")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    rows = []
    for number in range(1, options.arms + 1):
        row = mission(options, options.folder / f"arm{number}", number)
        rows.append(row)
        print(f"arm {number:3d}, {row['size']:.3f} of the size: {row['end']}{': ' + row['why'] if row['why'] else ''}", flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1))
    begun = [row for row in rows if row["end"] != "refused"]
    succeeded = sum(row["end"] == "success" for row in begun)
    unnamed = [row for row in begun if row["end"] == "false success" or (row["end"] == "failure" and not row["why"])]
    print(f"{succeeded} of {len(begun)} succeeded, {len(rows) - len(begun)} refused before the start, seed {options.seed}")
    return 1 if unnamed or not begun or succeeded < options.least * len(begun) else 0


if __name__ == "__main__":
    sys.exit(main())
