"""Tests of particles.py on a made-up bed."""

from __future__ import annotations

import unittest

import numpy as np

import particles
from made_up_results import ScriptTest, write_two_particles
from talcum_results import ResultsError

TIMES = np.array([0.0, 1.0, 2.0])


class TestParticles(ScriptTest):
    """Two particles at three times, of which the second rises, faster each time."""

    def setUp(self) -> None:
        super().setUp()
        velocity = np.array([[[0.0, 0.0, 0.0], [3.0, 0.0, 4.0 * time]] for time in TIMES]).reshape(-1, 3)
        data = {
            "velocity": (velocity, "sqrt(g d)"),
            "radius": (np.tile([0.5, 0.25], 3), "d"),
            "class": (np.tile([0, 1], 3), "1"),
            "mass": (np.tile([3.0, 4.0], 3), "rho_s d^3"),
            "force": (np.tile([[3.0, 0.0, -4.0], [0.0, 0.0, 0.0]], (3, 1)), "rho_s g d^3"),
        }
        write_two_particles(self.folder, TIMES, data)

    def test_each_colour_is_what_it_says(self) -> None:
        def last(colour: str) -> list[float]:
            return particles.read_bed(self.folder, colour, None, None).snapshots[-1].value.tolist()

        self.assertEqual(last("speed"), [0.0, (9.0 + 64.0) ** 0.5])
        self.assertEqual(last("rise"), [0.0, 8.0])
        self.assertEqual(last("size"), [1.0, 0.5])
        self.assertEqual(last("mass"), [3.0, 4.0])
        self.assertEqual(last("force"), [5.0, 0.0])
        with self.assertRaisesRegex(ResultsError, "has no agglomerate, only speed, rise, size, class, force, mass"):
            last("agglomerate")

    def test_classes_have_whole_marks_and_outlines(self) -> None:
        self.assertTrue(particles.are_numbers_of_few(np.array([0.0, 1.0, 1.0])))
        for others in ([0.0, 0.5], [0.0, 40.0], []):
            self.assertFalse(particles.are_numbers_of_few(np.array(others)))
        self.call(particles, "--colour", "class")
        self.assert_picture("particles.png")

    def test_a_few_sizes_have_a_colour_each(self) -> None:
        bed = particles.read_bed(self.folder, "size", None, None)
        self.assertEqual((bed.sizes.tolist(), bed.limits), ([0.5, 1.0], (-0.5, 1.5)))
        self.assertEqual(bed.coloured(bed.snapshots[0].value).tolist(), [1.0, 0.0])
        key = particles.draw(bed, 1).axes[-1]
        self.assertEqual([mark.get_text() for mark in key.get_yticklabels()], ["0.5", "1"])
        mass = particles.read_bed(self.folder, "mass", None, None)  # the control: numbers that are no sizes
        self.assertEqual(len(mass.sizes), 0)

    def test_times_are_chosen(self) -> None:
        times = [snapshot.time for snapshot in particles.read_bed(self.folder, "speed", 0.5, 1.5).snapshots]
        self.assertEqual(times, [1.0])
        with self.assertRaisesRegex(ResultsError, "no snapshot at these times"):
            particles.read_bed(self.folder, "speed", 5.0, None)

    def test_deep_beds_are_cut(self) -> None:
        y = np.linspace(0.0, 30.0, 31)
        self.assertEqual(y[particles.section(y, np.ones(31))].tolist(), [11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0])
        self.assertTrue(particles.section(y / 10.0, np.ones(31)).all())

    def test_picture_and_animation(self) -> None:
        animation = self.folder / "bed.gif"
        self.call(particles, "--panels", "2", "--animate", str(animation))
        self.assert_picture("particles.png")
        self.assertEqual(animation.read_bytes()[:4], b"GIF8")


if __name__ == "__main__":
    unittest.main()
