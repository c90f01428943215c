"""Reads and checks can_map.yaml: what stands there once, spelled out for every node and sub-index."""
import dataclasses
import re

import yaml

BITS = {"u8": 8, "u16": 16, "u32": 32, "i8": 8, "i16": 16, "i32": 32, "text": 0}
ACCESS = ("const", "ro", "wo", "rw")
PDO = ("none", "rx", "tx", "both")
SCALES = ("position", "torque")
RPDO_COB_IDS = (0x200, 0x300, 0x400, 0x500)  # the predefined connection set (CiA 301, 7.3.5); + node
TPDO_COB_IDS = (0x180, 0x280, 0x380, 0x480)
PDO_INVALID, NO_REMOTE = 0x80000000, 0x40000000


class BadTable(Exception):
    pass


class Map(dict):
    """A YAML mapping that knows its line, and refuses keys that nobody asked for."""

    def fail(self, message):
        raise BadTable(f"{self.file}:{self.line}: {message}")

    def only(self, *keys):
        for key in self:
            if key not in keys:
                self.fail(f"unknown key '{key}'; there are {', '.join(keys)}")
        return self

    def need(self, key, kind, default=None):
        value = self.get(key, default)
        if value is None:
            self.fail(f"no '{key}'")
        if not isinstance(value, kind) or isinstance(value, bool):
            self.fail(f"'{key}': {value!r} is not what stands there")
        return value


class Loader(yaml.SafeLoader):
    def construct_map(self, node):
        result = Map()
        result.file, result.line = self.name, node.start_mark.line + 1
        for key_node, value_node in node.value:
            key = self.construct_object(key_node, deep=True)
            if key in result:
                raise BadTable(f"{self.name}:{key_node.start_mark.line + 1}: '{key}' stands twice")
            result[key] = self.construct_object(value_node, deep=True)
        return result


Loader.add_constructor("tag:yaml.org,2002:map", Loader.construct_map)


@dataclasses.dataclass(frozen=True)
class Number:
    """`plus`, or a figure of the node plus that."""
    figure: str = ""
    plus: int = 0


@dataclasses.dataclass
class Row:
    """One sub-index of an object."""
    index: int
    sub: int
    name: str
    type: str
    access: str
    pdo: str = "none"
    value: Number = Number()
    low: Number = None
    high: Number = None
    text: str = ""      # of a type text; empty: the device's title
    capacity: int = 0   # bytes that a download of a text may have


@dataclasses.dataclass
class Object:
    index: int
    name: str
    kind: str  # var array record
    rows: list


@dataclasses.dataclass
class Signal:
    name: str
    row: Row
    byte: int
    scale: str
    unit: str
    bits: dict


@dataclasses.dataclass
class Device:
    key: str
    code: str
    title: str
    objects: list  # by index
    rpdo1: list
    tpdo1: list


@dataclasses.dataclass
class Node:
    number: int
    name: str
    device: Device
    joint: str  # empty: none


@dataclasses.dataclass
class Table:
    bus: dict
    identity: dict
    revision: dict
    figures: list
    devices: list
    nodes: list


class Reader:
    def __init__(self, path):
        try:
            with open(path, encoding="utf-8") as stream:
                loader = Loader(stream)
                self.top = loader.get_single_data()
        except OSError as error:
            raise BadTable(f"{path}: {error.strerror}")
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            raise BadTable(f"{path}:{mark.line + 1 if mark else 0}: {getattr(error, 'problem', error)}")
        if not isinstance(self.top, Map):
            raise BadTable(f"{path}:1: is not a table")
        self.top.only("revision", "bus", "identity", "nodes", "figures", "devices", "pdo_defaults", "common_objects")
        self.constants = {key: self.top.need("identity", Map).need(key, int) for key in ("vendor", "product", "revision")}
        self.texts = {key: self.top["identity"].need(key, str) for key in ("hardware", "software")}

    def number(self, at, key):
        if key not in at:
            return None
        value = at[key]
        if isinstance(value, int) and not isinstance(value, bool):
            return Number("", value)
        match = re.fullmatch(r"(\w+)(?: \+ (\w+))?", str(value))
        if not match:
            at.fail(f"'{key}': {value!r} is neither a number nor a figure plus a number")
        figure, plus = match.group(1), int(match.group(2) or "0", 0)
        if figure in self.constants:
            return Number("", self.constants[figure] + plus)
        if figure not in self.top.need("figures", Map):
            at.fail(f"'{key}': no figure '{figure}'")
        return Number(figure, plus)

    def row(self, index, sub, at, name):
        at.only("name", "type", "access", "pdo", "value", "low", "high", "text", "capacity")
        row = Row(index, sub, name, at.need("type", str), at.need("access", str), at.need("pdo", str, "none"))
        for value, known in ((row.type, BITS), (row.access, ACCESS), (row.pdo, PDO)):
            if value not in known:
                at.fail(f"{index:04X}:{sub:02X}: '{value}' is none of {', '.join(known)}")
        if row.pdo in ("rx", "both") and row.access != "rw" or row.pdo != "none" and row.type == "text":
            at.fail(f"{index:04X}:{sub:02X}: {row.type} {row.access} cannot stand in such a PDO")
        if row.type == "text":
            text = at.need("text", str)
            row.text, row.capacity = "" if text == "title" else self.texts.get(text, text), at.get("capacity", 0)
            return row
        row.value = self.number(at, "value") or at.fail(f"{index:04X}:{sub:02X}: no 'value'")
        row.low, row.high = self.number(at, "low"), self.number(at, "high")
        return row

    def object(self, index, at):
        name = at.need("name", str)
        if "entries" not in at:
            return Object(index, name, "var", [self.row(index, 0, at, name)])
        at.only("name", "kind", "entries")
        kind, rows = at.need("kind", str), []
        for key, entry in at.need("entries", Map).items():
            first, _, last = str(key).partition("-")
            for sub in range(int(first), int(last or first) + 1):
                rows.append(self.row(index, sub, entry, entry.need("name", str) + (f" {sub}" if last else "")))
        if rows[0].sub != 0:
            rows.insert(0, Row(index, 0, "Highest sub-index supported", "u8", "const", value=Number("", rows[-1].sub)))
        return Object(index, name, kind, rows)

    def pdo_objects(self, at, power_on):
        """1400 to 1BFF: communication parameters and mapping of four PDOs in each direction."""
        defaults = self.top.need("pdo_defaults", Map).only("count", "mapped", "type", "inhibit_100us")
        objects = []
        for direction, base, cob_ids in (("rpdo", 0x1400, RPDO_COB_IDS), ("tpdo", 0x1800, TPDO_COB_IDS)):
            maps = power_on.need(direction, list)
            if len(maps) != defaults["count"]:
                at.fail(f"power_on: {direction} lists {len(maps)} PDOs, not {defaults['count']}")
            for i, entries in enumerate(maps):
                which = ("Receive" if direction == "rpdo" else "Transmit") + f" PDO {i + 1}"
                cob_id = cob_ids[i] | (NO_REMOTE if direction == "tpdo" else 0) | (0 if entries else PDO_INVALID)
                index = base + i
                inhibit = defaults["inhibit_100us"] if direction == "tpdo" else 0
                rows = [Row(index, 0, "Highest sub-index supported", "u8", "const", value=Number("", 5)),
                        Row(index, 1, f"COB-ID of {which.lower()}", "u32", "rw", value=Number("node", cob_id)),
                        Row(index, 2, "Transmission type", "u8", "rw", value=Number("", defaults["type"])),
                        Row(index, 3, "Inhibit time", "u16", "rw", value=Number("", inhibit)),
                        Row(index, 5, "Event timer", "u16", "rw", value=Number("", 0))]
                objects.append(Object(index, f"{which} communication parameter", "record", rows))
                rows = [Row(index + 0x200, 0, "Number of mapped objects", "u8", "rw", value=Number("", len(entries)))]
                for n in range(defaults["mapped"]):
                    entry = entries[n] if n < len(entries) else 0
                    rows.append(Row(index + 0x200, n + 1, f"Mapped object {n + 1}", "u32", "rw", value=Number("", entry)))
                objects.append(Object(index + 0x200, f"{which} mapping parameter", "record", rows))
        return objects

    def signals(self, at, key, rows, direction):
        signals, byte = [], 0
        for entry in at.need(key, list):
            entry.only("signal", "object", "sub", "scale", "unit", "bits")
            row = rows.get((entry.need("object", int), entry.get("sub", 0)))
            if row is None or row.pdo not in (direction, "both"):
                entry.fail(f"{entry['object']:04X}:{entry.get('sub', 0):02X} cannot stand in this PDO")
            if entry.get("scale") not in (None, *SCALES):
                entry.fail(f"scale '{entry['scale']}' is none of {', '.join(SCALES)}")
            signals.append(Signal(entry.need("signal", str), row, byte, entry.get("scale", ""), entry.get("unit", ""), entry.get("bits", {})))
            byte += BITS[row.type] // 8
        if byte > 8:
            at.fail(f"{key} has {byte} bytes, more than a frame holds")
        return signals

    def device(self, key, at):
        at.only("code", "title", "type", "rpdo1", "tpdo1", "power_on", "objects")
        self.constants["device_type"] = at.need("type", int)
        objects = [self.object(index, entry) for part in (self.top.need("common_objects", Map), at.need("objects", Map))
                   for index, entry in part.items()]
        objects += self.pdo_objects(at, at.need("power_on", Map))
        objects.sort(key=lambda o: o.index)
        for a, b in zip(objects, objects[1:]):
            if a.index == b.index:
                at.fail(f"object {a.index:04X} stands twice")
        rows = {(row.index, row.sub): row for o in objects for row in o.rows}
        return Device(key, at.need("code", str), at.need("title", str), objects, self.signals(at, "rpdo1", rows, "rx"),
                      self.signals(at, "tpdo1", rows, "tx"))

    def read(self):
        devices = {key: self.device(key, at) for key, at in self.top.need("devices", Map).items()}
        nodes = []
        for number, at in self.top.need("nodes", Map).items():
            at.only("name", "device", "joint")
            if not isinstance(number, int) or not 1 <= number <= 126:
                at.fail(f"node {number!r} is outside 1 to 126")
            if at.need("device", str) not in devices:
                at.fail(f"no device '{at['device']}'")
            nodes.append(Node(number, at.need("name", str), devices[at["device"]], at.get("joint", "")))
        return Table(self.top.need("bus", Map), self.top["identity"], self.top.need("revision", Map), list(self.top["figures"]),
                     list(devices.values()), nodes)


def read_table(path):
    """Throws BadTable, whose text is "file:line: what is wrong"."""
    return Reader(path).read()
