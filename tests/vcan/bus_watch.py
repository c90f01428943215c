"""Listens to the drives on a CAN interface and says what they did and when: nothing of the project but the CAN map's identifiers.

Times are the kernel's receive stamps, wall clock, in seconds.
"""
import collections
import socket
import struct

DRIVES = (1, 2, 3, 4, 5)
SO_RCVBUFFORCE, SO_TIMESTAMPNS = 33, 35  # asm-generic/socket.h; the socket module does not name them
OPERATION_ENABLED, QUICK_STOP_ACTIVE, FAULT_REACTION, FAULT = "enabled", "quick stop", "fault reaction", "fault"

POWERLESS = ("disabled", "ready", "switched on", FAULT, "not ready")

Sample = collections.namedtuple("Sample", "t state position torque")


def state_of(statusword):
    """The CiA 402 state in a statusword."""
    if statusword & 0x4F == 0x0F:
        return FAULT_REACTION
    if statusword & 0x4F == 0x08:
        return FAULT
    if statusword & 0x4F == 0x40:
        return "disabled"
    return {0x21: "ready", 0x23: "switched on", 0x27: OPERATION_ENABLED, 0x07: QUICK_STOP_ACTIVE}.get(statusword & 0x6F, "not ready")


class Ear:
    """The frames of a few identifiers on an interface, with the kernel's receive times. The socket keeps some seconds of them."""

    def __init__(self, interface, ids):
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW | socket.SOCK_NONBLOCK, socket.CAN_RAW)
        exact = socket.CAN_EFF_FLAG | socket.CAN_RTR_FLAG | socket.CAN_SFF_MASK
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"".join(struct.pack("=II", i, exact) for i in ids))
        self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 8 << 20)
        self.socket.bind((interface,))

    def frames(self):
        """What came since the last call: (time, identifier, data)."""
        while True:
            try:
                message, control, _, _ = self.socket.recvmsg(16, 64)
            except (BlockingIOError, OSError):  # OSError: the interface went down or away
                return
            seconds, nanoseconds = struct.unpack("qq", control[0][2][:16])
            identifier, length = struct.unpack_from("=IB", message)
            yield seconds + nanoseconds * 1e-9, identifier, message[8:8 + length]

    def send(self, identifier, data=b""):
        self.socket.send(struct.pack("=IB3x8s", identifier, len(data), data))


class GapWatch:
    """The longest silence between two SYNCs, or two answers of the first drive, on an interface. Call poll() often."""

    def __init__(self, interface):
        self.ear = Ear(interface, [0x080, 0x181])
        self.last = {}
        self.gap_s = 0.0

    def poll(self):
        for t, identifier, _ in self.ear.frames():
            self.gap_s = max(self.gap_s, t - self.last.get(identifier, t))
            self.last[identifier] = t


class BusWatch:
    """Collects what the drives say, and the controlwords that they are sent. Call poll() often."""

    def __init__(self, interface):
        self.samples = {node: [] for node in DRIVES}
        self.heartbeats = {node: [] for node in DRIVES}
        self.controlwords = {node: [] for node in DRIVES}
        self.syncs = []
        self.said = {node: None for node in DRIVES}  # the state that a drive last told over SDO
        self.ear = Ear(interface, [0x080] + [function + node for function in (0x180, 0x200, 0x580, 0x700) for node in DRIVES])

    def poll(self):
        for t, identifier, data in self.ear.frames():
            self.take(t, identifier, data)

    def take(self, t, identifier, data):
        length = len(data)
        function, node = identifier & ~0x7F, identifier & 0x7F
        if function == 0x180 and node in self.samples and length >= 8:
            status, position, torque = struct.unpack("<Hih", data)
            self.samples[node].append(Sample(t, state_of(status), position, torque))
        elif function == 0x700 and node in self.heartbeats and length == 1:
            self.heartbeats[node].append((t, data[0]))
        elif function == 0x200 and node in self.controlwords and length >= 2:
            self.controlwords[node].append((t, struct.unpack_from("<H", data)[0]))
        elif function == 0x580 and node in self.samples and length == 8:
            index, value = struct.unpack_from("<H", data, 1)[0], struct.unpack_from("<i", data, 4)[0]
            if index == 0x6041:
                self.said[node] = state_of(value)
            elif index == 0x6064 and self.said[node]:
                self.samples[node].append(Sample(t, self.said[node], value, 0))
        elif identifier == 0x080:
            self.syncs.append(t)

    def ask(self, index):
        """Asks every drive over SDO for an object: 0x6041, then 0x6064, make a sample. Without a master, drives send nothing by themselves."""
        for node in DRIVES:
            self.ear.send(0x600 + node, struct.pack("<BHB4x", 0x40, index, 0))

    def told_to_stop(self, after):
        """When the first drive was sent anything but "operation enabled", after an instant; None if none was."""
        times = [t for node in DRIVES for t, word in self.controlwords[node] if t >= after and word & 0x0F != 0x0F]
        return min(times, default=None)

    def first(self, node, wanted, after):
        """When the drive first said, after an instant, a state of which wanted(sample) is true; None if it never did."""
        return next((s.t for s in self.samples[node] if s.t >= after and wanted(s)), None)

    def left_operation(self, after, nodes=DRIVES):
        """When the first and the last of some drives said that it is not under the master's command any more; None for one that never did."""
        times = [self.first(node, lambda s: s.state != OPERATION_ENABLED, after) for node in nodes]
        return min((t for t in times if t is not None), default=None), None if None in times else max(times)

    def without_torque(self, after):
        """When the last drive said that it has no power; None while one has."""
        times = [self.first(node, lambda s: s.state in POWERLESS, after) for node in DRIVES]
        return None if None in times else max(times)

    def stood_still(self, after, counts=5):
        """When the last drive came to where it stayed, after an instant; the instant itself if none moved."""
        latest = after
        for node in DRIVES:
            later = [s for s in self.samples[node] if s.t >= after]
            if later:
                latest = max([latest] + [s.t for s in later if abs(s.position - later[-1].position) > counts])
        return latest

    def moves(self, within_s=0.1, counts=20):
        """True when a drive moved by more than `counts` in the last moments."""
        for samples in self.samples.values():
            recent = [s.position for s in samples[-200:] if s.t >= samples[-1].t - within_s]
            if recent and max(recent) - min(recent) > counts:
                return True
        return False

    def longest_gap_s(self):
        """The longest silence of the SYNCs, or of a drive that had begun to answer them."""
        series = [self.syncs] + [[s.t for s in samples] for samples in self.samples.values()]
        return max((later - earlier for times in series for earlier, later in zip(times, times[1:])), default=0.0)

    def forget(self):
        for record in (*self.samples.values(), *self.heartbeats.values(), *self.controlwords.values(), self.syncs):
            record.clear()
