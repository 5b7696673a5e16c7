"""python_calls.py: what test_host_python.sh asks of port/python/smr.py.

usage: python_calls.py inputs DIR             writes what twin_tool reads, prints its arguments
       python_calls.py twin DIR               the same registrations as twin_tool, the same lines
       python_calls.py behave DIR             prints ok and not ok lines
SPDX-License-Identifier: MIT
"""
import gc
import os
import pickle
import sys
import warnings
import weakref

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "port", "python"))
import smr  # noqa: E402

FRAMES, MARKS, CARRIED, VOXELS = 5, 6, 9, 30


# ------------------------------------------------------------------ inputs

def bone(n, m, bend=0.0):
    """A bone-like closed surface of 2 + n m vertices, 60 mm wide and 200 long, bent."""
    z = np.repeat(np.cos(np.pi * np.arange(1, n + 1) / (n + 1)), m)
    angle = np.tile(2 * np.pi * np.arange(m) / m, n)
    r = np.sqrt(1 - z * z) * (1 + 0.5 * z * z) * (1 + 0.4 * z) * (1 + 0.1 * np.cos(2 * angle) + 0.3 * z * np.sin(angle))
    xyz = np.stack([16 * r * np.cos(angle), 13 * r * np.sin(angle), 60 * z], 1)
    xyz = np.concatenate([[[0, 0, 60]], xyz, [[0, 0, -60]]])
    xyz[:, 0] += bend * (xyz[:, 2] / 60) ** 2
    ring = lambda i, j: 1 + i * m + j % m  # noqa: E731
    triangles = [[0, ring(0, j), ring(0, j + 1)] for j in range(m)]
    triangles += [t for i in range(n - 1) for j in range(m)
                  for t in ([ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)],
                            [ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)])]
    triangles += [[ring(n - 1, j), 1 + n * m, ring(n - 1, j + 1)] for j in range(m)]
    return xyz.astype(np.float32), np.array(triangles, np.uint32)


def image(bend):
    """A bright bone in a dark image: voxels of 3 x 3 x 4 mm from (-45, -45, -70)."""
    z, y, x = np.meshgrid(*[np.arange(VOXELS)] * 3, indexing="ij")
    z = (4 * z - 70) / 60.0
    x, y = 3 * x - 45 - bend * z * z, 3 * y - 45
    r = np.sqrt((x / 16) ** 2 + (y / 13) ** 2 + z * z)
    return np.clip(230 - 150 * (r - 0.6) + 20 * np.sin(x / 7.0 + y / 5.0), 10, 240).astype(np.uint8)


def make_inputs(folder):
    rest, triangles = bone(20, 14)
    now = bone(20, 14, 7.0)[0]
    frames = np.stack([now + np.float32(i) * np.float32([0.4, 0.2, -0.3]) for i in range(FRAMES)])
    points = np.float32([[i, 2 * i - 8, 10 * i - 40] for i in range(CARRIED)])
    for name, a in (("rest.f32", rest), ("now.f32", now), ("frames.f32", frames), ("points.f32", points),
                    ("triangles.u32", triangles), ("reference.u8", image(0)), ("image.u8", image(4))):
        a.tofile(os.path.join(folder, name))
    print(len(rest), len(triangles), VOXELS)


def load(folder):
    read = lambda name, kind: np.fromfile(os.path.join(folder, name), kind)  # noqa: E731
    rest = read("rest.f32", np.float32).reshape(-1, 3)
    return (rest, read("triangles.u32", np.uint32).reshape(-1, 3), read("now.f32", np.float32).reshape(-1, 3),
            read("frames.f32", np.float32).reshape(FRAMES, -1, 3), read("points.f32", np.float32).reshape(-1, 3))


def volume(folder, name):
    voxels = np.fromfile(os.path.join(folder, name), np.uint8).reshape(VOXELS, VOXELS, VOXELS)
    return smr.Volume(voxels, (3, 3, 4), (-45, -45, -70))


# ------------------------------------------------------------------ the twin

def bits(a):
    return "".join(f" {word:08x}" for word in np.ascontiguousarray(a, np.float32).ravel().view(np.uint32))


def end(name, hash_, verdict):
    print(f"{name} {hash_:016x}")
    figures = [getattr(verdict, field) for field, _ in verdict._fields_[2:]]
    print(f"{name}.verdict {verdict.level} {verdict.reasons}{bits(np.float32(figures))}")


def twin(folder):
    rest, triangles, now, frames, points = load(folder)
    model = smr.Model.prepare({"bone": (rest, triangles)})
    result = smr.register(model, (now, triangles), threads=2)
    end("surface", result.hash, result.verdict)
    result = smr.register(model, (now, triangles), method="polar", search_mm=25, ticks=12)
    end("polar", result.hash, result.registration.verdict())
    pose = smr.align(smr.Surface(rest, triangles), smr.Surface(now, triangles))[0]
    print("align" + bits(pose))
    assert np.array_equal(pose, smr.align((rest, triangles), (now, triangles))[0])
    cloud = smr.Points(len(now))
    cloud.add(now[:len(now) // 2])
    result = smr.register(model, cloud)
    end("points", result.hash, result.verdict)
    at = [i * (len(rest) // MARKS) for i in range(MARKS)]
    marks = [smr.Landmark(now[v], vertex=v, structure="bone", weight=2, hard=i % 2 == 1) for i, v in enumerate(at)]
    result = smr.register(model, landmarks=marks)
    end("landmarks", result.hash, result.verdict)
    pictured = smr.Model.prepare({"bone": (rest, triangles)}, volume(folder, "reference.u8"))
    result = smr.register(pictured, volume(folder, "image.u8"))
    end("image", result.hash, result.verdict)
    first = [smr.Surface(frames[0], triangles)]
    for frame in smr.track(model, first + list(frames[1:])):
        print(f"track.{frame.number} {frame.registration.hash:016x}")
    carry = smr.Carry(model, points)
    print("carry" + bits(carry.apply(now)))
    back, facts = carry.map(now, points, inverse=True)
    print("back" + bits(back))
    print("facts" + bits(np.stack([facts["miss_mm"], facts["volume"]], 1)))


# ------------------------------------------------------------------ behaviour

counts = [0, 0]


def check(name, good):
    counts[0 if good else 1] += 1
    print(("ok " if good else "not ok ") + "python: " + name)


def refused(name, kind, text, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except kind as error:
        check(f"{name}: {error}", all(part in str(error) for part in text.split("...")))
    else:
        check(f"{name} is refused", False)


def hash_of(model, xyz, triangles, **settings):
    return smr.register(model, (xyz, triangles), ticks=6, **settings).hash


def arrays(model, rest, triangles, now):
    want = hash_of(model, now, triangles)
    check("float64 and int64 are converted", hash_of(model, now.astype(float), triangles.astype(np.int64)) == want)
    check("lists are taken", hash_of(model, now.tolist(), triangles.tolist()) == want)
    strided = np.zeros((len(now), 6), np.float32)
    strided[:, ::2] = now
    check("strides and Fortran order are copied",
          hash_of(model, strided[:, ::2], np.asfortranarray(triangles)) == want)
    check("other byte orders are turned", hash_of(model, now.astype(">f4"), triangles.astype(">u4")) == want)
    check("three threads give the bits of one", hash_of(model, now, triangles, threads=3) == want)
    check("another setting gives others", hash_of(model, now, triangles, stiffness=0.5) != want)
    refused("a flat array", ValueError, "[n][3]", smr.Surface, now.ravel(), triangles)
    refused("complex positions", TypeError, "real numbers", smr.Surface, now.astype(complex), triangles)
    refused("triangles of floats", TypeError, "whole numbers", smr.Surface, now, triangles.astype(float))
    refused("a negative index", smr.SmrError, "SMR_E_INPUT", smr.Surface, now, -triangles.astype(np.int64))
    refused("an index beyond the vertices", smr.SmrError, "smr_surface_build", smr.Surface, now[:9], triangles)
    refused("a NaN", smr.SmrError, "finite positions", smr.Surface, now * np.nan, triangles)
    refused("1e300", smr.SmrError, "finite positions", smr.Surface, now * 1e300, triangles)
    refused("positions of another number", ValueError, "vertices", smr.Registration(model).set_positions, 0, now[1:])


def settings(model, now, triangles):
    check("a word is its index", smr.Registration(model, method="polar").setting("method") == 1)
    check("an array is set", smr.Registration(model, box_min=[-1, -2, -3]).setting("box_min") == [-1, -2, -3])
    refused("a setting that is not there", TypeError, "no setting", smr.Registration, model, stifness=1)
    refused("a word that is not there", smr.SmrError, "rigid, polar", smr.Registration, model, method="soft")
    refused("a value out of range", smr.SmrError, "(0, 1]", smr.Registration, model, stiffness=0)
    refused("half an iteration", TypeError, "whole number", smr.Registration, model, iterations=1.5)
    refused("65 threads", smr.SmrError, "1 to 64", smr.Registration, model, threads=65)
    rest = model.mesh(0)
    soft = smr.Model.prepare({"a": rest}, radius_mm=[40, 20, 6.5])
    check("radii are set with their number", list(soft.info.radius_mm)[:soft.info.n_radii] == [40, 20, 6.5])
    refused("a setting of the other table", TypeError, "no setting", smr.Model.prepare, rest, stiffness=1)
    check("the tables have the sentences", "rotation" in smr.SETTINGS["method"].text)


def models(model, folder, now, triangles):
    path = os.path.join(folder, "bone.smr")
    model.save(path)
    want = hash_of(model, now, triangles)
    check("a saved model is the same", hash_of(smr.Model.open(path), now, triangles) == want)
    check("so are its bytes", hash_of(smr.Model.open(bytes(model)), now, triangles) == want)
    check("a mesh comes back as it was given", (model.mesh("bone")[1] == triangles).all() and len(model) == 1)
    damaged = bytearray(bytes(model))
    damaged[len(damaged) // 2] ^= 1
    refused("a damaged model", smr.SmrError, "SMR_E_MODEL", smr.Model.open, damaged)
    refused("half a model", smr.SmrError, "SMR_E_MODEL", smr.Model.open, bytes(model)[:1000])
    refused("no model", smr.SmrError, "SMR_E_MODEL", smr.Model.open, b"")
    refused("a structure that is not there", KeyError, "femur", model.mesh, "femur")
    refused("a structure's number that is not there", smr.SmrError, "no structure", model.mesh, 1)
    try:
        model._memory[0] = 1
        check("a model cannot be written to", False)
    except ValueError:
        check("a model cannot be written to", True)


def n_threads():
    return len(os.listdir("/proc/self/task")) if os.path.isdir("/proc/self/task") else 0


def ownership(rest, triangles, now):
    """Inputs that nobody else holds stay while they are borrowed."""
    want = smr.register(smr.Model.prepare((rest, triangles)), (now, triangles)).hash
    s = smr.Registration(smr.Model.prepare((rest, triangles)), smr.Surface(now.copy(), triangles.copy()))
    gc.collect()
    rubbish = [np.full(1 << 16, 255, np.uint8) for _ in range(200)]
    for _ in s.run():
        pass
    check("what is borrowed is kept", s.hash == want and len(rubbish) == 200)
    surface = smr.Surface(now, triangles)
    s = smr.Registration(smr.Model.prepare((rest, triangles)), surface)
    held = sys.getrefcount(surface)
    s.set_surface(smr.Surface(now, triangles), 0)
    s.set_surface(None)
    check("and let go when it is replaced", sys.getrefcount(surface) < held)
    before = n_threads()
    ended = smr.Registration(smr.Model.prepare((rest, triangles)), threads=4)
    del ended
    gc.collect()
    check("threads end with their registration", n_threads() == before)


def ticks(model, rest, triangles, now):
    s = smr.Registration(model, (now, triangles))
    partial = sum(not s.tick(1).complete for _ in range(50))
    check(f"a budget of 1 ns ends within iterations: {partial} of 50 ticks", partial > 25)
    while s.tick(1).complete:
        pass
    refused("a verdict within an iteration", smr.SmrError, "SMR_E_STATE", s.verdict)
    seen = []
    result = smr.register(model, (now, triangles), align="rigid", progress=seen.append)
    check("progress is told of each tick", len(seen) > 10 and seen[-1].done == 1)
    off = np.linalg.norm(result.positions[0] - now, axis=1)
    check(f"a good result: {off.mean():.2f} mm from the truth", off.mean() < 1.5 and result.verdict.word == "good")
    check("its expected error is a number for each vertex", np.isfinite(result.expected_error[0]).all()
          and len(result.expected_error[0]) == len(rest) and result.visible[0].dtype == bool)
    half = smr.register(model, {"bone": (now, triangles[np.all(now[triangles][:, :, 2] > 30, 1)])})
    seen, error = half.visible[0], half.expected_error[0]
    check(f"an end of a target: {seen.sum()} of {len(rest)} vertices are seen, the others are less certain",
          0 < seen.sum() < len(rest) / 2 and np.mean(error[~seen]) > 1.5 * np.mean(error[seen]))
    nothing = smr.register(model, (now + 5000, triangles))
    check("a target out of reach failed", nothing.verdict.word == "failed" and len(nothing.verdict.why) > 0)
    check("and has no expected error", np.isnan(nothing.expected_error[0]).any())
    turned = smr.apply_pose([[0, -1, 0, 50], [1, 0, 0, -20], [0, 0, 1, 300]], now)
    result = smr.register(model, (turned, triangles), align="similarity")
    off = np.linalg.norm(result.positions[0] - turned, axis=1)
    check(f"align finds a bone that lies elsewhere: {off.mean():.2f} mm", off.mean() < 2 and result.start is not None
          and result.pose.shape == (3, 4))
    egg = rest / np.linalg.norm(rest, axis=1, keepdims=True) * np.float32([30, 20, 60])
    symmetric, away = smr.Model.prepare((egg, triangles)), egg[:, [1, 2, 0]] * np.float32([1, 1, -1])
    for what, words, doubted in (
            ("ticks that end first", "ticks ended first", smr.register(model, (now, triangles), ticks=1)),
            ("a target inside out", "inside out", smr.register(model, (turned, triangles[:, ::-1]), align="rigid")),
            ("a target in metres", "units", smr.register(model, (0.001 * now, triangles))),
            ("start poses alike", "clearly different", smr.register(symmetric, (away, triangles[:, ::-1]), "rigid"))):
        check(f"{what}: {doubted.verdict.word}, {doubted.verdict.why[:1]}",
              doubted.verdict.word != "good" and words in " ".join(doubted.verdict.why)
              and doubted.verdict.probability <= 0.3)
    s = smr.Registration(model, caller_goals=1)
    s.set_goals("bone", now)
    for _ in s.run():
        pass
    off = np.linalg.norm(s.positions(0) - now, axis=1)
    check(f"goals of the caller's own: {off.max():.3f} mm", off.max() < 1)
    s = smr.Registration(model, volume=1.0)
    s.set_volume_ratio(None, 1.1)
    for _ in s.run():
        pass
    volume = s.structure_volume("bone")
    check(f"a volume asked for: {volume.ratio:.4f}", volume.closed == 1 and abs(volume.ratio - 1.1) < 0.01
          and abs(volume.asked_ratio - 1.1) < 1e-6 and volume.rest_mm3 > 0)


def targets(model, rest, triangles, now):
    hit = smr.Surface(now, triangles).closest(now[:5] + np.float32([0, 0, 0.01]))
    check("closest points", hit["distance"].max() < 0.02 and (hit["triangle"] != smr.NONE).all())
    check("none within nothing", smr.Surface(now, triangles).closest(now[:2] + 50, max_mm=1)["triangle"][0] == smr.NONE)
    marks = [smr.Landmark(now[v], vertex=v, structure=0, hard=True) for v in (0, 40, 90, 200)]
    result = smr.register(model, landmarks=marks)
    off = np.linalg.norm(result.registration.landmarks() - now[[0, 40, 90, 200]], axis=1)
    check(f"hard landmarks are reached: {off.max():.3f} mm", off.max() < 0.06)
    refused("a landmark of nothing", ValueError, "a vertex or a place", smr.register, model,
            landmarks=[smr.Landmark((0, 0, 0))])
    several = smr.Model.prepare({"bone": (rest, triangles)}, also=[now, [2 * rest + 5]], radius_mm=[20])
    weights = smr.Registration(several).reference_weights()
    check("equal weights of three shapes", several.info.n_references == 3 and np.abs(weights - 1 / 3).max() < 1e-6)
    refused("shapes of other vertices", ValueError, "as many vertices", smr.Model.prepare, (rest, triangles),
            also=[rest[1:]])
    warp = smr.Warp(rest[::20], now[::20])
    check("a spline passes through its landmarks",
          warp.kind == "spline" and np.abs(warp.apply(rest[::20]) - now[::20]).max() < 0.01)
    pose, rms = smr.align_landmarks(rest[:9], rest[:9] + np.float32([1, 2, 3]))
    check("landmarks give a pose", rms < 1e-3 and np.abs(pose[:, 3] - [1, 2, 3]).max() < 1e-3)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        smr.Model.prepare((0.001 * rest, triangles))
        smr.Registration(model, smr.Points(10), attraction=0)
    check("a model in metres, and a cloud without attraction, are warned of",
          [w for w in ("metres", "always attracts") for s in said if w in str(s.message)] == ["metres", "always attracts"])
    cloud = smr.Points(100)
    cloud.add(now[:150][:100], weights=np.ones(100))
    cloud.weigh(0, 0)
    check("a cloud counts its points", len(cloud) == 100)
    refused("more points than fit", smr.SmrError, "SMR_E_INPUT", cloud.add, now[:101])
    refused("voxels of int32", TypeError, "convert them", smr.Volume, np.zeros((3, 3, 3), np.int32), (1, 1, 1))
    refused("an image without profiles", smr.SmrError, "reference=", smr.register, model,
            smr.Volume(np.zeros((3, 3, 3)), (1, 1, 1)))
    jump = [(frame.jumped, frame.recovering, frame.serial, frame.registration.pose(0)[1])
            for frame in smr.track(model, [(now, triangles), now + 1, now + 120], ticks=9)]
    check(f"a jump is seen: {jump}", [one[:3] for one in jump] == [(False, False, 1), (False, False, 2), (True, False, 3)])
    check("a pose says how far its target is", jump[1][3] < 2.0 and np.isnan(jump[2][3]))
    carry = smr.Carry(model, rest[:7])
    check("a vertex is carried to its place", np.abs(carry.apply(now) - now[:7]).max() < 1e-3)
    check("and back", np.abs(carry.map(now, now[:7], inverse=True)[0] - rest[:7]).max() < 0.02)


class Watch:
    """In place of the library: before each call rubbish takes memory that was let go, and arrays that were converted
    and are gone by then are counted."""

    def __init__(self):
        self.real, self.numbers, self.made, self.gone = smr._lib, smr._numbers, [], 0

    def __getattr__(self, name):
        function = getattr(self.real, name)

        def call(*arguments):
            self.gone += sum(one() is None for one in self.made)
            self.rubbish = [np.full(self.shape, 7, np.float32) for _ in range(50)]
            return function(*arguments)
        return call

    def convert(self, *arguments):
        a = self.numbers(*arguments)
        self.shape = a.shape
        self.made.append(weakref.ref(a))
        return a

    def __enter__(self):
        smr._lib, smr._numbers = self, self.convert
        return self

    def __exit__(self, *_):
        smr._lib, smr._numbers = self.real, self.numbers


def converted(model, now, triangles):
    """What is converted lives until the library has read it; what it has nobody else writes."""
    s = smr.Registration(model)
    with Watch() as watch:
        s.set_positions("bone", now.astype(float))
    check("positions of float64 are set", np.abs(s.positions(0) - now).max() < 1e-3)
    check("and live until they are", len(watch.made) == 1 and watch.gone == 0)
    s.set_positions(None, now + 2)
    check("positions of all structures", np.abs(s.positions(0) - now - 2).max() < 1e-3)
    mine = now.copy()
    surface = smr.Surface(mine, triangles)
    mine[:] = 9
    check("a surface's positions are its own", (surface.xyz == now).all())
    frame = now + 1
    surface.refit(frame)
    frame[:] = 9
    check("those of refit as well", (surface.xyz == now + 1).all())


def wrapped(model, now, triangles):
    """No whole number is cut to 32 bits, no vector is filled up."""
    s, cloud = smr.Registration(model, n_landmarks=1), smr.Points(10)
    cloud.add(now[:10])
    surface = smr.Surface(now, triangles)
    for name, call in (("a structure", s.verdict), ("a structure's report", s.structure_report),
                       ("an index", model.index), ("active ones", s.set_active),
                       ("a target's structure", lambda k: s.set_surface(surface, k)),
                       ("points", smr.Points), ("a point", lambda i: cloud.weigh(i, 1)), ("a budget", s.tick),
                       ("a landmark's vertex", lambda v: s.set_landmarks([smr.Landmark((0, 0, 0), vertex=v)])),
                       ("samples", lambda n: smr.align(surface, surface, samples=n))):
        refused(f"{name} -1", smr.SmrError, "-1", call, -1)
        if name != "a budget":
            refused(f"{name} beyond 32 bits", smr.SmrError, "", call, 1 << 32)
            refused(f"{name} and a half", TypeError, "whole number", call, 0.5)
    check("none and ALL are all", model.index(None) == model.index(smr.ALL) == smr.ALL)
    check("numbers of numpy are numbers", model.index(np.int64(0)) == 0 == model.index(np.uint8(0)))
    refused("positions of all", smr.SmrError, "one structure", s.positions, None)
    voxels = np.zeros((3, 3, 3), np.uint8)
    for name, call in (("a place", lambda v: s.set_landmarks([smr.Landmark(v, vertex=0)])),
                       ("a place at rest", lambda v: s.set_landmarks([smr.Landmark((0, 0, 0), rest=v)])),
                       ("spacing", lambda v: smr.Volume(voxels, v)),
                       ("origin", lambda v: smr.Volume(voxels, (1, 1, 1), v))):
        refused(f"{name} of two numbers", ValueError, "three numbers", call, (1, 2))
    refused("a corner of two numbers", ValueError, "takes 3", smr.Registration, model, box_min=[1, 2])


def refusals(model, rest, now, triangles):
    """What is refused changes nothing, and says so in any process."""
    try:
        smr.Points(0)
    except smr.SmrError as error:
        again = pickle.loads(pickle.dumps(error))
        check(f"an error crosses processes: {again}", (str(again), again.status, again.where)
              == (str(error), error.status, error.where))
    for name, frame in (("too many points", np.tile(now, (2, 1))), ("NaN", now * np.nan), ("1e6 mm", now + 1e6)):
        cloud = smr.Points(len(now))
        cloud.add(now)
        refused(f"a frame of {name}", smr.SmrError, "SMR_E_INPUT", list,
                smr.track(model, [cloud, frame], iterations=2, iterations_last=2))
        check("leaves the cloud as it was", len(cloud) == len(now))
    image_of = smr.Volume(np.zeros((3, 3, 3)), (1, 1, 1))
    refused("an image for one structure", ValueError, "is None", smr.register, model, {"bone": image_of})
    refused("a pose that mirrors", smr.SmrError, "neither mirrors", smr.Registration(model).set_pose, -np.eye(4)[:3])
    refused("frames of structures", TypeError, "one target", list, smr.track(model, [{"bone": now}]))
    refused("a start of both kinds", ValueError, "a Warp", smr.register, model, (now, triangles), align="rigid",
            start=smr.Warp(rest[::20], now[::20]))


def finished(s):
    for _ in s.run():
        pass
    return s.hash


def saves(model, now, triangles):
    """What is saved goes on elsewhere to the same bits."""
    s = smr.Registration(model, (now, triangles))
    for _ in s.run(ticks=9):
        pass
    saved = s.save()
    want = finished(s)
    again = smr.Registration.restore(model, saved, (now, triangles), threads=3)
    check("a saved registration awaits nothing once its target is set", again.awaited == 0)
    check("and ends with the same bits", finished(again) == want)
    again = smr.Registration.restore(model, bytearray(saved))
    check("one without its target awaits it", again.awaited == 1)
    refused("and does not tick", smr.SmrError, "SMR_E_STATE...1 of what...must be set again first: targets", again.tick)
    refused("is not judged", smr.SmrError, "SMR_E_STATE...must be set again first", again.verdict)
    refused("a structure that is not there", smr.SmrError, "SMR_E_INPUT", again.positions, 9)
    refused("another target", smr.SmrError, "SMR_E_INPUT...had something else here", smr.Registration.restore, model,
            saved, (now + 1, triangles))
    again.set_target((now, triangles))
    check("and then goes on", again.awaited == 0 and finished(again) == want)
    damaged = bytearray(saved)
    damaged[len(saved) // 2] ^= 1
    for name, what in (("a damaged save", damaged), ("half a save", saved[:len(saved) // 2]), ("no save", b"")):
        refused(name, smr.SmrError, "SMR_E_SAVE", smr.Registration.restore, model, what)
    s = smr.Registration(model, (now, triangles))
    while s.tick(1).complete:
        pass
    refused("to save within an iteration", smr.SmrError, "SMR_E_STATE...until report.complete", s.save)


def motion(model, rest, triangles):
    """Fixed surfaces, masses, velocities, energies."""
    s = smr.Registration(model, contact=1, n_fixed=1)
    s.set_fixed(0, smr.Surface(rest + np.float32([24, 0, 0]), triangles))
    finished(s)
    off = np.abs(s.positions(0) - rest).max()
    check(f"a fixed surface keeps a structure off: {off:.2f} mm", off > 0.5)
    refused("a second one", smr.SmrError, "SMR_E_INPUT", s.set_fixed, 1, None)
    s.set_fixed(0, None)
    s.set_pose(np.eye(4))
    finished(s)
    check("until it is taken away", np.abs(s.positions(0) - rest).max() < 1e-3)
    s = smr.Registration(model, dynamics="on", damping=0, step_ms=10, gravity=[0, 0, -9810])
    s.set_motion("bone", mass=np.full(len(rest), 2.0), velocity=np.full((len(rest), 3), [100, 0, 0]))
    for _ in range(8 * 5):
        s.tick()
    energy, speed = s.energy(), s.velocities("bone").mean(0)
    check(f"a bone falls: {speed.round(1).tolist()} mm/s after {energy.steps} steps of {energy.mass_g:.0f} g",
          energy.steps == 5 and abs(speed[0] - 100) < 1 and abs(speed[2] + 490.5) < 5
          and abs(energy.mass_g - 2 * len(rest)) < 1)
    check("with the energy of its speed", abs(energy.kinetic_uj / (len(rest) * (speed ** 2).sum() / 1000) - 1) < 0.02)
    s.set_motion("bone", mass=np.where(np.arange(len(rest)) < 3, np.inf, 2.0))
    check("pinned vertices are counted", [s.tick(), s.energy().n_pinned][1] == 3)
    refused("masses of another number", ValueError, "as many", s.set_motion, "bone", np.ones(3))
    refused("neither", smr.SmrError, "SMR_E_NULL", s.set_motion, "bone")
    s, few = smr.Registration(model), smr.Registration(model, n_target_vertices=9)
    for name, words, call in (("energy", "dynamics", s.energy), ("velocities", "dynamics", lambda: s.velocities(0)),
                              ("motion", "dynamics", lambda: s.set_motion(0, np.ones(len(rest)))),
                              ("fixed surfaces", "n_fixed", lambda: s.set_fixed(0, None)),
                              ("volume ratios", "volume=1", lambda: s.set_volume_ratio(0, 1.1)),
                              ("goals", "caller_goals=1", lambda: s.set_goals(0, None)),
                              ("landmarks", "n_landmarks", lambda: s.set_landmarks([smr.Landmark(rest[0], vertex=0)])),
                              ("a target", "n_target_vertices", lambda: few.set_target((rest, triangles)))):
        refused(f"{name} without room says which setting", smr.SmrError, f"SMR_E_ARENA...{words}", call)


def behave(folder):
    rest, triangles, now, _, _ = load(folder)
    model = smr.Model.prepare({"bone": (rest, triangles)})
    arrays(model, rest, triangles, now)
    settings(model, now, triangles)
    models(model, folder, now, triangles)
    ownership(rest, triangles, now)
    ticks(model, rest, triangles, now)
    targets(model, rest, triangles, now)
    converted(model, now, triangles)
    wrapped(model, now, triangles)
    refusals(model, rest, now, triangles)
    saves(model, now, triangles)
    motion(model, rest, triangles)
    return counts[1]


if __name__ == "__main__":
    command = sys.argv[1]
    if command == "inputs":
        make_inputs(sys.argv[2])
    elif command == "twin":
        twin(sys.argv[2])
    else:
        sys.exit(1 if behave(sys.argv[2]) else 0)
