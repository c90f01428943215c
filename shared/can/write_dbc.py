"""A DBC of everything on the bus: process data with scaled signals, NMT, SYNC, emergencies, services, heartbeats."""
from can_table import BITS

NMT_COMMANDS = {1: "start", 2: "stop", 128: "enter_pre_operational", 129: "reset_node", 130: "reset_communication"}
NMT_STATES = {0: "boot_up", 4: "stopped", 5: "operational", 127: "pre_operational"}
MASTER = "master"


class Message:
    def __init__(self, identifier, name, length, sender, cycle_ms=0):
        self.identifier, self.name, self.length, self.sender, self.cycle_ms = identifier, name, length, sender, cycle_ms
        self.signals, self.values, self.comments = [], {}, {}

    def add(self, name, start_bit, bits, signed=False, factor=1, unit="", receiver="Vector__XXX", comment="", values=None):
        low, high = (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) if signed else (0, (1 << bits) - 1)
        self.signals.append(f" SG_ {name} : {start_bit}|{bits}@1{'-' if signed else '+'} ({factor!r},0) [{low * factor!r}|{high * factor!r}] "
                            f"\"{unit}\" {receiver}")
        if comment:
            self.comments[name] = comment
        if values:
            self.values[name] = values


def add_process_data(message, signals, motor, receiver):
    for s in signals:
        bits, signed = BITS[s.row.type], s.row.type.startswith("i")
        if s.bits:
            for name, bit in s.bits.items():
                message.add(name, 8 * s.byte + bit, 1, receiver=receiver)
            continue
        factor, unit, comment = 1, s.unit, ""
        if s.scale == "position":
            factor, unit = motor.position_scale()
            comment = ("Growth of the joint's screw" if motor.screw else "Joint angle") + " since the drive's own zero."
        if s.scale == "torque":
            factor, unit = motor.torque_scale()
            comment = "At the motor's shaft."
        message.add(s.name, 8 * s.byte, bits, signed, factor, unit, receiver, comment)


def process_data(node, motor, sync_ms):
    messages = []
    for key, signals, cob_id in (("rpdo1", node.device.rpdo1, 0x200), ("tpdo1", node.device.tpdo1, 0x180)):
        length = sum(BITS[s.row.type] // 8 for s in signals)
        sender, receiver = (MASTER, node.name) if key == "rpdo1" else (node.name, MASTER)
        message = Message(cob_id + node.number, f"{node.name}_{key}", length, sender, sync_ms)
        add_process_data(message, signals, motor, receiver)
        messages.append(message)
    return messages


def services(table, node):
    emergency = Message(0x080 + node.number, f"{node.name}_emcy", 8, node.name)
    emergency.add("error_code", 0, 16, comment="CiA 301 and 402; 0 is the end of an error.")
    emergency.add("error_register", 16, 8)
    emergency.add("manufacturer", 24, 40)
    messages = [emergency]
    for name, cob_id, sender in (("sdo_answer", 0x580, node.name), ("sdo_request", 0x600, MASTER)):
        message = Message(cob_id + node.number, f"{node.name}_{name}", 8, sender)
        message.add("command", 0, 8)
        message.add("object_index", 8, 16)
        message.add("sub_index", 24, 8)
        message.add("data", 32, 32)
        messages.append(message)
    return messages + [heartbeat(node.number, node.name, table.bus["node_heartbeat_ms"])]


def heartbeat(number, name, cycle_ms):
    message = Message(0x700 + number, f"{name}_heartbeat", 1, name, cycle_ms)
    message.add("state", 0, 8, values=NMT_STATES)
    return message


def all_messages(table, motors):
    nmt = Message(0x000, "nmt", 2, MASTER)
    nmt.add("command", 0, 8, values=NMT_COMMANDS)
    nmt.add("node", 8, 8, comment="0 is all of them.")
    messages = [nmt, Message(0x080, "sync", 0, MASTER, table.bus["sync_period_ms"]),
                heartbeat(table.bus["master_node"], MASTER, table.bus["master_heartbeat_ms"])]
    for node in table.nodes:
        messages += process_data(node, motors.get(node.number), table.bus["sync_period_ms"]) + services(table, node)
    return sorted(messages, key=lambda m: m.identifier)


def dbc(table, motors):
    """`motors`: of the drives, by node."""
    messages = all_messages(table, motors)
    lines = ['VERSION "' + str(table.revision["version"]) + '"', "", "NS_ :", "", "BS_:", "",
             "BU_: " + " ".join([MASTER] + [node.name for node in table.nodes]), ""]
    for m in messages:
        lines += [f"BO_ {m.identifier} {m.name}: {m.length} {m.sender}"] + m.signals + [""]
    for m in messages:
        lines += [f'CM_ SG_ {m.identifier} {name} "{text}";' for name, text in m.comments.items()]
    lines += ['BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;', 'BA_DEF_DEF_ "GenMsgCycleTime" 0;']
    lines += [f'BA_ "GenMsgCycleTime" BO_ {m.identifier} {m.cycle_ms};' for m in messages if m.cycle_ms]
    for m in messages:
        for name, values in m.values.items():
            lines.append(f"VAL_ {m.identifier} {name} " + " ".join(f'{number} "{text}"' for number, text in values.items()) + " ;")
    return "\n".join(lines + [""])
