"""lanternfishd and `lanternfish serve` in one guest, and what a test does to them.

Runs inside a guest (toolchain/guests/), as root of a network of its own. `Rig(programs)` takes the folder of the built programs. With `gateway`, the daemon is
on vcan0 and the sea on vcan1, joined by can-gw: frames can be dropped and changed on the way, and vcan0 can be taken away while the drives are
watched on vcan1.
"""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import traceback

import bus_watch

ROOT = pathlib.Path(__file__).resolve().parents[2]
RING_BYTES = 1236992  # camera.ring_bytes

FAILED, TOO_LATE = 1, 75  # exit statuses, for toolchain/guests/keeping_time.py

# What the core stops for when the machine stands still, and for how long it has to: three SYNC periods without a position, less the one that is there
# anyway; 0.2 s without an image, less the two frame periods that may pass.
STALLS_MS = {"stale position": 8.0, "output node lost": 8.0, "camera silent": 120.0}
BY_SILENCE = ("stale position", "output node lost")


class Failed(Exception):
    """A function failed: no machine excuses it."""


class TooLate(Exception):
    """Right, but too late: `missed_ms` is how much longer the test would have had to wait."""

    def __init__(self, message, missed_ms):
        super().__init__(message)
        self.missed_ms = missed_ms


LATE = []  # (what, ms) of the limits that were missed while the test went on


def expect(condition, message):
    if not condition:
        raise Failed(message)


def expect_in_time(what, took_s, limit_s):
    """Notes a missed limit and goes on, so that a function that fails later is still seen."""
    if took_s > limit_s:
        LATE.append((f"{what} after {1e3 * took_s:.0f} ms, {1e3 * limit_s:.0f} ms are allowed", 1e3 * (took_s - limit_s)))


def wait_for(what, condition, limit_s, poll_s=0.02, daemon=None):
    """The first true value of condition(); after limit_s it is a failure. Where the daemon says that it stopped for what a machine makes by standing still,
    what is waited for never comes, and it is TooLate."""
    end = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() >= end:
            break
        time.sleep(poll_s)
    reason = daemon.status().get("failure", {}).get("reason") if daemon else None
    message = f"{what}: not within {limit_s:g} s" + (f" ({reason})" if reason else "")
    if reason in STALLS_MS:
        raise TooLate(message, STALLS_MS[reason])
    raise Failed(message)


def expect_not_stopped(status, gap_s, message):
    """The mission was not ended or held by a fault; one that has nothing more to do parks its arm. Where its fault is one that a machine makes by standing
    still, and the listener on the bus (`gap_s`, its longest silence) saw that, too, it is TooLate."""
    if status["standing"] in ("working", "ready") or status.get("success"):
        return
    if status["standing"] == "leaving" and not status.get("failure"):
        return
    reason = status.get("failure", {}).get("reason")
    stall_ms = STALLS_MS.get(reason)
    if stall_ms is not None and (reason not in BY_SILENCE or 1e3 * gap_s >= stall_ms):
        raise TooLate(f"{message}: {status['standing']} ({reason}); the bus was silent for {1e3 * gap_s:.1f} ms", stall_ms)
    raise Failed(f"{message}: {status['standing']} ({status.get('failure')})")


def shell(command):
    subprocess.run(command, shell=True, check=True)


ANSWER_S = 5  # an answer of the daemon may take
PROCESSES = []  # of programs under test


def start(arguments, output):
    PROCESSES.append(subprocess.Popen([str(a) for a in arguments], stdout=output, stderr=output))
    return PROCESSES[-1]


@contextlib.contextmanager
def stage():
    """Leaves no program, rule or queue behind."""
    try:
        yield
    finally:
        for process in PROCESSES:
            if process.poll() is None:
                process.kill()
                process.wait()
        PROCESSES.clear()
        shell("cangw -F; tc qdisc del dev vcan0 root 2>/dev/null; ip link set vcan0 up 2>/dev/null || ip link add dev vcan0 type vcan")


class Daemon:
    """lanternfishd as a process; its operator interface."""

    def __init__(self, programs, folder, interface, camera, options=(), changes=()):
        self.folder = folder
        self.log = folder / "log"
        self.socket = folder / "operator.sock"
        text = (ROOT / "shared/vehicle/vcan.yaml").read_text()
        folder.mkdir(parents=True, exist_ok=True)
        if not camera:  # a ring that nobody writes into: without a camera there is no start
            camera = folder / "silent.ring"
            camera.touch()
            os.truncate(camera, RING_BYTES)
        for pattern, value in (("interface: .*", f"interface: {interface}"), ("  ring: .*", f"  ring: {camera}"),
                               ("socket: .*", f"socket: {self.socket}"), ("  folder: .*", f"  folder: {self.log}"),
                               ("lock_folder: .*", f"lock_folder: {folder}"), *changes):
            text, count = re.subn(pattern, value, text)
            expect(count == 1, f"vcan.yaml has {count} times '{pattern}'")
        config = folder / "vehicle.yaml"
        config.write_text(text)
        self.output = open(folder / "daemon.out", "w+")
        self.started = time.monotonic()
        self.process = start([programs / "lanternfishd", "--config", config, *options], self.output)

    def ask(self, what, **arguments):
        with socket.socket(socket.AF_UNIX) as s:
            s.settimeout(ANSWER_S)
            s.connect(str(self.socket))
            s.sendall(json.dumps({"do": what, **arguments}).encode() + b"\n")
            reply = b""
            while not reply.endswith(b"\n"):
                part = s.recv(65536)
                if not part:
                    break
                reply += part
        return json.loads(reply)

    def status(self):
        expect(self.process.poll() is None, f"the daemon ended ({self.process.returncode}):\n{self.text()}")
        return self.ask("status")

    def wait_ready(self, limit_s=20):
        """Seconds from its start until it answers."""
        def answers():
            expect(self.process.poll() is None, f"the daemon ended ({self.process.returncode}):\n{self.text()}")
            try:
                return self.ask("status")
            except (FileNotFoundError, ConnectionRefusedError, TimeoutError):
                return None
        wait_for("the operator interface", answers, limit_s)
        return time.monotonic() - self.started

    def order(self, what, **arguments):
        reply = self.ask(what, **arguments)
        expect(reply["ok"], f"{what} was refused: {reply}")
        return reply

    def wait_step(self, steps, limit_s=60):
        steps = (steps,) if isinstance(steps, str) else steps
        return wait_for(f"step {' or '.join(steps)}", lambda: (lambda s: s if s["step"] in steps else None)(self.status()), limit_s, 0.05, self)

    def stop(self, limit_s=12):
        self.process.send_signal(signal.SIGTERM)
        return self.wait(limit_s)

    def wait(self, limit_s):
        try:
            return self.process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise Failed(f"the daemon did not end within {limit_s} s:\n{self.text()}") from None

    def events(self):
        """log.jsonl as a list."""
        try:
            return [json.loads(line) for line in (self.log / "log.jsonl").read_text().splitlines() if line.endswith("}")]
        except FileNotFoundError:
            return []

    def faults(self):
        return [e for e in self.events() if e.get("kind") == "fault"]

    def text(self):
        self.output.flush()
        return (self.folder / "daemon.out").read_text()


class Sea:
    """`lanternfish serve`."""

    def __init__(self, programs, folder, interface, camera, scenario="default", seed=1, options=()):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.orders = folder / "orders"
        if not self.orders.exists():
            os.mkfifo(self.orders)
        self.output = open(folder / "sea.err", "w+")
        target = f"ring:{camera}" if camera else "none"
        self.process = start([programs / "lanternfish", "serve", scenario, "--seed", seed, "--can", interface, "--camera", target,
                              "--orders", self.orders, "--out", folder / "out", *options], self.output)
        self.fifo = os.open(self.orders, os.O_RDWR)

    def order(self, line):
        """Returns the wall clock's time at which it was given."""
        now = time.time()
        os.write(self.fifo, (line + "\n").encode())
        return now

    def stop(self, limit_s=10):
        """Its result.json."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(limit_s)
        os.close(self.fifo)
        expect(self.process.returncode == 0, f"lanternfish serve ended with {self.process.returncode}:\n{self.text()}")
        return json.loads((self.folder / "out/result.json").read_text())

    def text(self):
        return (self.folder / "sea.err").read_text()


class Rig:
    def __init__(self, programs, gateway=False, scenario="default", seed=1, camera=True, sea_options=()):
        self.programs = pathlib.Path(programs)
        self.folder = pathlib.Path("/tmp/rig")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.camera = "/dev/shm/camera" if camera else None
        self.gateway = gateway
        self.near, self.far = "vcan0", "vcan1" if gateway else "vcan0"
        os.environ.setdefault("LANTERNFISH_SHARE", str(ROOT / "shared"))
        if gateway:
            self.make(self.far)
            self.join()
        self.sea = Sea(self.programs, self.folder / "sea", self.far, self.camera, scenario, seed, sea_options)
        self.watch = bus_watch.BusWatch(self.far)
        self.runs = 0
        wait_for("the sea", lambda: "serving nodes" in self.sea.text(), 20)

    def make(self, interface):
        if not os.path.exists(f"/sys/class/net/{interface}"):
            shell(f"ip link add dev {interface} type vcan")
        shell(f"ip link set {interface} up")

    def join(self, apart=None):
        """Both ways through can-gw; from the sea to the daemon the frames of a filter `apart` have a rule of their own, that a test may take away."""
        shell("cangw -F")
        shell(f"cangw -A -s {self.near} -d {self.far} -e")
        for rule in [f"-f {apart}", f"-f {apart.replace(':', '~')}"] if apart else [""]:
            shell(f"cangw -A -s {self.far} -d {self.near} -e {rule}")

    def daemon(self, options=(), **more):
        self.runs += 1
        return Daemon(self.programs, self.folder / f"run{self.runs}", self.near, self.camera, options, **more)

    def settle(self, seconds):
        """Lets time pass and listens."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.watch.poll()
            time.sleep(0.05)
        self.watch.poll()


def verdict(test):
    """(exit status, messages, by how many ms limits were missed) of test(). Function comes before time: a late test with a wrong result is wrong."""
    LATE.clear()
    missed, messages, status = [], [], 0
    try:
        test()
    except TooLate as late:
        status, messages, missed = TOO_LATE, [str(late)], [late.missed_ms]
    except Exception as failure:  # pylint: disable=broad-except  # a socket's time-out is a failure like another
        if not isinstance(failure, Failed):
            traceback.print_exc()
        status, messages = FAILED, [str(failure)]
    if LATE:
        status = status or TOO_LATE
        messages += [what for what, _ in LATE]
        missed += [ms for _, ms in LATE]
    return status, messages, max(missed, default=0.0)


def main(test):
    """Runs test(programs), says why it failed and what the programs said, and ends with a status that tells function from time (keeping_time.py)."""
    if len(sys.argv) < 2:
        sys.exit(f"usage: {sys.argv[0]} FOLDER_OF_PROGRAMS")
    status, messages, missed = verdict(lambda: test(sys.argv[1]))
    if status == 0:
        return
    print("".join(f"{'FAILED' if status == FAILED else 'TOO LATE'}: {message}\n" for message in messages), file=sys.stderr)
    for log in sorted(pathlib.Path("/tmp/rig").glob("*/*.out")) + sorted(pathlib.Path("/tmp/rig").glob("*/*.err")):
        print(f"--- {log}\n{log.read_text()[-3000:]}", file=sys.stderr)
    if out := os.environ.get("LANTERNFISH_GUEST_OUT"):
        (pathlib.Path(out) / "missed_ms").write_text(f"{missed:.1f}\n")
    sys.exit(status)
