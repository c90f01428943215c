#!/usr/bin/python3
"""A peer that nobody here wrote the bus for: python_can_peer.py INTERFACE, while `lanternfish serve` is the hardware on it.

Reads the identity and segmented name of every node, re-maps a drive's process data, walks it through CiA 402 to operation enabled, moves it, and back,
and draws every abort code that the servers can give. Exit status 0 when all is as CiA 301 and 402 have it.
"""
import struct
import sys
import time

import can

from sdo_client import Abort, Node

NAMES = {1: "slew", 2: "shoulder", 3: "elbow", 4: "roll", 5: "jaw"}
SYNC_S = 0.004


def check(what, is_value, wanted):
    assert is_value == wanted, f"{what}: {is_value!r}, not {wanted!r}"
    print(f"  {what}: {is_value if isinstance(is_value, str) else hex(is_value)}")


def read_identity(node):
    drive = node.number in NAMES
    check("1000 device type", node.number_at(0x1000), 0x00020192 if drive else 0x00030191)
    check("1018:02 product", node.number_at(0x1018, 2), 0x4C465331)
    check("1018:04 serial", node.number_at(0x1018, 4), node.number)
    name, segmented = node.upload(0x1008)
    check("1008 name", name.decode(), f"LF servo drive, {NAMES[node.number]}" if drive else "LF output node")
    assert segmented, "the name came in one frame"
    check("1A00:00 mapped objects", node.number_at(0x1A00), 1)
    check("1A00:01", node.number_at(0x1A00, 1), 0x60410010 if drive else 0x60000108)


def abort_of(action):
    try:
        action()
    except Abort as abort:
        return abort.code
    return 0


def stalled_transfer(node):
    node.raw(node.head(0x40, 0x1008, 0) + bytes(4))
    node.answer()  # nothing is asked: after a second the server gives it up


def repeated_toggle(node):
    node.raw(node.head(0x40, 0x1008, 0) + bytes(4))
    node.raw(bytes([0x60]) + bytes(7))
    node.raw(bytes([0x60]) + bytes(7))


def two_consumers_of_one_node(node):
    node.download(0x1016, 1, (0x7F << 16) | 1000, 4)
    try:
        node.download(0x1016, 2, (0x7F << 16) | 1000, 4)
    finally:
        node.download(0x1016, 1, 0, 4)


def entry_while_counted(node):
    node.download(0x1401, 1, 0x80000000 | 0x300 + node.number, 4)
    node.download(0x1601, 1, 0x60400010, 4)


def nine_entries(node):
    node.download(0x1401, 1, 0x80000000 | 0x300 + node.number, 4)
    node.download(0x1601, 0, 9, 1)


def not_mappable(node):
    node.download(0x1401, 1, 0x80000000 | 0x300 + node.number, 4)
    node.download(0x1601, 0, 0, 1)
    node.download(0x1601, 1, 0x60770010, 4)  # a torque that is measured, into a received PDO


ABORTS = {
    0x05030000: ("toggle bit not alternated", repeated_toggle),
    0x05040000: ("transfer timed out", stalled_transfer),
    0x05040001: ("command specifier unknown (block upload)", lambda n: n.raw(n.head(0xA0, 0x1008, 0) + bytes(4))),
    0x06010000: ("unsupported access: a mapping entry of a PDO that counts entries", entry_while_counted),
    0x06010001: ("read of a write-only object", lambda n: n.upload(0x0005)),
    0x06010002: ("write of a read-only object", lambda n: n.download(0x1000, 0, 1, 4)),
    0x06020000: ("no such object", lambda n: n.upload(0x3000)),
    0x06040041: ("object cannot be mapped", not_mappable),
    0x06040042: ("more than a PDO holds", nine_entries),
    0x06040043: ("parameters incompatible: two consumers of one node", two_consumers_of_one_node),
    0x06070012: ("too long", lambda n: n.download(0x6066, 0, 1, 4)),
    0x06070013: ("too short", lambda n: n.download(0x6065, 0, 1, 2)),
    0x06090011: ("no such sub-index", lambda n: n.upload(0x1018, 9)),
    0x06090030: ("value not allowed", lambda n: n.download(0x605A, 0, 3, 2)),
    0x06090031: ("value too high", lambda n: n.download(0x6007, 0, 4, 2)),
    0x06090032: ("value too low", lambda n: n.download(0x6007, 0, -1, 2)),
    0x08000020: ("cannot be stored: signature", lambda n: n.download(0x1010, 1, 0x12345678, 4)),
    0x08000022: ("device state: identifier of a valid PDO", lambda n: n.download(0x1800, 1, 0x40000000 | 0x1B0, 4)),
}


def collect_aborts(node):
    for code, (what, action) in ABORTS.items():
        got = abort_of(lambda: action(node))
        assert got == code, f"{what}: abort {got:08X}, not {code:08X}"
        print(f"  {code:08X} {what}")
    assert abort_of(lambda: node.upload(0x1000)) == 0, "the server does not answer after all that"


class Axis:
    """A drive under SYNC: RPDO1 6040 + 607A + 60B2, TPDO1 6041 + 6064 + 6077."""

    def __init__(self, node):
        self.node, self.controlword, self.target = node, 0, 0
        self.next_sync = time.monotonic()

    def cycles(self, count):
        for _ in range(count):
            self.node.send(0x080, [])
            self.node.send(0x200 + self.node.number, struct.pack("<Hih", self.controlword, self.target, 0))
            self.next_sync = max(self.next_sync + SYNC_S, time.monotonic())
            while self.node.receive(max(self.next_sync - time.monotonic(), 0), 0x180 + self.node.number) is not None:
                pass

    def until(self, controlword, mask, wanted, what, cycles=250):
        self.controlword = controlword
        for _ in range(cycles):
            self.cycles(1)
            if self.node.statusword is not None and self.node.statusword & mask == wanted:
                print(f"  controlword {controlword:#06x}: {what}, statusword {self.node.statusword:#06x}")
                return
        raise AssertionError(f"not {what}: statusword {self.node.statusword}")


def walk_cia402(node):
    node.download(0x1017, 0, 100, 2)
    node.map(0x1400, 0x200 + node.number, [0x60400010, 0x607A0020, 0x60B20010])
    node.map(0x1800, 0x40000180 + node.number, [0x60410010, 0x60640020, 0x60770010])
    for communication in (0x1401, 0x1402, 0x1403, 0x1801, 0x1802, 0x1803):
        node.download(communication, 1, node.number_at(communication, 1) | 0x80000000, 4)
    node.download(0x60C2, 2, -3, 1)
    node.download(0x60C2, 1, 4, 1)
    node.download(0x6060, 0, 8, 1)
    node.download(0x605A, 0, 6, 2)  # a quick stop stays in its state
    node.nmt(1)
    node.wait_state(5)
    axis = Axis(node)
    axis.until(0x00, 0x4F, 0x40, "switch on disabled")
    axis.target = node.position
    axis.until(0x06, 0x6F, 0x21, "ready to switch on")
    axis.until(0x07, 0x6F, 0x23, "switched on")
    axis.target = node.position
    axis.until(0x0F, 0x6F, 0x27, "operation enabled")
    check("6061 mode", node.number_at(0x6061), 8)
    start = node.position
    for step in range(1, 101):  # 400 counts in 0.4 s
        axis.target = start + 4 * step
        axis.cycles(1)
    axis.cycles(250)  # the set-points end at once, at 1000 counts/s: the drive runs past by what it needs to stop, and comes back
    moved = node.position - start
    print(f"  moved {moved} counts of 400")
    assert abs(moved - 400) < 4, "the drive did not follow"
    axis.until(0x02, 0x6F, 0x07, "quick stop active")
    axis.until(0x00, 0x4F, 0x40, "switch on disabled")
    node.nmt(128)
    node.wait_state(127)
    assert not node.emergencies, [hex(code) for code in node.emergencies]


def main():
    with can.Bus(interface="socketcan", channel=sys.argv[1]) as bus:
        for number in range(1, 7):
            print(f"node {number}")
            node = Node(bus, number)
            node.nmt(130)
            node.nmt_state = None
            node.wait_state(0)
            read_identity(node)
        elbow = Node(bus, 3)
        print("aborts")
        collect_aborts(elbow)
        elbow.download_text(0x2000, 0, "tagged in three segments")
        check("2000 tag", elbow.upload(0x2000)[0].decode(), "tagged in three segments")
        print("CiA 402")
        walk_cia402(Node(bus, 3))
    print("all as CiA 301 and 402 have it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
