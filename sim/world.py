"""A whole scene in a space: members, loose bodies, joints, vehicles, ground, and their programme in time."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence

import pymunk

from capacity import InputError
from scene import Scene, Simulation, is_supported
from sim.chipmunk import constraints_on
from sim.contact_watch import ContactWatch, is_touching
from sim.direct_joints import add_joints
from sim.first_touch import first_touches, hold_back
from sim.ground import add_grounds
from sim.joint import DuctileJoint
from sim.load_programme import LoadProgramme, is_sudden
from sim.loose_bodies import add_bodies
from sim.measures import Watch
from sim.members import Assembly, assemble
from sim.model import Model
from sim.motion import set_going
from sim.overlaps import check_apart
from sim.prescribed_push import PrescribedPush
from sim.scene_model import limits_of, model_of, scheme_of
from sim.settling import settle
from sim.vehicles import Car, add_vehicles

# Way per step that counts as rest before a motion [m].
_REST = 1e-12
# A run of more would take days.
_MOST_STEPS = 1e9
#: Longest step of a scene that something sets going at once [s]. Parts within a step (`sim.kernels.parts`) would do for
#: the members, but measures see only what is at the end of one: peaks, forces in an impact, when joints break.
SUDDEN_STEP = 1e-4


class World:
    """A scene, ready to step.

    Parameters
    ----------
    scene : Scene
    dt : float, optional
        Step [s], in place of the scene's.
    iterations : int, optional
        Iterations of Chipmunk's solver in a step, in place of the scene's.
    duration : float, optional
        [s], in place of the scene's.

    Raises
    ------
    InputError
        When there is no programme to follow, a push shall have another duration, or bodies overlap from the start.
    SolverError
        When a scene that is pushed or set in motion does not come to rest under its own weight.

    Attributes
    ----------
    space : pymunk.Space
    time, duration : float
        Simulated so far, and in all [s].
    dt : float
        [s]
    part : float
        Of it, that the last step took [s].
    steps : int
        Taken so far.
    push : PrescribedPush, optional
    bodies : dict[str, pymunk.Body]
        Loose ones.
    cars : dict[str, Car]
    joints : dict[str, tuple of DuctileJoint]
        By the name of the joint, or of the member from its start to its end.
    broken : list of (float, str)
        Times at which joints broke [s], and what they are called.
    refined : list of (float, str)
        Times at which members were refined [s], and their names; 0 for those that were before anything moved.
    labels : dict[DuctileJoint, str]
        What joints are called, those too that there are no more.
    """

    def __init__(
        self,
        scene: Scene,
        dt: float | None = None,
        iterations: int | None = None,
        duration: float | None = None,
    ) -> None:
        if scene.meshed is not None:
            raise InputError("plane.mesh", "a mesh has no joints; it is for the reference", "write nodes and members")
        self.scene = scene
        run = scene.simulation or Simulation()
        self.dt = float(run.dt) if dt is None else dt
        self.space = space = pymunk.Space()
        space.iterations = run.iterations if iterations is None else iterations
        space.collision_slop = run.collision_slop
        self.time, self.steps = 0.0, 0
        self.part, self._parts_left = self.dt, 0
        self._fewest_parts = math.ceil(self.dt / SUDDEN_STEP - 1e-6) if is_sudden(scene) else 1
        self._largest_travel = run.largest_travel
        self._ramp = float(run.gravity_ramp)
        add_grounds(scene, space)
        self.bodies = add_bodies(scene, space)
        self.joints: dict[str, tuple[DuctileJoint, ...]] = {
            name: (joint,) for name, joint in add_joints(scene, space, self.bodies, scheme_of(scene)).items()
        }
        self.cars: dict[str, Car] = add_vehicles(scene, space)
        self._assembly = self._add_members(model_of(scene))
        self._loads = None if self._assembly is None else LoadProgramme(scene, self._assembly)
        check_apart(space, self._loose_places(), self._piece_places())
        self.push = self._start_push()
        self._start_motion()
        self.duration = self._duration(run, duration)
        self._continuous = [self.bodies[name] for name, body in scene.bodies.items() if body.continuous]
        self.labels: dict[DuctileJoint, str] = {}
        self.broken: list[tuple[float, str]] = []
        self.refined: list[tuple[float, str]] = []
        self._take_joints(scene.members)
        self._label(self.joints)
        if self._assembly is not None:
            self.refined += [(self.time, name) for name in self._assembly.refined]
        self._contacts: list[ContactWatch] = []
        self._watches = {name: Watch(measure, self) for name, measure in scene.measures.items()}

    def _loose_places(self) -> dict[pymunk.Body, str]:
        """Bodies and parts of vehicles, and where the scene file has them."""
        bodies = {body: f"bodies.{name}" for name, body in self.bodies.items()}
        return bodies | {body: f"vehicles.{name}" for name, car in self.cars.items() for body in car.bodies}

    def _piece_places(self) -> dict[pymunk.Body, str]:
        """Pieces of members, likewise; those at nodes by one of the members there."""
        spans = () if self._assembly is None else self._assembly.spans
        return {span.body: f"members.{span.member}" for span in spans}

    def _add_members(self, model: Model) -> Assembly | None:
        scene = self.scene
        if not scene.members:
            return None
        limits = {name: limits_of(member) for name, member in scene.members.items()}
        assembly = assemble(scene, model, self.space, limits=limits)
        for span in assembly.spans:
            for shape in span.body.shapes:
                shape.friction = scene.members[span.member].friction
        return assembly

    def _take_joints(self, members: Collection[str]) -> None:
        """Take the joints of some members as they are now."""
        if self._assembly is None:
            return
        own: dict[str, list[DuctileJoint]] = {name: [] for name in members}
        for place, joint in zip(self._assembly.places, self._assembly.joints, strict=False):
            if place.member in own:
                own[place.member].append(joint)
        self.joints |= {name: tuple(joints) for name, joints in own.items()}

    def _start_push(self) -> PrescribedPush | None:
        if self.scene.pushed is None or self._assembly is None:
            return None
        return PrescribedPush(self.scene, self._assembly)

    def _start_motion(self) -> None:
        """At rest under dead loads, unless the members fall, with the velocities that the scene's motion says."""
        motion = self.scene.motion
        if motion is not None and self._assembly is not None:
            if is_supported(self.scene) and not any(motion.velocity):
                settle(self.scene, self._assembly, _REST)
            set_going(self.scene, motion, self._assembly)

    def _duration(self, run: Simulation, wanted: float | None) -> float:
        if self.push is not None:
            if wanted is not None:
                raise InputError("duration", "a push ends at its last stop", "leave it out")
            return self.push.duration
        own = run.duration if self.scene.motion is None else self.scene.motion.duration
        length = own if wanted is None else wanted
        if length is None:
            raise InputError("simulation", "there is none in the scene", 'add [simulation] with duration = "5 s"')
        if not self.dt <= length:
            raise InputError(
                "dt", f"a step of {self.dt:g} s is longer than the whole run of {length:g} s", "shorten it"
            )
        if length > _MOST_STEPS * self.dt:
            fault = f"{length:g} s are more than {_MOST_STEPS:.0e} steps of {self.dt:g} s"
            raise InputError("duration", fault, "make it shorter, or the steps longer")
        return float(length)

    def _label(self, names: Iterable[str]) -> None:
        """Call the joints of that name, or of that member, by it, and be told when they break."""
        for name in names:
            for i, joint in enumerate(self.joints[name], 1):
                self.labels[joint] = name if name in self.scene.joints else f"{name} {i}"
                joint.on_break = self._note_break

    def _refine(self) -> None:
        """Refine the members that are due."""
        names = self._assembly.refine() if self._assembly is not None else ()
        if not names:
            return
        coarse = [joint for name in names for joint in self.joints[name]]
        self._take_joints(names)
        for joint in coarse:
            self.labels[joint] += " of the coarse member"
        self._label(names)
        self.refined += [(self.time, name) for name in names]

    def _note_break(self, joint: DuctileJoint) -> None:
        self.broken.append((self.time + self.part, self.labels[joint]))

    def step(self) -> None:
        """One step of `dt`, or one of the parts that it is cut into; members that are due are refined before it."""
        self._refine()
        if self._parts_left == 0:
            parts = self._parts()
            self.part, self._parts_left = self.dt / parts, parts
        self._parts_left -= 1
        h, end = self.part, self.time + self.part
        share = min(1.0, end / self._ramp) if self._ramp > 0.0 else 1.0
        self.space.gravity = (0.0, -share * self.scene.gravity)
        if self._loads is not None:
            self._loads.act(end, share)
        for car in self.cars.values():
            car.drive(self.time)
        touch = h
        for found in first_touches(self.space, self._loose(), h):
            hold_back(found, h)
            touch = min(touch, found.time)
        if self.push is not None:
            self.push.aim(h)
        self.space.step(h)
        self.steps += 1
        for contacts in self._contacts:
            contacts.note(self.time + touch)
        self.time = end
        if self.push is not None:
            self.push.read(h)
        for watch in self._watches.values():
            watch.note()

    def _loose(self) -> list[pymunk.Body]:
        """Continuous bodies that nothing is joined to."""
        return [body for body in self._continuous if not constraints_on(body)]

    def _parts(self) -> int:
        """Into how many parts the next step is cut, never fewer than before: a power of two for what travels fast.

        What is set going at once, by a blow or a load, swings faster than a frame, and its impact is over within one.

        The forces of a step are those at the end of a move of the same length. A longer move would carry yielding
        joints beyond where their forces were found, so the parts do not grow again.
        """
        if self._largest_travel is None:
            return self._fewest_parts
        meeting = {found.body for found in first_touches(self.space, self._loose(), self.dt)}
        meeting |= {body for body in self._loose() if is_touching(body)}
        fastest = max((body.velocity.length for body in meeting), default=0.0)
        wanted = math.ceil(math.log2(max(1.0, fastest * self.dt / self._largest_travel)) - 1e-9)
        self._fewest_parts = max(self._fewest_parts, 2**wanted)
        return self._fewest_parts

    @property
    def all_joints(self) -> list[DuctileJoint]:
        """All joints that there are now, and those that broke."""
        return [joint for own in self.joints.values() for joint in own]

    @property
    def finished(self) -> bool:
        """Whether the scene's duration is over, or its push."""
        return self.push.finished if self.push is not None else self.time >= self.duration - 0.5 * self.dt

    def bodies_called(self, name: str) -> Sequence[pymunk.Body]:
        """The body called ``name``, or all of the vehicle."""
        return self.cars[name].bodies if name in self.cars else (self.bodies[name],)

    def point_called(self, name: str) -> tuple[pymunk.Body, tuple[float, float]]:
        """The centre of mass of a body or of a vehicle's chassis, or a node, as a point of a body."""
        if name in self.bodies or name in self.cars:
            body = self.bodies[name] if name in self.bodies else self.cars[name].chassis
            x, y = body.center_of_gravity
            return body, (x, y)
        assert self._assembly is not None
        node = self._assembly.nodes[name]
        return node.body, node.point

    def contacts_of(self, bodies: Sequence[pymunk.Body]) -> ContactWatch:
        """A watch over the contacts of ``bodies``, kept up to date from now on."""
        self._contacts.append(ContactWatch(bodies))
        return self._contacts[-1]

    def results(self) -> dict[str, float | list[float]]:
        """What the scene's measures ask for, by their names, up to now."""
        return {name: watch.result() for name, watch in self._watches.items()}
