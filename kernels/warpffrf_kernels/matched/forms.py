r"""Independent numbers of a cell in each of its states, and the maps between these choices.

A cell has forces s = (p, t) on the second face and the resulting gap and slip, y = (g, w). Of six numbers three are
independent, u, prescribed by its state, and three are dependent, v:

    OPEN         u = s                                    v = y
    STICK        u = y                                    v = s
    SLIP         u = (g, t_d - mu p, w_e + kappa t_e)     v = (p, w_d, t_e)
    SMOOTH       u = (g, t)                               v = (p, w)              (without friction)

with d the direction of the traction and e transverse to it. All u are zero in a state that is satisfied exactly; for
SLIP they are small: t = -mu p w/|w| reads t_d = sqrt((mu p)^2 - t_e^2) and w_e = -|w|/(mu p) t_e, so
u = (0, t_d - mu p, (kappa - |w|/(mu p)) t_e). Both directions between (s, y) and (u, v) are linear.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

OPEN = wp.constant(0)
STICK = wp.constant(1)
SLIP = wp.constant(2)
SMOOTH = wp.constant(3)


@wp.struct
class Form:
    """A state of a cell: its kind, the direction d of the traction, kappa [m/N], and the coefficient of friction."""

    state: int
    d: wp.vec2d
    kappa: real
    mu: real


@wp.struct
class Four:
    """Two triples by two triples: first = a x + b y, second = c x + d y."""

    a: mat33
    b: mat33
    c: mat33
    d: mat33


@wp.func
def to_form(form: Form) -> Four:
    """(u, v) of (s, y)."""
    o = real(0.0)
    i = real(1.0)
    none = mat33(o, o, o, o, o, o, o, o, o)
    one = wp.identity(n=3, dtype=real)
    out = Four()
    if form.state == OPEN:
        out.a = one
        out.b = none
        out.c = none
        out.d = one
    elif form.state == STICK:
        out.a = none
        out.b = one
        out.c = one
        out.d = none
    elif form.state == SMOOTH:
        out.a = mat33(o, o, o, o, i, o, o, o, i)
        out.b = mat33(i, o, o, o, o, o, o, o, o)
        out.c = mat33(i, o, o, o, o, o, o, o, o)
        out.d = mat33(o, o, o, o, i, o, o, o, i)
    else:
        x = form.d[0]
        y = form.d[1]
        k = form.kappa
        out.a = mat33(o, o, o, -form.mu, x, y, o, -k * y, k * x)
        out.b = mat33(i, o, o, o, o, o, o, -y, x)
        out.c = mat33(i, o, o, o, o, o, o, -y, x)
        out.d = mat33(o, o, o, o, x, y, o, o, o)
    return out


@wp.func
def from_form(form: Form) -> Four:
    """(s, y) of (u, v)."""
    if form.state != SLIP:
        return to_form(form)  # each of them is its own inverse
    o = real(0.0)
    i = real(1.0)
    x = form.d[0]
    y = form.d[1]
    k = form.kappa
    m = form.mu
    out = Four()
    out.a = mat33(o, o, o, o, x, o, o, y, o)
    out.b = mat33(i, o, o, m * x, o, -y, m * y, o, x)
    out.c = mat33(i, o, o, o, o, -y, o, o, x)
    out.d = mat33(o, o, o, o, x, k * y, o, y, -k * x)
    return out


@wp.func
def after(second: Four, first: Four) -> Four:
    """The composition, `first` applied before `second`."""
    out = Four()
    out.a = second.a * first.a + second.b * first.c
    out.b = second.a * first.b + second.b * first.d
    out.c = second.c * first.a + second.d * first.c
    out.d = second.c * first.b + second.d * first.d
    return out


@wp.func
def first_of(map: Four, x: vec3, y: vec3) -> vec3:
    return map.a * x + map.b * y


@wp.func
def second_of(map: Four, x: vec3, y: vec3) -> vec3:
    return map.c * x + map.d * y


@wp.func
def unit_of(form: Form, i: int, yields: real) -> real:
    """Unit for comparing independent number i: `yields` [m/N] for lengths, 1 for forces."""
    if form.state == STICK or (i == 0 and form.state != OPEN) or (i == 2 and form.state == SLIP):
        return yields
    return real(1.0)


@wp.func
def forces_of(form: Form, u: vec3, v: vec3) -> vec3:
    """s of (u, v)."""
    if form.state == OPEN:
        return u
    if form.state == STICK:
        return v
    return first_of(from_form(form), u, v)


@wp.func
def moved_of(form: Form, u: vec3, v: vec3) -> vec3:
    """y of (u, v)."""
    if form.state == OPEN:
        return v
    if form.state == STICK:
        return u
    return second_of(from_form(form), u, v)
