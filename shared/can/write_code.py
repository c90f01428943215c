"""C++ of the CAN map: what core and devices both need (can_map.hpp), and the devices' objects (object_tables.cpp)."""
from can_table import BITS

TYPES = {"u8": "u8", "u16": "u16", "u32": "u32", "i8": "i8", "i16": "i16", "i32": "i32", "text": "text"}
ACCESS = {"const": "constant", "ro": "read_only", "wo": "write_only", "rw": "read_write"}
MAPPING = {"none": "none", "rx": "receive", "tx": "transmit", "both": "both"}
NOTICE = "made of can_map.yaml by generate_can_files.py: edit the table instead."


def mapping_entry(row):
    return (row.index << 16) | (row.sub << 8) | BITS[row.type]


def pdo_lines(device, key, signals):
    width = sum(BITS[s.row.type] // 8 for s in signals)
    entries = ", ".join(f"0x{mapping_entry(s.row):08X}" for s in signals)
    offsets = ", ".join(f"{s.name} = {s.byte}" for s in signals)
    return [f"namespace {device.code}_{key} {{", f"inline constexpr std::array<std::uint32_t, {len(signals)}> entries{{{entries}}};",
            f"inline constexpr std::size_t {offsets};", f"inline constexpr std::uint8_t length = {width};",
            f"}}  // namespace {device.code}_{key}"]


def bit_lines(signals, prefix):
    return [f"inline constexpr std::uint8_t {prefix}_{name} = 0x{1 << bit:02X};" for s in signals for name, bit in s.bits.items()
            if not name.endswith("_actual")]


def header(table):
    bus = table.bus
    drives = [str(n.number) for n in table.nodes if n.joint]
    lines = [f"// The CAN map, {NOTICE}", "#pragma once", "", "#include <array>", "#include <cstddef>", "#include <cstdint>", "",
             '#include "shared/messages/joint_io.hpp"', '#include "shared/messages/time.hpp"', "", "namespace lf::can_map {", "",
             f"inline constexpr std::uint32_t bitrate = {bus['bitrate']};",
             f"inline constexpr Duration sync_period = Duration::from_ms({bus['sync_period_ms']});", "",
             f"inline constexpr std::uint8_t master_node = 0x{bus['master_node']:02X};"]
    for key in ("master_heartbeat", "master_heartbeat_timeout", "node_heartbeat", "node_heartbeat_timeout", "process_data_deadline"):
        lines.append(f"inline constexpr Duration {key} = Duration::from_ms({bus[key + '_ms']});")
    lines += ["", "// The default machine's drives in the order of its joints.", f"inline constexpr std::array<std::uint8_t, {len(drives)}> drive_nodes{{{', '.join(drives)}}};"]
    lines += [f"inline constexpr std::uint8_t {n.device.code}_node = {n.number};" for n in table.nodes if not n.joint]
    lines += ["", "// Process data of transmission type 1: entries as in 1600 and 1A00 (index << 16 | sub << 8 | bits), and each value's first byte."]
    for device in table.devices:
        lines += pdo_lines(device, "rpdo1", device.rpdo1) + pdo_lines(device, "tpdo1", device.tpdo1)
    lines += ["", "// Bits of the output node's bytes."]
    for device in table.devices:
        lines += bit_lines(device.rpdo1, "output") + bit_lines(device.tpdo1, "input")
    return "\n".join(lines + ["", "}  // namespace lf::can_map", ""])


def number(value, absent):
    if value is None:
        return absent
    return f"{{Figure::{value.figure or 'none'}, {value.plus}}}"


def row_line(row):
    fields = [f"0x{row.index:04X}", str(row.sub), f"Type::{TYPES[row.type]}", f"Access::{ACCESS[row.access]}", f"Mapping::{MAPPING[row.pdo]}",
              number(row.value, ""), number(row.low, "unlimited_low"), number(row.high, "unlimited_high"),
              f'"{row.text}"' if row.type == "text" and row.text else ("own_title" if row.type == "text" and row.access == "const" else '""'),
              str(row.capacity), f'"{row.name}"']
    return "    {" + ", ".join(fields) + "},"


def sheet(table):
    identity, date = table.identity, table.revision["date"].strftime("%m-%d-%Y")
    return (f'{{"{identity["vendor_name"]}", 0x{identity["vendor"]:08X}, 0x{identity["product"]:08X}, 0x{identity["revision"]:08X}, '
            f'{table.revision["version"]}, "{date}"}}')


def object_tables(table):
    lines = [f"// The devices' objects, {NOTICE}", '#include "shared/can/object_tables.hpp"', "", "namespace lf::can_map {", "namespace {", ""]
    for device in table.devices:
        rows = [row for o in device.objects for row in o.rows]
        lines += [f"constexpr ObjectRow {device.key}_rows[] = {{"] + [row_line(row) for row in rows] + ["};", ""]
        heads = [f'    {{0x{o.index:04X}, ObjectKind::{o.kind}, "{o.name}"}},' for o in device.objects if o.kind != "var"]
        lines += [f"constexpr ObjectHead {device.key}_head_rows[] = {{"] + heads + ["};", ""]
    lines += ["}  // namespace", "", f"Sheet sheet() {{ return {sheet(table)}; }}"]
    for device in table.devices:
        lines += [f"std::span<const ObjectRow> {device.key}_objects() {{ return {device.key}_rows; }}",
                  f"std::span<const ObjectHead> {device.key}_heads() {{ return {device.key}_head_rows; }}",
                  f'const char* {device.key}_title() {{ return "{device.title}"; }}']
    return "\n".join(lines + ["", "}  // namespace lf::can_map", ""])
