#!/usr/bin/env python3
"""Hostile clients, a full disk and a slow disk miss no tick that is not missed without them, and the daemon's memory does not grow.

Usage: hostile_test.py FOLDER_OF_PROGRAMS NODES_ON_CAN SECONDS; inside the guest of run_in_qemu.sh, whose clock counts instructions. Each phase lasts SECONDS of the
guest's time: quiet, hostile clients, full disk, slow disk. Prints a table and leaves it in LANTERNFISH_GUEST_OUT.

The daemon is on can0 and the simulator's nodes on can1 of the same bus; the arm is homed and held under control, so that every tick has its whole work.
"""
import contextlib
import json
import os
import pathlib
import random
import shutil
import socket
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "vcan"))
import rig  # noqa: E402
from rig import expect  # noqa: E402

READING_S = 3600  # more than the guest's clock ever jumps while programs are read
rig.ANSWER_S = READING_S
# The C library gives back what it keeps in steps of 128 kB, and a thread takes one of its own at its first line: 132 kB in a quiet phase of 2 s.
GROWTH_KB = 256
SEED = 20261122


def connect(path):
    client = socket.socket(socket.AF_UNIX)
    client.settimeout(1)
    client.connect(str(path))
    return client


class Hostile:
    """Clients that idle, flood, never read, send garbage, never end a line, and come and go, until stopped."""

    def __init__(self, path):
        self.path, self.over, self.tries = path, threading.Event(), 0
        self.threads = [threading.Thread(target=self.repeat, args=(act, random.Random(SEED + i)))
                        for i, act in enumerate((self.idle, self.flood, self.deaf, self.garbage, self.endless, self.come_and_go))]
        for thread in self.threads:
            thread.start()

    def repeat(self, act, draw):
        while not self.over.is_set():
            self.tries += 1
            with contextlib.suppress(OSError):
                act(draw)
            self.over.wait(0.02)

    def idle(self, _):
        with contextlib.ExitStack() as all_of_them:
            for _ in range(20):
                all_of_them.enter_context(connect(self.path))
            self.over.wait(0.5)

    def flood(self, _):
        with connect(self.path) as client:
            client.sendall(b'{"do":"status"}\n' * 100)
            while client.recv(65536):
                pass

    def deaf(self, _):
        with connect(self.path) as client:
            for _ in range(200):
                client.sendall(b'{"do":"status"}\n')
            self.over.wait(0.2)

    def garbage(self, draw):
        lines = (b'{"do":"task","tasks":[{"turn_valve":90}]}\n', b'{"do":' * 500 + b"\n", b'{"do":"jog","joint":"elbow","by_deg":1e308}\n', draw.randbytes(300) + b"\n",
                 b'[]\n', b'{"do":"\xff\xfe"}\n', b'{"do":"task","tasks":' + b"[" * 2000 + b"\n")
        with connect(self.path) as client:
            client.sendall(draw.choice(lines))
            client.recv(65536)

    def endless(self, _):
        with connect(self.path) as client:
            for _ in range(100):
                client.sendall(b"x" * 4096)

    def come_and_go(self, _):
        for _ in range(50):
            connect(self.path).close()

    def stop(self):
        self.over.set()
        for thread in self.threads:
            thread.join(10)


@contextlib.contextmanager
def quiet(_folder):
    yield lambda daemon: contextlib.nullcontext()


@contextlib.contextmanager
def hostile_clients(_folder):
    @contextlib.contextmanager
    def act(daemon):
        clients = Hostile(daemon.socket)
        yield
        clients.stop()
        expect(clients.tries > 10, f"{clients.tries} attacks were made")
    yield act


@contextlib.contextmanager
def full_disk(folder):
    """The log's folder is a disk of 256 kB that is full."""
    log = folder / "log"
    log.mkdir(parents=True)
    rig.shell(f"mount -t tmpfs -o size=256k,mode=755 full {log}")
    subprocess.run(["dd", "if=/dev/zero", f"of={log}/filler", "bs=4096"], check=False, capture_output=True)
    yield lambda daemon: contextlib.nullcontext()


@contextlib.contextmanager
def slow_disk(folder):
    """can0.log is a pipe whose reader takes 4 kB twice a second, some 4 % of what is written: every write waits."""
    log = folder / "log"
    log.mkdir(parents=True)
    os.mkfifo(log / "can0.log")
    over = threading.Event()

    def read_slowly():
        end = os.open(log / "can0.log", os.O_RDWR)
        while not over.wait(0.5):
            os.read(end, 4096)
        os.set_blocking(end, False)
        # What waits in it is let go, so that the daemon can end.
        give_up = time.monotonic() + 30
        while time.monotonic() < give_up and not finished.is_set():
            with contextlib.suppress(BlockingIOError):
                while os.read(end, 1 << 20):
                    pass
            time.sleep(0.05)
        os.close(end)

    finished = threading.Event()
    reader = threading.Thread(target=read_slowly)
    reader.start()
    time.sleep(0.1)

    @contextlib.contextmanager
    def act(_daemon):
        yield
        over.set()
    try:
        yield act
    finally:
        over.set()
        finished.set()
        reader.join(40)


def memory_kb(pid):
    """What the process has of private memory that can grow: heap, and maps without a file."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmData")).split()[1])


def phase(programs, folder, trouble, seconds):
    """What one daemon did while there was trouble for so long."""
    with trouble(folder) as begin:
        daemon = rig.Daemon(programs, folder, "can0", None)
        daemon.wait_ready(READING_S)
        daemon.order("home")
        rig.wait_for("a homed arm", lambda: daemon.status()["standing"] == "ready", READING_S)
        # The answers' code is read now, not in the measured time.
        for _ in range(3):
            daemon.status()
        before = daemon.status()
        with begin(daemon):
            time.sleep(0.2 * seconds)
            early = memory_kb(daemon.process.pid)
            time.sleep(0.8 * seconds)
            late = memory_kb(daemon.process.pid)
        status = rig.wait_for("an answer", lambda: answer(daemon), READING_S)
        expect(daemon.process.poll() is None, f"the daemon ended:\n{daemon.text()}")
        expect(status["standing"] == "ready", f"the arm is no longer held: {status['standing']}, {status.get('failure')}, {status['counters']}")
        expect(status["frames"]["received"] - before["frames"]["received"] > 4 * (status["ticks"] - before["ticks"]), f"the drives are hardly heard: {status['frames']} in {status['ticks']} ticks")
        stop = daemon.ask("estop")
        expect(stop["ok"], f"an emergency stop was refused: {stop}")
        ended = daemon.stop(READING_S)
        expect(ended in (0, 1), f"the daemon ended with {ended}:\n{daemon.text()}")
    wake_up = status["latency"]["wake_up_us"]
    missed = [of["counters"].get("ticks missed", 0) for of in (before, status)]
    return {"ticks": status["ticks"] - before["ticks"], "missed": missed[1] - missed[0], "missed_before": missed[0], "heap_calls": status["core"]["heap_calls"],
            "page_faults": status["core"]["page_faults"], "p999_us": wake_up["p999"], "max_us": wake_up["max"], "growth_kb": late - early, "log": status.get("log", "")}


def answer(daemon):
    with contextlib.suppress(OSError, ValueError):
        return daemon.status()
    return None


def judge(measured):
    """`measured`: name -> what phase() gives; "quiet" is what the others are held against."""
    for name, row in measured.items():
        expect(row["missed"] <= measured["quiet"]["missed"], f"{name}: {row['missed']} ticks missed, {measured['quiet']['missed']} without")
        expect(row["heap_calls"] == 0, f"{name}: {row['heap_calls']} heap calls in the control thread")
        expect(row["growth_kb"] <= GROWTH_KB, f"{name}: the daemon's memory grew by {row['growth_kb']} kB")
        expect(row["ticks"] >= 0.9 * measured["quiet"]["ticks"], f"{name}: {row['ticks']} ticks of {measured['quiet']['ticks']}")
    expect(measured["full_disk"]["log"] != "", "a full disk is not told in the status")


def suffer(programs):
    seconds = float(sys.argv[3])
    folder = pathlib.Path("/tmp/rig")
    folder.mkdir()
    os.environ["LANTERNFISH_SHARE"] = str(rig.ROOT / "shared")
    copy = pathlib.Path("/tmp/bin")  # what is timed does not wait for a file of the machine
    copy.mkdir()
    for program in (pathlib.Path(programs) / "lanternfishd", pathlib.Path(sys.argv[2])):
        shutil.copy(program, copy)
    said = open(folder / "nodes.out", "w+", encoding="utf-8")
    nodes = rig.start([copy / pathlib.Path(sys.argv[2]).name, "can1"], said)
    rig.wait_for("the nodes", lambda: "serving" in (folder / "nodes.out").read_text(), READING_S)
    measured = {}
    for trouble in (quiet, hostile_clients, full_disk, slow_disk):
        measured[trouble.__name__] = phase(copy, folder / trouble.__name__, trouble, seconds)
        print(f"{trouble.__name__}: {measured[trouble.__name__]}", flush=True)
    nodes.terminate()
    print(f"each {seconds:g} s of the guest's time\n| | ticks | missed | woken up late p99.9, worst (us) | heap calls | memory grew (kB) |\n|---|---|---|---|---|---|")
    for name, row in measured.items():
        print(f"| {name.replace('_', ' ')} | {row['ticks']} | {row['missed']} | {row['p999_us']:.0f}, {row['max_us']:.0f} | {row['heap_calls']} | {row['growth_kb']} |")
    if out := os.environ.get("LANTERNFISH_GUEST_OUT"):
        (pathlib.Path(out) / "hostile.json").write_text(json.dumps(measured, indent=1))
    judge(measured)


if __name__ == "__main__":
    rig.main(suffer)
