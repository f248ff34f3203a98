"""Mistakes with scenes, runs and files; see `workshop`."""

from __future__ import annotations

import numpy as np
from workshop import ORIGIN, Mistake, other_scene_body, reduced, roller_mesh, untyped

import warpffrf as wf

signals, forces, joints = untyped(wf.signals), untyped(wf.forces), untyped(wf.joints)
simulate, Contact, Scene = untyped(wf.simulate), untyped(wf.Contact), untyped(wf.Scene)

BODIES = (
    Mistake("gravity upwards", lambda w: wf.Scene(gravity=(0, 0, 9.81)), ("points upwards", "(0, 0, -9.81)")),
    Mistake("gravity in mm/s2", lambda w: wf.Scene(gravity=(0, 0, -9810)), ("9810 m/s2", "not mm")),
    Mistake("gravity as a number", lambda w: Scene(gravity=-9.81), ("gravity must have shape (3)",)),
    Mistake("gravty=", lambda w: Scene(gravty=ORIGIN), ("did you mean 'gravity'?",)),
    Mistake(
        "a mesh for a body", lambda w: untyped(w.scene).add_body(roller_mesh(), name="x"), ("reduce(mesh, material",)
    ),
    Mistake("a body without a name", lambda w: untyped(w.scene).add_body(reduced()), ("name must be given",)),
    Mistake("a name twice", lambda w: w.scene.add_body(reduced(), name="lower"), ("'lower'", "choose another")),
    Mistake(
        "w first",
        lambda w: w.scene.add_body(reduced(), name="x", rotation=(1, 0, 0, 0)),
        ("180 degrees about x", "(x, y, z, w)"),
    ),
    Mistake(
        "Euler angles",
        lambda w: w.scene.add_body(reduced(), name="x", rotation=(0, 0, 1.57)),
        ("(x, y, z, w)", "'xyz'"),
    ),
    Mistake(
        "degrees",
        lambda w: w.scene.add_body(reduced(), name="x", rotation={"axis": (0, 0, 1), "angle": 90}),
        ("np.radians(90)",),
    ),
    Mistake(
        "a reflection",
        lambda w: w.scene.add_body(reduced(), name="x", rotation=np.diag([1, 1, -1])),
        ("reflection", "sign of one axis"),
    ),
    Mistake(
        "no unit quaternion",
        lambda w: w.scene.add_body(reduced(), name="x", rotation=(0, 0, 1, 1)),
        ("unit quaternion", "length"),
    ),
    Mistake(
        "a position in the plane",
        lambda w: w.scene.add_body(reduced(), name="x", position=(0, 1)),
        ("position must have shape (3)",),
    ),
    Mistake("no mass", lambda w: w.scene.add_rigid_body(0.0, (1, 1, 1), name="x"), ("mass must be greater than zero",)),
    Mistake(
        "moments of no body", lambda w: w.scene.add_rigid_body(1.0, (1, 1, 3), name="x"), ("about the centre of mass?",)
    ),
    Mistake("inertia='ful'", lambda w: w.scene.add_body(reduced(), name="x", inertia="ful"), ("did you mean 'full'?",)),
    Mistake("a surface by a wrong name", lambda w: w.lower["rimm"], ("did you mean 'rim'?", "to wf.reduce")),
    Mistake("a point of a flexible body", lambda w: w.lower.at(ORIGIN), ("name an interface", "'bore'")),
    Mistake("a body by a wrong name", lambda w: w.scene.body("slidr"), ("did you mean 'slider'?",)),
    Mistake(
        "a body of another scene",
        lambda w: w.scene.add(wf.joints.Fixed(other_scene_body().at(ORIGIN), w.scene.ground)),
        ("'crank'", "another scene", "scene.add_body"),
    ),
    Mistake("an item twice", lambda w: w.scene.add(w.guide), ("in the scene already",)),
    Mistake("a class for an item", lambda w: w.scene.add(wf.Contact), ("cannot be added",)),
)

JOINTS = (
    Mistake(
        "a body for a port",
        lambda w: joints.Fixed(w.lower, w.scene.ground),
        ("body 'lower' is flexible: name one of its interfaces",),
    ),
    Mistake(
        "a contact surface for a port",
        lambda w: wf.joints.Fixed(w.lower["rim"], w.scene.ground),
        ("contact surface", "interface"),
    ),
    Mistake(
        "axis='y'",
        lambda w: joints.Revolute(w.lower["bore"], w.scene.ground, axis="y"),
        ("axis must be an array of numbers",),
    ),
    Mistake("no axis", lambda w: joints.Revolute(w.lower["bore"], w.scene.ground), ("Revolute: axis must be given",)),
    Mistake(
        "axs=", lambda w: joints.Revolute(w.lower["bore"], w.scene.ground, axs=(0, 1, 0)), ("did you mean 'axis'?",)
    ),
    Mistake(
        "an axis of no length",
        lambda w: wf.joints.Revolute(w.lower["bore"], w.scene.ground, axis=ORIGIN),
        ("axis has zero length", "such as (0, 1, 0)"),
    ),
    Mistake(
        "one body twice",
        lambda w: wf.joints.Fixed(w.slider.at(ORIGIN), w.slider.at((1, 0, 0))),
        ("both ports are on 'slider'",),
    ),
    Mistake(
        "ports apart",
        lambda w: (w.scene.add(wf.joints.Fixed(w.lower["bore"], w.slider.at(ORIGIN), name="f")), w.scene.check()),
        ("apart", "scene.place"),
    ),
    Mistake(
        "a coordinate that is held",
        lambda w: joints.Drive(w.guide, 1.0, coordinate="rotation"),
        ("'rotation'", "'translation'"),
    ),
    Mistake(
        "a driven joint that is not there",
        lambda w: w.scene.add(
            joints.Drive(wf.joints.Prismatic(w.scene.ground, w.slider.at(ORIGIN), axis=(0, 0, 1), name="g"), 1.0)
        ),
        ("add its joint 'g'",),
    ),
    Mistake("a lambda for a signal", lambda w: joints.Drive(w.guide, lambda t: t), ("signals.Table(times",)),
    Mistake("a signal by its name", lambda w: joints.Drive(w.guide, "sin"), ("signals are objects",)),
    Mistake("values for a signal", lambda w: joints.Drive(w.guide, [0.0, 1.0]), ("signals.Table(times, values)",)),
    Mistake("a signal's class", lambda w: joints.Drive(w.guide, wf.signals.Ramp), ("signals.Ramp(...)",)),
    Mistake("arguments by place", lambda w: signals.SmoothStep(0, 100, 0.01), ("duration=...",)),
    Mistake("times that fall", lambda w: wf.signals.Table([0, 2, 1], [0, 1, 2]), ("times must increase, times[2]",)),
    Mistake("NaN in a table", lambda w: wf.signals.Table([0, 1], [0, np.nan]), ("values[1] is nan",)),
)

FORCES = (
    Mistake(
        "a direction in the plane",
        lambda w: forces.PointForce(w.slider.at(ORIGIN), (0, 1)),
        ("(signal, direction)", "(10.0, (0, 0, 1))"),
    ),
    Mistake(
        "one number", lambda w: forces.PointForce(w.slider.at(ORIGIN), 5), ("three components", "(signal, direction)")
    ),
    Mistake(
        "a force on the ground",
        lambda w: forces.PointForce(w.scene.ground.at(ORIGIN), (0, 0, 1)),
        ("choose a port of a body",),
    ),
    Mistake(
        "frame='local'", lambda w: forces.PointForce(w.slider.at(ORIGIN), (0, 0, 1), frame="local"), ("world, body",)
    ),
    Mistake("a spring on a body", lambda w: forces.JointSpringDamper(w.slider, 1e3), ("acts on a joint",)),
    Mistake(
        "a negative stiffness",
        lambda w: wf.forces.JointSpringDamper(w.guide, -1e3),
        ("stiffness must not be negative",),
    ),
    Mistake("stifness=", lambda w: forces.JointSpringDamper(w.guide, stifness=1e3), ("did you mean 'stiffness'?",)),
    Mistake(
        "a preload that changes",
        lambda w: forces.JointSpringDamper(w.guide, 1e3, preload=lambda t: 10.0 * t),
        ("preload", "signals.Table(times"),
    ),
    Mistake(
        "no spring at all",
        lambda w: wf.forces.JointSpringDamper(w.guide, 0.0).law(),
        ("stiffness and damping are both zero",),
    ),
    Mistake(
        "a spring from a bare ground",
        lambda w: wf.forces.SpringDamper(w.scene.ground, w.slider.at(ORIGIN), 1e3),
        ("scene.ground.at",),
    ),
    Mistake(
        "a sensor of the ground", lambda w: wf.sensors.Position(w.scene.ground.at(ORIGIN)), ("choose a port of a body",)
    ),
)

CONTACTS = (
    Mistake(
        "an interface in contact", lambda w: wf.Contact(w.lower["bore"], w.floor), ("first surface", "contact surface")
    ),
    Mistake("the rigid one first", lambda w: wf.Contact(w.floor, w.lower["rim"]), ("name the flexible body first",)),
    Mistake(
        "friction without its modes",
        lambda w: wf.Contact(w.lower["rim"], w.floor, friction=0.1),
        ("reduce(..., grid=ContactGrid(tangential=True))",),
    ),
    Mistake(
        "friction in per cent",
        lambda w: wf.forces.PrismaticFriction(w.guide, friction=30.0, bearing_length=0.1),
        ("30 is beyond 2", "give 0.3"),
    ),
    Mistake(
        "a negative friction",
        lambda w: wf.Contact(w.lower["rim"], w.floor, friction=-0.1),
        ("friction must not be negative",),
    ),
    Mistake(
        "friction as text",
        lambda w: Contact(w.lower["rim"], w.floor, friction="0.3"),
        ("coefficient or one of laws.Coulomb",),
    ),
    Mistake("fricton=", lambda w: Contact(w.lower["rim"], w.floor, fricton=0.3), ("did you mean 'friction'?",)),
    Mistake(
        "quadrature='best'",
        lambda w: Contact(w.lower["rim"], w.floor, quadrature="best"),
        ("known: 'full', 'reduced'",),
    ),
    Mistake(
        "cell_error in per cent",
        lambda w: wf.Contact(w.lower["rim"], w.floor, cell_error=1.0),
        ("between 0.0005 and 0.02",),
    ),
    Mistake(
        "a law's class", lambda w: Contact(w.lower["rim"], w.floor, law=wf.laws.LinearLayer), ("law must be one of",)
    ),
    Mistake(
        "closing away from it",
        lambda w: w.scene.close_gap(w.scene.add(wf.Contact(w.lower["rim"], w.floor)), along=(1, 0, 0)),
        ("never brings the gap", "direction"),
    ),
    Mistake(
        "two bodies for a gap",
        lambda w: untyped(w.scene).close_gap(w.lower, w.slider),
        ("positional arguments", "along=..."),
    ),
    Mistake(
        "a body for a contact",
        lambda w: untyped(w.scene).close_gap(w.lower),
        ("a contact with finite sliding is needed",),
    ),
)

RUNS = (
    Mistake("savevery=", lambda w: w.run(savevery=2), ("it belongs to options=wf.RunOptions(save_every=...)",)),
    Mistake("a file for a scene", lambda w: simulate("press.toml", 1.0, step=1e-3), ("a Scene is needed",)),
    Mistake("no step", lambda w: simulate(w.scene, 1.0), ("give step, or accuracy=",)),
    Mistake("step by place", lambda w: simulate(w.scene, 1.0, 1e-3), ("step=...",)),
    Mistake("a negative step", lambda w: w.run(step=-1e-3), ("step must be greater than zero",)),
    Mistake("start='equilibirum'", lambda w: w.run(start="equilibirum"), ("'equilibrium'",)),
    Mistake(
        "integrator='hht'", lambda w: w.run(options=untyped(wf).RunOptions(integrator="hht")), ("integrators.HHT()",)
    ),
    Mistake("rho_inf=2", lambda w: wf.integrators.GeneralizedAlpha(rho_inf=2.0), ("rho_inf",)),
    Mistake("results as text", lambda w: w.run(results=w.folder / "x.txt"), (".h5",)),
    Mistake("a foreign file", lambda w: w.run(results=w.file("x.h5", "my notes")), ("x.h5", "another")),
    Mistake("resume without results", lambda w: w.run(resume=True), ("give results",)),
    Mistake("stages and a step", lambda w: w.run(duration=[wf.Stage("a", 0.1, 1e-3)]), ("leave that of the run out",)),
    Mistake("accuracy in per cent", lambda w: w.run(accuracy=1.0), ("accuracy",)),
    Mistake(
        "velocities against a joint",
        lambda w: (setattr(w.slider, "velocity", np.array([1.0, 0, 0])), w.run()),
        ("'guide'", "project_start=True"),
    ),
    Mistake(
        "a drive that begins elsewhere",
        lambda w: (w.scene.add(joints.Drive(w.guide, 0.1, quantity="position", name="push")), w.run()),
        ("drive 'push'", "begin at that value"),
    ),
    Mistake(
        "a table that ends early",
        lambda w: (w.scene.add(joints.Drive(w.guide, wf.signals.Table([0, 1e-3], [0, 0]), name="push")), w.run()),
        ("push", "hold=True"),
    ),
    Mistake("a scene without bodies", lambda w: wf.Scene().check(), ("scene.add_body",)),
    Mistake(
        "static with an integrator",
        lambda w: wf.static(
            w.scene, 0.1, step=0.1, options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha())
        ),
        ("integrator is for runs in time",),
    ),
)

FILES = (
    Mistake(
        "a section",
        lambda w: wf.load_scene(w.file("a.toml", "[materals.steel]\nyoungs_modulus = 1\n")),
        ("did you mean 'materials'?",),
    ),
    Mistake(
        "a key",
        lambda w: wf.load_scene(w.file("a.toml", "[scene]\ngravty = [0, 0, -9.81]\n")),
        ("a.toml:2", "did you mean 'gravity'?"),
    ),
    Mistake("a file of a scene", lambda w: wf.load_scene("no.toml"), ("no.toml",)),
    Mistake("a file of a body", lambda w: wf.ReducedBody.load(w.folder / "no.h5"), ("no.h5",)),
    Mistake("a file of results", lambda w: wf.Result.load(w.folder / "no.h5"), ("no.h5",)),
)

MISTAKES = (*BODIES, *JOINTS, *FORCES, *CONTACTS, *RUNS, *FILES)

# what cannot be distinguished from what is meant, and why nothing is said
ARGUED = {
    "contact with another body than meant": "every pair of surfaces of two bodies may be meant",
    "a step that is somewhat too long": "only the run shows it, in its notes and its error budget",
    "a material of another machine": "aluminium in the place of steel is a valid machine",
}
