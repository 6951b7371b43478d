"""What a clip of a .glb says, by glTF 2.0's own rules: the reference of the checks in Python.

World positions of nodes, in the file's axes and units. Interpolation as appendix C of the specification has it: STEP, LINEAR (rotations: slerp by the
shorter way), CUBICSPLINE (tangents times the key's interval, rotations normalised); before the first key the first, after the last the last.
Shares nothing with the program. Leaves out: sparse accessors, buffers outside of the file, weights of morph targets.
"""

import json
import struct
from pathlib import Path

import numpy as np

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
PLANTED = 3e-3  # m; a joint that the file itself holds within this while a foot lies flat is a planted one
STEP = 0.01  # s, between two samples


class Glb:
    """One .glb: its JSON, its bytes, its nodes' parents."""

    def __init__(self, path: Path):
        data = Path(path).read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + length])
        self.bytes = data[20 + length + 8 :]
        self.nodes = self.json.get("nodes", [])
        self.parents = {child: node for node, held in enumerate(self.nodes) for child in held.get("children", [])}

    def array(self, index: int) -> np.ndarray:
        """An accessor's values, (count x width), integers as glTF normalises them."""
        accessor = self.json["accessors"][index]
        assert "sparse" not in accessor, "sparse accessors are not read here"
        kind, width, count = COMPONENTS[accessor["componentType"]], WIDTHS[accessor["type"]], accessor["count"]
        if "bufferView" not in accessor:
            return np.zeros((count, width))
        view = self.json["bufferViews"][accessor["bufferView"]]
        size = np.dtype(kind).itemsize
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", size * width)
        raw = np.ndarray((count, width), kind, self.bytes, start, (stride, size))
        values = raw.astype(np.float64)
        if accessor.get("normalized"):
            values = np.maximum(values / np.iinfo(kind).max, -1.0)
        return values

    def clips(self) -> list[tuple[int, str, dict]]:
        """The clips that carry a report: index, name, report."""
        found = enumerate(self.json.get("animations", []))
        told = ((at, clip.get("name", ""), clip.get("extras", {}).get("surefoot")) for at, clip in found)
        return [one for one in told if one[2]]

    def joints(self) -> list[int]:
        """Skins' joints, and whatever a clip moves but by STEP (contact nodes jump at the very moment of a sample)."""
        found = {joint for skin in self.json.get("skins", []) for joint in skin["joints"]}
        for clip in self.json.get("animations", []):
            ways = [clip["samplers"][channel["sampler"]].get("interpolation") for channel in clip["channels"]]
            targets = [channel["target"] for channel in clip["channels"]]
            found |= {target["node"] for target, way in zip(targets, ways) if "node" in target and way != "STEP"}
        return sorted(found & self.shown())

    def shown(self) -> set[int]:
        """The nodes of the default scene: others have no place."""
        scenes = self.json.get("scenes", [])
        if not scenes:
            return set(range(len(self.nodes)))
        todo, found = list(scenes[self.json.get("scene", 0)].get("nodes", [])), set()
        while todo:
            node = todo.pop()
            found.add(node)
            todo += self.nodes[node].get("children", [])
        return found

    def times(self, clip: int) -> np.ndarray:
        """Every 10 ms of the clip, s."""
        samplers = self.json["animations"][clip]["samplers"]
        last = max(self.array(sampler["input"])[-1, 0] for sampler in samplers)
        return np.arange(0.0, last + 1e-9, STEP)

    def places(self, clip: int, times: np.ndarray) -> dict[int, np.ndarray]:
        """World positions of every node at those times, (times x 3)."""
        animation = self.json["animations"][clip]
        moved = {}
        for channel in animation["channels"]:
            target = channel["target"]
            if "node" in target and target["path"] != "weights":
                sampler = animation["samplers"][channel["sampler"]]
                moved[target["node"], target["path"]] = self.sample(sampler, target["path"], times)
        worlds = {}

        def world(node: int) -> np.ndarray:
            if node not in worlds:
                own = self.local(node, moved, len(times))
                worlds[node] = world(self.parents[node]) @ own if node in self.parents else own
            return worlds[node]

        return {node: world(node)[:, :3, 3] for node in range(len(self.nodes))}

    def local(self, node: int, moved: dict, count: int) -> np.ndarray:
        """A node's local matrices, (times x 4 x 4)."""
        held = self.nodes[node]
        if "matrix" in held:
            return np.broadcast_to(np.array(held["matrix"]).reshape(4, 4).T, (count, 4, 4))
        rest = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
        t, r, s = (moved.get((node, path), np.broadcast_to(np.array(held.get(path, value), float), (count, len(value)))) for path, value in rest.items())
        x, y, z, w = (r / np.linalg.norm(r, axis=1, keepdims=True)).T
        matrix = np.zeros((count, 4, 4))
        matrix[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], 1)
        matrix[:, 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], 1)
        matrix[:, 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1)
        matrix[:, :3, :3] *= s[:, None, :]
        matrix[:, :3, 3] = t
        matrix[:, 3, 3] = 1.0
        return matrix

    def sample(self, sampler: dict, path: str, times: np.ndarray) -> np.ndarray:
        """A sampler's values at those times."""
        keys, values = self.array(sampler["input"])[:, 0], self.array(sampler["output"])
        way = sampler.get("interpolation", "LINEAR")
        if way == "CUBICSPLINE":
            values = values.reshape(len(keys), 3, -1)
        at = np.clip(np.searchsorted(keys, times, "right") - 1, 0, len(keys) - 1)
        after = np.minimum(at + 1, len(keys) - 1)
        span = keys[after] - keys[at]
        u = np.where(span > 0, (times - keys[at]) / np.where(span > 0, span, 1), 0.0)
        u = np.clip(u, 0.0, 1.0)[:, None]
        if way == "STEP":
            return values[at]
        if way == "CUBICSPLINE":
            span = span[:, None]
            result = (2 * u**3 - 3 * u**2 + 1) * values[at, 1] + (u**3 - 2 * u**2 + u) * span * values[at, 2]
            result = result + (3 * u**2 - 2 * u**3) * values[after, 1] + (u**3 - u**2) * span * values[after, 0]
            return result
        return slerp(values[at], values[after], u) if path == "rotation" else values[at] + u * (values[after] - values[at])


def slerp(a: np.ndarray, b: np.ndarray, u: np.ndarray) -> np.ndarray:
    """From a to b by the shorter way."""
    dot = np.sum(a * b, axis=1, keepdims=True)
    b, dot = np.where(dot < 0, -b, b), np.abs(dot)
    angle = np.arccos(np.clip(dot, 0.0, 1.0))
    near = angle < 1e-6
    sine = np.where(near, 1.0, np.sin(angle))
    return np.where(near, a + u * (b - a), (np.sin((1 - u) * angle) * a + np.sin(u * angle) * b) / sine)


def compare(report: dict, joints: list[int], times: np.ndarray, due: dict, found: dict, unit: float) -> dict:
    """How far a program's joints (found) are from the reference (due), m; `unit`: the file's units a metre.

    off, at: the worst joint. planted: how many spans of a joint that stands still while a foot lies flat there are; slid: the most that one of them
    moves in the program; more: the most that it moves beyond the reference.
    """
    told = {"off": 0.0, "at": "", "planted": 0, "slid": 0.0, "more": 0.0, "slid_at": ""}
    for joint in joints:
        off = np.linalg.norm(found[joint] - due[joint], axis=1) / unit
        if not np.all(np.isfinite(off)):
            return told | {"off": float("inf"), "at": f"node {joint} is not finite"}
        if off.max() > told["off"]:
            told |= {"off": float(off.max()), "at": f"node {joint} at {times[off.argmax()]:.2f} s"}
    for contact in report.get("contacts", []):
        inside = (times >= contact["start"]) & (times <= contact["end"])
        if contact["part"] != "flat" or contact.get("frame", "world") != "world" or inside.sum() < 3:
            continue
        for joint in joints:
            own, seen = (np.linalg.norm(way[joint][inside] - way[joint][inside][0], axis=1).max() / unit for way in (due, found))
            if own > PLANTED or not near(contact, due[joint][inside][0], unit):
                continue
            told["planted"] += 1
            if seen - own > told["more"]:
                told |= {"more": float(seen - own), "slid_at": f"node {joint}, {contact['foot']} from {contact['start']:.2f} s"}
            told["slid"] = max(told["slid"], float(seen))
    return told


def near(contact: dict, place: np.ndarray, unit: float) -> bool:
    """Whether a joint belongs to the foot that stands there: within 0.4 m of the contact's point."""
    return float(np.linalg.norm(place - np.array(contact["position"]))) / unit < 0.4
