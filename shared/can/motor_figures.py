"""The figures of a drive that follow from its joint in the arm's URDF, as can_map.yaml defines them."""
import math

MARGIN_RAD = 0.01
COUNTS_PER_REV = 64  # a hall sensor's 16 lines


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

    def most_counts_per_rad(self):
        lower, upper = self.joint["lower_rad"], self.joint["upper_rad"]
        return max(abs(self.counts_per_rad(lower + (upper - lower) * i / 64)) for i in range(65))

    def rated_torque_mnm(self):
        """At the motor's shaft: what gives the joint its rated torque where the gear has the most lever, driving a load. As shared/arm/motor.cpp."""
        j = self.joint
        ratio = self.most_counts_per_rad() / COUNTS_PER_REV * 2 * math.pi
        return max(1, rounded(1000 * j["rated_torque_nm"] / (ratio * j["efficiency"] * (1 - j["coulomb_share"]))))

    def figures(self):
        j = self.joint
        lower, upper = j["lower_rad"], j["upper_rad"]
        most = self.most_counts_per_rad()
        ends = sorted((self.counts(lower - MARGIN_RAD), self.counts(upper + MARGIN_RAD)))
        low, high = rounded(ends[0]), rounded(ends[1])
        velocity = max(1, rounded(j["velocity_rad_s"] * most))
        return {"stroke_low": low, "stroke_high": high, "following_window": max(50, (high - low) // 20),
                "velocity": velocity, "velocity_back": -velocity, "cruise": velocity // 2 + 1,
                "creep": max(1, rounded(2 * j["stiction_rad_s"] * most)),
                "acceleration": max(1, rounded(j["acceleration_rad_s2"] * most)),
                "peak_torque": rounded(1000 * j["effort_nm"] / j["rated_torque_nm"]),
                "rated_torque": self.rated_torque_mnm(), "water": 120}

    def position_scale(self):
        """(physical value of a count, unit): a geared joint turns, a screw grows."""
        return (1 / self.joint["counts_per_m"], "m") if self.screw else (1 / self.joint["counts_per_rad"], "rad")

    def torque_scale(self):
        return (self.rated_torque_mnm() / 1e6, "N m")
