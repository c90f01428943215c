#!/usr/bin/env python3
"""Turns valves from any start to any target, both drawn between the stops, and says what became of each.

    any_turn.py build/release/bin/lanternfish --draws 50 [--seed N] [--out FILE.csv] [--set key=value ...]

Draw number I of seed N gives the same start, target and scenario seed wherever it runs. With --out, draws that the file already holds are kept, so that a
run that was stopped goes on where it was. Exit status 1 when a run was a false success, by whatever contradicts the core's account, or when fewer than --at-least are right.
"""
import argparse
import collections
import csv
import json
import pathlib
import random
import subprocess
import sys
import tempfile

COLUMNS = ["draw", "start_deg", "target_deg", "scenario_seed", "verdict", "reached_deg", "reason"]
# How the core names a half turn that it does not guess.
REFUSALS = ("half a turn apart", "pointer mark was not recognised")


def draw(seed, number, stops):
    chance = random.Random(f"{seed}/{number}")
    start, target = (round(chance.uniform(*stops), 1) for _ in range(2))
    return start, target, 1000 + number


def fly(program, sets, start, target, scenario_seed):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", "turn_only", "--seed", str(scenario_seed), "--json", "--no-outside", "--out", folder + "/run",
                   "--set", f"valve.start_deg={start}", "--set", f"tasks=[{{turn_valve: {{to_deg: {target}}}}}]"]
        for each in sets:
            command += ["--set", each]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 1):
            return "refused before the start", float("nan"), (done.stderr.strip().splitlines() or ["nothing was said"])[-1]
        result = json.loads(pathlib.Path(folder + "/run/result.json").read_text())
    task = result["tasks"][0]
    reason = result["failure"]["reason"] if result.get("failure") else ""
    if result["false_success"]:
        return "FALSE SUCCESS", task["reached_deg"], reason
    if result["success"]:
        return "right", task["reached_deg"], ""
    verdict = "refused by name" if any(words in reason for words in REFUSALS) else "failed"
    return verdict, task["reached_deg"], reason


def kept(path):
    if not path or not path.exists():
        return {}
    with path.open(newline="") as file:
        return {int(row["draw"]): row for row in csv.DictReader(file)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--draws", type=int, default=50)
    parser.add_argument("--at-least", type=int, default=0, help="that have to be right")
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--stops", type=float, nargs=2, default=(-105, 105))
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--set", action="append", default=[], dest="sets")
    arguments = parser.parse_args()
    rows = kept(arguments.out)
    for number in range(arguments.first, arguments.first + arguments.draws):
        if number in rows:
            continue
        start, target, scenario_seed = draw(arguments.seed, number, arguments.stops)
        verdict, reached, reason = fly(arguments.program, arguments.sets, start, target, scenario_seed)
        rows[number] = dict(zip(COLUMNS, (number, start, target, scenario_seed, verdict, round(reached, 2), reason)))
        print(f"{number:4d}  {start:7.1f} -> {target:7.1f}  seed {scenario_seed}  {verdict}  {reason}", flush=True)
        if arguments.out:
            with arguments.out.open("w", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS)
                writer.writeheader()
                writer.writerows(rows[i] for i in sorted(rows))
    counts = collections.Counter(row["verdict"] for row in rows.values())
    print(f"seed {arguments.seed}: " + ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common()))
    return 1 if counts["FALSE SUCCESS"] or counts["right"] < arguments.at_least else 0


if __name__ == "__main__":
    sys.exit(main())
