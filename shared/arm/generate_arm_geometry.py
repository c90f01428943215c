#!/usr/bin/env python3
"""Makes the control core's constants of the arm's URDF: generate_arm_geometry.py URDF HEADER

The core has no parser and no heap, and the URDF stays the only source of the arm's geometry. The chain is checked to be of the kind whose closed
forms the core uses. Bad input: one line "file:line: message" on stderr, exit status 2, and no header.
"""
import math
import os
import sys
import xml.parsers.expat

LINKS = ["base", "slew", "upper_arm", "forearm", "wrist", "finger_a", "finger_b"]
JOINTS = ["slew", "shoulder", "elbow", "roll", "jaw"]
TOLERANCE = 1e-9


class BadUrdf(Exception):
    pass


class Element:
    def __init__(self, file, line, tag, attributes):
        self.file, self.line, self.tag, self.attributes, self.children = file, line, tag, attributes, []

    def fail(self, message):
        raise BadUrdf(f"{self.file}:{self.line}: {message}")

    def find(self, tag):
        return next((c for c in self.children if c.tag == tag), None)

    def child(self, tag):
        return self.find(tag) or self.fail(f"{self.label()} has no <{tag}>")

    def named(self, tag, name):
        for c in self.children:
            if c.tag == tag and c.attributes.get("name") == name:
                return c
        self.fail(f"no <{tag}> named '{name}'")

    def numbers(self, attribute, count, default=None):
        text = self.attributes.get(attribute)
        if text is None:
            return default if default is not None else self.fail(f"{self.label()} has no {attribute}")
        try:
            values = [float(word) for word in text.split()]
        except ValueError:
            values = []
        if len(values) != count or not all(map(math.isfinite, values)):
            self.fail(f'{self.label()}: {attribute}="{text}" is not {"a number" if count == 1 else f"{count} numbers"}')
        return values

    def number(self, attribute):
        return self.numbers(attribute, 1)[0]

    def label(self):
        name = self.attributes.get("name")
        return f"{self.tag} '{name}'" if name else f"<{self.tag}>"


def parse(file):
    parser = xml.parsers.expat.ParserCreate()
    root = Element(file, 0, "", {})
    stack = [root]

    def start(tag, attributes):
        stack.append(Element(file, parser.CurrentLineNumber, tag, attributes))
        stack[-2].children.append(stack[-1])

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: stack.pop()
    try:
        with open(file, "rb") as stream:
            parser.ParseFile(stream)
    except OSError as error:
        raise BadUrdf(f"{file}: {error.strerror}")
    except xml.parsers.expat.ExpatError as error:
        raise BadUrdf(f"{file}:{error.lineno}: is not well-formed XML ({xml.parsers.expat.ErrorString(error.code)})")
    return root.child("robot")


def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transform(rotation, v):
    return [sum(rotation[i][k] * v[k] for k in range(3)) for i in range(3)]


def rotation_rpy(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = (f(x) for x in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_z = [[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]
    about_y = [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]
    about_x = [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    return multiply(multiply(about_z, about_y), about_x)


def origin(element):
    """(rotation, translation) of an element's <origin>."""
    at = element.find("origin")
    if at is None:
        return rotation_rpy(0, 0, 0), [0.0, 0.0, 0.0]
    return rotation_rpy(*at.numbers("rpy", 3, [0.0, 0.0, 0.0])), at.numbers("xyz", 3, [0.0, 0.0, 0.0])


def read_joint(robot, name):
    joint = robot.named("joint", name)
    limit = joint.child("limit")
    drive = joint.child("lanternfish:drive")
    screw = joint.find("lanternfish:screw")
    values = {"lower_rad": limit.number("lower"), "upper_rad": limit.number("upper"), "effort_nm": limit.number("effort"),
              "velocity_rad_s": limit.number("velocity")}
    for key in ("rated_torque_nm", "acceleration_rad_s2", "stiction_rad_s", "backlash_rad", "holding_torque_nm"):
        values[key] = drive.number(key)
    keys = ("pivot_a_m", "pivot_b_m", "offset_rad", "counts_per_m")
    values.update({key: screw.number(key) if screw else 0.0 for key in keys})
    friction = joint.find("lanternfish:friction")
    for key, none in (("coulomb_share", 0.0), ("viscous_share", 0.0), ("efficiency", 1.0), ("back_efficiency", 1.0)):
        values[key] = friction.number(key) if friction else none
    values["counts_per_rad"] = 0.0 if screw else 1 / joint.child("lanternfish:gear").number("rad_per_count")
    if not values["lower_rad"] < values["upper_rad"]:
        limit.fail(f"joint '{name}': lower limit is not below the upper one")
    return values


def read_dh(robot):
    """Mount's yaw and the DH rows (a, alpha, d, theta offset) of the four arm joints: RotZ(q + offset) TransZ(d) TransX(a) RotX(alpha)."""
    joints = [robot.named("joint", name) for name in JOINTS[:4]] + [robot.named("joint", "tool")]

    def expect(joint, value, wanted, what):
        if abs(value - wanted) > TOLERANCE:
            joint.fail(f"{joint.label()}: the arm's closed forms need {what} = {wanted:.6g}, not {value:.6g}")

    mount, at = origin(joints[0])
    for value in at:
        expect(joints[0], value, 0, "its origin")
    expect(joints[0], mount[2][2], 1, "the cosine between its axis and the base's z")
    rows = []
    d = 0.0
    for joint, alpha in zip(joints[1:], (math.pi / 2, 0, math.pi / 2, 0)):
        rotation, at = origin(joint)
        expect(joint, rotation[2][0], 0, "the cosine between its x axis and its parent's z")
        expect(joint, math.atan2(rotation[2][1], rotation[2][2]), alpha, "the twist from its parent's z")
        offset = math.atan2(rotation[1][0], rotation[0][0])
        a = math.cos(offset) * at[0] + math.sin(offset) * at[1]
        along_next = math.sin(offset) * at[0] - math.cos(offset) * at[1]  # the next joint's own d, when alpha is a quarter turn
        tool = joint is joints[4]
        rows.append([0.0 if tool else a, alpha, d + (at[2] if tool else 0.0), offset])
        if tool:
            expect(joint, math.hypot(at[0], at[1]), 0, "its distance from the roll axis")
        else:
            expect(joint, at[2], 0, "its shift along its parent's axis")
        d = along_next if joint is joints[3] else expect(joint, along_next, 0, "its shift along its own axis") or 0.0
    expect(joints[4], rows[3][3], 0, "the tool's turn about the roll axis")
    return math.atan2(mount[1][0], mount[0][0]), rows


def capsule(shape):
    """(end, end, radius) of a capsule that contains a collision shape: 1.1 times as thick, so that it overhangs the ends by 0.64 of the radius only."""
    rotation, at = origin(shape)
    geometry = shape.child("geometry").children[0]
    if geometry.tag == "box":
        size = geometry.numbers("size", 3)
        axis = size.index(max(size))
        radius = 0.5 * math.hypot(*(s for i, s in enumerate(size) if i != axis))
        length = size[axis]
    elif geometry.tag == "cylinder":
        axis, radius, length = 2, geometry.number("radius"), geometry.number("length")
    else:
        geometry.fail(f"<{geometry.tag}>: no capsule can be made of it")
    thick = 1.1 * radius
    half = max(0.0, length / 2 - math.sqrt(thick * thick - radius * radius))
    if half == 0.0:  # short and thick: a sphere around it
        thick = math.hypot(radius, length / 2)
    along = transform(rotation, [half if i == axis else 0.0 for i in range(3)])
    return [x - y for x, y in zip(at, along)], [x + y for x, y in zip(at, along)], thick


def read_capsules(robot):
    """Of every link but the base, whose plate no capsule resembles."""
    return [(index, *capsule(c)) for index, name in enumerate(LINKS) if index > 0
            for c in robot.named("link", name).children if c.tag == "collision"]


def read_jaw(robot):
    """How the pads stand: pivot in the tool frame, and the pad's face from the pivot."""
    link = robot.named("link", "finger_a")
    pad = link.named("collision", "pad")
    size = pad.child("geometry").child("box").numbers("size", 3)
    _, at = origin(pad)
    _, pivot = origin(robot.named("joint", "jaw"))
    _, tool = origin(robot.named("joint", "tool"))
    return {"pivot_x_m": pivot[0], "pivot_z_m": pivot[2] - tool[2], "face_x_m": at[0] + size[0] / 2, "face_z_m": at[2],
            "pad_width_m": size[1], "pad_depth_m": size[2], "tip_beyond_tool_m": pivot[2] - tool[2] + at[2] + size[2] / 2}


def array(values):
    return "{" + ", ".join(repr(v) for v in values) + "}"


def header(urdf, robot):
    yaw, rows = read_dh(robot)
    joints = [read_joint(robot, name) for name in JOINTS]
    jaw = read_jaw(robot)
    capsules = read_capsules(robot)
    fields = list(joints[0])
    lines = [
        f"// The arm's numbers, made of {os.path.basename(urdf)} by generate_arm_geometry.py: edit the URDF instead.",
        "// Frames as in shared/geometry/pose.hpp; a link's frame is its joint's.",
        "#pragma once", "", "#include <array>", "#include <cstddef>", "", "namespace lf::arm_geometry {", "",
        "// Denavit and Hartenberg: RotZ(q + theta_offset_rad) TransZ(d_m) TransX(a_m) RotX(alpha_rad). The last row ends in the tool frame.",
        "struct DhRow {", "  double a_m, alpha_rad, d_m, theta_offset_rad;", "};",
        "inline constexpr std::array<DhRow, 4> dh{{"] + [f"    {array(row)}," for row in rows] + [
        "}};", f"inline constexpr double mount_yaw_rad = {yaw!r};  // base_from_arm = RotZ(mount_yaw_rad)", "",
        "// Limits, drive and actuator of a joint; shared/arm/arm_description.hpp says what each means.",
        "struct JointNumbers {", "  double " + ", ".join(fields) + ";", "};",
        f"inline constexpr std::array<JointNumbers, {len(joints)}> joints{{{{"]
    lines += [f"    {array(joint.values())},  // {name}" for name, joint in zip(JOINTS, joints)]
    lines += ["}};", "", "// parent_from_joint of slew, shoulder, elbow, roll, jaw (finger_a) and finger_b; rotation row by row.",
              "struct Transform {", "  std::array<double, 9> rotation;", "  std::array<double, 3> translation_m;", "};",
              "inline constexpr std::array<Transform, 6> joint_origins{{"]
    for name in JOINTS + ["finger_b"]:
        rotation, at = origin(robot.named("joint", name))
        lines.append(f"    {{{array(sum(rotation, []))}, {array(at)}}},")
    lines += ["}};", "", "// The jaw in the tool frame's x-z plane: finger_a turns about -y at (pivot_x_m, pivot_z_m), its pad's face lies (face_x_m, face_z_m) from there",
              "// at jaw angle 0 and looks along +x; finger_b is its mirror image. Pads are pad_width_m along y and pad_depth_m along z.",
              "struct JawNumbers {", "  double " + ", ".join(jaw) + ";", "};", f"inline constexpr JawNumbers jaw{array(jaw.values())};", "",
              "// Capsules that contain the collision shapes of the moving links: link (its BodyId), ends in the link's frame, radius.",
              "struct CapsuleNumbers {", "  std::size_t link;", "  std::array<double, 3> a_m, b_m;", "  double radius_m;", "};",
              f"inline constexpr std::array<CapsuleNumbers, {len(capsules)}> capsules{{{{"]
    lines += [f"    {{{link}, {array(a)}, {array(b)}, {radius!r}}}," for link, a, b, radius in capsules]
    return "\n".join(lines + ["}};", "", "}  // namespace lf::arm_geometry", ""])


def main():
    if len(sys.argv) != 3:
        print("usage: generate_arm_geometry.py URDF HEADER", file=sys.stderr)
        return 2
    try:
        text = header(sys.argv[1], parse(sys.argv[1]))
        os.makedirs(os.path.dirname(os.path.abspath(sys.argv[2])), exist_ok=True)
        with open(sys.argv[2], "w", encoding="utf-8") as stream:
            stream.write(text)
    except BadUrdf as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{sys.argv[2]}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
