"""Checks tests/machines.py by closed forms: python3 tests/test_machines.py"""

import math
import random
import unittest

import machines


def bare(seed=1):
    """A rig without effects and pieces, and without noise."""
    rig = machines.Rig(random.Random(seed))
    rig.effects, rig.pieces, rig.gust, rig.noise = {}, {}, 0.0, 1e-9
    return rig


def run(rig, drive, seconds):
    move = machines.body(rig, random.Random(0))
    for k in range(round(seconds / machines.STEP_S)):
        x, v = move(drive(k * machines.STEP_S))
    return x, v


class Motion(unittest.TestCase):
    def test_a_bare_rig_rises_to_its_speed_by_its_drag(self):
        rig = bare()
        x, v = run(rig, lambda t: 5.0, 0.7)
        final, decay = 5.0 * rig.gain / rig.drag, math.exp(-0.7 * rig.drag)
        self.assertAlmostEqual(v / (final * (1.0 - decay)), 1.0, delta=1e-3)
        self.assertAlmostEqual(x / (final * (0.7 - (1.0 - decay) / rig.drag)), 1.0, delta=1e-3)

    def test_friction_holds_below_its_force_and_takes_it_away_above(self):
        rig = bare()
        rig.effects["wall_friction"] = {"force": 3.0 * rig.gain}
        self.assertEqual(run(rig, lambda t: 2.9, 0.5), (0.0, 0.0))
        _, v = run(rig, lambda t: 5.0, 0.5)
        free = 2.0 * rig.gain / rig.drag * (1.0 - math.exp(-0.5 * rig.drag))
        self.assertAlmostEqual(v / free, 1.0, delta=2e-3)

    def test_a_pendulum_swings_with_the_frequency_of_its_gravity(self):
        rig = bare()
        rig.drag = 1e-9
        rig.effects["height_dependent_flow"] = {"per_s2": 16.0, "turn": 1e6}
        kick = lambda t: 1.0 if t < 0.01 else 0.0
        quarter = math.pi / 2.0 / 4.0  # ω = 4 1/s
        x, v = run(rig, kick, 0.005 + quarter)
        self.assertAlmostEqual(x / (0.01 * rig.gain / 4.0), 1.0, delta=1e-2)
        self.assertLess(abs(v), 0.02 * 0.01 * rig.gain)


class Actuator(unittest.TestCase):
    def through(self, name, values, u, seconds):
        rig = bare()
        rig.effects[name] = values
        drive = machines.actuator(rig)
        return [drive(u, k * machines.STEP_S) for k in range(round(seconds / machines.STEP_S))]

    def test_dead_zone_limit_delay_and_lag_are_those_of_their_definitions(self):
        self.assertEqual(self.through("dead_zone", {"width": 3.0}, -5.0, 0.01)[-1], -2.0)
        self.assertEqual(self.through("saturation", {"limit": 8.0}, 20.0, 0.01)[-1], 8.0)
        late = self.through("transport_delay", {"delay": 0.05}, 1.0, 0.06)
        self.assertEqual((late[249], late[251]), (0.0, 1.0))
        lagged = self.through("fan_lag", {"tau": 0.1}, 1.0, 0.1)[-1]
        self.assertAlmostEqual(lagged, 1.0 - math.exp(-1.0), delta=1e-3)


class Sensor(unittest.TestCase):
    def test_readings_come_in_steps_and_late(self):
        rig = bare()
        rig.effects["sensor_quantisation"] = {"step": 0.5}
        rig.effects["sensor_delay"] = {"delay": 0.1}
        see, read = machines.sensor(rig, random.Random(0))
        seen = [read(see(3.2)) for _ in range(600)]
        self.assertEqual((seen[498], seen[501]), (0.0, 3.0))


class Truth(unittest.TestCase):
    def test_every_effect_and_piece_can_be_drawn_and_twins_never_meet(self):
        drawn = set()
        for seed in range(400):
            rig = machines.Rig(random.Random(seed))
            drawn |= {*rig.effects, *rig.pieces}
            self.assertFalse(any(len(twins & set(rig.effects)) > 1 for twins in machines.TWINS))
        self.assertEqual(drawn, {*machines.EFFECTS, *machines.PIECES})


if __name__ == "__main__":
    unittest.main()
