"""The generators themselves: energy, convergence, sticking, reproducibility.

python -m unittest discover -s tools -t tools
"""

import unittest

import numpy as np

from . import axis, cases, channels, machine, operating, sizes, wide
from .balance import Bench
from .control import Controllers
from .laws import catalogue
from .loads import KINDS as LOADS
from .loads import Loads
from .measuring import ColouredLoad
from .stepping import run

PERIOD = 1e-3


def still(sample, substep):
    return 0.0


def bench(count=4, **more):
    rng = np.random.default_rng(5)
    machines, _ = machine.draw(rng, count)
    return Bench(machine=machines, laws=[], creep=np.zeros(count), **more)


def swinging(machines, samples):
    t = np.arange(samples)[:, None] * PERIOD
    return 0.4 * machines.volts * np.sin(2 * np.pi * 1.5 * t)


class Stepping(unittest.TestCase):
    def test_energy_is_kept(self):
        """What goes in is stored, or lost to resistance and friction."""
        here = bench()
        m, u = here.machine, swinging(here.machine, 2000)
        h = PERIOD / 10
        # Sampled every sub-step, so that the integrals are accurate.
        fine = run(here, np.repeat(u, 10, axis=0), still, h)
        stored = 0.5 * m.L * fine.i[-1] ** 2 + 0.5 * m.J * fine.w[-1] ** 2
        middle = 0.5 * (fine.i[1:] + fine.i[:-1])
        speed = 0.5 * (fine.w[1:] + fine.w[:-1])
        given = (fine.u[:-1] * middle).sum(axis=0) * h
        lost = (m.R * middle**2 + m.B * speed**2 + m.T_c * np.abs(speed)).sum(axis=0) * h
        # The trapezoidal rule on a path with corners at every sample.
        np.testing.assert_allclose(given, stored + lost, rtol=2e-4)

    def test_a_shorter_step_changes_little(self):
        """For every law, through sticking and reversals."""
        ids = [id for id, law in catalogue().items()]
        runs = [
            cases.make(cases.Plan(ids, seed=3, noise="none", samples=500), substeps=n)
            for n in (10, 30)
        ]
        for k, id in enumerate(ids):
            omega = [made[k].recordings["estimation"]["omega"] for made in runs]
            error = np.sqrt(np.mean((omega[0] - omega[1]) ** 2)) / np.abs(omega[1]).max()
            # A tenth of the smallest noise level. Backlash amplifies the timing of its contacts.
            self.assertLess(error, 1e-3 if id == "backlash" else 1e-4, id)

    def test_a_shaft_below_break_away_stays(self):
        here = bench()
        m = here.machine
        below = np.tile(0.95 * m.T_c / m.K * m.R, (500, 1))
        held = run(here, below, still, PERIOD)
        self.assertEqual(np.abs(held.w).max(), 0.0)
        above = run(here, below / 0.95 * 1.05, still, PERIOD)
        self.assertTrue((above.w[-1] > 0.0).all())

    def test_dry_friction_alone_stops_a_shaft_on_time(self):
        """J dw/dt = -T_c from w_0, without current: stops after J w_0 / T_c."""
        here = bench(force=True)
        m = here.machine
        m.B = np.zeros_like(m.B)
        push = 3.0 * m.T_c / m.K
        u = np.where(np.arange(400)[:, None] < 100, push, 0.0)
        trace = run(here, u, still, PERIOD)
        peak = 0.1 * 2.0 * m.T_c / m.J
        np.testing.assert_allclose(trace.w[100], peak, rtol=1e-9)
        # Two pushes' worth of speed against one of friction: at rest 0.2 s later.
        np.testing.assert_allclose(trace.w[200], 0.5 * peak, rtol=1e-9)
        self.assertEqual(np.abs(trace.w[302:]).max(), 0.0)


class Made(unittest.TestCase):
    def test_the_same_seed_gives_the_same_bytes(self):
        plan = cases.Plan([None, "cogging"], seed=11, coloured=True, samples=300)
        first, second = cases.make(plan), cases.make(plan)
        for one, other in zip(first, second, strict=True):
            for kind in cases.KINDS:
                for name, values in one.recordings[kind].items():
                    self.assertEqual(values.tobytes(), other.recordings[kind][name].tobytes())
        plan.seed = 12
        third = cases.make(plan)[0].recordings["estimation"]["omega"]
        self.assertFalse(np.array_equal(third, first[0].recordings["estimation"]["omega"]))

    def test_a_neighbour_with_an_effect_changes_nothing(self):
        """Machines are stepped together, but each for itself."""
        ids = list(catalogue())
        plain = speeds_with([None] * len(ids))
        for k in range(len(ids)):
            hidden = [ids[j] if j != k else None for j in range(len(ids))]
            if k % 8 == 0:
                mixed = speeds_with(hidden, 400)
                np.testing.assert_allclose(mixed[:, k], plain[:400, k], rtol=1e-12, atol=1e-12)

    def test_every_law_that_can_be_seen_is_seen(self):
        """At its usual size it moves the outputs by more than the medium noise."""
        # The touch comes after the end of this run.
        balanced = [id for id, law in catalogue().items() if law.add is not None]
        ids = [id for id in balanced if id != "x_touch"]
        plain, hidden = speeds_with([None] * len(ids)), speeds_with(ids)
        moved = np.sqrt(np.mean((hidden - plain) ** 2, axis=0)) / np.abs(plain).max(axis=0)
        for id, share in zip(ids, moved, strict=True):
            self.assertGreater(share, 1e-3, id)

    def test_a_coloured_load_has_the_stated_spread_and_memory(self):
        load = ColouredLoad(np.random.default_rng(2), np.full(400, 2.0), np.full(400, 0.05), 1e-3)
        values = np.array([load(k, 0) for k in range(2000)])
        self.assertAlmostEqual(values.std(), 2.0, delta=0.05)
        after = (values[50:] * values[:-50]).mean() / values.var()
        self.assertAlmostEqual(after, np.exp(-1.0), delta=0.03)

    def test_an_axis_follows_its_path(self):
        made = axis.make([None, "asymmetric_friction"], seed=4, samples=2000)
        for case in made:
            x = case.recordings["estimation"]["x"]
            self.assertGreater(np.ptp(x), 0.02)
            self.assertLess(np.abs(x).max(), 0.2)


class Wide(unittest.TestCase):
    def test_a_gear_turns_as_its_motor_does(self):
        """Seen from the slow shaft the machine is another, and its motion the motor's over n."""
        rng = np.random.default_rng(3)
        m, _ = sizes.motor(rng)
        with_gear, n = sizes.geared(rng, m)
        with_gear.T_c = n * m.T_c
        carriage, r = sizes.axis(rng, m)
        all_ = sizes.together([m, with_gear, carriage])
        here = Bench(machine=all_, laws=[], creep=np.zeros(3))
        w = run(here, swinging(all_, 1000), still, PERIOD).w
        np.testing.assert_allclose(w[:, 1], w[:, 0] / n, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(w[:, 2], w[:, 0] * r, rtol=1e-9, atol=1e-9)

    def test_motors_of_all_sizes_are_motors(self):
        rng = np.random.default_rng(1)
        drawn = [sizes.motor(rng) for _ in range(300)]
        watts = np.array([watts for _, watts in drawn])
        self.assertLess(watts.min(), 3.0)
        self.assertGreater(watts.max(), 3e3)
        m = sizes.together([m for m, _ in drawn])
        # The rated current loses a share of the voltage, and turns against a share of the torque.
        self.assertTrue((m.R * m.amps < 0.6 * m.volts).all())
        self.assertTrue((m.T_c + m.B * m.top_speed < 0.25 * m.rated_torque).all())

    def test_every_load_has_the_stated_spread_and_memory(self):
        n, sd, slow, h = 400, 2.0, 0.05, 1e-3
        memories = {
            "ornstein_uhlenbeck": np.exp(-1.0),
            "telegraph": np.exp(-1.0),
            "shots": np.exp(-1.0),
            # A whole turn of its phase.
            "oscillation": np.exp(-1.0 / 3.0),
            "sine": -1.0,
        }
        for kind in LOADS:
            rng = np.random.default_rng(2)
            load = Loads(rng, [kind] * n, np.full(n, sd), np.full(n, slow), h)
            values = np.array([load(k, 0).copy() for k in range(2000)])
            if kind == "random_walk":
                self.assertAlmostEqual(values[1000].std() / sd, 1.0, delta=0.15)
                self.assertEqual(np.abs(values[0]).max(), 0.0)
                continue
            self.assertAlmostEqual(values[500:].std() / sd, 1.0, delta=0.06, msg=kind)
            lag = (values[550:] * values[500:-50]).mean() / values[500:].var()
            self.assertAlmostEqual(lag, memories[kind], delta=0.06, msg=kind)

    def test_closed_loops_follow(self):
        """By voltage and by current, in speed and in position, sampled fast and slowly."""
        modes = np.array(["speed", "speed", "position", "position"] * 2)
        force = np.array([False, True] * 4)
        every = np.array([1] * 4 + [10] * 4)
        one, _ = sizes.motor(np.random.default_rng(6))
        all_ = sizes.together([one] * 8)
        t = np.arange(3000) * PERIOD
        wave = np.sin(2 * np.pi * 0.5 * t)[:, None]
        asked = np.where(modes == "speed", 0.3, 0.1 * one.volts / one.K) * wave
        rng = np.random.default_rng(1)
        control = Controllers(all_, force, modes, asked, every, PERIOD, 0.0, rng)
        here = Bench(machine=all_, laws=[], creep=np.zeros(8), force=force)
        trace = run(here, control, still, PERIOD)
        shown = np.where(modes == "speed", trace.w / all_.top_speed, trace.theta)[1000:]
        off = np.sqrt(np.mean((shown - asked[1000:]) ** 2, axis=0))
        share = off / np.sqrt(np.mean(asked[1000:] ** 2, axis=0))
        self.assertLess(share.max(), 0.35, share)
        for lane in range(4, 8):
            changes = np.flatnonzero(np.diff(trace.u[:, lane])) + 1
            self.assertTrue((changes % 10 == 0).all())

    def test_operating_points_are_what_they_say(self):
        rng, t = np.random.default_rng(4), np.arange(4000) * PERIOD
        m, _ = sizes.motor(rng)
        for point in (operating.one_direction, operating.high_speed, operating.one_way_loop):
            _, asked = point(rng, t, m)
            self.assertTrue((np.sign(asked) == np.sign(asked[0])).all(), point.__name__)
        _, high = operating.high_speed(rng, t, m)
        self.assertGreater(np.abs(high).min(), 0.6)
        _, low = operating.low_speed(rng, t, m)
        self.assertLess(np.abs(low).max(), 0.05)
        mode, path = operating.position_loop(rng, t, m)
        self.assertEqual(mode, "position")
        self.assertLess(np.abs(np.diff(path)).max() / PERIOD, m.top_speed)

    def test_sensors_show_what_is_stated(self):
        t = np.arange(2000) * PERIOD
        wave = np.sin(20.0 * t)
        late = channels.late(t, wave, 2.5e-3)
        np.testing.assert_allclose(late[10:], np.sin(20.0 * (t[10:] - 2.5e-3)), atol=1e-4)
        speed = channels.differences(wave, 1e-3, PERIOD)
        self.assertLess(np.abs(speed[1:] - 20.0 * np.cos(20.0 * t[1:])).max(), 1.5)
        steps = speed / (1e-3 / PERIOD)
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)

    def test_a_plan_holds_all_kinds_and_says_so(self):
        hidden = [None, "cogging", "stribeck", "saturation", "x_touch", "delay"] * 10
        plan = wide.Plan(hidden, seed=9, lasts=0.1)
        made = wide.make(plan)
        truths = [case.truth for case in made]
        self.assertEqual([truth["hidden"] for truth in truths], hidden)
        for key, values in {
            "kind": set(wide.KIND_SHARES),
            "motion": {"rotary", "linear"},
            "input": {"voltage", "current"},
            "speed_from": {"sensor", "differences", None},
            "zero_speed": {"smooth", "stick"},
        }.items():
            self.assertEqual({truth[key] for truth in truths}, values, key)
        self.assertGreater(len({truth["rate_hz"] for truth in truths}), 6)
        kinds = {truth["load"]["kind"] for truth in truths if truth["load"]}
        self.assertEqual(kinds, set(LOADS))
        self.assertTrue(any(truth["skew_s"] > 0.0 for truth in truths))
        points = {point for truth in truths for point in truth["operating"].values()}
        self.assertEqual(
            points, {it.__name__ for it in operating.BY_VOLTAGE + operating.BY_CURRENT}
        )
        for case in made:
            shown = case.recordings["estimation"]
            self.assertAlmostEqual(case.period * case.truth["rate_hz"], 1.0)
            motion = {"v", "x"} if case.motion == "linear" else {"omega", "theta"}
            self.assertTrue(motion & set(shown), case.truth)
            self.assertEqual(set(case.truth["noise"]["estimation"]), set(shown) - {"u"})
            for values in shown.values():
                self.assertTrue(np.isfinite(values).all(), case.truth)

    def test_the_same_seed_gives_the_same_bytes(self):
        plan = wide.Plan([None, "cogging", "stribeck"], seed=2, lasts=0.05)
        for one, other in zip(wide.make(plan), wide.make(plan), strict=True):
            for name, values in one.recordings["validation"].items():
                self.assertEqual(values.tobytes(), other.recordings["validation"][name].tobytes())


def speeds_with(ids, samples=1000):
    """Speeds of the same machines under the same input with these hidden, (samples, machines)."""
    laws = catalogue()
    rng = np.random.default_rng(8)
    machines, _ = machine.draw(rng, len(ids))
    drawn = []
    for k, id in enumerate(ids):
        law = laws[id] if id else None
        own = np.random.default_rng(100 + k)
        drawn.append((id, law.draw(own, machines.take(k), law.size) if law else {}))
    here = cases._bench(machines, cases._gather(drawn, laws), laws, np.zeros(len(ids)))
    return run(here, swinging(machines, samples), still, PERIOD).w


if __name__ == "__main__":
    unittest.main()
