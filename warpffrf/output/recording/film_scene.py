"""One oil film in a recording: pressure, gap and film fraction on the first surface and unwrapped.

Below `/world/<first body>/<film>` are the nodes of the film's grid as surfaces in three colourings, in a view of their
own without the first body, which would hide them; below `/film_map/<film>` the same unwrapped, angle (or length) from
e_0 of the first surface to the right, its axis up. Values are bilinear between nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.places import grid_theta_offset
from warpffrf.output.plots.colors import field_scale, largest, map_axes_picture
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.extent import EYE, FIELD, FRONT

TITLES = {"pressure": "Film pressure", "gap": "Gap", "fraction": "Film fraction"}
MAP_SHAPE = (180, 480)  # pixels (height, width)
MM = 1e3
FINEST, LIFTED = 160, 0.006  # columns drawn, at least; of the size: above the facets of the second body
ABOVE = 0.5  # direction of the eye along the axis, for 1 towards the largest pressure


class FilmColors:
    """Colours of the fields of films, one range for all films of a run."""

    def __init__(self, films: list[Any], rows: np.ndarray, pressure: Any) -> None:
        """pressure: the scale that contacts and films share."""
        gap = largest([film.gap[rows] for film in films])
        self._scales: dict[str, Any] = {
            "pressure": pressure, "gap": field_scale("gap", gap), "fraction": field_scale("fraction", 1.0),
        }  # fmt: skip
        self.fields = list(TITLES) if films else []

    def scale(self, field: str) -> Any:
        """The colours of one field."""
        return self._scales[field]


class FilmScene:
    """Logs one film into a recording."""

    fields = tuple(TITLES)

    def __init__(self, recorder: Any, name: str) -> None:
        self.recorder, self.name = recorder, name
        self.view, self.film = recorder.result.view.films[name], recorder.result.history.films[name]
        self.surface = self.view.first
        grid = self.surface.grid
        columns = np.arange(grid.columns + bool(grid.periodic))
        self.columns = columns % grid.columns  # of a full bore the first once more
        theta = grid.theta_start + grid_theta_offset(self.surface) + grid.pitch * columns
        self.theta, self.z = theta, np.asarray(grid.z, dtype=float)
        self.finer = np.linspace(theta[0], theta[-1], -(-FINEST // len(theta)) * (len(theta) - 1) + 1)
        shape, (t, z) = self.surface.shape, np.meshgrid(self.finer, self.z, indexing="ij")
        outside = not shape.profile().planar and shape.side > 0.0  # else seen through the first body, which is left out
        points = shape.point(t, z)
        self.size = float(np.ptp(points.reshape(-1, 3), axis=0).max())
        self.towards = (1.0 if outside else -1.0) * shape.normal(t, z)
        self.points = points + LIFTED * self.size * self.towards

    def world(self, *parts: str) -> str:
        """Entity on the first body."""
        return self.recorder.path("world", self.view.first_body.name, self.name, *parts)

    def map(self, *parts: str) -> str:
        """Entity of the unwrapped film."""
        return self.recorder.path("film_map", self.name, *parts)

    def title(self, field: str) -> str:
        """Of a view."""
        return TITLES[field] + (f" '{self.name}'" if len(self.recorder.film_scenes) > 1 else "")

    def static(self) -> None:
        """Log the surfaces and the axes of the map."""
        rr, log = self.recorder.rr, self.recorder.log_static
        triangles = fr.grid_triangles(len(self.finer), len(self.z)).astype(np.uint32)
        points = self.points.reshape(-1, 3)
        mesh = {"vertex_positions": points.astype(np.float32), "triangle_indices": triangles}
        for field in self.fields:
            log(self.world(field), rr.Mesh3D(**mesh))
        plane = self.surface.shape.kind == "plane"
        self.right, self.order = _sorted(self.theta, plane)
        edges = self.right[[0, -1]] * (MM if plane else 180.0 / np.pi)
        words = "along the surface [mm]" if plane else "angle from e_0 of the first surface [deg]"
        heights = self.z[0] * MM, self.z[-1] * MM
        picture, corner = map_axes_picture(tuple(edges), heights, (words, "along the axis [mm]"), MAP_SHAPE)
        log(self.map("axes"), rr.Image(picture, draw_order=0.0, opacity=fr.BLENDED))
        for field in self.fields:
            log(self.map(field), rr.Transform3D(translation=[*corner, 0.0]))
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        log(self.world(EYE), rr.Transform3D(translation=middle, scale=self.size))

    def frame(self, i: int) -> None:
        """Log colours and maps of saved row i."""
        rr, log = self.recorder.rr, self.recorder.stream.log
        found = {"pressure": self.film.pressure[i], "gap": self.film.gap[i], "fraction": self.film.fill[i]}
        for field, values in found.items():
            scale, values = self.recorder.film_colors.scale(field), values[self.columns]
            fine = np.stack([np.interp(self.finer, self.theta, row) for row in values.T], axis=1)
            log(self.world(field), rr.Mesh3D.from_fields(vertex_colors=scale.packed(fine.ravel())))
            log(self.map(field), rr.Image(scale.rgb(self._picture(values)), draw_order=1.0))

    def close_up(self, field: str) -> Any:
        """The film seen from outside of its first body, which is left out, with the second one in it."""
        import rerun.blueprint as rrb

        second = self.recorder.path("world", self.view.second_body.name)
        shape = self.surface.shape
        rows = self.recorder.rows[self.recorder.good]
        peak = self.theta[int(np.argmax(self.film.pressure[rows].max(axis=(0, 2))))] if len(rows) else self.theta[0]
        towards = self.towards[int(np.argmin(np.abs(self.finer - peak))), len(self.z) // 2]
        along = shape.e_a if shape.e_a @ FRONT > 0.0 else -shape.e_a
        eye = towards + ABOVE * along
        return rrb.Spatial3DView(
            origin=self.world(EYE),
            contents=[f"+ {self.world(field)}", f"+ {second}/solid", f"+ {second}/surface"],
            name=self.title(field),
            eye_controls=rrb.EyeControls3D(
                position=FIELD * eye / np.linalg.norm(eye), look_target=(0.0, 0.0, 0.0), eye_up=tuple(along)
            ),
            line_grid=False,
        )

    def map_view(self, field: str) -> Any:
        """The unwrapped film."""
        import rerun.blueprint as rrb

        contents = [f"+ {self.map('axes')}", f"+ {self.map(field)}"]
        return rrb.Spatial2DView(origin=self.map(), contents=contents, name=f"{self.title(field)}, unwrapped")

    def _picture(self, values: np.ndarray) -> np.ndarray:
        """(height, width) of nodal values (columns, rows), bilinear."""
        values = values[self.order]
        x = np.linspace(self.right[0], self.right[-1], MAP_SHAPE[1])
        z = np.linspace(self.z[-1], self.z[0], MAP_SHAPE[0])
        across = np.stack([np.interp(x, self.right, row) for row in values.T], axis=1)
        return np.stack([np.interp(z, self.z, column) for column in across], axis=1)


def _sorted(theta: np.ndarray, plane: bool) -> tuple[np.ndarray, np.ndarray]:
    """Positions of columns, ascending, angles between -pi and pi where the film goes around; and the columns."""
    full = not plane and np.ptp(theta) > 2.0 * np.pi - 1e-9
    if not full:
        order = np.argsort(theta)
        return theta[order], order
    own = (theta[:-1] + np.pi) % (2.0 * np.pi) - np.pi
    order = np.argsort(own)
    own = own[order]
    return np.append(own, own[0] + 2.0 * np.pi), np.append(order, order[0])
