"""smr.py: shape-matching registration in Python: the library's C interface by ctypes, arrays by numpy.

    import smr
    model = smr.Model.prepare({"femur": (xyz, triangles)})
    result = smr.register(model, (target_xyz, target_triangles), align="similarity")
    print(result.verdict.word, result.positions[0], result.expected_error[0])

Needs Python 3.9, numpy and the shared library, which is looked for in this order: the file that the environment
variable SMR_LIBRARY names (nothing else is tried then), beside this file, in the build directory of the sources that
this file lies in, where the system looks for libraries.

Units are millimetres and nanoseconds where not said otherwise. include/smr.h says more of everything here; names are
the same without "smr_".

Arrays. Positions, normals and weights: any real numbers, converted to float32 in C order; what is that already is not
copied. Triangles: any whole numbers from 0 on, converted to uint32. Voxels: uint8, int8, uint16, int16, float32 and, by
conversion, float64 and bool; other types are refused, for their values may not fit. A wrong shape is a ValueError, a
wrong kind of number a TypeError. What the library refuses is an SmrError, and nothing has changed then (of a mapping
of targets: see Registration.set_target()).

Ownership. Each object owns the memory that the library works in. What the library borrows (a registration its model,
targets and image) is kept alive by the object that borrows it. Voxels and goals are not copied if they have the right
type: do not write into them while a registration has them. Surfaces and clouds are copies.

Threads. The library runs with the interpreter's lock released. One object is for one thread at a time. A child of
fork() has none of its parent's threads: it makes its objects anew (multiprocessing: the start method "spawn").

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import ctypes as C
import ctypes.util
import glob
import os
import warnings
import weakref
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

VERSION = (1, 0)  # of the library's interface that this file knows; cookies have the major version

ALIGN = 64  # bytes: where memory starts
ALL = 0xFFFFFFFF  # every structure
NONE = 0xFFFFFFFF  # no triangle, no vertex
FINEST = 0xFFFFFFFF  # the last radius of the model
_MOST = 0xFFFFFFFE  # of a count or an index
COORD_MAX = 1.0e5  # mm: largest absolute coordinate

Array = np.ndarray
Pose = np.ndarray  # [3][4]: rotation times scale, and translation, mm


# ------------------------------------------------------------------ errors

_SENTENCES = {
    -1: "a required pointer is NULL",
    -2: "wrong cookie, a field outside its stated range, or fields that exclude each other",
    -3: "the memory handed over is too small",
    -4: "the memory handed over is not aligned to SMR_ALIGN",
    -5: "the bytes are not a model, are of another version, damaged or inconsistent",
    -6: "a count, index or coordinate in the data is out of range",
    -7: "the object's state does not allow the call, or the object is not of the expected type",
    -8: "the progress callback asked to stop",
    -9: "the bytes are not a log, are of another version, damaged, or end within a record",
    -10: "the bytes are not a save, are of another version, damaged or inconsistent",
    -11: "a log or a save needs a capability that this build leaves out",
    -12: "memory has changed that only the library may change",
}
_E_CONFIG, _E_ARENA, _E_INPUT, _E_STATE = -2, -3, -6, -7

# What calls expect that the status alone does not tell.
_NO_DYNAMICS = "the setting dynamics is off: make the registration with dynamics=\"on\""
_COMPLETE = "a complete iteration is expected (tick until report.complete), and targets as they were set"
_EXPECTED = {
    ("smr_set_motion", _E_ARENA): _NO_DYNAMICS,
    ("smr_get_velocities", _E_ARENA): _NO_DYNAMICS,
    ("smr_get_energy", _E_ARENA): _NO_DYNAMICS,
    ("smr_set_goals", _E_ARENA): "the setting caller_goals is off: make the registration with caller_goals=1",
    ("smr_set_fixed", _E_ARENA): "there are no fixed surfaces: make the registration with contact=1 and n_fixed=1",
    ("smr_set_fixed", _E_INPUT): "an index below the setting n_fixed is expected",
    ("smr_set_volume_ratio", _E_ARENA): "the setting volume is 0: make the registration with volume=1",
    ("smr_set_surface", _E_ARENA): "the setting n_target_vertices is expected to hold all targets' vertices",
    ("smr_set_points", _E_ARENA): "the setting n_target_vertices is expected to hold all targets' points",
    ("smr_set_landmarks", _E_ARENA): "at most as many landmarks as the setting n_landmarks are expected",
    ("smr_set_pose", _E_INPUT): "a pose of finite numbers that neither mirrors nor is singular is expected",
    ("smr_set_positions", _E_INPUT): "finite positions within 100 m are expected",
    ("smr_surface_build", _E_INPUT): "finite positions within 100 m, and triangles of the vertices' numbers, are expected",
    ("smr_set_volume", _E_STATE): "profiles are expected: Model.prepare(..., reference=the image of the model)",
    ("smr_save", _E_STATE): _COMPLETE,
    ("smr_save_begin", _E_STATE): _COMPLETE,
    ("smr_get_verdict", _E_STATE): _COMPLETE,
    ("smr_get_expected_error", _E_STATE): _COMPLETE,
    ("smr_get_expected_parts", _E_STATE): _COMPLETE,
}


class SmrError(Exception):
    """What the library refuses. status: negative; name: "SMR_E_..."; sentence: what that means; where: which call, or
    what was expected in place of the sentence."""

    def __init__(self, status: int, where: str = "") -> None:
        self.status = status
        self.name: str = _lib.smr_status_name(status).decode()
        self.sentence = _SENTENCES.get(status, "unknown status")
        self.where = where
        said = f"{self.sentence} ({where})" if where else self.sentence
        super().__init__(f"{self.name}: {where if ' ' in where else said}")

    def __reduce__(self) -> Tuple[Any, Tuple[int, str]]:
        return SmrError, (self.status, self.where)  # args has the sentence, of which none can be made again


def _check(result: int, function: Any, _arguments: Any) -> int:
    if result < 0:
        name = function.__name__
        words = _EXPECTED.get((name, result))
        raise SmrError(result, name if words is None else f"{name}: {words}")
    return result


# ------------------------------------------------------------------ the C interface

_U, _F, _P, _Z, _Q = C.c_uint32, C.c_float, C.c_void_p, C.c_size_t, C.c_uint64


class _Struct(C.Structure):
    """A struct of smr.h, with its fields and its -1 for what was not measured."""

    def __repr__(self) -> str:
        values = ((name, getattr(self, name)) for name, _ in self._fields_)
        shown = (f"{name}={list(v) if isinstance(v, C.Array) else v}" for name, v in values)
        return f"{type(self).__name__}({', '.join(shown)})"


def _struct(name: str, *fields: Tuple[str, Any]) -> Any:
    return type(name, (_Struct,), {"_fields_": list(fields)})


_Mesh = _struct("_Mesh", ("xyz", _P), ("triangles", _P), ("n_vertices", _U), ("n_triangles", _U))
_Structure = _struct("_Structure", ("name", C.c_char_p), ("mesh", _Mesh))
_Volume = _struct("_Volume", ("voxels", _P), ("mask", _P), ("type", _U), ("size", _U * 3), ("origin", _F * 3),
                  ("spacing", _F * 3), ("direction", _F * 9))
_Pose = _struct("_Pose", ("m", _F * 12))
_Port = _struct("_Port", ("ctx", _P), ("n_workers", _U), ("parallel", _P), ("now_ns", _P))
_Closest = _struct("_Closest", ("point", _F * 3), ("normal", _F * 3), ("distance", _F), ("triangle", _U),
                   ("weight", _F * 3), ("on_border", _U))
_AlignConfig = _struct("_AlignConfig", ("cookie", _U), ("scaled", _U), ("iterations", _U), ("samples", _U),
                       ("given", _P), ("port", _P), ("n_parts", _U), ("part", _P))


class AlignReport(_Struct):
    """What align() found. Distances (mm) are those of the parts that both surfaces have; *_share: 0..1 of the area."""
    _fields_ = [("rms_mm", _F), ("model_share", _F), ("target_share", _F), ("scale", _F), ("second_rms_mm", _F),
                ("mirrored_rms_mm", _F), ("n_alike", _U), ("given", _U), ("model_inside_out", _U),
                ("target_inside_out", _U), ("n_other", _U), ("other", _Pose * 3)]

    @property
    def others(self) -> List[Pose]:
        """The clearly different poses [3][4] that were compared."""
        return [_pose_array(pose) for pose in self.other[:self.n_other]]


_AlignPart = _struct("_AlignPart", ("model", _P), ("target", _P), ("pose", _Pose), ("report", AlignReport),
                     ("order", _U))


class ModelInfo(_Struct):
    """Figures of a model; arrays have one element for each of n_radii radii, coarse to fine."""
    _fields_ = [("n_vertices", _U), ("n_triangles", _U), ("n_structures", _U), ("n_radii", _U), ("centre", _F * 3),
                ("edge_mm", _F), ("radius_mm", _F * 16), ("indexes_per_cluster", _F * 16),
                ("direct_per_cluster", _F * 16), ("largest_cluster", _U * 16), ("smallest_cluster", _U * 16),
                ("n_blocks", _U * 16), ("separate", _U * 16), ("active_min", _U * 16), ("n_levels", _U),
                ("level_end", _U * 24), ("order", _U), ("profile_samples", _U), ("n_references", _U),
                ("profile_step_mm", _F), ("checksum", _U), ("bytes", _Z)]


class _Subjects(_Struct):
    _fields_ = [("xyz", _P), ("n", _U)]


_StructureInfo = _struct("_StructureInfo", ("name", C.c_char * 64), ("n_vertices", _U), ("n_triangles", _U))
_Landmark = _struct("_Landmark", ("structure", _U), ("vertex", _U), ("rest", _F * 3), ("place", _F * 3), ("weight", _F),
                    ("hard", _U))


class TickDetails(_Struct):
    """What a tick did; distances in mm, phase_ns in ns, *_share 0..1. -1: not measured."""
    _fields_ = [("phase", _U), ("radius", _U), ("radius_iteration", _U), ("n_taken", _U), ("n_wanted", _U),
                ("n_active", _U), ("n_rejected", _U), ("n_guarded", _U), ("matched_share", _F), ("attraction_used", _F),
                ("residual_rms_mm", _F), ("residual_max_mm", _F), ("phase_ns", _Q * 5), ("plastic_updates", _U),
                ("tracking", _U), ("settled", _U), ("jumped", _U), ("recovering", _U), ("target_serial", _U)]


class TickReport(_Struct):
    """How far a tick came; distances in mm, progress 0..1. -1: not measured. details: a TickDetails."""
    _fields_ = [("iteration", _U), ("done", _U), ("converged", _U), ("progress", _F), ("n_forces", _U),
                ("residual_mean_mm", _F), ("displacement_max_mm", _F), ("state_hash", _Q), ("details", TickDetails)]
    complete = True  # False: the budget ended within an iteration, which the next tick resumes


class StructureReport(_Struct):
    """What one structure's forces did; mm. -1: not measured."""
    _fields_ = [("has_target", _U), ("n_forces", _U), ("n_rejected", _U), ("matched_share", _F),
                ("residual_mean_mm", _F), ("residual_max_mm", _F), ("moved_mean_mm", _F), ("moved_max_mm", _F)]


class StructureVolume(_Struct):
    """The volume of a closed structure (smr_structure_volume). closed 0: it encloses none, and all else is 0."""
    _fields_ = [("closed", _U), ("rest_mm3", _F), ("asked_mm3", _F), ("present_mm3", _F), ("asked_ratio", _F),
                ("ratio", _F)]


class Energy(_Struct):
    """Energies of a model in motion, of all structures together (smr_energy): uJ, g, mm."""
    _fields_ = [("steps", _U), ("sweeps", _U), ("n_pinned", _U), ("mass_g", _F), ("centre", _F * 3), ("kinetic_uj", _F),
                ("gravity_uj", _F), ("elastic_uj", _F), ("goals_uj", _F)]


class Verdict(_Struct):
    """Whether a result can be relied on, and what was measured (smr_verdict). -1: nothing of the kind was measured."""
    _fields_ = [("level", _U), ("reasons", _U), ("probability", _F), ("expected_error_mm", _F),
                ("expected_across_mm", _F), ("expected_along_mm", _F), ("expected_visible_mm", _F), ("visible_share", _F),
                ("target_covered", _F), ("other_share", _F), ("residual_mm", _F), ("normals_agree", _F), ("image_similarity", _F),
                ("goals_share", _F), ("strain", _F), ("stretch", _F), ("volume_ratio", _F), ("rotation_deg", _F), ("turned_deg", _F), ("bend_mm", _F),
                ("scale", _F), ("scale_rest", _F), ("subjects_ratio", _F),
                ("moved_last_mm", _F)]

    doubts: Tuple[str, ...] = ()  # sentences of register() on the start, the target and the run

    @property
    def word(self) -> str:
        """"good", "look" or "failed"."""
        return ("good", "look", "failed")[self.level]

    @property
    def why(self) -> List[str]:
        """A sentence for each reason: what was measured and where to look."""
        return [*self.doubts] + [_lib.smr_reason_text(1 << i).decode() for i in range(32) if self.reasons >> i & 1]

    def _doubt(self, doubts: Iterable[str]) -> None:
        """A result in doubt is to be looked at; each doubt counts as much as one of `smr register`."""
        for sentence in doubts:
            self.doubts += (sentence,)
            self.level = max(self.level, 1)
            self.probability *= 0.3


_Fact = _struct("_Fact", ("miss_mm", _F), ("volume", _F))
_Setting = _struct("_Setting", ("name", C.c_char_p), ("unit", C.c_char_p), ("text", C.c_char_p), ("kind", _U),
                   ("number", _U), ("offset", _U), ("bytes", _U), ("open", _U), ("or_zero", _U), ("low", C.c_double),
                   ("high", C.c_double), ("value", C.c_double), ("image", C.c_double))


# The C names of the structs above whose fields stand here; those of settings come from the library itself.
STRUCTS = {"smr_mesh": _Mesh, "smr_structure": _Structure, "smr_volume": _Volume, "smr_pose": _Pose, "smr_port": _Port,
           "smr_closest": _Closest, "smr_align_config": _AlignConfig, "smr_align_report": AlignReport,
           "smr_align_part": _AlignPart, "smr_model_info": ModelInfo, "smr_structure_info": _StructureInfo,
           "smr_landmark": _Landmark,
           "smr_tick_report": TickReport, "smr_tick_details": TickDetails, "smr_structure_report": StructureReport,
           "smr_structure_volume": StructureVolume, "smr_verdict": Verdict, "smr_energy": Energy,
           "smr_subjects": _Subjects, "smr_carry_fact": _Fact, "smr_setting": _Setting}

# Calls that return a status: p pointer, u uint32_t, z size_t, q uint64_t, f float.
_CALLS = {
    "smr_surface_bytes": "uup", "smr_surface_build": "ppzp", "smr_surface_refit": "pp", "smr_surface_step": "pupq",
    "smr_surface_closest": "pppffp", "smr_surface_distances": "ppup", "smr_points_bytes": "up",
    "smr_points_open": "upzp", "smr_points_add": "ppppu",
    "smr_points_weigh": "puf", "smr_points_clear": "p", "smr_points_count": "pp", "smr_points_surface_bytes": "up",
    "smr_points_surface": "ppzp", "smr_align_bytes": "pp", "smr_articulated_bytes": "ppp", "smr_articulated_begin": "pppppzppp", "smr_align": "ppppzpp", "smr_align_landmarks": "ppuupp",
    "smr_warp_bytes": "up", "smr_warp_fit": "ppufpzpp", "smr_warp_apply": "ppu", "smr_prepare_bytes": "pupp",
    "smr_prepare": "puppzpzp", "smr_model_open": "pzp", "smr_model_get_info": "pp", "smr_model_structure": "pup",
    "smr_model_mesh": "pupp", "smr_arena_bytes": "ppp", "smr_init": "ppppzp", "smr_set_positions": "pup",
    "smr_set_pose": "pp", "smr_set_surface": "pup", "smr_set_points": "pup", "smr_set_volume": "pp",
    "smr_set_landmarks": "ppu", "smr_get_landmarks": "pp",
    "smr_get_reference_weights": "ppp", "smr_get_pose": "pupp", "smr_set_goals": "pupp", "smr_tick": "pqp",
    "smr_set_volume_ratio": "puf", "smr_get_structure_volume": "pup", "smr_set_fixed": "pup",
    "smr_set_motion": "pupp", "smr_get_velocities": "pup", "smr_get_energy": "pp", "smr_save_bytes": "pp",
    "smr_save": "ppz", "smr_job_step": "pupq", "smr_set_pose_begin": "ppp", "smr_set_positions_begin": "pupp",
    "smr_save_begin": "ppzp", "smr_set_scrub_begin": "pup", "smr_save_info": "pzp", "smr_restore": "ppppzpzp", "smr_get_awaited": "pp",
    "smr_set_active": "pu", "smr_set_scrub": "pu", "smr_scrub": "pq", "smr_get_positions": "pup", "smr_get_normals": "pup", "smr_get_structure_report": "pup",
    "smr_get_verdict": "pup", "smr_get_visible": "pup", "smr_get_expected_error": "pup",
    "smr_get_expected_parts": "pupp", "smr_get_local_volume": "pufp", "smr_carry_bytes": "uuup",
    "smr_carry_fit": "pupuppzp", "smr_carry_apply": "ppp", "smr_carry_map": "ppupupp", "smr_pthread_create": "ppzu",
}
_CODES = {"p": _P, "u": _U, "z": _Z, "q": _Q, "f": _F}


def _places() -> Iterator[str]:
    """Where the library may lie, in the order of looking."""
    if os.environ.get("SMR_LIBRARY"):
        yield os.environ["SMR_LIBRARY"]
        return
    here = os.path.dirname(os.path.abspath(__file__))
    for folder in (here, os.path.join(here, "..", "..", "build")):
        for pattern in ("libsmr.so", "libsmr.so.*", "libsmr.dylib"):
            yield from sorted(glob.glob(os.path.join(glob.escape(folder), pattern)))
    yield "libsmr.so"
    found = ctypes.util.find_library("smr")
    if found is not None:
        yield found


def _load() -> Any:
    tried = []
    for place in _places():
        try:
            return C.CDLL(place)
        except OSError as error:
            tried.append(f"{place}: {error}")
    raise ImportError("libsmr.so was not found: build it with `make shared`, or let SMR_LIBRARY name it\n  "
                      + "\n  ".join(tried))


def _declare(lib: Any) -> None:
    for name, codes in _CALLS.items():
        function = getattr(lib, name)
        function.argtypes, function.restype, function.errcheck = [_CODES[c] for c in codes], C.c_int, _check
    others = {"smr_status_name": (C.c_char_p, [C.c_int]), "smr_self_test": (_U, []), "smr_state_hash": (_Q, [_P]),
              "smr_reason_text": (C.c_char_p, [_U]), "smr_config_settings": (C.POINTER(_Setting), [_P]),
              "smr_prepare_settings": (C.POINTER(_Setting), [_P]), "smr_align_config_default": (_AlignConfig, []),
              "smr_pthread_bytes": (_Z, [_U]), "smr_pthread_port": (_Port, [_P]), "smr_pthread_destroy": (None, [_P])}
    for name, (result, arguments) in others.items():
        function = getattr(lib, name)
        function.restype, function.argtypes = result, arguments


_lib = _load()
_declare(_lib)


# ------------------------------------------------------------------ settings

class Setting(NamedTuple):
    """One setting of register(), Registration or Model.prepare(). words: what a choice takes; default_image: into an
    image. open: low itself is not legal. or_zero: 0 is legal, too."""
    name: str
    unit: str
    text: str
    kind: str  # "count", "number", "choice", "switch", "pointer"
    low: float
    high: float
    open: bool
    or_zero: bool
    default: float
    default_image: float
    words: Tuple[str, ...]
    length: int  # of an array; 1 for a single value
    offset: int


_KINDS = ("", "count", "number", "choice", "switch", "pointer")


def _read_settings(function: Any) -> Dict[str, Setting]:
    n = _U()
    rows = function(C.byref(n))
    table = {}
    for row in (rows[i] for i in range(n.value)):
        if row.kind == 0:
            continue
        kind, unit = _KINDS[row.kind], row.unit.decode()
        table[row.name.decode()] = Setting(
            row.name.decode(), "" if kind == "choice" else unit, row.text.decode(), kind, row.low, row.high,
            bool(row.open), bool(row.or_zero), row.value, row.image, tuple(unit.split("|")) if kind == "choice" else (),
            1 if kind == "pointer" else row.bytes // 4, row.offset)
    return table


def _config_class(name: str, table: Dict[str, Setting]) -> Any:
    """The struct that a table of settings describes; its places are compared with the library's."""
    fields: List[Tuple[str, Any]] = [("cookie", _U)]
    for s in table.values():
        kind = {"number": _F, "pointer": _P}.get(s.kind, _U)
        fields.append((s.name, kind * s.length if s.length > 1 else kind))
    made = _struct(name, *fields)
    for s in table.values():
        if getattr(made, s.name).offset != s.offset:
            raise ImportError(f"smr.py: {name}.{s.name} is at {s.offset} in the library, expected elsewhere")
    return made


SETTINGS = _read_settings(_lib.smr_config_settings)
PREPARE_SETTINGS = _read_settings(_lib.smr_prepare_settings)
_Config = _config_class("smr_config", SETTINGS)
_PrepareConfig = _config_class("smr_prepare_config", PREPARE_SETTINGS)


class _SavedInfo(_Struct):
    _fields_ = [("bytes", _Z), ("library", _U), ("model_checksum", _U), ("n_vertices", _U), ("config", _Config)]


def _take_defaults() -> None:
    for name, kind in (("smr_config_default", _Config), ("smr_config_default_image", _Config),
                       ("smr_config_paper", _Config), ("smr_prepare_config_default", _PrepareConfig),
                       ("smr_prepare_config_paper", _PrepareConfig), ("smr_align_config_default", _AlignConfig)):
        function = getattr(_lib, name)
        function.restype, function.argtypes = kind, []
        cookie = function().cookie
        if cookie & 0xFFFF != C.sizeof(kind) & 0xFFFF or cookie >> 16 & 0xFF != VERSION[0]:
            raise ImportError(f"smr.py is for major version {VERSION[0]} of the library; {name}() is of "
                              f"{cookie >> 16 & 0xFF} and {cookie & 0xFFFF} bytes")


_take_defaults()


def _range_text(s: Setting) -> str:
    if s.words:
        return "one of " + ", ".join(s.words)
    text = f"in {'(' if s.open else '['}{s.low:g}, {s.high:g}] {s.unit}".rstrip()
    return "0 or " + text if s.or_zero else text


def _one_value(s: Setting, value: Any) -> Union[int, float]:
    if s.words and isinstance(value, str):
        if value not in s.words:
            raise SmrError(_E_CONFIG, f"{s.name} is {value!r}, expected {_range_text(s)}")
        return s.words.index(value)
    number = float(value) if s.kind == "number" else int(value)
    if s.kind != "number" and number != value:
        raise TypeError(f"{s.name} takes a whole number, not {value!r}")
    legal = (s.low < number if s.open else s.low <= number) and number <= s.high
    if not (legal or (s.or_zero and number == 0) or number in (s.default, s.default_image)):
        raise SmrError(_E_CONFIG, f"{s.name} is {value!r}, expected {_range_text(s)}")
    return number


def _apply_settings(config: Any, table: Dict[str, Setting], settings: Mapping[str, Any]) -> None:
    for name, value in settings.items():
        s = table.get(name)
        if s is None or s.kind == "pointer":
            raise TypeError(f"there is no setting {name!r}; smr.SETTINGS and smr.PREPARE_SETTINGS list them")
        if s.length == 1:
            setattr(config, name, _one_value(s, value))
            continue
        values = [_one_value(s, v) for v in value]
        if len(values) > s.length or (len(values) < s.length and name != "radius_mm"):
            raise ValueError(f"{name} takes {'at most ' if name == 'radius_mm' else ''}{s.length} values")
        for i, number in enumerate(values):
            getattr(config, name)[i] = number
        if name == "radius_mm" and "n_radii" not in settings:
            config.n_radii = len(values)


# ------------------------------------------------------------------ arrays

def _numbers(value: Any, what: str, columns: int = 3) -> Array:
    """[n][columns] float32 in C order; columns 0: [n]."""
    a = np.asarray(value)
    if a.dtype.kind not in "fiub":
        raise TypeError(f"{what}: expected real numbers, not {a.dtype}")
    if a.ndim != (2 if columns else 1) or (columns and a.shape[1] != columns):
        raise ValueError(f"{what}: expected the shape [n]{f'[{columns}]' if columns else ''}, not {list(a.shape)}")
    with np.errstate(over="ignore"):  # what float32 cannot hold is infinite, and refused
        return np.ascontiguousarray(a, np.float32)


def _diagonal(xyz: Array) -> float:
    """Of the box around [n][3]; 0 of nothing."""
    return float(np.linalg.norm(np.ptp(xyz, axis=0))) if len(xyz) else 0.0


def _indexes(value: Any, what: str) -> Array:
    """[n][3] uint32 in C order."""
    a = np.asarray(value)
    if a.size == 0:
        return np.zeros((0, 3), np.uint32)
    if a.dtype.kind not in "iu":
        raise TypeError(f"{what}: expected whole numbers, not {a.dtype}")
    if a.ndim != 2 or a.shape[1] != 3:
        raise ValueError(f"{what}: expected the shape [n][3], not {list(a.shape)}")
    if a.min() < 0 or a.max() > 0xFFFFFFFF:
        raise SmrError(_E_INPUT, f"{what}: an index below 0 or beyond 32 bits")
    return np.ascontiguousarray(a, np.uint32)


def _integer(value: Any, what: str) -> int:
    number = int(value)
    if number != value:
        raise TypeError(f"{what}: expected a whole number, not {value!r}")
    return number


def _whole(value: Any, what: str, most: int, status: int = _E_INPUT) -> int:
    """A whole number from 0 to most; ctypes would take any, and cut it to its bits."""
    number = _integer(value, what)
    if not 0 <= number <= most:
        raise SmrError(status, f"{what} is {number}, expected 0 to {most}")
    return number


def _three(value: Any, what: str) -> Array:
    """[3] float32."""
    a = np.asarray(value)
    if a.shape != (3,):
        raise ValueError(f"{what}: expected three numbers, not the shape {list(a.shape)}")
    return _numbers(a, what, 0)


def _memory(n: int) -> Array:
    """n bytes, at least one, that start on a multiple of ALIGN. The view keeps the whole alive."""
    whole = np.empty(int(n) + ALIGN, np.uint8)
    start = -whole.ctypes.data % ALIGN
    return whole[start:start + max(int(n), 1)]


def _sized(call: Callable[..., int], *arguments: Any) -> int:
    """What a ..._bytes() call says."""
    n = _Z()
    call(*arguments, C.byref(n))
    return n.value


def _at(a: Optional[Array]) -> Optional[int]:
    return None if a is None else int(a.ctypes.data)


def _pose_struct(pose: Any) -> _Pose:
    m = np.asarray(pose, np.float32)
    if m.shape not in ((3, 4), (4, 4)):
        raise ValueError(f"pose: expected the shape [3][4] or [4][4], not {list(m.shape)}")
    return _Pose((_F * 12)(*m[:3].ravel()))


def _pose_array(pose: _Pose) -> Pose:
    return np.array(pose.m, np.float32).reshape(3, 4)


def apply_pose(pose: Any, xyz: Any) -> Array:
    """xyz [n][3] mm moved by a pose [3][4]."""
    m = np.asarray(pose, np.float32)
    return _numbers(xyz, "xyz") @ m[:3, :3].T + m[:3, 3]


def self_test() -> List[str]:
    """What is wrong with this thread's float arithmetic: nothing, or some of "fused", "flushed", "excess", "rounding".
    Other Python modules may have switched denormal numbers off; results then have other bits than elsewhere."""
    bits = _lib.smr_self_test()
    return [word for i, word in enumerate(("fused", "flushed", "excess", "rounding")) if bits >> i & 1]


# ------------------------------------------------------------------ threads

def _end_pool(handle: int, process: int, _kept: Array) -> None:
    """The memory is kept until here. A forked child has no such threads."""
    if process == os.getpid():
        _lib.smr_pthread_destroy(handle)


class _Pool:
    """Threads behind a port; they end with it. threads None: as many as processors."""

    def __init__(self, threads: Optional[int] = None) -> None:
        n = min(os.cpu_count() or 1, 64) if threads is None else _integer(threads, "threads")
        size = _lib.smr_pthread_bytes(n) if 1 <= n <= 64 else 0
        if size == 0:
            raise SmrError(_E_CONFIG, f"{threads} threads, expected 1 to 64")
        memory, handle = _memory(size), _P()
        _lib.smr_pthread_create(C.byref(handle), _at(memory), size, n)
        self.n = n
        self.port = _lib.smr_pthread_port(handle)
        weakref.finalize(self, _end_pool, handle.value or 0, os.getpid(), memory)


# ------------------------------------------------------------------ inputs

class Surface:
    """A target surface, ready for closest points. xyz: [n][3] mm; triangles: [m][3], at least one."""

    def __init__(self, xyz: Any, triangles: Any) -> None:
        self.xyz = _numbers(xyz, "xyz").copy()  # what the library has, whatever the caller writes
        self.triangles = _indexes(triangles, "triangles").copy()
        mesh = _Mesh(_at(self.xyz), _at(self.triangles), len(self.xyz), len(self.triangles))
        size = _sized(_lib.smr_surface_bytes, mesh.n_vertices, mesh.n_triangles)
        self._memory, self._handle = _memory(size), _P()
        _lib.smr_surface_build(C.byref(mesh), _at(self._memory), size, C.byref(self._handle))

    @property
    def room(self) -> int:
        """What it takes of n_target_vertices."""
        return len(self.xyz)

    def refit(self, xyz: Any) -> None:
        """New positions [n][3] mm of the same triangles, several times faster than a new surface. Registrations that
        have it must get it again by set_surface() before they tick."""
        new = _numbers(xyz, "xyz").copy()
        if new.shape != self.xyz.shape:
            raise ValueError(f"xyz: expected the shape {list(self.xyz.shape)}, not {list(new.shape)}")
        _lib.smr_surface_refit(self._handle, _at(new))
        _lib.smr_surface_step(self._handle, 0, None, 0)
        self.xyz = new

    def closest(self, points: Any, normals: Any = None, min_cos: float = 0.0, max_mm: float = COORD_MAX) -> Array:
        """The closest point of the surface to each of points [n][3] mm, within max_mm; with normals [n][3] only where
        the triangle's has at least the cosine min_cos. A record array [n]: point [3] mm, normal [3], distance mm,
        triangle (NONE: nothing found), weight [3], on_border."""
        at = _numbers(points, "points")
        way = None if normals is None else _numbers(normals, "normals")
        if way is not None and way.shape != at.shape:
            raise ValueError("normals: expected as many as points")
        hits = np.zeros(len(at), np.dtype(_Closest))
        step, to = hits.itemsize, hits.ctypes.data
        for i in range(len(at)):
            _lib.smr_surface_closest(self._handle, at.ctypes.data + 12 * i,
                                     None if way is None else way.ctypes.data + 12 * i, min_cos, max_mm, to + step * i)
        return hits


class Points:
    """A cloud of points as a target: a ring of `capacity` points that keeps the newest."""

    def __init__(self, capacity: int) -> None:
        self.capacity = _whole(capacity, "capacity", _MOST)
        size = _sized(_lib.smr_points_bytes, self.capacity)
        self._memory, self._handle = _memory(size), _P()
        _lib.smr_points_open(self.capacity, _at(self._memory), size, C.byref(self._handle))

    @property
    def room(self) -> int:
        """What it takes of n_target_vertices."""
        return self.capacity

    def __len__(self) -> int:
        n = _U()
        _lib.smr_points_count(self._handle, C.byref(n))
        return n.value

    def add(self, xyz: Any, normals: Any = None, weights: Any = None) -> None:
        """Adds [n][3] mm, at most `capacity`; normals [n][3] outwards, 0 0 0 for none; weights [n], 0..4. Registrations
        that have the cloud must get it again by set_points() before they tick."""
        at = _numbers(xyz, "xyz")
        way = None if normals is None else _numbers(normals, "normals")
        weight = None if weights is None else _numbers(weights, "weights", 0)
        if (way is not None and way.shape != at.shape) or (weight is not None and len(weight) != len(at)):
            raise ValueError("normals and weights: expected as many as points")
        _lib.smr_points_add(self._handle, _at(at), _at(way), _at(weight), len(at))

    def weigh(self, index: int, weight: float) -> None:
        """Another weight for one point, 0 for a mistake; index in the order of adding."""
        _lib.smr_points_weigh(self._handle, _whole(index, "index", _MOST), weight)

    def clear(self) -> None:
        """Takes all points out."""
        _lib.smr_points_clear(self._handle)

    def surface(self) -> Surface:
        """A copy in which Surface.closest() finds the nearest point, and onto which align() lays a model."""
        size = _sized(_lib.smr_points_surface_bytes, len(self))
        made = Surface.__new__(Surface)
        made.xyz, made.triangles = np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)
        made._memory, made._handle = _memory(size), _P()
        _lib.smr_points_surface(self._handle, _at(made._memory), size, C.byref(made._handle))
        return made


_VOXELS = {"uint8": 0, "int8": 1, "uint16": 2, "int16": 3, "float32": 4}


class Volume:
    """An image. voxels: [z][y][x]; spacing and origin: mm along x, y, z, the origin is the centre of the first voxel;
    direction: [3][3], columns are the axes' unit vectors. mask: [z][y][x], 0 counts as outside, as NaN does."""

    def __init__(self, voxels: Any, spacing: Sequence[float], origin: Sequence[float] = (0.0, 0.0, 0.0),
                 direction: Any = None, mask: Any = None) -> None:
        a = np.asarray(voxels)
        if a.ndim != 3:
            raise ValueError(f"voxels: expected the shape [z][y][x], not {list(a.shape)}")
        if a.dtype.kind == "b" or a.dtype == np.float64:
            a = a.astype(np.uint8 if a.dtype.kind == "b" else np.float32)
        if a.dtype.newbyteorder("=").name not in _VOXELS:
            raise TypeError(f"voxels: expected {', '.join(_VOXELS)} or float64, not {a.dtype}: convert them first")
        self.voxels = np.ascontiguousarray(a, a.dtype.newbyteorder("="))
        self.mask = None if mask is None else np.ascontiguousarray(np.asarray(mask) != 0).view(np.uint8)
        if self.mask is not None and self.mask.shape != self.voxels.shape:
            raise ValueError(f"mask: expected the shape {list(self.voxels.shape)}, not {list(self.mask.shape)}")
        axes = np.eye(3) if direction is None else np.asarray(direction, float).reshape(3, 3)
        self._view = _Volume(_at(self.voxels), _at(self.mask), _VOXELS[self.voxels.dtype.name],
                             (_U * 3)(*self.voxels.shape[::-1]), (_F * 3)(*_three(origin, "origin")),
                             (_F * 3)(*_three(spacing, "spacing")), (_F * 9)(*axes.ravel()))


@dataclass
class Landmark:
    """A point of the model, and where it is now. The point: a vertex of a structure, or `rest` [3] mm in the rest shape
    (structure None: of whichever lies nearest). weight: one over the variance of its place. hard: it ends there."""
    place: Sequence[float]
    rest: Optional[Sequence[float]] = None
    vertex: Optional[int] = None
    structure: Union[int, str, None] = None
    weight: float = 1.0
    hard: bool = False


# ------------------------------------------------------------------ the model

Mesh = Tuple[Any, Any]  # xyz [n][3] mm, triangles [m][3]


class Model:
    """A prepared model. Model.prepare() makes one of surfaces, Model.open() reads one that was saved."""

    def __init__(self, memory: Array) -> None:
        """memory: uint8 that starts on a multiple of ALIGN, as prepare() and open() make it."""
        self._memory, self._handle = memory, _P()
        memory.flags.writeable = False
        _lib.smr_model_open(_at(memory), len(memory), C.byref(self._handle))
        self.info = ModelInfo()
        _lib.smr_model_get_info(self._handle, C.byref(self.info))
        self._structures = [_StructureInfo() for _ in range(self.info.n_structures)]
        for i, s in enumerate(self._structures):
            _lib.smr_model_structure(self._handle, i, C.byref(s))

    @classmethod
    def prepare(cls, structures: Union[Mesh, Mapping[str, Mesh]], reference: Optional[Volume] = None,
                threads: Optional[int] = None, paper: bool = False, also: Sequence[Any] = (),
                **settings: Any) -> "Model":
        """Of {name: (xyz, triangles)}, or of one (xyz, triangles). reference: the image that fits the surfaces, for
        registrations into images. threads None: as many as processors; the model is the same. paper: as the paper has
        it. also: shapes of at most 15 further subjects, each the xyz [n][3] of all structures in a row, or a sequence
        with one xyz for each structure. settings: PREPARE_SETTINGS, build/SETTINGS.md."""
        named = structures if isinstance(structures, Mapping) else {"": structures}
        config = (_lib.smr_prepare_config_paper if paper else _lib.smr_prepare_config_default)()
        _apply_settings(config, PREPARE_SETTINGS, settings)
        pool = _Pool(threads)
        config.port = C.addressof(pool.port)
        config.reference = None if reference is None else C.addressof(reference._view)
        meshes = [(_numbers(xyz, name or "xyz"), _indexes(triangles, name or "triangles"))
                  for name, (xyz, triangles) in named.items()]
        n = len(meshes)
        all_xyz = np.concatenate([xyz.reshape(-1, 3) for xyz, _ in meshes] or [np.zeros((0, 3))])
        size = _diagonal(all_xyz)
        if 0.0 < size < 5.0:
            warnings.warn(f"lengths are millimetres, but the model's diagonal is only {size:.3g} mm: is it in metres?",
                          stacklevel=2)
        shapes = [_numbers(np.concatenate(x) if isinstance(x, (list, tuple)) else x, "also") for x in also]
        if any(len(x) != len(all_xyz) for x in shapes):
            raise ValueError("also: expected as many vertices as the structures have")
        rows = np.ascontiguousarray(np.concatenate(shapes or [np.zeros((0, 3), np.float32)]))
        subjects = _Subjects(_at(rows), len(shapes))
        config.also = C.addressof(subjects)
        table = (_Structure * max(n, 1))()
        for row, name, (xyz, triangles) in zip(table, named, meshes):
            row.name = name.encode()
            row.mesh = _Mesh(_at(xyz), _at(triangles), len(xyz), len(triangles))
        scratch = _memory(_sized(_lib.smr_prepare_bytes, table, n, C.byref(config)))
        where = (table, n, C.byref(config), _at(scratch), len(scratch))
        memory = _memory(_sized(_lib.smr_prepare, *where, None, 0))
        _sized(_lib.smr_prepare, *where, _at(memory), len(memory))
        return cls(memory)

    @classmethod
    def open(cls, source: Union[str, os.PathLike, bytes, bytearray, memoryview]) -> "Model":
        """Of a file (smr build, save()) or of its bytes, which are copied and checked."""
        if isinstance(source, (str, os.PathLike)):
            data: Array = np.fromfile(source, np.uint8)
        else:
            data = np.frombuffer(source, np.uint8)
        memory = _memory(len(data))
        memory[:len(data)] = data
        return cls(memory)

    def save(self, path: Union[str, os.PathLike]) -> None:
        """Writes the model's bytes, which open() and the program smr read on any machine."""
        self._memory.tofile(path)

    def __bytes__(self) -> bytes:
        return self._memory.tobytes()

    def __len__(self) -> int:
        return len(self._structures)

    @property
    def names(self) -> List[str]:
        """The structures' names, in order."""
        return [s.name.decode(errors="replace") for s in self._structures]

    def index(self, structure: Union[int, str, None]) -> int:
        """A structure's number; None, or ALL: ALL."""
        if structure is None or (structure == ALL and not isinstance(structure, str)):
            return ALL
        if isinstance(structure, str):
            if structure not in self.names:
                raise KeyError(f"the model has no structure {structure!r}")
            return self.names.index(structure)
        k = _integer(structure, "structure")
        if not 0 <= k < len(self):
            raise SmrError(_E_INPUT, f"the model has no structure {k}")
        return k

    def n_vertices(self, structure: Union[int, str]) -> int:
        """Vertices of a structure."""
        k = self.index(structure)
        if k == ALL:
            raise SmrError(_E_INPUT, "one structure is expected, not all")
        return int(self._structures[k].n_vertices)

    def mesh(self, structure: Union[int, str]) -> Tuple[Array, Array]:
        """A structure's rest shape as it was given: xyz [n][3] mm, triangles [m][3]."""
        xyz = np.empty((self.n_vertices(structure), 3), np.float32)
        k = self.index(structure)
        triangles = np.empty((self._structures[k].n_triangles, 3), np.uint32)
        _lib.smr_model_mesh(self._handle, k, _at(xyz), _at(triangles))
        return xyz, triangles

    def rest(self) -> Array:
        """All structures' rest positions in a row, [n][3] mm."""
        return np.concatenate([self.mesh(i)[0] for i in range(len(self))])


# ------------------------------------------------------------------ start poses

def _merged(meshes: Iterable[Tuple[Array, Array]]) -> Surface:
    """One surface of several."""
    all_xyz, all_triangles, at = [], [], 0
    for xyz, triangles in meshes:
        all_xyz.append(xyz)
        all_triangles.append(triangles.astype(np.int64) + at)
        at += len(xyz)
    return Surface(np.concatenate(all_xyz), np.concatenate(all_triangles))


def _as_surface(shape: Any, what: str) -> Surface:
    """A model's structures as one surface; a cloud as one without triangles."""
    made = _merged(shape.mesh(i) for i in range(len(shape))) if isinstance(shape, Model) else _as_target(shape)
    if isinstance(made, Volume):
        raise TypeError(f"{what}: expected a surface or points, not an image")
    return made.surface() if isinstance(made, Points) else made


def align(model: Union[Model, Surface, Mesh], target: Union[Surface, Points, Mesh, Array], scaled: bool = True,
          given: Any = None, threads: Optional[int] = None, **settings: int) -> Tuple[Pose, AlignReport]:
    """The pose [3][4] that lays a model onto a target, without landmarks. A (xyz, triangles) is a surface, an array
    [n][3] a cloud. scaled: with one scale. given: the pose [3][4] that is tried as well; None: as the files lie.
    threads None: as many as processors. settings: iterations, samples."""
    return _align(model, target, [], scaled, given, threads, **settings)[:2]


def align_parts(model: Model, target: Any, targets: Sequence[Any], scaled: bool = False, given: Any = None,
                threads: Optional[int] = None, **settings: int) -> Tuple[List[Pose], List[AlignReport]]:
    """A pose [3][4] for each structure of a model, whose joints have turned. target: of the whole, as in align();
    targets: each structure's, the same object for several that share one, None for one that goes with its neighbour.
    A report with n_alike 0: the pose is the neighbour's."""
    if len(targets) != len(model):
        raise ValueError("targets: expected one, or None, for each structure")
    onto = {id(t): _as_surface(t, "target") for t in [target, *targets] if t is not None}
    parts = [(_as_surface(model.mesh(i), "model"), None if t is None else onto[id(t)]) for i, t in enumerate(targets)]
    made = _align(model, onto[id(target)], parts, scaled, given, threads, **settings)[2]
    return [_pose_array(p.pose) for p in made], [p.report for p in made]


def _align(model: Any, target: Any, parts: Sequence[Tuple[Surface, Optional[Surface]]], scaled: bool, given: Any,
           threads: Optional[int], **settings: int) -> Tuple[Pose, AlignReport, Any]:
    source, onto = _as_surface(model, "model"), _as_surface(target, "target")
    config = _lib.smr_align_config_default()
    config.scaled = int(scaled)
    for name, value in settings.items():
        if name not in ("iterations", "samples"):
            raise TypeError(f"align() has no setting {name!r}")
        setattr(config, name, _whole(value, name, _MOST, _E_CONFIG))
    start = None if given is None else _pose_struct(given)
    config.given = None if start is None else C.addressof(start)
    pool = _Pool(threads)
    config.port = C.addressof(pool.port)
    made = (_AlignPart * len(parts))()
    for part, (structure, own) in zip(made, parts):
        part.model, part.target = structure._handle, None if own is None else own._handle
    config.n_parts, config.part = len(parts), C.addressof(made) if parts else None
    scratch = _memory(_sized(_lib.smr_align_bytes, C.byref(config)))
    pose, report = _Pose(), AlignReport()
    _lib.smr_align(source._handle, onto._handle, C.byref(config), _at(scratch), len(scratch), C.byref(pose),
                   C.byref(report))
    return _pose_array(pose), report, made


def articulated(model: Union[Model, Surface, Mesh], target: Union[Surface, Mesh], start: Any = None,
                threads: Optional[int] = None, unexplained: Optional[List[float]] = None) -> Optional[Array]:
    """Start positions [n][3] of one surface whose parts have turned about joints, for set_positions(); None: the pose
    start [3][4] explains both surfaces, or no turned parts do. start None: as the files lie. unexplained gets the share
    0..1.5 that is left: of several starts, AlignReport.others, the least is right."""
    source, onto = _as_surface(model, "model"), _as_surface(target, "target")
    pose = _pose_struct(np.eye(3, 4) if start is None else start)
    pool, bent, job = _Pool(threads), _U(), (_Q * 256)()
    scratch = _memory(_sized(_lib.smr_articulated_bytes, source._handle, onto._handle))
    xyz = np.empty((len(source.xyz), 3), np.float32)
    _lib.smr_articulated_begin(source._handle, onto._handle, C.byref(pose), C.addressof(pool.port), _at(scratch),
                               len(scratch), _at(xyz), C.byref(bent), C.byref(job))
    _lib.smr_job_step(C.byref(job), 0, None, 0)
    if unexplained is not None and bent.value:
        unexplained.append((bent.value - 1) * 1e-6)
    return xyz if bent.value else None


def _pairs(from_: Any, to: Any) -> Tuple[Array, Array]:
    a, b = _numbers(from_, "from"), _numbers(to, "to")
    if a.shape != b.shape:
        raise ValueError("landmarks: expected as many in both spaces")
    return a, b


def align_landmarks(from_: Any, to: Any, scaled: bool = False) -> Tuple[Pose, float]:
    """The pose [3][4] that lays from_[i] onto to[i], both [n][3] mm, by least squares, and the distance left, mm."""
    a, b = _pairs(from_, to)
    pose, rms = _Pose(), _F()
    _lib.smr_align_landmarks(_at(a), _at(b), len(a), int(scaled), C.byref(pose), C.byref(rms))
    return _pose_array(pose), rms.value


class Warp:
    """A thin-plate spline from from_[i] to to[i], both [n][3] mm. smoothing: mm; 0 passes through every landmark.
    kind: "spline", or what the landmarks determine instead: "scaled", "rigid", "translation"."""

    def __init__(self, from_: Any, to: Any, smoothing: float = 0.0) -> None:
        a, b = _pairs(from_, to)
        size, kind = _sized(_lib.smr_warp_bytes, len(a)), _U()
        self._memory, self._handle = _memory(size), _P()
        _lib.smr_warp_fit(_at(a), _at(b), len(a), smoothing, _at(self._memory), size, C.byref(self._handle),
                          C.byref(kind))
        self.kind = ("spline", "scaled", "rigid", "translation")[kind.value]

    def apply(self, xyz: Any) -> Array:
        """Points [n][3] mm carried by the spline, as a new array."""
        out = _numbers(xyz, "xyz").copy()
        _lib.smr_warp_apply(self._handle, _at(out), len(out))
        return out


# ------------------------------------------------------------------ registration

Target = Union[Surface, Points, Volume, Mesh, Array]
Targets = Union[Target, Mapping[Any, Target], None]  # a mapping: structures, by number or name, to targets


def _as_target(target: Any) -> Union[Surface, Points, Volume]:
    """A (xyz, triangles) becomes a surface, an array [n][3] a cloud."""
    if isinstance(target, (Surface, Points, Volume)):
        return target
    if isinstance(target, tuple) and len(target) == 2:
        return Surface(*target)
    xyz = _numbers(target, "target")
    cloud = Points(len(xyz))
    cloud.add(xyz)
    return cloud


def _as_targets(target: Targets) -> Dict[Union[int, str, None], Union[Surface, Points, Volume]]:
    if target is None:
        return {}
    if isinstance(target, Mapping):
        made = {key: _as_target(value) for key, value in target.items()}
        if any(key is not None and isinstance(value, Volume) for key, value in made.items()):
            raise ValueError("target: an image is for every structure without a surface: its key is None")
        return made
    return {None: _as_target(target)}


class Job:
    """A call in pieces, for programs with little time at once: step() until it returns True, then result.

    From the first position that a job of set_pose_begin() or set_positions_begin() writes until its end, other calls
    for the registration raise SmrError, but set_pose() starts anew."""

    def __init__(self, registration: Registration, result: Any = None, *kept: Any) -> None:
        self._state = (C.c_uint64 * 256)()  # SMR_JOB_BYTES
        self._kept, self._result, self.done = (registration, result, *kept), result, False

    def step(self, units: int = 0, budget_ns: int = 0) -> bool:
        """Goes on for `units` pieces, or budget_ns; 0: no limit. Returns whether the job has ended."""
        self.done = _lib.smr_job_step(self._state, _whole(units, "units", _MOST), None,
                                      _whole(int(budget_ns), "budget_ns", (1 << 64) - 1)) == 0
        return self.done

    @property
    def result(self) -> Any:
        """What the call returns: bytes of a save; None of others."""
        if not self.done:
            raise ValueError("the job has not ended: call step() until it returns True")
        return None if self._result is None else self._result.tobytes()


class Registration:
    """A registration in progress, tick by tick.

    target: as in set_target(). threads: 1 by default; None: as many as processors; no result depends on it. paper: as
    the paper has it. settings: SETTINGS, build/SETTINGS.md; n_target_vertices follows from target where it is not given,
    and the defaults are those for images where target is a Volume."""

    def __init__(self, model: Model, target: Targets = None, threads: Optional[int] = 1, paper: bool = False,
                 **settings: Any) -> None:
        targets = _as_targets(target)
        image = any(isinstance(t, Volume) for t in targets.values())
        config = (_lib.smr_config_paper if paper
                  else _lib.smr_config_default_image if image else _lib.smr_config_default)()
        self.model = model
        self._pool = _Pool(threads)
        config.n_workers = self._pool.n
        config.n_target_vertices = sum({id(t): t.room for t in targets.values() if not isinstance(t, Volume)}.values())
        _apply_settings(config, SETTINGS, settings)
        size = self._begin(config)
        _lib.smr_init(model._handle, C.byref(config), C.byref(self._pool.port), _at(self._memory), size,
                      C.byref(self._handle))
        for structure, one in targets.items():
            self._set_one(structure, one)

    def _begin(self, config: Any) -> int:
        """Memory for this configuration; its bytes."""
        self._config = config
        self._borrowed: Dict[Any, Any] = {}  # what the library points to, by structure
        size = _sized(_lib.smr_arena_bytes, self.model._handle, C.byref(config))
        self._memory, self._handle = _memory(size), _P()
        self.report = TickReport()
        wrong = self_test()
        if wrong:
            warnings.warn(f"this thread's float arithmetic is {', '.join(wrong)}: results have other bits than others'")
        return size

    # ---- save and restore

    def save(self) -> bytes:
        """The registration as bytes, between complete iterations; inputs are in it as checksums only."""
        size = _sized(_lib.smr_save_bytes, self._handle)
        out = np.empty(size, np.uint8)
        self._call(_lib.smr_save, _at(out), size)
        return out.tobytes()

    def save_begin(self) -> Job:
        """Begins save(); the job's result is the bytes. A tick ends the job with an error."""
        out = np.empty(_sized(_lib.smr_save_bytes, self._handle), np.uint8)
        job = Job(self, out)
        self._call(_lib.smr_save_begin, _at(out), len(out), job._state)
        return job

    @classmethod
    def restore(cls, model: Model, saved: Any, target: Targets = None, threads: Optional[int] = 1) -> Registration:
        """Goes on from what save() wrote, to the same bits. What was set then is set again: target here, goals and
        fixed surfaces by their calls; `awaited` says how many inputs are missing. A Surface that structures shared is
        one again."""
        info, a = _SavedInfo(), np.frombuffer(saved, np.uint8)
        _lib.smr_save_info(_at(a), len(a), C.byref(info))
        self = cls.__new__(cls)
        self.model, self._pool = model, _Pool(threads)
        info.config.n_workers = self._pool.n
        size = self._begin(info.config)
        _lib.smr_restore(model._handle, C.byref(info.config), C.byref(self._pool.port), _at(a), len(a),
                         _at(self._memory), size, C.byref(self._handle))
        for structure, one in _as_targets(target).items():
            self._set_one(structure, one)
        return self

    def _call(self, function: Any, *arguments: Any) -> int:
        """A call for this registration. What is refused while inputs are awaited says which are expected."""
        try:
            return int(function(self._handle, *arguments))
        except SmrError as error:
            n = self.awaited if error.status in (_E_STATE, _E_INPUT) else 0
            name = error.where.split(":")[0]
            if n == 0 or (error.status == _E_INPUT and not name.startswith("smr_set_")):
                raise
            words = (f"{n} of what the saved registration had must be set again first: targets by set_target() or "
                     "restore(), goals and fixed surfaces by their calls" if error.status == _E_STATE
                     else "the saved registration had something else here: set again what it had, equal to the bit")
            raise SmrError(error.status, f"{name}: {words}") from None

    @property
    def awaited(self) -> int:
        """Inputs that must still be set again after restore()."""
        n = _U()
        _lib.smr_get_awaited(self._handle, C.byref(n))
        return n.value

    def setting(self, name: str) -> Any:
        """A setting's value in this registration."""
        value = getattr(self._config, name)
        return list(value) if isinstance(value, C.Array) else value

    # ---- inputs

    def _keep(self, structure: Union[int, str, None], what: Any) -> None:
        """Notes what the library now borrows for a structure; ALL replaces the others."""
        k = self.model.index(structure)
        if k == ALL:
            for other in [key for key in self._borrowed if isinstance(key, int)]:
                del self._borrowed[other]
        self._borrowed[k] = what

    def _set_one(self, structure: Union[int, str, None], target: Union[Surface, Points, Volume]) -> None:
        if isinstance(target, Volume):
            self.set_volume(target)
        elif isinstance(target, Points):
            self.set_points(target, structure)
        else:
            self.set_surface(target, structure)

    def set_target(self, target: Targets) -> None:
        """A Surface, Points or Volume, a (xyz, triangles), an array [n][3] of points; or a mapping of structures to
        these, an image under None only. Of a mapping those are set that stand before the one that was refused."""
        for structure, one in _as_targets(target).items():
            self._set_one(structure, one)

    def set_surface(self, surface: Optional[Surface], structure: Union[int, str, None] = None) -> None:
        """The target surface of a structure, or of all. None takes it away."""
        handle = None if surface is None else surface._handle
        self._call(_lib.smr_set_surface, self.model.index(structure), handle)
        self._keep(structure, surface)

    def set_points(self, points: Optional[Points], structure: Union[int, str, None] = None) -> None:
        """The cloud that a structure, or all, has as its target; again whenever points were added."""
        handle = None if points is None else points._handle
        if points is not None and self.setting("attraction") == 0:
            warnings.warn("attraction is 0, but a cloud of points always attracts", stacklevel=2)
        self._call(_lib.smr_set_points, self.model.index(structure), handle)
        self._keep(structure, points)

    def set_volume(self, volume: Optional[Volume]) -> None:
        """The image for every structure without a surface. None takes it away."""
        self._call(_lib.smr_set_volume, None if volume is None else C.byref(volume._view))
        self._borrowed["volume"] = volume

    def set_pose(self, pose: Any) -> None:
        """Starts from the rest shape moved by a pose [3][4]."""
        self._call(_lib.smr_set_pose, C.byref(_pose_struct(pose)))

    def set_positions(self, structure: Union[int, str, None], xyz: Any) -> None:
        """Puts a structure, or all in a row, at [n][3] mm, in the order of the vertices, and starts over."""
        a = self._vertices(structure, xyz)  # kept until the library has it
        self._call(_lib.smr_set_positions, self.model.index(structure), _at(a))

    def set_pose_begin(self, pose: Any) -> Job:
        """Begins set_pose()."""
        job = Job(self)
        self._call(_lib.smr_set_pose_begin, C.byref(_pose_struct(pose)), job._state)
        return job

    def set_positions_begin(self, structure: Union[int, str, None], xyz: Any) -> Job:
        """Begins set_positions()."""
        a = self._vertices(structure, xyz)
        job = Job(self, None, a)
        self._call(_lib.smr_set_positions_begin, self.model.index(structure), _at(a), job._state)
        return job

    def _vertices(self, structure: Union[int, str, None], xyz: Any) -> Array:
        a, k = _numbers(xyz, "xyz"), self.model.index(structure)
        n = sum(self.model.n_vertices(i) for i in range(len(self.model.names)) if k in (i, ALL))
        if len(a) != n:
            raise ValueError(f"xyz: expected {n} vertices, not {len(a)}")
        return a

    def set_landmarks(self, landmarks: Sequence[Landmark]) -> None:
        """Landmarks in place of those before, at most the setting n_landmarks. Copied."""
        table = (_Landmark * max(len(landmarks), 1))()
        for row, mark in zip(table, landmarks):
            if (mark.rest is None) == (mark.vertex is None):
                raise ValueError("a landmark has either a vertex or a place at rest")
            row.structure = self.model.index(mark.structure)
            row.vertex = NONE if mark.vertex is None else _whole(mark.vertex, "vertex", _MOST)
            row.rest = (_F * 3)(*((0.0, 0.0, 0.0) if mark.rest is None else _three(mark.rest, "rest")))
            row.place = (_F * 3)(*_three(mark.place, "place"))
            row.weight, row.hard = mark.weight, int(mark.hard)
        self._call(_lib.smr_set_landmarks, table, len(landmarks))
        self._n_landmarks = len(landmarks)

    _n_landmarks = 0

    def landmarks(self) -> Array:
        """Where the landmarks' points of the model are, [n][3] mm."""
        xyz = np.empty((self._n_landmarks, 3), np.float32)
        self._call(_lib.smr_get_landmarks, _at(xyz))
        return xyz

    def reference_weights(self) -> Array:
        """Weights of the model's shapes in the blend that invisible vertices follow, its own first."""
        weights, n = np.zeros(16, np.float32), _U()
        self._call(_lib.smr_get_reference_weights, _at(weights), C.byref(n))
        return weights[:n.value].copy()

    def set_goals(self, structure: Union[int, str], xyz: Any, weights: Any = None) -> None:
        """Goals of the caller's own for each vertex of a structure: xyz [n][3] mm, weights [n], 0..1000, 0 for none;
        None takes them away. The setting caller_goals must be 1."""
        at = None if xyz is None else self._vertices(structure, xyz)
        weight = None if weights is None else _numbers(weights, "weights", 0)
        if at is not None and weight is not None and len(weight) != len(at):
            raise ValueError("weights: expected as many as vertices")
        self._call(_lib.smr_set_goals, self.model.index(structure), _at(at), _at(weight))
        self._borrowed["goals", self.model.index(structure)] = (at, weight)

    def set_fixed(self, index: int, surface: Optional[Surface]) -> None:
        """Number `index`, below the setting n_fixed, of the surfaces that structures keep out of; None takes it away.
        The setting contact must be above 0."""
        i = _whole(index, "index", _MOST)
        self._call(_lib.smr_set_fixed, i, None if surface is None else surface._handle)
        self._borrowed["fixed", i] = surface

    def set_motion(self, structure: Union[int, str], mass: Any = None, velocity: Any = None) -> None:
        """Masses [n] g, inf: pinned, and velocities [n][3] mm/s of a structure's vertices; None: as they are. Copied.
        The setting dynamics must be on."""
        speed = None if velocity is None else self._vertices(structure, velocity)
        weight = None if mass is None else _numbers(mass, "mass", 0)
        if weight is not None and len(weight) != self.model.n_vertices(structure):
            raise ValueError("mass: expected as many as vertices")
        self._call(_lib.smr_set_motion, self.model.index(structure), _at(weight), _at(speed))

    def velocities(self, structure: Union[int, str]) -> Array:
        """[n][3] mm/s, of a structure in motion."""
        return self._for_vertices(_lib.smr_get_velocities, structure, np.float32, 3)

    def energy(self) -> Energy:
        """Energies of a model in motion."""
        energy = Energy()
        self._call(_lib.smr_get_energy, C.byref(energy))
        return energy

    def set_volume_ratio(self, structure: Union[int, str, None], ratio: float) -> None:
        """The volume that a closed structure, or each of them (None), is to have over the rest shape's in the scale of
        the start, 0.1..10; 1 until set. The setting volume must be above 0."""
        self._call(_lib.smr_set_volume_ratio, ALL if structure is None else self.model.index(structure), ratio)

    def structure_volume(self, structure: Union[int, str]) -> StructureVolume:
        """Volumes of a structure at rest, as asked for and now, mm^3."""
        volume = StructureVolume()
        self._call(_lib.smr_get_structure_volume, self.model.index(structure), C.byref(volume))
        return volume

    def set_active(self, n: int) -> None:
        """Exactly the first n vertices in the order of priority take part from the next iteration on; 0: as set up."""
        self._call(_lib.smr_set_active, _whole(n, "n", _MOST))

    def set_scrub(self, inputs: bool = True, state: bool = True) -> None:
        """Checks model, targets and image by checksum, a slice in each tick, and the whole arena in each call."""
        self._call(_lib.smr_set_scrub, bool(inputs) + 2 * bool(state))

    def set_scrub_begin(self, inputs: bool = True, state: bool = True) -> Job:
        """Begins set_scrub()."""
        job = Job(self)
        self._call(_lib.smr_set_scrub_begin, bool(inputs) + 2 * bool(state), job._state)
        return job

    def scrub(self, budget_ns: int = 0) -> bool:
        """Goes on with the round over the inputs, or runs a whole one (0). Returns whether the round has ended."""
        return self._call(_lib.smr_scrub, _whole(int(budget_ns), "budget_ns", (1 << 64) - 1)) == 0

    # ---- ticks

    def tick(self, budget_ns: int = 0) -> TickReport:
        """One iteration, or as much of it as budget_ns allows (report.complete says which); 0: no clock."""
        report = TickReport()
        budget = _whole(int(budget_ns), "budget_ns", (1 << 64) - 1)
        report.complete = self._call(_lib.smr_tick, budget, C.byref(report)) == 0
        self.report = report
        return report

    def run(self, ticks: Optional[int] = None, budget_ns: int = 0) -> Iterator[TickReport]:
        """Ticks until the schedule is done, or while tracking until there is nothing to do; at most `ticks`. Yields
        each report."""
        n = 0
        while ticks is None or n < ticks:
            report = self.tick(budget_ns)
            n += 1
            yield report
            if report.complete and (report.done or report.details.settled):
                return

    # ---- results

    def _for_vertices(self, call: Any, structure: Union[int, str], kind: Any, columns: int) -> Array:
        n = self.model.n_vertices(structure)
        out = np.empty((n, columns) if columns else n, kind)
        self._call(call, self.model.index(structure), _at(out))
        return out

    def positions(self, structure: Union[int, str]) -> Array:
        """A structure's present positions, [n][3] mm."""
        return self._for_vertices(_lib.smr_get_positions, structure, np.float32, 3)

    def normals(self, structure: Union[int, str]) -> Array:
        """Unit normals, [n][3]; 0 where no triangle has an area."""
        return self._for_vertices(_lib.smr_get_normals, structure, np.float32, 3)

    def all_positions(self) -> Array:
        """All structures' present positions in a row, [n][3] mm: what Carry.apply() takes."""
        return np.concatenate([self.positions(i) for i in range(len(self.model))])

    def expected_error(self, structure: Union[int, str]) -> Array:
        """[n] mm: how far each vertex is expected from its true place; NaN where too little is visible to say."""
        mm = self._for_vertices(_lib.smr_get_expected_error, structure, np.float32, 0)
        mm[mm < 0] = np.nan
        return mm

    def expected_parts(self, structure: Union[int, str]) -> Tuple[Array, Array]:
        """[n] mm each: the parts of expected_error() across the surface and along it, whose squares add up."""
        mm = np.empty((2, self.model.n_vertices(structure)), np.float32)
        self._call(_lib.smr_get_expected_parts, self.model.index(structure), _at(mm[0]), _at(mm[1]))
        mm[mm < 0] = np.nan
        return mm[0], mm[1]

    def local_volume(self, structure: Union[int, str], radius_mm: float = 0.0) -> Array:
        """[n]: volume around each vertex over that at rest, in clusters of about radius_mm; 0: eight mean edges."""
        ratio = np.empty(self.model.n_vertices(structure), np.float32)
        self._call(_lib.smr_get_local_volume, self.model.index(structure), radius_mm, _at(ratio))
        return ratio

    def pose(self, structure: Union[int, str, None] = None) -> Tuple[Pose, float]:
        """The rigid pose [3][4] from the rest shape of a structure, or of all (None), to its visible vertices, and their
        mean distance in it to the planes through their last goals, mm; NaN where that was not measured."""
        pose, mm = _Pose(), _F()
        self._call(_lib.smr_get_pose, self.model.index(structure), C.byref(pose), C.byref(mm))
        return _pose_array(pose), mm.value if mm.value >= 0 else float("nan")

    def visible(self, structure: Union[int, str]) -> Array:
        """[n] bool: whether the target shows the vertex."""
        return self._for_vertices(_lib.smr_get_visible, structure, np.uint8, 0) != 0

    def verdict(self, structure: Union[int, str, None] = None) -> Verdict:
        """Whether a structure, or the whole, can be relied on. Only between complete iterations."""
        verdict = Verdict()
        self._call(_lib.smr_get_verdict, self.model.index(structure), C.byref(verdict))
        return verdict

    def structure_report(self, structure: Union[int, str]) -> StructureReport:
        """What a structure's forces did in the last iteration."""
        report = StructureReport()
        self._call(_lib.smr_get_structure_report, self.model.index(structure), C.byref(report))
        return report

    @property
    def hash(self) -> int:
        """Of the complete state: the same on every processor, by every program."""
        return int(_lib.smr_state_hash(self._handle))


@dataclass
class Result:
    """What register() found. Lists have one element for each structure.
    positions: [n][3] mm; expected_error: [n] mm, NaN where too little is visible; visible: [n] bool; verdict: of the
    whole; verdicts: of each; pose: [3][4] of the start, None without; start: what align() found, None without; report:
    of the last tick; hash: of the state."""
    names: List[str]
    positions: List[Array]
    expected_error: List[Array]
    visible: List[Array]
    verdict: Verdict
    verdicts: List[Verdict]
    pose: Optional[Pose]
    start: Optional[AlignReport]
    report: TickReport
    hash: int
    registration: Registration = field(repr=False)

    def carry(self, points: Any, inverse: bool = False) -> Array:
        """Points [n][3] mm of the model's space, carried to where the model is now, or back."""
        now = np.concatenate(self.positions)
        return Carry(self.registration.model).map(now, points, inverse)[0]


def _start(s: Registration, model: Model, targets: Mapping[Any, Any], align_by: Optional[str],
           start: Any) -> Tuple[Optional[Pose], Optional[AlignReport]]:
    """Puts a registration at its start: a Warp, a pose, or what align() finds."""
    if isinstance(start, Warp):
        if align_by is not None:
            raise ValueError("align: a Warp is the start already; one of both")
        for i in range(len(model)):
            s.set_positions(i, start.apply(model.mesh(i)[0]))
        return None, None
    pose, report = start, None
    if align_by is not None:
        if align_by not in ("rigid", "similarity", "parts"):
            raise ValueError("align: expected None, \"rigid\", \"similarity\" or \"parts\"")
        distinct = list({id(t): t for t in targets.values()}.values())
        if len(distinct) == 1 and not isinstance(distinct[0], Volume):
            onto = distinct[0]
        elif distinct and all(isinstance(t, Surface) for t in distinct):
            onto = _merged((t.xyz, t.triangles) for t in distinct)
        else:
            raise ValueError("align: expected surfaces, or one cloud, as targets")
        if align_by == "parts":
            own = [targets.get(name, targets.get(i, targets.get(None))) for i, name in enumerate(model.names)]
            if len(distinct) == 1:
                own = [None if t is None else onto for t in own]
            poses, reports = align_parts(model, onto, own, given=start)
            for i, p in enumerate(poses):
                xyz = model.mesh(i)[0]
                s.set_positions(i, xyz @ p[:, :3].T + p[:, 3])
            return None, next((r for r in reports if r.n_alike), reports[0])
        pose, report = align(model, onto, align_by == "similarity", given=start)
    if pose is not None:
        s.set_pose(pose)
        pose = np.array(pose, np.float32)[:3]
    return pose, report


def _doubts(model: Model, targets: Mapping[Any, Any], found: Optional[AlignReport], report: TickReport) -> Iterator[str]:
    """What speaks against a result beside its verdict's own measures, as `smr register` says it."""
    surfaces = [t.xyz for t in targets.values() if isinstance(t, Surface)]
    if surfaces and len(surfaces) == len(targets) and (found is None or found.scale == 1.0):
        ratio = float(_diagonal(np.concatenate(surfaces)) / max(_diagonal(model.rest()), 1e-30))
        if not 1 / 9 <= ratio <= 9:
            yield f"the target is {ratio:.3g} times as large as the model: look at the units of both"
    if found is not None and found.model_inside_out:
        yield "the model is a closed surface that is inside out"
    if found is not None and found.target_inside_out:
        yield "the target is a closed surface that is inside out"
    if found is not None and found.n_alike > 1 and not found.given:
        yield (f"{found.n_alike} clearly different start poses explain the surfaces alike: look which way round the "
               "result lies, or give landmarks")
    if found is not None and found.n_alike > 0 and found.mirrored_rms_mm < 0.7 * found.rms_mm:
        yield (f"the model's mirror image starts nearer, {found.mirrored_rms_mm:.1f} instead of {found.rms_mm:.1f} mm: "
               "look whether the target is of the other side of the body")
    if not report.done and not report.details.tracking:
        yield f"ticks ended first, after {100 * report.progress:.0f} % of the schedule"


def register(model: Model, target: Targets = None, align: Optional[str] = None, start: Any = None,
             landmarks: Sequence[Landmark] = (), threads: Optional[int] = None, ticks: Optional[int] = None,
             budget_ns: int = 0, progress: Optional[Callable[[TickReport], Any]] = None, **settings: Any) -> Result:
    """Deforms a model onto its target and says how far the result can be trusted.

    target: a Surface, Points or Volume, a (xyz, triangles), an array [n][3] of points, or a mapping of structures to
    these; None with landmarks alone. align: None, "rigid" or "similarity": a start pose from the surfaces; "parts": of
    each structure, for joints. start: a pose [3][4] (align_landmarks()), or a Warp (the usual start into an image).
    landmarks: points of the model that are drawn to their places. threads None: as many as processors. ticks: at most
    so many, None: to the end. budget_ns: of a tick, 0: no clock. progress: called with each report. settings: SETTINGS,
    build/SETTINGS.md."""
    targets = _as_targets(target)
    if landmarks:
        settings.setdefault("n_landmarks", len(landmarks))
    s = Registration(model, targets or None, threads, **settings)
    pose, found = _start(s, model, targets, align, start)
    if landmarks:
        s.set_landmarks(landmarks)
    for report in s.run(ticks, budget_ns):
        if progress is not None:
            progress(report)
    while not s.report.complete:  # what is judged is a complete iteration
        s.tick()
    each, verdict = range(len(model)), s.verdict()
    if not s._config.dynamics:  # which has no end
        verdict._doubt(_doubts(model, targets, found, s.report))
    return Result(model.names, [s.positions(i) for i in each], [s.expected_error(i) for i in each],
                  [s.visible(i) for i in each], verdict, [s.verdict(i) for i in each], pose, found, s.report,
                  s.hash, s)


# ------------------------------------------------------------------ tracking

@dataclass
class Frame:
    """One frame of track(). positions: a list of [n][3] mm, one for each structure; report: of its last tick; jumped:
    the target lay beyond reach; settled: there was nothing more to do; recovering: coarse radii still run after a jump;
    serial: frames set up to the one that the positions follow; registration: to read anything else from."""
    number: int
    positions: List[Array]
    report: TickReport
    jumped: bool
    settled: bool
    recovering: bool
    serial: int
    registration: Registration = field(repr=False)


def _next_target(frame: Any, before: Any) -> Union[Surface, Points]:
    """A frame's target. Positions alone are new ones of the surface before, or a cloud in place of the one before."""
    if isinstance(frame, Mapping):
        raise TypeError("track() follows one target of the whole model; for several: Registration(model, {...}, track=...)")
    if isinstance(frame, (Surface, Points)) or before is None or isinstance(frame, tuple):
        made = _as_target(frame)
        if isinstance(made, Volume):
            raise TypeError("track() follows surfaces and points")
        return made
    if isinstance(before, Surface):
        before.refit(frame)
    else:
        xyz = _numbers(frame, "frame")
        if len(xyz) > before.capacity or not (np.abs(xyz) <= COORD_MAX).all():  # before it is emptied
            raise SmrError(_E_INPUT, f"a frame of at most {before.capacity} points within {COORD_MAX:g} mm is expected")
        before.clear()
        before.add(xyz)
    return before


def track(model: Model, frames: Iterable[Any], align: Optional[str] = None, start: Any = None, ticks: int = 30,
          budget_ns: int = 0, recover: bool = True, threads: Optional[int] = 1, **settings: Any) -> Iterator[Frame]:
    """Registers a model onto the first frame, follows the others, and yields a Frame for each as it comes.

    frames: the first is a Surface, Points, a (xyz, triangles) or an array [n][3] of points; later ones may be positions
    [n][3] mm alone: of the same triangles, or as a new cloud of at most as many points. Clouds and surfaces that grow
    need the setting n_target_vertices. ticks, budget_ns: of a frame and of a tick; the first frame's schedule is not
    bounded. recover: after a jump coarse radii run again. Others as in register()."""
    settings.setdefault("track", "recover" if recover else "report")
    s: Optional[Registration] = None
    target: Any = None
    for number, frame in enumerate(frames):
        target = _next_target(frame, target)
        if s is None:
            s = Registration(model, target, threads, **settings)
            _start(s, model, {None: target}, align, start)
            for _ in s.run():
                pass
        else:
            s._set_one(None, target)
            for _ in s.run(ticks, budget_ns):
                pass
        report = s.report
        yield Frame(number, [s.positions(i) for i in range(len(model))], report, bool(report.details.jumped),
                    bool(report.details.settled), bool(report.details.recovering), report.details.target_serial, s)


# ------------------------------------------------------------------ carried points

class Carry:
    """A map of space, fixed by where vertices are at rest and now; exact at the vertices.

    rest: a Model, or all structures' rest positions in a row, [n][3] mm. points: [m][3] mm at rest that are bound, for
    apply(). threads: 1 by default."""

    def __init__(self, rest: Union[Model, Any], points: Any = None, threads: Optional[int] = 1) -> None:
        at = rest.rest() if isinstance(rest, Model) else _numbers(rest, "rest")
        bound = np.zeros((0, 3), np.float32) if points is None else _numbers(points, "points")
        self.n_vertices, self.n_points = len(at), len(bound)
        self._pool = _Pool(threads)
        size = _sized(_lib.smr_carry_bytes, len(at), len(bound), self._pool.n)
        self._memory, self._handle = _memory(size), _P()
        _lib.smr_carry_fit(_at(at), len(at), _at(bound) if len(bound) else None, len(bound), C.byref(self._pool.port),
                           _at(self._memory), size, C.byref(self._handle))

    def _now(self, now: Any) -> Array:
        if isinstance(now, Registration):
            now = now.all_positions()
        elif isinstance(now, Result):
            now = np.concatenate(now.positions)
        a = _numbers(now, "now")
        if len(a) != self.n_vertices:
            raise ValueError(f"now: expected {self.n_vertices} vertices, not {len(a)}")
        return a

    def apply(self, now: Any) -> Array:
        """Where the bound points are, [m][3] mm. now: a Registration, a Result, or [n][3] mm in the order of rest."""
        at, xyz = self._now(now), np.empty((self.n_points, 3), np.float32)
        _lib.smr_carry_apply(self._handle, _at(at), _at(xyz))
        return xyz

    def map(self, now: Any, xyz: Any, inverse: bool = False) -> Tuple[Array, Array]:
        """Other points [k][3] mm from rest to now, or back: where they go [k][3] mm, and a record array [k]: miss_mm,
        how far forwards from the place found misses the point (above 0.01 the way back was not found), and volume, of
        the local map; 0 or less: it folds there."""
        at, points = self._now(now), _numbers(xyz, "xyz")
        out, facts = np.empty_like(points), np.zeros(len(points), np.dtype(_Fact))
        if len(points):
            _lib.smr_carry_map(self._handle, _at(at), int(inverse), _at(points), len(points), _at(out), _at(facts))
        return out, facts
