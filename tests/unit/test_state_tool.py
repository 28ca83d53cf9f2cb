#!/usr/bin/python3
"""Decoupling by state feedback from Python: what libreflux.so gives, against numpy.

usage: test_state_tool.py LIBRARY
"""
import sys
import unittest
from pathlib import Path

import numpy as np
from scipy.linalg import expm

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import libreflux, state_decoupler  # noqa: E402

A = np.array([[-1.0, 0.5, 0.0], [0.25, -2.0, 0.5], [0.0, 0.5, -0.75]])
B = np.array([[1.0, 0.25], [0.5, 0.5], [0.0, 1.0]])
C = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
E = np.array([[0.5], [0.25], [0.125]])


class StateTool(unittest.TestCase):
    def test_poles_and_zeros_are_the_eigenvalues_of_the_closed_loop(self):
        found = state_decoupler.design(A, B, C, E, [[-2.0], [-3.0]])
        self.assertEqual(found.index.tolist(), [0, 0])
        wanted = np.sort(np.concatenate([[-2.0, -3.0], found.zeros.real]))
        np.testing.assert_allclose(np.sort(np.linalg.eigvals(A + B @ found.f).real), wanted, atol=1e-12)

    def test_the_gain_at_rest_is_one(self):
        found = state_decoupler.design(A, B, C, E, [[-2.0], [-3.0]])
        np.testing.assert_allclose(-C @ np.linalg.solve(A + B @ found.f, B @ found.g), np.eye(2), atol=1e-12)
        np.testing.assert_allclose(found.k_star, [2.0, 3.0], rtol=1e-12)

    def test_feedforward_by_outputs_keeps_a_disturbance_out_and_by_states_is_least_squares(self):
        by_outputs = state_decoupler.design(A, B, C, E, [[-2.0], [-3.0]], feedforward="outputs")
        left = -C @ np.linalg.solve(A + B @ by_outputs.f, E + B @ by_outputs.tf)
        np.testing.assert_allclose(left, 0.0, atol=1e-12)
        by_states = state_decoupler.design(A, B, C, E, [[-2.0], [-3.0]], feedforward="states")
        np.testing.assert_allclose(by_states.tf, -np.linalg.lstsq(B, E, rcond=None)[0], atol=1e-12)

    def test_a_sampled_model_is_the_matrix_exponential(self):
        a, b, e = state_decoupler.sample(A, B, E, 0.5)
        both = np.zeros((6, 6))
        both[:3, :3], both[:3, 3:5], both[:3, 5:] = A, B, E
        whole = expm(0.5 * both)
        np.testing.assert_allclose(np.hstack([a, b, e]), whole[:3], atol=1e-13)

    def test_what_is_refused_comes_with_its_reason_and_what_was_found(self):
        with self.assertRaises(state_decoupler.StateRefused) as caught:
            state_decoupler.design(A, B, C, E, [[-10.0], [-3.0]], hold=0.5)
        self.assertIn("hold_s", str(caught.exception))
        self.assertGreater(caught.exception.found.radius, 1.0)
        with self.assertRaises(state_decoupler.StateRefused) as caught:
            state_decoupler.design(A, np.ones((3, 2)), C, E, [[-1.0], [-1.0]])
        self.assertIn("b_star", str(caught.exception))


if __name__ == "__main__":
    libreflux.load(sys.argv.pop(1))
    unittest.main()
