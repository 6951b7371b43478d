"""Written FBX files in Assimp: `assimp export FILE.fbx` to its own JSON, played here and compared.

    python3 tests/tools/fbx_assimp_check.py [FILE.fbx ..]     # without names: all of target/fbx

Needs the program `assimp` (Debian: assimp-utils). `cargo test fbx_out` writes the files, and beside each where its bones must be on
every frame (the file's metres, Y up; "units" of them are a metre of the body). Held: numbers are finite, joints within 0.5 mm, every
bone there under its name, one take with its name.
"""

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

NEAR = 0.5e-3  # m
CENTIMETRE = 0.01  # m: the unit of the files


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def local(place, turn, size):
    w, x, y, z = turn
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return [[row[j] * size[j] for j in range(3)] + [place[i]] for i, row in enumerate(rows)] + [[0, 0, 0, 1]]


def mixed(keys, time, turn=False):
    """The value between two keys as Assimp's viewers take it: straight, rotations on the shorter arc."""
    after = next((at for at, key in enumerate(keys) if key[0] >= time - 1e-6), len(keys) - 1)
    before = max(after - 1, 0)
    (start, one), (end, other) = keys[before], keys[after]
    share = 1.0 if end <= start else min(max((time - start) / (end - start), 0.0), 1.0)
    if turn and sum(a * b for a, b in zip(one, other)) < 0:
        other = [-part for part in other]
    value = [a + (b - a) * share for a, b in zip(one, other)]
    length = math.hypot(*value) if turn else 1.0
    return [part / length for part in value]


def check(path):
    told = json.loads(path.with_suffix(".json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "scene.json"
        subprocess.run(["assimp", "export", str(path), str(out), "-fassjson"], check=True, capture_output=True)
        scene = json.loads(out.read_text())
    faults = []
    takes = scene.get("animations", [])
    if [take["name"] for take in takes] != [told["take"]]:
        return [f"takes {[take['name'] for take in takes]}: there is one, {told['take']}"], (0.0, "")
    take = takes[0]
    rate = take["tickspersecond"] or 25.0
    channels = {channel["name"]: channel for channel in take["channels"]}
    found = set()
    worst = (0.0, "")

    def walk(node, above, frame, at):
        matrix = [node["transformation"][4 * row : 4 * row + 4] for row in range(4)]
        channel = channels.get(node["name"])
        if channel:
            ticks = frame / told["fps"] * rate
            matrix = local(
                mixed(channel["positionkeys"], ticks),
                mixed(channel["rotationkeys"], ticks, turn=True),
                mixed(channel["scalingkeys"], ticks),
            )
        placed = product(above, matrix)
        at[node["name"]] = [placed[row][3] for row in range(3)]
        found.add(node["name"])
        for child in node.get("children", []):
            walk(child, placed, frame, at)

    unit = [[float(i == j) for j in range(4)] for i in range(4)]
    for frame, places in list(enumerate(told["frames"]))[::5]:
        at = {}
        walk(scene["rootnode"], unit, frame, at)
        for name, wanted in zip(told["names"], places):
            if name in at:
                off = math.dist([part * CENTIMETRE for part in at[name]], wanted) / told["units"]
                worst = max(worst, (off if math.isfinite(off) else math.inf, f"{name} on frame {frame}"))
    missing = [name for name in told["bones"] if name not in found]
    if missing:
        faults.append(f"not there: {missing[:5]}")
    if not worst[0] <= NEAR:
        faults.append(f"a joint is {worst[0] * 1e3:.3f} mm off: {worst[1]}")
    return faults, worst


def main():
    folder = Path(__file__).resolve().parents[2] / "target" / "fbx"
    paths = [Path(name) for name in sys.argv[1:]] or sorted(folder.glob("*.fbx"))
    bad = 0
    for path in paths:
        faults, worst = check(path)
        bad += bool(faults)
        print(f"{path.name}: {worst[0] * 1e3:.4f} mm at most ({worst[1]})" + "".join(f"\n  FAULT {fault}" for fault in faults))
    print(f"Assimp: {len(paths)} files, {bad} with faults")
    return 1 if bad or not paths else 0


sys.exit(main())
