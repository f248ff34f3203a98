r"""Published numbers of rolling contact: Kalker's coefficients and an example of his program CONTACT.

**Coefficients.** Like half-spaces, elliptic patch with half-axes a along the rolling direction and b across, shear
modulus G. At small creepages xi (along), eta (across) and spin phi the whole patch sticks, and the forces are (J. J.
Kalker, On the rolling contact of two elastic bodies in the presence of dry friction, thesis, Delft 1967; table of the
creepage and spin coefficients in Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer 1990)

    F_x = -G a b C_11 xi,      F_y = -G a b (C_22 eta + sqrt(a b) C_23 phi).

The table has three digits; between its Poisson ratios 0, 1/4 and 1/2 it is to be interpolated by a parabola.

**Eurosprinter**: wheel on rail from the examples of CONTACT (E. A. H. Vollebregt, User guide for CONTACT, VORtech):
a wheel of 625 mm with a crown of 1,777 mm on a flat rail, both of G = 82 GPa and nu = 0.28, 106.7 kN, friction 0.33;
its forces at nine creepages along the rail, over mu N, and its patch. They are computed on a grid of cells, so that
they have an error of their own, of about a percent: its example of Carter gives 0.648 for 0.64.
"""

from __future__ import annotations

KALKER_POISSON = (0.0, 0.25, 0.5)
KALKER = {  # by a/b: C_11, C_22, C_23 at KALKER_POISSON
    1.0: ((3.40, 4.12, 5.20), (3.40, 3.67, 3.98), (1.33, 1.47, 1.63)),
    0.5: ((2.88, 3.62, 4.83), (2.88, 3.01, 3.14), (0.827, 0.929, 1.07)),
    2.0: ((4.37, 5.10, 6.11), (4.37, 4.90, 5.56), (2.35, 2.62, 2.96)),
}

EUROSPRINTER_LOAD, EUROSPRINTER_FRICTION = 106.7e3, 0.33  # N, -
EUROSPRINTER_RADII = 0.625, 1.777  # m, along and across the rail
EUROSPRINTER_SHEAR, EUROSPRINTER_POISSON = 82e9, 0.28  # Pa, -
EUROSPRINTER_PATCH = 6.304e-3, 12.61e-3, 640.7e6, 0.07651e-3  # a, b [m], p0 [Pa], approach [m]
EUROSPRINTER_FORCES = (  # creepage, F_x/(mu N)
    (1e-5, 0.007015),
    (0.4e-3, 0.2588),
    (0.8e-3, 0.4742),
    (1.2e-3, 0.6482),
    (1.6e-3, 0.7831),
    (2.0e-3, 0.8816),
    (2.4e-3, 0.9467),
    (2.8e-3, 0.9832),
    (3.2e-3, 0.9976),
)
