#!/usr/bin/python3
"""peers: registration into images by elastix (Debian's elastix) and by smr, from the same landmarks, against the same truth.
usage: peers.py SMR DATA OUT [patient|person|ct]...      prints a line for each; ends with 77 where a program or data are missing

elastix: a similarity from the landmarks, affine by mutual information, then B-splines of 12 mm by correlation, both within
12 mm of the model. Distances are means of the structures' means, model to truth and back; times are those of the commands.
SPDX-License-Identifier: MIT
"""
import json, os, re, shutil, subprocess, sys, time

COMMON = """(FixedInternalImagePixelType "float") (MovingInternalImagePixelType "float") (UseDirectionCosines "true")
(FixedImageDimension 3) (MovingImageDimension 3) (Registration "MultiResolutionRegistration")
(FixedImagePyramid "FixedSmoothingImagePyramid") (MovingImagePyramid "MovingSmoothingImagePyramid")
(Interpolator "LinearInterpolator") (ResampleInterpolator "FinalBSplineInterpolator") (Resampler "DefaultResampler")
(Optimizer "AdaptiveStochasticGradientDescent") (ImageSampler "RandomCoordinate") (NewSamplesEveryIteration "true")
(HowToCombineTransforms "Compose") (NumberOfResolutions 3) (ErodeMask "false") (RequiredRatioOfValidSamples 0.05)
(RandomSeed 1) (DefaultPixelValue 0) (WriteResultImage "false")
"""
STEPS = {
    "affine": COMMON + """(Transform "AffineTransform") (Metric "AdvancedMattesMutualInformation") (NumberOfHistogramBins 32)
(AutomaticScalesEstimation "true") (AutomaticTransformInitialization "false") (MaximumNumberOfIterations 500)
(NumberOfSpatialSamples 4000)""",
    "bspline": COMMON + """(Transform "BSplineTransform") (Metric "AdvancedNormalizedCorrelation")
(FinalGridSpacingInPhysicalUnits 12 12 12) (GridSpacingSchedule 4 2 1) (MaximumNumberOfIterations 1000)
(NumberOfSpatialSamples 8000)""",
}


def split(lines):
    """(a one on each line, as elastix wants them)"""
    return re.sub(r"\) \(", ")\n(", lines) + "\n"


def vertices(path):
    """The file's head, its vertices and what follows them."""
    data = open(path, "rb").read()
    at = data.index(b"end_header\n") + 11
    n = int(re.search(rb"element vertex (\d+)", data[:at]).group(1))
    return data[:at], np.frombuffer(data, "<f4", 3 * n, at).reshape(n, 3), data[at + 12 * n:]


def landmarks(path):
    if path.endswith(".csv"):
        rows = [line.split(",") for line in open(path).read().split("\n")[1:] if line]
        return {row[0]: [float(x) for x in row[1:4]] for row in rows}
    return {p["label"]: p["position"] for p in json.load(open(path))["markups"][0]["controlPoints"]}


def similarity(a, b):
    """Matrix and translation that take the points a to b best (Umeyama 1991)."""
    ma, mb = a.mean(0), b.mean(0)
    u, s, vt = np.linalg.svd((b - mb).T @ (a - ma))
    d = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    m = np.trace(np.diag(s) @ d) / ((a - ma) ** 2).sum() * (u @ d @ vt)
    return m, mb - m @ ma


def image(path):
    """Head and voxels, z first."""
    data = open(path, "rb").read()
    at = data.index(b"ElementDataFile = LOCAL\n") + 24
    head = dict(re.findall(r"(\w+) = (.*)", data[:at].decode()))
    kind = {"MET_UCHAR": "u1", "MET_SHORT": "<i2", "MET_FLOAT": "<f4", "MET_USHORT": "<u2"}[head["ElementType"]]
    return head, np.frombuffer(data, kind, -1, at).reshape([int(n) for n in head["DimSize"].split()][::-1])


def write_image(path, head, voxels):
    head = dict(head, ElementDataFile="LOCAL", CompressedData="False")
    names = [k for k in head if k != "ElementDataFile"] + ["ElementDataFile"]
    open(path, "wb").write("".join(f"{k} = {head[k]}\n" for k in names).encode() + np.ascontiguousarray(voxels).tobytes())


def run(*command):
    begin = time.time()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode not in (0, 1, 3): # 1 and 3: the verdict of a registration
        sys.exit(f"peers: {' '.join(command[:4])} ended with {done.returncode}: {done.stdout[-500:]}")
    return done.stdout, time.time() - begin


def measured(smr, results, truth):
    """Mean over the structures of the mean distances to the truth and back."""
    sums, n = [0.0, 0.0], 0
    for path in results:
        text = run(smr, "measure", path, os.path.join(truth, os.path.basename(path)))[0]
        both = re.findall(r"[AB] to [AB]: mean ([0-9.]+)", text)
        sums, n = [s + float(x) for s, x in zip(sums, both)], n + 1
    return [s / n for s in sums]


def elastix(case, out, smr):
    """Surfaces of the model as elastix brings them into the target, and the seconds of its two steps."""
    models = os.path.join(out, "model")
    os.makedirs(models, exist_ok=True)
    for path in case["model"]:
        shutil.copy(path, models)
    run(smr, "labels", models, "--like", case["reference"], "-o", f"{out}/mask.mha")
    head, label = image(f"{out}/mask.mha")
    away = ndimage.distance_transform_edt(label == 0, sampling=[float(x) for x in head["ElementSpacing"].split()][::-1])
    write_image(f"{out}/mask.mha", dict(head, ElementType="MET_UCHAR"), (away < 12).astype("u1"))
    a, b = (landmarks(path) for path in case["landmarks"])
    both = sorted(set(a) & set(b))
    m, t = similarity(np.array([a[k] for k in both]), np.array([b[k] for k in both]))
    numbers = " ".join(f"{x:.9g}" for x in [*m.ravel(), *t])
    open(f"{out}/start.txt", "w").write(f"""(Transform "AffineTransform")
(NumberOfParameters 12)
(TransformParameters {numbers})
(CenterOfRotationPoint 0 0 0)
(InitialTransformParametersFileName "NoInitialTransform")
(HowToCombineTransforms "Compose")
(FixedImageDimension 3)
(MovingImageDimension 3)
""")
    for name, text in STEPS.items():
        open(f"{out}/{name}.txt", "w").write(split(text))
    seconds = run("elastix", "-f", case["reference"], "-m", case["target"], "-fMask", f"{out}/mask.mha", "-t0", f"{out}/start.txt",
                  "-p", f"{out}/affine.txt", "-p", f"{out}/bspline.txt", "-out", out, "-threads", "2")[1]
    results = []
    for path in case["model"]:
        before, points, after = vertices(path)
        with open(f"{out}/points.txt", "w") as file:
            file.write(f"point\n{len(points)}\n" + "".join("%.9g %.9g %.9g\n" % tuple(p) for p in points))
        run("transformix", "-def", f"{out}/points.txt", "-tp", f"{out}/TransformParameters.1.txt", "-out", out)
        text = open(f"{out}/outputpoints.txt").read()
        moved = np.array([[float(x) for x in row.split()] for row in re.findall(r"OutputPoint = \[ (.*?) \]", text)])
        results.append(os.path.join(out, os.path.basename(path)))
        open(results[-1], "wb").write(before + moved.astype("<f4").tobytes() + after)
    return results, seconds


def cases(data, out):
    thigh = [f"{data}/hip_thigh_vhm/{name}" for name in sorted(os.listdir(f"{data}/hip_thigh_vhm")) if name.endswith(".ply")]
    patient = f"{data}/thigh_patient"
    for who in "patient", "person":
        yield who, dict(model=thigh, reference=f"{patient}/mri_reference.mha", target=f"{data}/thigh_{who}/mri_{who}.mha", options=[],
                        landmarks=[f"{patient}/landmarks_reference.mrk.json", f"{data}/thigh_{who}/landmarks_{who}.mrk.json"],
                        truth=f"{data}/thigh_{who}/truth")
    # The right side of real hips into their mirror image; landmarks are the ends of the bones, the same for both programs.
    hips, ct = f"{data}/ct_hips_surfaces", f"{data}/volumes/ct_hips.mha"
    head, voxels = image(ct)
    offset, spacing = ([float(x) for x in head[k].split()] for k in ("Offset", "ElementSpacing"))
    offset[0] = -(offset[0] + spacing[0] * (voxels.shape[2] - 1))
    write_image(f"{out}/mirrored.mha", dict(head, Offset="%.9g %.9g %.9g" % tuple(offset)), voxels[:, :, ::-1])
    truth = f"{out}/mirrored_truth"
    os.makedirs(truth, exist_ok=True)
    for name in os.listdir(hips):
        if name.endswith("_left.ply"):
            before, points, after = vertices(f"{hips}/{name}")
            faces = np.frombuffer(after, "V1, <i4, <i4, <i4").copy()
            faces["f2"], faces["f3"] = faces["f3"].copy(), faces["f2"].copy()
            points = points * np.float32([-1, 1, 1])
            open(f"{truth}/{name.replace('left', 'right')}", "wb").write(before + points.tobytes() + faces.tobytes())
    for path, place in (f"{out}/right.csv", hips), (f"{out}/left.csv", truth):
        with open(path, "w") as file:
            file.write("label,x,y,z\n")
            for label, bone, way in (("crest", "hip_bone", (0, 0, 1)), ("front", "hip_bone", (-0.5, -1, 0.5)), ("back", "hip_bone", (0, 1, 0.3)),
                                     ("symphysis", "hip_bone", (1, -1, -0.5)), ("trochanter", "femur_proximal", (-1, 0.5, 0.3)),
                                     ("head", "femur_proximal", (1, 0, 0.5))):
                points = vertices(f"{place}/{bone}_right.ply")[1]
                file.write("%s,%.9g,%.9g,%.9g\n" % (label, *points[np.argsort(points @ np.array(way))[-10:]].mean(0)))
    yield "ct", dict(model=sorted(f"{hips}/{name}" for name in os.listdir(hips) if name.endswith("_right.ply")), reference=ct,
                     target=f"{out}/mirrored.mha", landmarks=[f"{out}/right.csv", f"{out}/left.csv"], truth=truth, options=["--align", "rigid"])


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    smr, data, out = sys.argv[1:4]
    os.makedirs(out, exist_ok=True)
    for name, case in cases(data, out):
        if sys.argv[4:] and name not in sys.argv[4:]:
            continue
        where = f"{out}/{name}"
        shutil.rmtree(where, ignore_errors=True)
        seconds = run(smr, "register", "--model", *case["model"], "--reference", case["reference"], "--target", case["target"],
                      "--landmarks", *case["landmarks"], *case["options"], "-o", f"{where}/smr", "--threads", "2")[1]
        ours = measured(smr, [f"{where}/smr/{os.path.basename(p)}" for p in case["model"]], case["truth"])
        print("%s_smr %.3f / %.3f mm, %.0f s" % (name, *ours, seconds), flush=True)
        os.makedirs(f"{where}/elastix", exist_ok=True)
        results, seconds = elastix(case, f"{where}/elastix", smr)
        print("%s_elastix %.3f / %.3f mm, %.0f s" % (name, *measured(smr, results, case["truth"]), seconds), flush=True)


try:
    import numpy as np
    from scipy import ndimage
except ImportError:
    print("skip: needs python3-numpy and python3-scipy")
    sys.exit(77)
if not shutil.which("elastix") or not shutil.which("transformix"):
    print("skip: needs elastix")
    sys.exit(77)
main()
