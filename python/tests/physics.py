"""The equations of motion once more, by moving bodies about: velocities of each link from the geometry, forces from its drag.

Nothing here comes from the wheel, and nothing is simplified, so that an agreement means something.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Robot(NamedTuple):
    """Links (middle, front, back), each with its c_t over the viscosity; chi = c_n/c_t; sphere on the middle link."""

    links: tuple[float, float, float]
    c_t: tuple[float, float, float]
    chi: float
    sphere: float

    def resistance(self, phi: Floats) -> Floats:
        """The 5 × 5 matrix of generalised drag over (v_x, v_y, θ̇, φ̇₁, φ̇₂) at θ = 0."""
        l0, l1, l2 = self.links
        one, two = phi[0], np.pi - phi[1]
        turned = [np.array([np.cos(angle), np.sin(angle)]) for angle in (0.0, one, two)]
        normal = [np.array([-t[1], t[0]]) for t in turned]
        ahead = turned[0]
        # Centre of each link, and each body's angular velocity, as rows over the five rates.
        spin = [np.array([0, 0, 1.0, 0, 0]), np.array([0, 0, 1.0, 1, 0]), np.array([0, 0, 1.0, 0, -1])]
        slide = np.zeros((2, 5))
        slide[:, :2] = np.eye(2)
        velocity = [slide]
        for link, end, length in ((1, l0 / 2, l1), (2, -l0 / 2, l2)):
            joint = slide + end * np.outer(_turn(ahead), spin[0])
            velocity.append(joint + length / 2 * np.outer(_turn(turned[link]), spin[link]))
        total = np.zeros((5, 5))
        for link in range(3):
            length, c_t = self.links[link], self.c_t[link]
            along, across = turned[link] @ velocity[link], normal[link] @ velocity[link]
            total += c_t * length * np.outer(along, along)
            total += self.chi * c_t * length * np.outer(across, across)
            total += self.chi * c_t * length**3 / 12 * np.outer(spin[link], spin[link])
        total += 6 * np.pi * self.sphere * velocity[0].T @ velocity[0]
        total += 8 * np.pi * self.sphere**3 * np.outer(spin[0], spin[0])
        return total

    def connection(self, phi: Floats) -> Floats:
        """A: no net force or torque on the body."""
        drag = self.resistance(phi)
        return np.asarray(-np.linalg.solve(drag[:3, :3], drag[:3, 3:]), dtype=np.float64)

    def power(self, phi: Floats) -> Floats:
        """W: what the joints' motors give."""
        drag = self.resistance(phi)
        motion = np.vstack([self.connection(phi), np.eye(2)])
        return np.asarray(motion.T @ drag @ motion, dtype=np.float64)


def _turn(vector: Floats) -> Floats:
    return np.array([-vector[1], vector[0]])
