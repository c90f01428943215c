"""Electronic data sheets (CiA 306) of the nodes."""
from can_table import BITS, RPDO_COB_IDS, TPDO_COB_IDS

DATA_TYPES = {"i8": 2, "i16": 3, "i32": 4, "u8": 5, "u16": 6, "u32": 7, "text": 9}
OBJECT_TYPES = {"var": 7, "array": 8, "record": 9}
BAUD_RATES = (10, 20, 50, 125, 250, 500, 800, 1000)  # kbit/s
MANDATORY = (0x1000, 0x1001, 0x1018)


def access(row):
    """CiA 306 says with rww in which PDOs a writable object may stand; `both` is rw."""
    return "rww" if row.access == "rw" and row.pdo == "rx" else row.access


def value(number, row, figures):
    """$NODEID stays a formula: the file serves a device that was given another number."""
    if number.figure == "node":
        return f"$NODEID+0x{number.plus:X}" if number.plus else "$NODEID"
    result = figures[number.figure] + number.plus if number.figure else number.plus
    signed = row.type.startswith("i")
    return str(result) if signed or abs(result) < 10 else f"0x{result:0{BITS[row.type] // 4}X}"


def entry(section, row, figures, title):
    lines = [f"[{section}]", f"ParameterName={row.name}", "ObjectType=0x7", f"DataType=0x{DATA_TYPES[row.type]:04X}", f"AccessType={access(row)}"]
    if row.type == "text":
        lines.append(f"DefaultValue={row.text or (title if row.access == 'const' else '')}")
    else:
        lines.append(f"DefaultValue={value(row.value, row, figures)}")
        if row.low is not None:
            lines.append(f"LowLimit={value(row.low, row, figures)}")
        if row.high is not None:
            lines.append(f"HighLimit={value(row.high, row, figures)}")
    return lines + [f"PDOMapping={0 if row.pdo == 'none' else 1}", ""]


def object_lines(obj, figures, title):
    if obj.kind == "var":
        return entry(f"{obj.index:04X}", obj.rows[0], figures, title)
    lines = [f"[{obj.index:04X}]", f"ParameterName={obj.name}", f"ObjectType=0x{OBJECT_TYPES[obj.kind]:X}", f"SubNumber={len(obj.rows)}", ""]
    for row in obj.rows:
        lines += entry(f"{obj.index:04X}sub{row.sub:X}", row, figures, title)
    return lines


def listing(section, indices):
    return [f"[{section}]", f"SupportedObjects={len(indices)}"] + [f"{i + 1}=0x{index:04X}" for i, index in enumerate(indices)] + [""]


def file_name(node):
    return f"node{node.number}_{node.name}.eds"


def title(node):
    return node.device.title + (f", {node.joint}" if node.joint else "")


def eds(table, node, figures):
    identity, objects = table.identity, node.device.objects
    date = table.revision["date"].strftime("%m-%d-%Y")
    lines = ["[FileInfo]", f"FileName={file_name(node)}", f"FileVersion={table.revision['version']}", "FileRevision=0", "EDSVersion=4.0",
             f"Description={title(node)}, node {node.number}", "CreationTime=12:00AM", f"CreationDate={date}", "CreatedBy=Lanternfish",
             "ModificationTime=12:00AM", f"ModificationDate={date}", "ModifiedBy=Lanternfish", "",
             "[DeviceInfo]", f"VendorName={identity['vendor_name']}", f"VendorNumber=0x{identity['vendor']:08X}", f"ProductName={title(node)}",
             f"ProductNumber=0x{identity['product']:08X}", f"RevisionNumber=0x{identity['revision']:08X}", "OrderCode=0"]
    lines += [f"BaudRate_{rate}={1 if rate * 1000 == table.bus['bitrate'] else 0}" for rate in BAUD_RATES]
    lines += ["SimpleBootUpMaster=0", "SimpleBootUpSlave=1", "Granularity=8", "DynamicChannelsSupported=0", "GroupMessaging=0",
              f"NrOfRXPDO={len(RPDO_COB_IDS)}", f"NrOfTXPDO={len(TPDO_COB_IDS)}", "LSS_Supported=0", "",
              "[DummyUsage]", "Dummy0001=0"] + [f"Dummy000{i}=1" for i in range(2, 8)] + ["", "[Comments]", "Lines=0", ""]
    indices = [o.index for o in objects]
    lines += listing("MandatoryObjects", list(MANDATORY))
    lines += listing("OptionalObjects", [i for i in indices if i not in MANDATORY and not 0x2000 <= i < 0x6000])
    lines += listing("ManufacturerObjects", [i for i in indices if 0x2000 <= i < 0x6000])
    for obj in objects:
        lines += object_lines(obj, figures, title(node))
    return "\n".join(lines)
