"""What MuJoCo takes for a step of a humanoid that stands on a plane, with nothing but its joints' springs: the engine alone, no law.

    python3 tests/tools/mujoco_tick.py

Prints a line; `cargo bench --bench ragdoll -- ticks` calls it, and prints it beside what the articulated body takes. The body is as the
built-in rig's figure: the same links and joints (the freedoms of both are told), 90 kg, box feet whose four corners each touch the
ground, steps of 5 ms, two of which are a tick, at the engine's default solver. Wants the package `mujoco`.
"""

import sys
import time

try:
    import mujoco
except ImportError:
    sys.exit("skipped: the Python package mujoco is not there (pip install mujoco)")


def joint(axes, stiffness, damping):
    return "".join(
        f'<joint axis="{axis}" stiffness="{stiffness}" damping="{damping}" armature="0.01"/>' for axis in axes
    )


BALL = ("1 0 0", "0 1 0", "0 0 1")
TWO = ("1 0 0", "0 1 0")
HINGE = ("0 1 0",)


def body(place, joints, shape, mass, inside=""):
    return f'<body pos="{place}">{joints}<geom {shape} mass="{mass}" contype="0" conaffinity="0"/>{inside}</body>'


def capsule(to, radius):
    return f'type="capsule" fromto="0 0 0 {to}" size="{radius}"'


def arm(side):
    hand = body("0 0 -0.26", joint(TWO, 20, 1), 'type="sphere" size="0.05"', 0.6)
    forearm = body("0 0 -0.30", joint(HINGE, 60, 3), capsule("0 0 -0.26", 0.035), 1.6, hand)
    return body(f"0 {0.19 * side} 0.38", joint(BALL, 80, 4), capsule("0 0 -0.30", 0.045), 2.6, forearm)


def leg(side):
    foot = (
        f'<body pos="0 0 -0.41">{joint(TWO, 900, 25)}'
        '<geom type="box" size="0.125 0.045 0.02" pos="0.055 0 -0.06" mass="1.2"/></body>'
    )
    shank = body("0 0 -0.42", joint(HINGE, 1500, 40), capsule("0 0 -0.41", 0.05), 4.0, foot)
    return body(f"0 {0.09 * side} 0", joint(BALL, 1500, 40), capsule("0 0 -0.42", 0.07), 12.0, shank)


def humanoid():
    head = body("0 0 0.45", joint(BALL, 150, 5), 'type="sphere" pos="0 0 0.12" size="0.11"', 6.2)
    trunk = body("0 0 0.10", joint(BALL, 1500, 40), capsule("0 0 0.40", 0.12), 28.0, head + arm(1) + arm(-1))
    pelvis = '<freejoint/><geom type="box" size="0.09 0.15 0.08" mass="10" contype="0" conaffinity="0"/>'
    return (
        '<mujoco><option timestep="0.005"/><worldbody><geom type="plane" size="5 5 1"/>'
        f'<body pos="0 0 0.909">{pelvis}{trunk}{leg(1)}{leg(-1)}</body></worldbody></mujoco>'
    )


model = mujoco.MjModel.from_xml_string(humanoid())
data = mujoco.MjData(model)
mujoco.mj_step(model, data, 400)
AT_ONCE = 10
times = []
for _ in range(300):
    begun = time.perf_counter()
    mujoco.mj_step(model, data, AT_ONCE)
    times.append((time.perf_counter() - begun) / AT_ONCE)
if not 0.8 < data.qpos[2] < 1.0:
    sys.exit(f"skipped: MuJoCo's body does not stand, its pelvis is at {data.qpos[2]:.2f} m")
median = sorted(times)[len(times) // 2] * 1e6
print(
    f"MuJoCo {mujoco.__version__}, a standing body of {model.nv} degrees of freedom and {data.ncon} contacts, no law: "
    f"a step of 5 ms {median:.0f} µs, a tick of two {2 * median:.0f} µs"
)
