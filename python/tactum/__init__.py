"""Six degree-of-freedom haptic contact of polygonal parts.

Units are SI: m, kg, s, rad, N, N m. A pose X_AB is the 4 x 4 homogeneous matrix of frame B in frame A, its rotation in the
upper left, the origin of B in A in the last column. W is the world, z up; D the device (x towards the operator, y to the
operator's right, z up); H its handle; P the frame of a part's mesh, as its file has it; B a body, at its centre of mass, with
the axes of P. A wrench is six numbers: force [N], then torque [N m]. What cannot be done raises tactum.Error with the
sentence of the program: what was found, what was expected, and where.

C++ does the work without the interpreter's lock: other Python threads run meanwhile. An object is that of one thread at a
time; a Part may be queried by many.

    import numpy as np, tactum
    sim = tactum.open("block-on-plate")
    for i in range(1500):
        X_DH = np.eye(4); X_DH[2, 3] = -1e-5 * i
        wrench, contacts = sim.step(X_DH)
"""
import json as _json

import numpy as _np

from . import _tactum
from ._tactum import (Distance, Error, Joint, Part, Recording, Sample, Session, Simulation, World, clearance, clearances,
                      contact_dtype, devices, scenes, signed_distance)

__all__ = ["Distance", "Error", "Joint", "Part", "Recording", "Sample", "Session", "Simulation", "World", "clearance",
           "clearances", "contact_dtype", "devices", "open", "open_session", "pose", "scenes", "signed_distance"]
__version__ = ".".join(map(str, _tactum.version))


def _toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _json.dumps(value)
    return repr(float(value)) if isinstance(value, float) else str(value)


def _settings_text(settings):
    """A table [settings]: the text as it is, or keys as docs/settings.md has them, {"coupling.damping_ratio": 0.7}."""
    if isinstance(settings, str):
        return settings
    lines = [f"{key} = {_toml_value(value)}" for key, value in (settings or {}).items()]
    return "[settings]\n" + "\n".join(lines) + "\n" if lines else ""


def open(scene, *, device="", other_devices=(), grip="", response="", settings=None, rate_Hz=0.0):
    """A scene to be stepped: a Simulation.

    scene: a name of scenes(), or the path of a scene file. device: whose limits hold, by a name of devices(); "": the
    scene's. other_devices: the same of the second hand and all after it. grip: of the simulated hands. response: "constraint" or "penalty"; "": the scene's. settings: a dict of settings
    by key ({"coupling.damping_ratio": 0.7}), or the text of a table [settings]. rate_Hz: frames a second; 0: the scene's.
    """
    return Simulation._open(scene, device, list(other_devices), grip, response, _settings_text(settings), rate_Hz)


def open_session(scene, *, device="", other_devices=(), grip="", settings=None, rate_Hz=0.0, record="", trace=False):
    """A scene on a device, run in C++ throughout: a Session.

    device, other_devices, grip, settings, rate_Hz: as of open().
    record: a file ending in .mcap that takes the run, which `tactum replay` and Recording read. trace: keep every frame's
    numbers, for Session.trace().
    """
    return Session._open(scene, device, list(other_devices), grip, _settings_text(settings), rate_Hz, record, trace)


def pose(p=(0.0, 0.0, 0.0), rotation=None):
    """The 4 x 4 matrix of a place [m] and a rotation: a 3 x 3 matrix, or a rotation vector [rad]; None: no rotation."""
    X = _np.eye(4)
    X[:3, 3] = p
    if rotation is None:
        return X
    rotation = _np.asarray(rotation, dtype=float)
    if rotation.shape == (3, 3):
        X[:3, :3] = rotation
        return X
    angle = _np.linalg.norm(rotation)
    x, y, z = rotation / angle if angle > 0.0 else rotation
    K = _np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    X[:3, :3] += _np.sin(angle) * K + (1.0 - _np.cos(angle)) * K @ K
    return X


def _part_report(part):
    """The report of its preparation: unit, repairs, mesh, pieces, verification."""
    return _json.loads(part._report)


def _session_trace(session):
    """Column names and the table of all frames so far, of a session that was opened with trace=True: (names, (n, columns)).

    Units end the names; axes are those of W, but device_* has those of D (docs/trace.md).
    """
    return session._trace


def _column(names, table, name):
    if name not in names:
        raise Error(f"there is no such column: found {name}, expected one of {len(names)}, such as {names[0]}")
    return table[:, names.index(name)]


def _recording_column(recording, name):
    """One column of the table, by its name: (frames,)."""
    return _column(recording.columns, recording.table, name)


Part.report = property(_part_report)
Session.trace = _session_trace
Recording.column = _recording_column


def __getattr__(name):
    if name == "plots":  # matplotlib is imported when it is asked for
        import importlib
        return importlib.import_module(".plots", __name__)
    raise AttributeError(f"module 'tactum' has no attribute {name!r}")
