"""The figures of a drive that follow from its joint in the arm's URDF, as can_map.yaml defines them."""
import math

MARGIN_RAD = 0.01


def rounded(value):
    """To the nearest integer, halves away from zero, as C's llround."""
    return int(math.copysign(math.floor(abs(value) + 0.5), value))


class Motor:
    """`joint` as generate_arm_geometry.read_joint() gives it."""

    def __init__(self, joint):
        self.joint = joint
        self.screw = joint["pivot_a_m"] != 0.0

    def length_m(self, angle_rad):
        a, b = self.joint["pivot_a_m"], self.joint["pivot_b_m"]
        return math.sqrt(a * a + b * b - 2 * a * b * math.cos(angle_rad + self.joint["offset_rad"]))

    def counts(self, angle_rad):
        if not self.screw:
            return self.joint["counts_per_rad"] * angle_rad
        return self.joint["counts_per_m"] * (self.length_m(angle_rad) - self.length_m(0))

    def counts_per_rad(self, angle_rad):
        if not self.screw:
            return self.joint["counts_per_rad"]
        lever = self.joint["pivot_a_m"] * self.joint["pivot_b_m"] * math.sin(angle_rad + self.joint["offset_rad"]) / self.length_m(angle_rad)
        return self.joint["counts_per_m"] * lever

    def figures(self):
        j = self.joint
        lower, upper = j["lower_rad"], j["upper_rad"]
        most = max(abs(self.counts_per_rad(lower + (upper - lower) * i / 64)) for i in range(65))
        ends = sorted((self.counts(lower - MARGIN_RAD), self.counts(upper + MARGIN_RAD)))
        low, high = rounded(ends[0]), rounded(ends[1])
        velocity = max(1, rounded(j["velocity_rad_s"] * most))
        return {"stroke_low": low, "stroke_high": high, "following_window": max(50, (high - low) // 20),
                "velocity": velocity, "velocity_back": -velocity, "cruise": velocity // 2 + 1,
                "creep": max(1, rounded(2 * j["stiction_rad_s"] * most)),
                "acceleration": max(1, rounded(j["acceleration_rad_s2"] * most)),
                "peak_torque": rounded(1000 * j["effort_nm"] / j["rated_torque_nm"]),
                "rated_torque": rounded(1000 * j["rated_torque_nm"]), "water": 120}

    def position_scale(self):
        """(physical value of a count, unit): a geared joint turns, a screw grows."""
        return (1 / self.joint["counts_per_m"], "m") if self.screw else (1 / self.joint["counts_per_rad"], "rad")

    def torque_scale(self):
        return (self.joint["rated_torque_nm"] / 1000, "N m")
