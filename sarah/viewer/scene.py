"""The robot in the page's scene, with the loads on its pads, its stance leg and the push."""

from __future__ import annotations

import io
import itertools
import math
import textwrap
from collections.abc import Sequence

import numpy as np
import trimesh
import viser
import yourdfpy
from viser.extras import ViserUrdf

from sarah.episode.push import push_words
from sarah.episode.spec import EpisodeSpec
from sarah.episode.trace import Trace
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.robot.description import ANKLE_JOINTS, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, Vector
from sarah.robot.scale import Scale
from sarah.scenery import push_arrow
from sarah.scenery.bumps import mesh
from sarah.scenery.camera import Camera, View
from sarah.scenery.ground import LEVEL, Ground
from sarah.scenery.push_arrow import STANDARD

Colour = tuple[int, int, int]


def channels(colour: str) -> Colour:
    """Red, green and blue from 0 to 255.

    :param colour: colour such as ``#0072B2``
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


PAD_COLOURS = (LEFT, "#7CBBE6", RIGHT, "#F5B183")
"""Colours of left fore, left hind, right fore and right hind, in the scene and in the plots."""
BUMPS: Colour = (140, 148, 158)
"""Colour of rough ground."""
METRES_PER_NEWTON_OF_LOAD = 0.0008
"""Length of a pad's bar per load, in m/N."""
ARROW_GAP = 0.2
"""Distance from the torso's centre at which an arrow ends, in m, beside the standard robot: not inside the torso."""
STATUS_GAP = 0.15
"""Distance of the words above the robot, in m, beside the standard robot."""
TOLD_WIDTH = 80
"""Length of the lines of what the scene cannot show, in characters."""
FIRST_CAMERA = Camera(height=0.6, distance=2.1, yaw=150.9, pitch=-11.0, field_of_view=45.8)
"""Camera that a page begins with, for the standard robot."""
WINDOW = (400, 300)
"""Shape of the narrowest window in which all that the first camera must see is seen."""
DRIFT, PUSH_SEEN = 0.25, 150.0
"""Drift of the robot in m, and force of a push in N, that the first camera must see."""


class RobotScene:
    """The robot of an episode's trace, in its state at one of the ticks.

    :param server: server whose scene is filled
    :param robot: robot to show
    """

    def __init__(self, server: viser.ViserServer, robot: RobotDescription) -> None:
        self._server = server
        self._scene = server.scene
        self.stance = self._scene.add_cylinder(
            "/stance", radius=0.17, height=0.004, color=channels(PHASE_COLOURS["shift"]), opacity=0.7, visible=False
        )
        """Disc under the stance leg, in the colour of the phase."""
        self.status = self._scene.add_label("/status", "", anchor="bottom-center")
        """Words above the robot."""
        self._add_robot(robot)
        self.arrows: dict[Vector, viser.ArrowsHandle] = {}
        """Arrows of the episode's pushes, by their force in N."""
        self._ground = LEVEL
        self.bumps: viser.MeshHandle | None = None
        """Rough ground, while an episode has some."""
        self._add_surroundings(first_camera(robot, self._model))
        self._trace: Trace | None = None
        self._told = ""

    def tell(self, words: Sequence[str]) -> None:
        """Write above the robot what the scene cannot show.

        :param words: words about the episode
        """
        self._told = "".join(f"{line}\n" for line in textwrap.wrap(", ".join(words), TOLD_WIDTH))

    def load(self, trace: Trace, spec: EpisodeSpec) -> None:
        """Show another episode.

        :param trace: trace of the episode
        :param spec: specification of the episode, which has its robot and its ground
        """
        self._trace = trace
        if spec.robot != self.robot:
            self._torso.remove()  # and with it what hangs on it
            self._add_robot(spec.robot)
        self._show_ground(spec.ground)
        for handle in self.arrows.values():
            handle.remove()
        self._pushes = trace.shown_pushes()
        forces = [force for force in dict.fromkeys(self._pushes) if force is not None]
        self.arrows = {force: self._add_arrow(index, force) for index, force in enumerate(forces)}

    def _add_robot(self, robot: RobotDescription) -> None:
        self.robot = robot
        self._model = yourdfpy.URDF.load(io.StringIO(robot.urdf), load_meshes=False)
        self._order = [(*ACTUATED_JOINTS, *ANKLE_JOINTS).index(name) for name in self._model.actuated_joint_names]
        self._torso = self._scene.add_frame("/robot", show_axes=False, position=(0.0, 0.0, robot.standing_height))
        self._robot = ViserUrdf(self._server, self._model, root_node_name="/robot")
        self._loads = [self._add_load(robot, *pad) for pad in zip(ANKLE_JOINTS, PAD_COLOURS, strict=True)]
        self.status.position = status_place(robot, self._model)

    def _add_arrow(self, index: int, force: Vector) -> viser.ArrowsHandle:
        return self._scene.add_arrows(
            f"/push/{index}",
            arrow(np.array(force), self.robot.scale)[None],
            channels(PUSH),
            shaft_radius=0.015 * self.robot.scale.length,
            head_radius=0.04 * self.robot.scale.length,
            visible=False,
        )

    def show(self, tick: int) -> None:
        """Show the loaded episode in its state at the beginning of a tick.

        :param tick: row of the trace
        """
        trace = self._trace
        assert trace is not None
        x, y, z, w = trace.orientation[tick]
        with self._server.atomic():
            self._torso.position, self._torso.wxyz = trace.position[tick], np.array([w, x, y, z])
            self._robot.update_cfg(np.concatenate([trace.joints[tick], trace.ankles[tick]])[self._order])
            for bar, load in zip(self._loads, trace.pressures[tick], strict=True):
                scale = self.robot.scale
                height = METRES_PER_NEWTON_OF_LOAD * scale.length / scale.mass * float(load)
                bar.scale = (1.0, 1.0, max(height, 0.001))
            self._show_stance(trace, tick)
            self._show_push(trace, tick)

    def _show_stance(self, trace: Trace, tick: int) -> None:
        self.stance.visible = trace.phase[tick] in PHASE_COLOURS  # a robot that fell while it stood has none
        if not self.stance.visible:
            return
        side = "right" if trace.stance[tick] > 0 else "left"
        hinge = self._model.get_transform(f"{side}_forefoot", "torso")[:3, 3]
        rotation = viser.transforms.SO3(self._torso.wxyz).as_matrix()
        x, y, _ = self._torso.position + rotation @ hinge
        self.stance.position = np.array([x, y, self._ground.height(x, y) + 0.002])
        self.stance.color = channels(PHASE_COLOURS[trace.phase[tick]])

    def _show_ground(self, ground: Ground) -> None:
        """Show bumps over a sunken floor, and turn the whole scene until gravity points down."""
        if ground == self._ground:
            return
        self._ground = ground
        self._scene.set_up_direction(-np.array(ground.gravity))
        if self.bumps is not None:
            self.bumps.remove()
            self.bumps = None
        lowest = 0.0
        if ground.is_rough:
            nodes, triangles = mesh(ground)
            lowest = float(nodes[:, 2].min())
            self.bumps = self._scene.add_mesh_simple(
                "/bumps", nodes, triangles, color=BUMPS, flat_shading=True, cast_shadow=False
            )
        self.floor.position = np.array([0.0, 0.0, lowest])

    def _show_push(self, trace: Trace, tick: int) -> None:
        """Show the push that acts, or has just acted, and all words."""
        shown = self._pushes[tick]
        for force, handle in self.arrows.items():
            handle.visible = force == shown
            handle.position = trace.position[tick]
        push = f"{' '.join(push_words(shown))}\n" if shown is not None else ""
        self.status.text = self._told + push + " · ".join(describe_tick(trace, tick))

    def _add_load(self, robot: RobotDescription, plate: str, colour: str) -> viser.MeshHandle:
        """Add a bar over a plate's soles, whose height shows the load on its pad."""
        side, end = plate.split("_")
        hinge = self._model.joint_map[plate].origin[:3, 3]
        bar = trimesh.creation.cylinder(radius=0.013, segment=((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
        return self._scene.add_mesh_simple(
            f"/robot/visual/{side}_hip/{side}_thigh/{side}_shank/{end}_load",
            bar.vertices,
            bar.faces,
            color=channels(colour),
            position=hinge + np.array([0.0, robot.soles[plate][0][1], 0.0]),
        )

    def _add_surroundings(self, view: Camera) -> None:
        scene = self._scene
        self.floor = scene.add_grid(
            "/floor",
            4.0,
            4.0,
            cell_size=0.1,
            section_size=0.5,
            cell_color=(215, 220, 225),
            section_color=(185, 190, 200),
            plane_color=(243, 245, 248),
            plane_opacity=1.0,
        )
        scene.configure_environment_map(None)  # a map would wash the colours out, and take seconds without a GPU
        scene.add_light_ambient("/daylight", intensity=1.5)
        scene.add_light_directional("/sun", position=(2.0, 3.0, 4.0), intensity=2.5, cast_shadow=False)
        camera = self._server.initial_camera
        camera.position, camera.look_at = View(*WINDOW, view).position, (0.0, 0.0, view.height)
        camera.fov = math.radians(view.field_of_view)


def arrow(force: np.ndarray, scale: Scale = STANDARD) -> np.ndarray:
    """Tail and tip of a push's arrow from the torso's centre, as rows.

    :param force: force of the push, in N; shape (3,)
    :param scale: size of the robot
    """
    gap = scale.length * ARROW_GAP * force / np.linalg.norm(force)
    return push_arrow.arrow(-gap, force, scale)[::-1]


def first_camera(robot: RobotDescription, model: yourdfpy.URDF) -> Camera:
    """Camera that a page begins with: it sees the robot, the words above it and pushes from all sides.

    :param robot: robot to show
    :param model: model of the robot, with all joints at zero
    """
    torso = np.array((0.0, 0.0, robot.standing_height))
    x, y, z = (model.scene.bounds + torso).T
    corners = np.array(list(itertools.product(x, y, z)))
    drift = robot.scale.length * DRIFT
    drifted = [corners + offset for offset in itertools.product((-drift, drift), (-drift, drift), (0.0,))]
    turns = np.linspace(0.0, 2 * np.pi, 36, endpoint=False)
    forces = PUSH_SEEN * robot.scale.mass * np.stack((np.cos(turns), np.sin(turns), np.zeros_like(turns)), axis=1)
    arrows = [torso + arrow(force, robot.scale) for force in forces]
    seen = np.concatenate((*drifted, *arrows, status_place(robot, model)[None]))
    return FIRST_CAMERA.scaled(robot.scale.length).seeing(seen, *WINDOW)


def status_place(robot: RobotDescription, model: yourdfpy.URDF) -> np.ndarray:
    """Place of the words above a robot, in m; shape (3,).

    :param robot: robot to show
    :param model: model of the robot, with all joints at zero
    """
    top = robot.standing_height + model.scene.bounds[1, 2]
    return np.array((0.0, 0.0, top + STATUS_GAP * robot.scale.length))


def describe_tick(trace: Trace, tick: int) -> tuple[str, str]:
    """Two lines of text for a tick: time, phase and stance leg; steps per second and score.

    :param trace: trace of the episode
    :param tick: row of the trace
    """
    side = "right" if trace.stance[tick] > 0 else "left"
    score = trace.score[tick]
    scored = "" if math.isnan(score) else f" · score so far {score:.2f}"  # nobody knows it of a logged robot
    return (
        f"{trace.time[tick]:.1f} s · {trace.phase[tick].upper()}, {side} stance leg",
        f"{trace.steps_per_second[tick]:.1f} steps/s{scored}",
    )
