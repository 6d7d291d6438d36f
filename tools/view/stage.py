"""The drawing on viser's scene: nodes are made once, then only what has changed is sent."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import numpy as np
import viser

from surefoot.tools.view.drawing import Arrows, Drawing, Item, Lines, Mesh, Shapes, Words
from surefoot.tools.view.unit_shapes import unit_shape

_WORLD = "/world"
_MORE = 1.5  # room for more copies of a shape is made by this factor
_AMBIENT = 0.9
_FOG_M = (4.0, 14.0)
_CAMERA_M, _LOOK_AT_M = (0.75, -1.15, 0.6), (0.15, 0.0, 0.15)


class Stage:
    """One scene for every browser that looks.

    The world is moved under the camera instead of the camera over the world: a person turns and zooms freely while
    the robot stays in the middle.
    """

    def __init__(self, server: viser.ViserServer, layers: Collection[str]):
        """An empty stage with layers that can be hidden."""
        self._scene = server.scene
        self._scene.set_up_direction("+z")
        self._scene.configure_environment_map(None)  # its light washes the colours out
        self._scene.configure_default_lights(cast_shadow=False)
        self._scene.add_light_ambient("/light", intensity=_AMBIENT)
        self._scene.configure_fog(*_FOG_M)
        server.initial_camera.position, server.initial_camera.look_at = _CAMERA_M, _LOOK_AT_M
        self._world = self._scene.add_frame(_WORLD, show_axes=False)
        self._layers = {layer: self._scene.add_frame(f"{_WORLD}/{layer}", show_axes=False) for layer in layers}
        self._nodes: dict[str, _Node] = {}

    def show(self, drawing: Drawing, focus_W: np.ndarray | None) -> None:
        """Make the scene what the drawing says.

        Args:
            drawing: what is not in it disappears.
            focus_W: (3,) what comes to stand in the middle [m]; None leaves all where it is.
        """
        for name in self._nodes.keys() - drawing.keys():
            self._nodes[name].hide()
        for name, item in drawing.items():
            if name not in self._nodes or not self._nodes[name].takes(item):
                self._nodes[name] = _Node(self._scene, f"{_WORLD}/{name}", item)
            self._nodes[name].show(item)
        if focus_W is not None:
            self._world.position = -focus_W

    def set_visible(self, layer: str, visible: bool) -> None:
        """Show or hide a layer."""
        self._layers[layer].visible = visible

    def clear(self) -> None:
        """Take everything away: another run has another terrain."""
        for node in self._nodes.values():
            node.remove()
        self._nodes.clear()


class _Node:
    """One item on viser's scene."""

    def __init__(self, scene: viser.SceneApi, name: str, item: Item):
        self._kind = type(item)
        self._item: Item | None = None
        self._visible = True
        self._room = 0
        if isinstance(item, Shapes):
            self._shape = item.kind
            self._room = int(_MORE * len(item.p_W)) + 1
        self._handle: Any = _MAKE[type(item)](scene, name, item, self._room)

    def takes(self, item: Item) -> bool:
        """Whether the item can be shown by this node."""
        if type(item) is not self._kind:
            return False
        return not isinstance(item, Shapes) or (item.kind == self._shape and len(item.p_W) <= self._room)

    def show(self, item: Item) -> None:
        """Send what differs from the last time."""
        if item is self._item:
            return
        handle, last, self._item = self._handle, self._item, item
        match item:
            case Shapes():
                self._show_shapes(item, last if isinstance(last, Shapes) else None)
            case Mesh():
                handle.vertices, handle.faces = item.vertices_W.astype(np.float32), item.faces.astype(np.uint32)
            case Lines() | Arrows():
                if len(item.points_W):
                    handle.points = item.points_W.astype(np.float32)
                self._set_visible(len(item.points_W) > 0)
                return
            case Words():
                handle.text, handle.position = item.text, item.p_W
        self._set_visible(True)

    def _show_shapes(self, item: Shapes, last: Shapes | None) -> None:
        """An array that is the same object as before is not even compared."""
        handle, room = self._handle, self._room
        if last is None or item.p_W is not last.p_W:
            handle.batched_positions = _filled(item.p_W, room)
        if last is None or item.quat_W is not last.quat_W:
            handle.batched_wxyzs = _filled(item.quat_W, room, unit=True)
        if last is None or item.size_m is not last.size_m:
            handle.batched_scales = _filled(item.size_m, room)
        if last is None or item.rgb is not last.rgb:
            handle.batched_colors = _filled(item.rgb, room).astype(np.uint8)

    def hide(self) -> None:
        """Until it is shown again."""
        self._item = None
        self._set_visible(False)

    def _set_visible(self, visible: bool) -> None:
        """Of most items nothing changes, and viser takes longer to find that out."""
        if visible != self._visible:
            self._handle.visible = self._visible = visible

    def remove(self) -> None:
        """For ever."""
        self._handle.remove()


def _filled(rows: np.ndarray, room: int, unit: bool = False) -> np.ndarray:
    """(room, k) rows (n, k), and below them zeros, or unit quaternions: of size zero nothing is seen."""
    filled = np.zeros((room, rows.shape[1]), np.float32)
    filled[: len(rows)] = rows
    if unit:
        filled[len(rows) :, 0] = 1.0
    return filled


def _add_shapes(scene: viser.SceneApi, name: str, item: Shapes, room: int) -> Any:
    vertices, faces = unit_shape(item.kind)
    return scene.add_batched_meshes_simple(
        name,
        vertices,
        faces,
        _filled(item.quat_W, room, unit=True),
        _filled(item.p_W, room),
        batched_scales=_filled(item.size_m, room),
        batched_colors=_filled(item.rgb, room).astype(np.uint8),
        opacity=item.opacity if item.opacity < 1.0 else None,
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
    )


def _add_mesh(scene: viser.SceneApi, name: str, item: Mesh, room: int) -> Any:
    return scene.add_mesh_simple(
        name,
        item.vertices_W,
        item.faces,
        color=item.rgb,
        opacity=item.opacity if item.opacity < 1.0 else None,
        flat_shading=True,
        side="double",
        cast_shadow=False,
        receive_shadow=False,
    )


def _add_lines(scene: viser.SceneApi, name: str, item: Lines, room: int) -> Any:
    points = item.points_W if len(item.points_W) else np.zeros((1, 2, 3))
    return scene.add_line_segments(name, points, item.rgb, thickness=item.thickness_m)


def _add_arrows(scene: viser.SceneApi, name: str, item: Arrows, room: int) -> Any:
    points = item.points_W if len(item.points_W) else np.zeros((1, 2, 3))
    radius = item.radius_m
    return scene.add_arrows(
        name, points, item.rgb, shaft_radius=radius, head_radius=2.2 * radius, head_length=5.0 * radius
    )


def _add_words(scene: viser.SceneApi, name: str, item: Words, room: int) -> Any:
    return scene.add_label(name, item.text, position=item.p_W, font_screen_scale=0.8, anchor="bottom-center")


_MAKE: dict[type, Callable[[viser.SceneApi, str, Any, int], Any]] = {
    Shapes: _add_shapes,
    Mesh: _add_mesh,
    Lines: _add_lines,
    Arrows: _add_arrows,
    Words: _add_words,
}
