r"""Two-node Timoshenko beams: exact stiffness of the uniform beam, consistent mass.

Axes: e_x along the beam, e_y in the plane of e_x and the given direction, e_z = e_x x e_y. In each plane of bending,
with `phi = 12 E I/(k G A L^2)` (0 without shear), ends 1 and 2, xi = x/L and the rotation theta = w' - gamma, the
solution of the unloaded beam is (Przemieniecki 1968, Theory of Matrix Structural Analysis, ch. 5 and 11)

    w = N . (w_1, theta_1, w_2, theta_2),
    N (1 + phi) = (1 - 3 xi^2 + 2 xi^3 + phi (1 - xi),  L (xi - 2 xi^2 + xi^3 + phi (xi - xi^2)/2),
                   3 xi^2 - 2 xi^3 + phi xi,            L (-xi^2 + xi^3 - phi (xi - xi^2)/2)),
    theta (1 + phi) = (6 (xi^2 - xi)/L,  1 - 4 xi + 3 xi^2 + phi (1 - xi),  6 (xi - xi^2)/L,  3 xi^2 - 2 xi + phi xi),

so that nodal values of static loads at nodes are exact for one element. Stretch and twist are linear.

Mass points: four stations of the Gauss rule along the beam, exact for the cubic, with four points of the section each,
at +-root(2 I_z/A) along y and +-root(2 I_y/A) along z: area, both second moments, and the polar one I_y + I_z.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.structure import Beam
from warpffrf.offline.structure.shell import skew

Array = np.ndarray
Y, Z = (1, 5, 7, 11), (2, 4, 8, 10)  # freedoms of bending along y and along z
PARALLEL = 1e-6  # sine of the angle between a beam and its direction


class BeamElements:
    """Beams with node positions `x` (e, 2, 3) [m], the elements `here` of the part `beam`."""

    def __init__(self, x: Array, beam: Beam, here: slice) -> None:
        self.x, self.beam = x, beam
        self.offset, given = beam.offset[here], beam.direction[here]
        along = x[:, 1] - x[:, 0]
        self.length = np.linalg.norm(along, axis=1)
        bad = np.flatnonzero(~(self.length > 0.0))
        if len(bad):
            raise InputError(f"beam {beam.name!r}: element {bad[0]} has no length; merge its nodes and leave it out")
        e_x = along / self.length[:, None]
        direction = given / np.linalg.norm(given, axis=1)[:, None]
        e_z = np.cross(e_x, direction)
        sine = np.linalg.norm(e_z, axis=1)
        bad = np.flatnonzero(sine < PARALLEL)
        if len(bad):
            raise InputError(
                f"beam {beam.name!r}: element {bad[0]} is parallel to direction {given[bad[0]].tolist()}, which then "
                "does not define the section's y axis; give another direction"
            )
        e_z /= sine[:, None]
        self.axes = np.stack([e_x, np.cross(e_z, e_x), e_z], axis=1)  # (e, 3, 3), rows
        s, material = beam.section, beam.material
        E, G = material.youngs_modulus, 0.5 * material.youngs_modulus / (1.0 + material.poisson_ratio)
        self.E, self.G = E, G

        def phi(moment: float, factor: float) -> Array:
            return 12.0 * E * moment / (factor * G * s.area * self.length**2) if factor else 0.0 * self.length

        self.phi_y, self.phi_z = phi(s.I_z, s.shear_y), phi(s.I_y, s.shear_z)  # deflection along y, along z

    def to_local(self) -> Array:
        """(e, 12, 12): freedoms of the centroid's ends in local axes from those of the nodes."""
        e = len(self.x)
        S = np.zeros((e, 12, 12))
        arm = -skew(self.offset)  # theta x a
        for node in (0, 6):
            S[:, node : node + 3, node : node + 3] = self.axes
            S[:, node : node + 3, node + 3 : node + 6] = self.axes @ arm
            S[:, node + 3 : node + 6, node + 3 : node + 6] = self.axes
        return S

    def stiffness(self) -> Array:
        """K (e, 12, 12) of the nodes."""
        s, L, e = self.beam.section, self.length, len(self.x)
        K = np.zeros((e, 12, 12))
        for i, k in ((0, self.E * s.area / L), (3, self.G * s.J / L)):
            K[:, i, i] = K[:, i + 6, i + 6] = k
            K[:, i, i + 6] = K[:, i + 6, i] = -k
        for dofs, moment, phi, sign in ((Y, s.I_z, self.phi_y, 1.0), (Z, s.I_y, self.phi_z, -1.0)):
            c = self.E * moment / (L**3 * (1.0 + phi))
            b = np.zeros((e, 4, 4))
            signs = np.array([1.0, sign, 1.0, sign])  # theta_y = -w'
            b[:, 0, 0], b[:, 0, 1], b[:, 0, 2], b[:, 0, 3] = 12 * c, 6 * L * c, -12 * c, 6 * L * c
            b[:, 1, 1], b[:, 1, 2], b[:, 1, 3] = (4 + phi) * L**2 * c, -6 * L * c, (2 - phi) * L**2 * c
            b[:, 2, 2], b[:, 2, 3], b[:, 3, 3] = 12 * c, -6 * L * c, (4 + phi) * L**2 * c
            b += np.triu(b, 1).swapaxes(1, 2)
            K[np.ix_(range(e), dofs, dofs)] += b * np.outer(signs, signs)
        S = self.to_local()
        return S.swapaxes(1, 2) @ K @ S

    def axis_motion(self, xi: float) -> Array:
        """Displacement and rotation (e, 6, 12) at xi, local axes, from the local freedoms of the ends."""
        L, e = self.length, len(self.x)
        H = np.zeros((e, 6, 12))
        for i in (0, 3):
            H[:, i, i], H[:, i, i + 6] = 1.0 - xi, xi
        for w, theta, dofs, phi, sign in ((1, 5, Y, self.phi_y, 1.0), (2, 4, Z, self.phi_z, -1.0)):
            shear = 0.5 * phi * (xi - xi**2)
            N = [
                1 - 3 * xi**2 + 2 * xi**3 + phi * (1 - xi),
                L * (xi - 2 * xi**2 + xi**3 + shear),
                3 * xi**2 - 2 * xi**3 + phi * xi,
                L * (-(xi**2) + xi**3 - shear),
            ]
            slope = 6 * (xi**2 - xi) / L
            turn = [slope, 1 - 4 * xi + 3 * xi**2 + phi * (1 - xi), -slope, 3 * xi**2 - 2 * xi + phi * xi]
            for dof, a, b, s in zip(dofs, N, turn, (1.0, sign, 1.0, sign), strict=True):
                H[:, w, dof] = s * a / (1.0 + phi)
                H[:, theta, dof] = sign * s * b / (1.0 + phi)
        return H

    def corners(self) -> tuple[Array, Array]:
        """Of the rectangle of the same area moments at both ends: positions (e, 8, 3) [m], motion (e, 8, 3, 12)."""
        s, S = self.beam.section, self.to_local()
        y, z = np.sqrt(3.0 * s.I_z / s.area), np.sqrt(3.0 * s.I_y / s.area)
        places, motions = [], []
        for end in (0, 1):
            for d in ((0.0, y, z), (0.0, -y, z), (0.0, -y, -z), (0.0, y, -z)):
                at = slice(6 * end, 6 * end + 3), slice(6 * end + 3, 6 * end + 6)
                local = S[:, at[0]] - skew(np.array(d)) @ S[:, at[1]]
                places.append(self.x[:, end] + self.offset + np.array(d) @ self.axes)
                motions.append(self.axes.swapaxes(1, 2) @ local)
        return np.stack(places, 1), np.stack(motions, 1)

    def mass_points(self) -> tuple[Array, Array, Array]:
        """Positions (e, 16, 3) [m], masses (e, 16) [kg], and motion (e, 16, 3, 12) per freedom of the nodes."""
        s = self.beam.section
        y, z = np.sqrt(2.0 * s.I_z / s.area), np.sqrt(2.0 * s.I_y / s.area)
        S = self.to_local()
        stations, weights = np.polynomial.legendre.leggauss(4)
        places, masses, motions = [], [], []
        for station, weight in zip(0.5 + 0.5 * stations, 0.5 * weights, strict=True):
            centre = (1 - station) * self.x[:, 0] + station * self.x[:, 1] + self.offset
            H = self.axis_motion(station) @ S
            for d in ((0.0, y, 0.0), (0.0, -y, 0.0), (0.0, 0.0, z), (0.0, 0.0, -z)):
                local = H[:, :3] - skew(np.array(d)) @ H[:, 3:]
                places.append(centre + np.array(d) @ self.axes)
                masses.append(0.25 * weight * self.beam.material.density * s.area * self.length)
                motions.append(self.axes.swapaxes(1, 2) @ local)
        return np.stack(places, 1), np.stack(masses, 1), np.stack(motions, 1)
