"""Verification: frequency responses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import warpffrf as wf
from references.closed_forms import PointContact, contact_modulus
from references.finite_elements.jointed_frame import frame_response
from scenes import responses
from studies.validate.case import Row, case

ROOM = "Frequency responses"
FRAME_FREQUENCIES = (0.0, 100.0, 200.0, 300.0, 450.0, 600.0, 1000.0, 1400.0, 1900.0)  # Hz
ROLLER_FREQUENCIES = (0.0, 100.0, 300.0, 500.0, 700.0, 1000.0, 1500.0, 3000.0, 5000.0)  # Hz; resonances: rows
MORE, LESS = 1.001, 0.999  # of the load: the equilibria whose difference is the stiffness of a contact
Z = (0.0, 0.0, 1.0)


def _off(found: np.ndarray, exact: np.ndarray) -> float:
    """The largest difference of responses (r, f) at any frequency, over the largest response there."""
    return float((np.abs(found - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())


@case(ROOM, "Direct solution with all elements (hex27, scikit-fem, dense matrices), below to above 7 resonances")
def jointed_frame_response() -> Iterator[Row]:
    """A frame of two flexible arms of 200 x 20 x 15 mm, clamped, on a hinge, and held by a damped bushing: response of
    hinge and far end, in three directions each, to forces at each"""
    f = np.array(FRAME_FREQUENCIES)
    exact = frame_response(responses.ARM, responses.STIFFNESS, responses.DAMPING, f)
    scene, ports = responses.frame()
    modes = wf.eigenmodes(scene, 8, progress=False)
    axes = np.eye(3)
    seen = [(port, e) for port in ports for e in axes]
    for p, place in enumerate(("hinge", "far end")):
        for i, axis in enumerate("xyz"):
            found = modes.frequency_response((ports[p], axes[i]), seen, f).receptance
            off = _off(found, exact[:, :, p, i].reshape(6, -1))
            yield Row(f"force on the {place} along {axis}: responses off by", off, 0.0, 1e-3, scale=1.0)
            if i == 1:
                for n in (0, 2, 7):
                    mine, theirs = abs(found[3 * p + 1, n]), abs(exact[p, 1, p, 1, n])
                    yield Row(f"{place}, along y, {f[n]:g} Hz", mine, theirs, 1e-3, "m/N")


@case(ROOM, "Two masses and Hertz's contact, k = 3/2 F/delta; and with the stiffness between equilibria at two loads")
def roller_response() -> Iterator[Row]:
    """Two crossed rollers pressed together by 2 kN, half-spaces with 71 x 71 cells, the lower on a damped bed:
    responses from 0 to 5 kHz, below, between and above the two resonances"""
    f = np.array(ROLLER_FREQUENCIES)
    scene, ports = responses.rollers()
    modes = wf.eigenmodes(scene, 2, progress=False)
    seen = [(port, Z) for port in ports]
    found = np.stack([modes.frequency_response(force, seen, f).receptance for force in seen], axis=1)
    hertz = PointContact(responses.LOAD, responses.RADIUS, contact_modulus(responses.STEEL, responses.STEEL))
    apart = []
    for load in (MORE * responses.LOAD, LESS * responses.LOAD):
        at_rest = wf.equilibrium(responses.rollers(load)[0], progress=False)
        lower, upper = (at_rest.joint(f"guide {name}").coordinate[-1] for name in ("lower", "upper"))
        apart.append(upper - lower)
    closed, between = 1.5 * responses.LOAD / hertz.approach, (MORE - LESS) * responses.LOAD / (apart[1] - apart[0])
    static = np.real(found[:, :, 0])
    linear = 1.0 / (static[1, 1] - static[0, 1])
    yield Row("stiffness of the contact", linear, closed, 1e-3, "N/m")
    yield Row("stiffness of the contact, of equilibria", linear, between, 1e-3, "N/m")
    root = np.sqrt(np.array(responses.MASSES))
    K = np.array([[responses.BED + closed, -closed], [-closed, closed]]) / np.outer(root, root)
    for n, theirs in enumerate(np.sqrt(np.linalg.eigvalsh(K)) / (2.0 * np.pi)):
        yield Row(f"resonance {n + 1}, Hertz", abs(modes.eigenvalues[n]) / (2.0 * np.pi), theirs, 1e-3, "Hz")
    for stiffness, name in ((closed, "Hertz"), (between, "equilibria")):
        exact = responses.two_masses(stiffness, f)
        for p, place in enumerate(("lower", "upper")):
            off = _off(found[:, p], exact[:, p])
            yield Row(f"{name}, force on the {place} roller: responses off by", off, 0.0, 1e-3, scale=1.0)
