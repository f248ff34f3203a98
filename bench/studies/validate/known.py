"""What is known of the verification: rows that miss their tolerance, and cases that are not compared yet."""

from __future__ import annotations

KNOWN_MISSES = {  # (case, quantity): reason
    ("short_bearing", "force, eccentricity 0.8"): (
        "the closed form is that of a bearing of no length: L/D 0.05 carries 0.8 % less at this eccentricity, and "
        "eight cells along the bearing take 1.6 %"
    ),
    ("falling_plate", "1/h² after 10 steps over the closed form's"): (
        "what the grid leaves of the force throws so light a plate out of its place in the first of few steps; twice "
        "as many steps reach the tolerance"
    ),
}

NOT_COMPARED = (  # case, source, reason
    ("Squeezed disc, 3πμR⁴V/(2h³)", "Stefan (1874); F5", "a film of the program is a rectangle of rows and columns"),
    (
        "Pressure dam bearings: eccentricity and whirl threshold of four bearings",
        "Nicholas, Barrett and Leader (1980); Q2",
        "a step of the gap within a pad has no scene yet, and the threshold by speed no search",
    ),
    (
        "Slider with a pocket and a cavity in it",
        "Fowell and others (2007), closed form by pieces; Q6",
        "a gap that jumps within a cell has no scene yet",
    ),
    (
        "Friction of a test bearing in mixed lubrication",
        "Sander and others, measured; Q4",
        "the bearing's clearance is not published, and the rod deforms in a way that needs its mesh",
    ),
    (
        "Pressures of an elastohydrodynamic journal bearing",
        "COMSOL, application library; Q5",
        "the grooves' places are not among the published numbers",
    ),
    (
        "A wheel in a groove, conforming in one direction",
        "Vollebregt (2018); G2",
        "no body has the published finite-element influence coefficients, and a rail is rigid so far",
    ),
    (
        "Separate integration against a monolithic one, to round-off",
        "tests/references/monolithic; D9",
        "compared in tests (tests/monolithic), as agreement of two programs of this project",
    ),
    (
        "Static response to loads in the span of the basis, sampling weights",
        "full finite elements by scikit-fem",
        "compared in tests (tests/offline), to 1e-8 and to round-off",
    ),
)
