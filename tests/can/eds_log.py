#!/usr/bin/python3
"""Holds a run's SDO traffic against the nodes' electronic data sheets (CiA 306), read as the INI files they are: eds_log.py EDS_DIR RUN_DIR. No project code inside.

- Every object that is read or written exists in its node's EDS, with an access that allows it and a data type of that size; what is written lies within its
  limits, what is constant is read as it stands there. Where a node says that there is no such object, its EDS has none.
- What is mapped into PDOs is there to be mapped, with that many bits.
- The same traffic against sheets that were spoiled is found out.
"""
import configparser
import copy
import pathlib
import struct
import sys

SIZES = {2: 1, 3: 2, 4: 4, 5: 1, 6: 2, 7: 4}  # bytes, by data type; 9 is text of any length
SIGNED = {2, 3, 4}
READABLE, WRITABLE = {"ro", "const", "rw", "rwr", "rww"}, {"wo", "rw", "rwr", "rww"}
MAPPINGS = {*range(0x1600, 0x1800), *range(0x1A00, 0x1C00)}
NO_OBJECT, NO_SUB_INDEX = 0x06020000, 0x06090011


def sheets(folder):
    found = {}
    for path in sorted(pathlib.Path(folder).glob("node*.eds")):
        sheet = configparser.ConfigParser(interpolation=None, strict=True)
        sheet.optionxform = str
        sheet.read_string(path.read_text(encoding="ascii"))
        found[int(path.name[4:].split("_")[0])] = sheet
    return found


def entry(sheet, index, sub):
    section = f"{index:04X}sub{sub:X}"
    if section in sheet:
        return sheet[section]
    plain = f"{index:04X}"
    return sheet[plain] if sub == 0 and plain in sheet and int(sheet[plain]["ObjectType"], 0) == 7 else None


def number(text, node, signed, size):
    total = sum(node if part == "$NODEID" else int(part, 0) for part in text.split("+"))
    return total - (1 << 8 * size) if signed and total >= 1 << (8 * size - 1) else total


class Transfer:
    def __init__(self, kind, index, sub):
        self.kind, self.index, self.sub, self.data, self.abort = kind, index, sub, b"", None

    def name(self):
        return f"{self.kind} {self.index:04X}:{self.sub:02X}"


def transfers(log):
    """Yields (node, transfer) of each that ended, expedited or in segments."""
    under_way = {}
    for line in pathlib.Path(log).read_text(encoding="ascii").splitlines():
        identifier, data = line.split()[2].split("#")
        identifier, data = int(identifier, 16), bytes.fromhex(data)
        node, service = identifier & 0x7F, identifier >> 7
        if service not in (0xB, 0xC):
            continue
        command = data[0] >> 5
        if command == 4:  # abort, from either side
            if node in under_way:
                transfer = under_way.pop(node)
                transfer.abort = struct.unpack_from("<I", data, 4)[0]
                yield node, transfer
            continue
        if service == 0xC:  # the master asks
            index, sub = struct.unpack_from("<HB", data, 1)
            if command == 1:
                under_way[node] = Transfer("write", index, sub)
                if data[0] & 2:
                    under_way[node].data = data[4:8 - (data[0] >> 2 & 3 if data[0] & 1 else 0)]
            elif command == 2:
                under_way[node] = Transfer("read", index, sub)
            elif command == 0 and node in under_way:
                under_way[node].data += data[1:8 - (data[0] >> 1 & 7)]
                under_way[node].last = bool(data[0] & 1)
            continue
        if node not in under_way:
            continue
        transfer, ended = under_way[node], False
        if command == 3:  # a write begins; expedited, it has ended
            ended = bool(transfer.data)
        elif command == 1:
            ended = getattr(transfer, "last", False)
        elif command == 2 and data[0] & 2:
            transfer.data, ended = data[4:8 - (data[0] >> 2 & 3 if data[0] & 1 else 0)], True
        elif command == 0:
            transfer.data += data[1:8 - (data[0] >> 1 & 7)]
            ended = bool(data[0] & 1)
        if ended:
            yield node, under_way.pop(node)


def mapping_fault(sheet, transfer):
    """What is wrong with an object that is mapped; None for none, and for a place that is emptied."""
    bits, sub, index = transfer.data[0], transfer.data[1], struct.unpack_from("<H", transfer.data, 2)[0]
    if index == 0:
        return None
    mapped = entry(sheet, index, sub)
    if mapped is None:
        return f"maps {index:04X}:{sub:02X}, which is not there"
    if mapped.get("PDOMapping") != "1":
        return f"maps {index:04X}:{sub:02X}, which cannot be"
    size = SIZES.get(int(mapped["DataType"], 0), 0)
    return None if bits == 8 * size else f"maps {bits} bits of {index:04X}:{sub:02X}, which has {8 * size}"


def fault(sheet, node, transfer):
    row = entry(sheet, transfer.index, transfer.sub)
    if transfer.abort in (NO_OBJECT, NO_SUB_INDEX):
        return None if row is None else "is in the EDS, and the node says that it has none"
    if row is None:
        return "is not in the EDS"
    if transfer.abort is not None:
        return f"was aborted with {transfer.abort:08X}"
    if row["AccessType"] not in (READABLE if transfer.kind == "read" else WRITABLE):
        return f"has access {row['AccessType']}"
    data_type = int(row["DataType"], 0)
    if data_type == 9:
        return None if transfer.data.decode("ascii").isprintable() else "is no text"
    size, signed = SIZES[data_type], data_type in SIGNED
    if len(transfer.data) != size:
        return f"moved {len(transfer.data)} bytes, data type {data_type} has {size}"
    value = int.from_bytes(transfer.data, "little", signed=signed)
    if transfer.kind == "read" and row["AccessType"] == "const" and value != number(row["DefaultValue"], node, signed, size):
        return f"reads {value}, constant {row['DefaultValue']}"
    if transfer.kind == "write":
        for limit, beyond in (("LowLimit", lambda v, l: v < l), ("HighLimit", lambda v, l: v > l)):
            if limit in row and beyond(value, number(row[limit], node, signed, size)):
                return f"is written {value}, {limit} {row[limit]}"
    # Read, too: what a drive has mapped already is not written again.
    return mapping_fault(sheet, transfer) if transfer.index in MAPPINGS and transfer.sub > 0 else None


def faults(all_sheets, traffic):
    found = []
    for node, transfer in traffic:
        what = fault(all_sheets[node], node, transfer) if node in all_sheets else "has no EDS"
        if what:
            found.append(f"node {node}: {transfer.name()} {what}")
    return found


def spoil(all_sheets, section, key, value):
    """A copy in which every node that has it has it wrong; None removes the object."""
    spoilt = copy.deepcopy(all_sheets)
    for sheet in spoilt.values():
        if section in sheet:
            if value is None:
                sheet.remove_section(section)
            else:
                sheet[section][key] = value
    return spoilt


def main():
    eds, run = sys.argv[1], pathlib.Path(sys.argv[2])
    good, traffic = sheets(eds), list(transfers(run / "can0.log"))
    assert sorted(good) == [1, 2, 3, 4, 5, 6], sorted(good)
    found = faults(good, traffic)
    for line in found:
        print(line)
    assert not found, f"{len(found)} faults"
    for node in good:
        kinds = {transfer.kind for n, transfer in traffic if n == node}
        assert kinds == {"read", "write"}, f"node {node}: {kinds}"
    written = {(t.index, t.sub) for _, t in traffic if t.kind == "write"}
    mapped = [t for _, t in traffic if t.kind == "write" and t.index in MAPPINGS and t.sub > 0]
    texts = [t for _, t in traffic if t.kind == "read" and t.index == 0x1008]
    assert len(written) > 20 and len(mapped) > 20 and len(texts) == 6, (len(written), len(mapped), len(texts))

    for section, key, value, what in (("1017", "", None, "is not in the EDS"), ("607Dsub1", "DataType", "0x0003", "moved 4 bytes"),
                                      ("60C2sub1", "AccessType", "ro", "has access ro"), ("1000", "DefaultValue", "0x1", "constant 0x1"),
                                      ("6065", "HighLimit", "10", "HighLimit 10"), ("6064", "PDOMapping", "0", "which cannot be"),
                                      ("6041", "DataType", "0x0005", "maps 16 bits")):
        assert any(what in line for line in faults(spoil(good, section, key, value), traffic)), f"spoiling {section} {key} went unnoticed"
    print(f"{len(traffic)} transfers, {len({(n, t.index, t.sub) for n, t in traffic})} objects of {len(good)} nodes, "
          f"{sum(t.abort is not None for _, t in traffic)} refused")
    return 0


if __name__ == "__main__":
    sys.exit(main())
