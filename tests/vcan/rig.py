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

LATE_MS = 4.0  # a SYNC period: what comes later than that came too late


class Failed(Exception):
    pass


def expect(condition, message):
    if not condition:
        raise Failed(message)


def wait_for(what, condition, limit_s, poll_s=0.02):
    """The first true value of condition(); Failed after limit_s."""
    end = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        expect(time.monotonic() < end, f"{what}: not within {limit_s:g} s")
        time.sleep(poll_s)


def shell(command):
    subprocess.run(command, shell=True, check=True)


ANSWER_S = 5  # an answer of the daemon may take
PROCESSES = []  # of programs under test
LATEST = {}  # the control thread's wake-ups in the last status of each daemon: process -> ms


def start(arguments, output):
    PROCESSES.append(subprocess.Popen([str(a) for a in arguments], stdout=output, stderr=output))
    return PROCESSES[-1]


@contextlib.contextmanager
def stage():
    """Leaves no program, rule or queue behind."""
    try:
        yield
    except Exception:
        time.sleep(1.1)  # the sea says once a second how late it was
        raise
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
        source = [("  ring: .*", f"  ring: {camera}")] if camera else [("source: ring", "source: none"), ("  ring: .*", "")]
        for pattern, value in (("interface: .*", f"interface: {interface}"), *source,
                               ("socket: .*", f"socket: {self.socket}"), ("  folder: .*", f"  folder: {self.log}"),
                               ("lock_folder: .*", f"lock_folder: {folder}"), *changes):
            text, count = re.subn(pattern, value, text)
            expect(count == 1, f"vcan.yaml has {count} times '{pattern}'")
        folder.mkdir(parents=True, exist_ok=True)
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
        status = self.ask("status")
        LATEST[self.process.pid] = 1e-3 * status["latency"]["wake_up_us"]["max"]
        return status

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
        return wait_for(f"step {' or '.join(steps)}", lambda: (lambda s: s if s["step"] in steps else None)(self.status()), limit_s, 0.05)

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


def out_of_time():
    """Why it may have been the machine that failed: what was not done in real time, besides the programs under test."""
    reasons = [f"the control thread was woken up {late_ms:.1f} ms late" for late_ms in LATEST.values() if late_ms > LATE_MS]
    for sea in pathlib.Path("/tmp/rig").glob("*/sea.err"):
        late_ms = [float(number) for number in re.findall(r"not in real time: .* up to ([0-9.]+) ms", sea.read_text())]
        reasons += [f"the simulated sea was {max(late_ms):.1f} ms late"] if late_ms else []
    for result in pathlib.Path("/tmp/rig").glob("*/out/result.json"):
        camera = json.loads(result.read_text())["camera"]
        if camera and camera["not_rendered"] > 0.1 * camera["exposures"]:
            reasons.append(f"the simulated camera could not make {camera['not_rendered']} of {camera['exposures']} pictures in time")
    return reasons


def main(test):
    """Runs test(programs); says why it failed and what the programs said, and leaves what speaks for them in LANTERNFISH_GUEST_OUT (keeping_time.py)."""
    if len(sys.argv) < 2:
        sys.exit(f"usage: {sys.argv[0]} FOLDER_OF_PROGRAMS")
    try:
        test(sys.argv[1])
    except Exception as failure:  # pylint: disable=broad-except  # a socket's time-out is a failure like another
        print(f"FAILED: {failure}", file=sys.stderr)
        if not isinstance(failure, Failed):
            traceback.print_exc()
        time.sleep(1.1)
        for log in sorted(pathlib.Path("/tmp/rig").glob("*/*.out")) + sorted(pathlib.Path("/tmp/rig").glob("*/*.err")):
            print(f"--- {log}\n{log.read_text()[-3000:]}", file=sys.stderr)
        if out := os.environ.get("LANTERNFISH_GUEST_OUT"):
            (pathlib.Path(out) / "out_of_time").write_text("".join(reason + "\n" for reason in out_of_time()))
        sys.exit(1)
