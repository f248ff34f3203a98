"""Demos that come with the package; `warpffrf demo NAME` runs them, `demos/NAME.py` does from a checkout.

Every demo is a module with `build()`, which returns its scene, and `main(out, quick=, progress=)`, which runs it, holds
its figures against values known from elsewhere and returns 0 when they agree. A new one is a new module and a line in
`DEMOS`.
"""

from __future__ import annotations

# module -> what the command line says about it
DEMOS = {
    "two_rollers": "Two steel rollers, pressed together, rolling, under a load step: contact beside Hertz.",
    "coarse_rollers": "The two rollers in 4 mm tetrahedra, far larger than the contact: beside a fine mesh, Hertz.",
    "crowned_on_raceway": "A crowned roller on a bearing's inner ring, in 2 mm cells: Hertz's ellipse, line, no edges.",
    "crown_sweep": "Two crowned rollers, 60 equilibria over crown, load and tilt: Hertz, edges, the best crown.",
    "rolling_friction": "Two rollers with friction, one carried along, braked until it slips, on two meshes: Carter.",
    "creep_curves": "Two crowned rollers in 4 mm cells, rolled with creepages and spin: beside CONTACT and Kalker.",
    "ball_on_plane": "A ball pressed on a plane and pushed sideways: beside Hertz, Cattaneo and Mindlin.",
    "ball_impact": "A ball hits a half-space: force and time of contact beside Hertz's impact.",
    "ball_in_ring": "A ball rolls in the groove of a ring, two bodies of a ball bearing: beside Hertz and rolling.",
    "ball_bearing": "A whole ball bearing under a radial load, its inner ring turning: published loads, kinematics.",
    "roller_bearing": "A roller bearing whose thin outer ring stands on two feet: loads beside a full FE ring.",
    "pin_in_bore": "A pin in a bore of nearly its own radius, conformal contact: beside Persson.",
    "journal_bearing": "A shaft in a sleeve with an oil film: rest, unbalance, whirl, beside references of their own.",
    "connecting_rod": "An elastic rod on its crank pin with an oil film, four-stroke load: beside a film of its own.",
    "piston": "A piston's skirt in its liner, both elastic, on two films, four-stroke load: beside a full FE model.",
    "lap_joint": "Two strips, two bolts: hysteresis, and a vibration that friction damps, beside full finite elements.",
    "tilted_roller": "A crowned roller tilted by 0.5 mrad: where the patch goes and what holds the tilt.",
    "slider_crank": "A slider-crank with a flexible rod: its bending beside the beam equation.",
    "spinning_beam": "A beam spun up about one end, with and without geometric stiffening.",
    "elastica": "A cantilever bent far, in one body, two and four: beside the closed form of the elastica.",
    "snapping_arch": "A shallow arch that snaps through, by displacement and by load: beside a full FE model.",
    "plate": "A clamped plate deflects by twice its thickness and vibrates: Levy, full FE, frequency by amplitude.",
    "frame_on_bushings": "A flexible frame on four bushings, pushed at a seat: statics, frequencies, momentum.",
    "press_fit": "A shaft pressed into a hub and turned until it slips: beside Lame, micro-slip in torsion.",
    "leaf_spring": "A leaf spring clamped in its middle, leaves that rub: beams at their tips, full finite elements.",
    "heavy_top": "A fast heavy top on a ball joint: position after one second beside the published one.",
}
