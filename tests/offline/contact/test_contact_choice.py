"""Spacing and sampling points from a wanted error."""

from __future__ import annotations

import pytest
from offline_bodies import reduced

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.offline.contact.contact_choice import contact_choice
from warpffrf.offline.contact.contact_grid import grid_error

ERRORS = (0.2, 0.05, 0.01)


@pytest.mark.parametrize("patch", ["line", "ellipse"])
def test_both_become_finer_with_the_error(patch):
    found = [contact_choice(1e-3, error=error, patch=patch) for error in ERRORS]
    spacings, errors = [c.spacing for c in found], [c.sampling_error for c in found]
    assert spacings == sorted(spacings, reverse=True) and spacings[-1] < spacings[0]
    assert errors == sorted(errors, reverse=True)
    for choice, wanted in zip(found, ERRORS, strict=True):
        share = grid_error(choice.spacing, 1e-3, patch=patch)
        assert share is not None
        assert share == choice.grid_error
        assert share + choice.sampling_share <= wanted * (1.0 + 1e-12)


def test_the_choice_scales_with_the_patch():
    small, large = (contact_choice(b, error=0.02) for b in (1e-4, 1e-2))
    assert large.spacing == pytest.approx(100.0 * small.spacing, rel=1e-12)
    assert large.sampling_error == small.sampling_error


def test_a_body_is_reduced_with_it():
    """Fewer nodes and fewer points where less is wanted, and what was trained keeps the promise."""
    mesh = roller(0.05, 0.015, 0.02, sectors=90, layers=3, axial=4, order=1)
    grid_nodes, points = [], []
    for error in (0.3, 0.02):
        choice = contact_choice(7e-3, error=error)
        spacing = max(choice.spacing, 3.5e-3)  # that of the mesh
        rim = reduced(mesh, spacing=spacing, sampling_error=choice.sampling_error)
        surface = rim.contact_surfaces["rim"]
        assert surface.sampling is not None and surface.sampling.training_error <= choice.sampling_error
        grid_nodes.append(surface.grid.columns)
        points.append(surface.sampling.count)
    assert points[0] <= points[1] and grid_nodes[0] < grid_nodes[1]


def test_what_is_refused():
    with pytest.raises(InputError, match="half_width"):
        contact_choice(0.0)
    with pytest.raises(InputError, match="fraction below 1"):
        contact_choice(1e-3, error=1.0)
    with pytest.raises(InputError, match="patch"):
        contact_choice(1e-3, patch="dot")
