#!/usr/bin/env python3
"""Flies seeds of a scenario and holds their digests against recorded ones: a change that is to change nothing changes no bit of a run.

Usage: tests/hil/same_digests.py LANTERNFISH RECORDED.csv --out FOLDER [--scenario NAME] [--seeds 1-20] [--record]

RECORDED.csv has the columns seed and digest. default_digests.csv was flown on an AMD EPYC on 29 November 2026; another make of processor has others, as a build for
another has. --record writes it anew: after a change that is meant to change runs, with the reason in the commit. A FOLDER of the same program and scenario is gone on
with, as campaign does.
Exit status: 0 where all are equal and every run succeeds, 1 otherwise.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("recorded", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scenario", default="default")
    parser.add_argument("--seeds", default="1-20")
    parser.add_argument("--record", action="store_true")
    given = parser.parse_args()

    wanted = [str(seed) for part in given.seeds.split(",") for low, _, high in [part.partition("-")] for seed in range(int(low), int(high or low) + 1)]
    flown = subprocess.run([given.program, "campaign", given.scenario, "--seeds", given.seeds, "--out", str(given.out)], stdout=subprocess.DEVNULL)
    if flown.returncode not in (0, 1):
        return flown.returncode
    files = {seed: given.out / seed / "result.json" for seed in wanted}
    results = {seed: json.loads(file.read_text()) for seed, file in files.items() if file.exists()}
    failed = [seed for seed in wanted if seed not in results or not results[seed]["success"]]
    digests = {seed: result["digest"] for seed, result in results.items()}
    if given.record and not failed:
        with given.recorded.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerows([["seed", "digest"], *digests.items()])
    with given.recorded.open() as file:
        recorded = {row["seed"]: row["digest"] for row in csv.DictReader(file)}
    others = [seed for seed, digest in digests.items() if recorded.get(seed) != digest]
    for seed in others:
        print(f"seed {seed}: {digests[seed]}, recorded is {recorded.get(seed, 'nothing')}")
    print(f"{len(digests) - len(others)} of {len(wanted)} digests as recorded; failed: {', '.join(failed) or 'none'}")
    return 1 if others or failed else 0


if __name__ == "__main__":
    sys.exit(main())
