"""An SDO client and a little of NMT and CiA 402, on python-can alone: a peer that shares no code with the project (CiA 301, 7.2.4.3; CiA 402-2)."""
import struct
import time

import can

SDO_TIMEOUT_S = 2.5  # the server gives a stalled transfer up after 1 s


class Abort(Exception):
    def __init__(self, code):
        super().__init__(f"abort {code:08X}")
        self.code = code


class Node:
    def __init__(self, bus, number):
        self.bus, self.number = bus, number
        self.statusword, self.position, self.emergencies, self.nmt_state = None, None, [], None

    # --- frames ---
    def send(self, identifier, data):
        self.bus.send(can.Message(arbitration_id=identifier, data=bytes(data), is_extended_id=False))

    def note(self, message):
        """Keeps what a frame tells of this node."""
        identifier, data = message.arbitration_id, bytes(message.data)
        if identifier == 0x180 + self.number and len(data) == 8:
            self.statusword, self.position, _ = struct.unpack("<Hih", data)
        elif identifier == 0x080 + self.number and len(data) == 8:
            self.emergencies.append(struct.unpack_from("<H", data)[0])
        elif identifier == 0x700 + self.number and len(data) == 1:
            self.nmt_state = data[0]

    def receive(self, timeout_s, identifier):
        """The next frame with this identifier; None after the time."""
        end = time.monotonic() + timeout_s
        while True:
            left = end - time.monotonic()
            message = self.bus.recv(max(left, 0))
            if message is None:
                return None
            self.note(message)
            if message.arbitration_id == identifier:
                return bytes(message.data)

    def nmt(self, command):
        self.send(0x000, [command, self.number])

    def wait_state(self, state, timeout_s=2.0):
        end = time.monotonic() + timeout_s
        while time.monotonic() < end and self.nmt_state != state:
            self.receive(0.05, 0x700 + self.number)
        assert self.nmt_state == state, f"node {self.number}: NMT state {self.nmt_state}, not {state}"

    # --- SDO ---
    def raw(self, request, timeout_s=SDO_TIMEOUT_S):
        """One request's answer, eight bytes. Throws Abort."""
        self.send(0x600 + self.number, request)
        return self.answer(timeout_s)

    def answer(self, timeout_s=SDO_TIMEOUT_S):
        data = self.receive(timeout_s, 0x580 + self.number)
        assert data is not None and len(data) == 8, f"node {self.number}: no SDO answer"
        if data[0] == 0x80:
            raise Abort(struct.unpack_from("<I", data, 4)[0])
        return data

    @staticmethod
    def head(command, index, sub):
        return struct.pack("<BHB", command, index, sub)

    def upload(self, index, sub=0):
        """(bytes, whether they came in segments)"""
        answer = self.raw(self.head(0x40, index, sub) + bytes(4))
        assert answer[1:4] == self.head(0, index, sub)[1:], "the answer is another object's"
        if answer[0] & 0x02:
            return answer[4:8 - ((answer[0] >> 2) & 3)], False
        size, data, toggle = struct.unpack_from("<I", answer, 4)[0], b"", 0
        while True:
            answer = self.raw(bytes([0x60 | toggle]) + bytes(7))
            assert answer[0] & 0xF0 == toggle, "the toggle bit does not alternate"
            data += answer[1:8 - ((answer[0] >> 1) & 7)]
            toggle ^= 0x10
            if answer[0] & 1:
                assert len(data) == size, f"{len(data)} bytes of {size} announced"
                return data, True

    def number_at(self, index, sub=0, signed=False):
        data, _ = self.upload(index, sub)
        return int.from_bytes(data, "little", signed=signed)

    def download(self, index, sub, value, size):
        command = 0x23 | ((4 - size) << 2)
        data = value.to_bytes(size, "little", signed=value < 0)
        answer = self.raw(self.head(command, index, sub) + data.ljust(4, b"\0"))
        assert answer[0] == 0x60, answer

    def download_text(self, index, sub, text):
        data, toggle = text.encode(), 0
        assert self.raw(self.head(0x21, index, sub) + struct.pack("<I", len(data)))[0] == 0x60
        while True:
            part, data = data[:7], data[7:]
            answer = self.raw(bytes([toggle | ((7 - len(part)) << 1) | (0 if data else 1)]) + part.ljust(7, b"\0"))
            assert answer[0] == 0x20 | toggle
            toggle ^= 0x10
            if not data:
                return

    def map(self, communication, cob_id, entries):
        """Re-maps a PDO in the order of CiA 301 and reads it back."""
        mapping = communication + 0x200
        self.download(communication, 1, cob_id | 0x80000000, 4)
        self.download(communication, 2, 1, 1)
        self.download(mapping, 0, 0, 1)
        for i, entry in enumerate(entries, 1):
            self.download(mapping, i, entry, 4)
        self.download(mapping, 0, len(entries), 1)
        self.download(communication, 1, cob_id, 4)
        assert [self.number_at(mapping, i) for i in range(len(entries) + 1)] == [len(entries)] + entries
