r"""Friction of one contact: tractions, slip, stick and slip areas, creepages, T-gamma, power and wear index.

Tractions tau are constant on cells, those of the first surface's contact grid or those that move with the patch, with
components along (e_theta, t_z) of the first surface, on the first body. `w` is the slip velocity of the first surface
relative to the second, so that friction gives `tau.w <= 0`. Terms: e_theta is the *longitudinal* direction, t_z the
*lateral* one, n = e_theta x t_z the outward normal of the first surface. With the cells' areas A, the mean pressure p
of a node or cell, the mean rolling speed V and creep c and spin omega_n of the first body against the second about the
centre of the patch (`creep`)

    Q = sum tau A                tangential force (Fx, Fy) on the first body, components along the surface [N]
    M_z                          spin moment of the tractions on the first body about n through the centre [N m]
    |Q| / P                      traction coefficient, P the load
    xi = c / |V|                 longitudinal and lateral creepage [-]
    phi = omega_n / |V|          spin creepage [rad/m]
    -(Q_1 xi_1 + Q_2 xi_2 + M_z phi)     T-gamma [N]: friction loss per metre rolled
    -sum tau.w A                 friction power [W]; the value of the run is in `power`
    p |w|                        wear index [W/m2]: Archard's wear depth rate is proportional to it
                                 (J. F. Archard, J. Appl. Phys. 24 (1953) 981)

T-gamma is the wear number of wheels on rails (R. Lewis, U. Olofsson, Wear 257 (2004) 721). In steady rolling of bodies
of similar material it is power/|V|: the elastic part of the slip does no work on constant tractions. The power of a run
has slips of finite steps and is too small by about 1.5 times the fraction of the half-width that the patch advances per
step, 10 % at a sixteenth (two rollers at half of the bound, `verification.carter_rollers`); the energy ledger has the
rest in the line of the contact grid, and both lines together are T-gamma to 0.2 %. For dissimilar materials, tractions
shift the pressure off the centre, and the pressure then takes part of the energy by its lever arm: the remaining
friction part is `power_per_metre`. Signs: if friction dissipates, a force on the first body along e_theta has a
creepage against it. Divided by |V|, not V, creepages keep their direction when a contact rolls backwards.

The run counts the columns that the patch advances per step: above one, material enters the patch with a slip history of
a whole step that it does not have.

Creep of a contact at the centre of its patch, and the moment of the tractions there, about the outward normal.

The *centre* is the point of least distance of the surfaces: for cells that move with the patch their centre, on the
contact grid the line of centres at mid-width, for a point contact on both at the height of the centre of pressure. With
the outward normal n of the first surface there, e_theta x t_z = n, and positions x = x_1 e_theta + x_2 t_z from it, the
rigid-body slip of the surfaces is

    w_1 = c_1 - omega_n x_2,      w_2 = c_2 + omega_n x_1,      omega_n = n.(omega_A - omega_B),

the first (A) against the second (B), with the creep c at the centre (J. J. Kalker, Three-Dimensional Elastic Bodies in
Rolling Contact, 1990, with the longitudinal direction along e_theta, the lateral one along t_z). The run records the
creep in a neighbouring column, from which the same equations give that of the column of the centre x_C, and there in
the middle x' of the rows, so that

    c_i = t_i.(c'_1 t'_1 + c'_2 t'_2 + c'_n n' + (omega_A - omega_B) x (x_C - x')),

t, t' the tangents at both: on a tread the radius at x_C is another one. c'_n n' is the velocity along the normal n' at
x' with which the one along n at x_C is zero, as the surfaces touch. Tractions on the first body have the moment

    M_z = n.sum (x - x_C) x A (tau_1 e_theta + tau_2 t_z),

and dissipate the power -(Q_1 c_1 + Q_2 c_2 + M_z omega_n). This holds for patches that are small compared with the
radii: slip due to the curvature of the patch, as of a ball in a conforming groove (Heathcote), is in the power of the
run, and not in this sum.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.output.contact.patch_moments import traction_forces
from warpffrf.output.geometry.places import grid_theta_offset, rotate, tangents

OPEN, STICK, SLIP = 0, 1, 2
STATES = ("open", "stick", "slip")
ROLLS = 1e-9  # of the largest rolling speed of the run: below it the contact is stationary, and creepage is undefined
SLIDES = 1e-6  # of the creep velocity: a contact that rolls by less slides without rolling
MOVES = 1e-6  # columns per step: a smaller advance of the patch is round-off
MOST_CELLS = {"nodes": 1.0, "cells": 2.5}  # columns per step up to which entering material is treated correctly
FRICTION_ERROR = 0.01  # of the largest friction force, up to that limit
COARSER = {"nodes": "a coarser contact grid", "cells": "fewer strips, Contact(..., cells=(strips, rows))"}

# relative error of the loss in micro-slip, times the cube of the cells across the slip zone: two spheres in pre-sliding
# compared with Mindlin and Deresiewicz: 58, 4.8, 15, 3.2, 1.0, -4.8, -0.9 % with 0.63, 0.81, 1.0, 1.1, 1.3, 1.4 and 1.9
# cells across; it scatters by a factor of three and more with the positions of cells at the two edges of the zone
LOSS = 0.1


class FrictionResult(reprs.Shown):
    """Friction of one contact; arrays have one row per saved step, fields the window (columns, rows) of the
    pressure."""

    _hidden = frozenset({"contact", "history"})

    def __init__(self, contact: Any) -> None:
        """contact: the `ContactResult`; raises `InputError` for a contact without friction."""
        history = getattr(contact.history, "friction", None)
        if history is None:
            raise InputError(
                f"contact '{contact.name}' has no friction, so there are no tractions and no slip; give "
                "Contact(..., friction=mu) and run again"
            )
        self.contact, self.history = contact, history
        self.traction = history.traction  # (T, 2, columns, rows) Pa, on the first body along (e_theta, t_z)
        self.slip_velocity = history.slip_velocity  # (T, 2, columns, rows) m/s, first relative to second, 0 if open
        self.state = history.state  # (T, columns, rows) 0 open, 1 stick, 2 slip
        self.power = history.power  # (T,) W dissipated
        self.creep_velocity = history.creep_velocity  # (T, 2) m/s, rigid slip at the patch centre
        self.rolling_velocity = history.rolling_velocity  # (T,) m/s, mean speed of both surfaces along e_theta
        self.cells_per_step = history.cells_per_step  # (T,) largest number of columns per step since the last saved row

    def _facts(self) -> dict[str, Any]:
        rows, *cells = self.state.shape
        return {"name": self.contact.name, "rows": rows, "cells": " x ".join(map(str, cells))}

    # --- fields ---

    @cached_property
    def traction_magnitude(self) -> np.ndarray:
        """(T, columns, rows) Pa."""
        return np.hypot(self.traction[:, 0], self.traction[:, 1])

    @cached_property
    def slip_speed(self) -> np.ndarray:
        """(T, columns, rows) m/s."""
        return np.hypot(self.slip_velocity[:, 0], self.slip_velocity[:, 1])

    @cached_property
    def wear_index(self) -> np.ndarray:
        """(T, columns, rows) W/m2, pressure times slip speed."""
        return np.maximum(self.contact.mean_pressure, 0.0) * self.slip_speed

    # --- histories ---

    @cached_property
    def tangential_force(self) -> np.ndarray:
        """(T, 2) N, (Fx, Fy) on the first body, longitudinal and lateral: sum of the traction components along
        (e_theta, t_z) of the first surface; on a round surface the first is the torque about the axis over the radius.
        """
        return np.einsum("tdjk,tk->td", self.traction, self.contact.cell_areas)

    @cached_property
    def traction_coefficient(self) -> np.ndarray:
        """(T,) [-] tangential over normal load; NaN without load."""
        load = self.contact.normal_load
        size = np.linalg.norm(self.tangential_force, axis=1)
        return np.divide(size, load, out=np.full(len(load), np.nan), where=load > 0.0)

    @cached_property
    def spin_velocity(self) -> np.ndarray:
        """(T,) rad/s, angular velocity of the first body against the second about the outward normal of the first
        surface at the centre of the patch."""
        return spin_velocity(self.contact)

    @cached_property
    def spin_moment(self) -> np.ndarray:
        """(T,) N m, M_z of the tractions on the first body, about the outward normal of the first surface through the
        centre of the patch; 0 without contact."""
        return spin_moment(self.contact)

    @cached_property
    def _rolling_speed(self) -> np.ndarray:
        """(T,) m/s, |V|; NaN without rolling or contact."""
        speed = np.abs(np.asarray(self.rolling_velocity, dtype=float))
        rolls = speed > ROLLS * np.max(speed, initial=0.0, where=np.isfinite(speed))
        rolls &= self.contact.touching & (np.asarray(self.cells_per_step) > MOVES)
        rolls &= speed > SLIDES * np.linalg.norm(self.creep_velocity, axis=1)
        return np.where(rolls, speed, np.nan)

    @cached_property
    def creepage(self) -> np.ndarray:
        """(T, 2) [-] longitudinal and lateral creepage, creep along (e_theta, t_z) at the centre of the patch over the
        rolling speed; NaN without rolling or contact. All rows of a line contact have the same value: it is that of
        plane closed forms at the mean line load, which is below that at mid-width if ends are free."""
        creep = center_creep(self.contact, self.creep_velocity)
        return creep / self._rolling_speed[:, None]

    @cached_property
    def spin_creepage(self) -> np.ndarray:
        """(T,) rad/m, phi = n.(omega_A - omega_B)/|V|; NaN without rolling or contact."""
        return self.spin_velocity / self._rolling_speed

    @cached_property
    def t_gamma(self) -> np.ndarray:
        """(T,) N (J/m), friction loss per metre rolled, from forces and creepages (see the module); NaN without rolling
        or contact."""
        return -np.einsum("td,td->t", self.tangential_force, self.creepage) - self.spin_moment * self.spin_creepage

    @property
    def power_per_metre(self) -> np.ndarray:
        """(T,) N (J/m), friction power of the run over |V|, for comparison with `t_gamma`; NaN without rolling or
        contact."""
        return np.asarray(self.power, dtype=float) / self._rolling_speed

    def _area(self, state: int) -> np.ndarray:
        return ((np.asarray(self.state) == state).sum(axis=1) * self.contact.cell_areas).sum(axis=1)

    @cached_property
    def stick_area(self) -> np.ndarray:
        """(T,) m2 of sticking cells, the area of adhesion."""
        return self._area(STICK)

    @cached_property
    def slip_area(self) -> np.ndarray:
        """(T,) m2 of slipping cells."""
        return self._area(SLIP)

    @cached_property
    def slip_share(self) -> np.ndarray:
        """(T,) [-] of the loaded area, the part that slips: 1 in gross slip, where the bodies slide as a whole; NaN
        without contact."""
        return slip_share(self.stick_area, self.slip_area)

    @cached_property
    def field_power(self) -> np.ndarray:
        """(T,) W, `-sum tau.w A` of the recorded fields: an independent check of `power`."""
        return -np.einsum("tdjk,tdjk,tk->t", self.traction, self.slip_velocity, self.contact.cell_areas)

    @cached_property
    def wear_rate(self) -> np.ndarray:
        """(T,) W, wear index integrated over the patch."""
        return (self.wear_index.sum(axis=1) * self.contact.cell_areas).sum(axis=1)

    @cached_property
    def wear_peak(self) -> np.ndarray:
        """(T,) W/m2, largest wear index of a cell."""
        return self.wear_index.max(axis=(1, 2), initial=0.0)

    @property
    def too_fast(self) -> np.ndarray:
        """(T,) bool, whether the patch advanced by more cells per step than allowed for 1 % accuracy of friction."""
        return np.asarray(self.cells_per_step) > MOST_CELLS[self.contact.loaded]

    @cached_property
    def slip_width(self) -> float:
        """Width, in cells, of the slip zone at the edge of a patch in partial slip, see `LOSS`; NaN if the patch moves
        by a cell or more, if nothing slipped in the saved rows, and for full slip."""
        state, areas = np.asarray(self.state), np.asarray(self.contact.cell_areas)
        if not self.contact.touching.any():
            return float("nan")
        theta, z = self.contact.patch_center[self.contact.touching].T
        if np.ptp(theta) * float(self.contact.view.first.shape.radius_at(z[-1])) > np.max(self.contact.spacing):
            return float("nan")
        pressed, slips = np.any(state != OPEN, axis=0), np.any(state == SLIP, axis=0)
        if not np.any(slips) or np.array_equal(slips, pressed):
            return float("nan")
        at = int(np.argmax(self.contact.normal_load))
        stuck = float((areas[at] * (pressed & ~slips)).sum() / (areas[at] * pressed).sum())
        across = [int(np.count_nonzero(np.any(pressed, axis=axis))) for axis in (1, 0)]
        kind = self.contact.patch_kind
        if kind == "point":
            return 0.5 * min(across) * (1.0 - float(np.sqrt(stuck)))
        return 0.5 * across[int(kind == "line_around")] * (1.0 - stuck)

    @property
    def loss_error(self) -> float:
        """Approximate relative error of the loss per cycle in micro-slip due to the cells; NaN where `slip_width`
        is."""
        return LOSS / self.slip_width**3

    def _coarse_slip(self) -> str | None:
        """Warning about a slip zone of few cells, None if there is none."""
        if not self.loss_error > FRICTION_ERROR:
            return None
        cure = "more strips and rows, Contact(..., cells=(strips, rows))"
        return (
            f"contact '{self.contact.name}': the zone that slips at the rim of the patch is {self.slip_width:.2g} "
            f"cells wide, and the friction loss of a cycle may err by about {self.loss_error:.0%}; use "
            f"{cure if self.contact.loaded == 'cells' else 'a finer contact grid'}"
        )

    def warning(self) -> str | None:
        """Warning about a patch that advances too many cells per step, or has a partial slip zone of few cells; None if
        there is nothing to do."""
        if not np.any(self.too_fast):
            return self._coarse_slip()
        most, allowed = float(np.nanmax(self.cells_per_step)), MOST_CELLS[self.contact.loaded]
        errs = "is not resolved" if allowed == 1.0 else f"errs by more than {FRICTION_ERROR:.0%} of its largest force"
        return (
            f"contact '{self.contact.name}': the patch advances up to {most:.3g} cells per step, in "
            f"{int(self.too_fast.sum())} of {len(self.too_fast)} saved rows more than {allowed:g}, so that friction "
            f"{errs}; take steps {most / allowed:.3g} times shorter, or {COARSER[self.contact.loaded]}"
        )

    # --- along the rolling direction ---

    def profile(self, i: int, coefficient: float | None = None) -> dict[str, np.ndarray]:
        """Section of `ContactResult.mid_pressure` along the arc, saved step `i` (the last is -1).

        `arc` (columns,) m from the line of centres, increasing along e_theta; `pressure`, `bound` (coefficient times
        pressure; NaN without a coefficient), `traction` along e_theta and `across` along t_z, all Pa; `slip` m/s along
        e_theta; `state` of the nearest row. Raises `InputError` for a step that was not saved.
        """
        contact = self.contact
        i = _row(i, len(contact.mean_pressure))
        at = slice(i, i + 1)
        order = slice(None) if contact.side > 0.0 else slice(None, None, -1)

        def section(values: np.ndarray) -> np.ndarray:
            return contact.in_section(np.asarray(values, dtype=float), at)[0][order]

        pressure = section(contact.mean_pressure[at])
        return {
            "arc": contact.side * contact.arc[i][order],
            "pressure": pressure,
            "bound": pressure * (np.nan if coefficient is None else coefficient),
            "traction": section(self.traction[at, 0]),
            "across": section(self.traction[at, 1]),
            "slip": section(self.slip_velocity[at, 0]),
            "state": np.asarray(self.state)[i][:, contact.section_row(i)][order],
        }


def slip_share(stick: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """(T,) [-] the slipping area over the loaded one, from areas (T,) [m2]; NaN without either."""
    loaded = stick + slip
    return np.divide(slip, loaded, out=np.full(len(loaded), np.nan), where=loaded > 0.0)


def _row(i: int, count: int) -> int:
    """Saved step `i` of `count` from 0; negative ones count from the end."""
    if not -count <= i < count:
        raise InputError(f"saved step {i} does not exist; there are {count}, from 0 to {count - 1}")
    return i % count


def center_points(contact: Any) -> tuple[np.ndarray, np.ndarray]:
    """Centre of the patch (T, 3) [m] and outward normal of the first surface there (T, 3); user axes of its body."""
    surface = contact.view.first
    theta, z = contact.patch_center.T
    theta = theta + grid_theta_offset(surface)
    return surface.shape.point(theta, z), surface.shape.normal(theta, z)


def relative_rotation(contact: Any) -> np.ndarray:
    """omega_A - omega_B (T, 3) [rad/s] of the bodies' frames, user axes of the first; the ground does not rotate."""
    found, first = np.zeros((len(contact.patch_center), 3)), contact.bodies.get(contact.view.first_body.name)
    for body, sign in ((contact.view.first_body, 1.0), (contact.view.second_body, -1.0)):
        motion = contact.bodies.get(body.name)
        if motion is not None:
            found = found + sign * np.asarray(motion.angular_velocity, dtype=float)
    if first is None:
        return found
    back = np.asarray(first.rotation) * (-1.0, -1.0, -1.0, 1.0)
    return np.array([rotate(q, rate[None])[0] for q, rate in zip(back, found, strict=True)]).reshape(-1, 3)


def spin_velocity(contact: Any) -> np.ndarray:
    """omega_n (T,) [rad/s]."""
    return np.einsum("td,td->t", center_points(contact)[1], relative_rotation(contact))


def center_creep(contact: Any, creep: np.ndarray) -> np.ndarray:
    """Creep (T, 2) [m/s] along (e_theta, t_z) at the centre, from the recorded `creep` (T, 2)."""
    shape, offset = contact.view.first.shape, grid_theta_offset(contact.view.first)
    (theta, z), (theta_0, z_0) = contact.patch_center.T, contact.creep_place.T
    around = contact.side * np.asarray(shape.radius_at(z_0)) * (theta - theta_0)
    creep = np.asarray(creep, dtype=float) + np.stack([0.0 * around, spin_velocity(contact) * around], axis=1)
    theta = theta + offset
    velocity = np.einsum("td,dtk->tk", creep, tangents(shape, theta, z_0))
    velocity = velocity + np.cross(relative_rotation(contact), shape.point(theta, z) - shape.point(theta, z_0))
    n, n_0 = shape.normal(theta, z), shape.normal(theta, z_0)
    velocity = velocity - n_0 * (np.einsum("tk,tk->t", velocity, n) / np.einsum("tk,tk->t", n_0, n))[:, None]
    return np.einsum("tk,dtk->td", velocity, tangents(shape, theta, z))


def spin_moment(contact: Any) -> np.ndarray:
    """M_z (T,) [N m] of the tractions on the first body, about the outward normal of its surface through the centre."""
    points, normals = center_points(contact)
    found = np.zeros(len(points))
    for i, (point, normal) in enumerate(zip(points, normals, strict=True)):
        places, forces = traction_forces(contact, i)
        found[i] = normal @ np.cross(places - point, forces).sum(axis=0)
    return found
