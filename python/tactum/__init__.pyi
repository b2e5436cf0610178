"""Types of tactum. Shapes: a pose is (4, 4), a wrench or twist (6,), a vector (3,); numbers are float64, SI units."""
from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import plots as plots

Floats = NDArray[np.float64]
__version__: str
contact_dtype: np.dtype[Any]


class Error(ValueError):
    """What was found, what was expected, and where."""


class Distance:
    """Where two parts stand to each other, in world axes; the normal points from B to A."""
    @property
    def distance_m(self) -> float: ...
    @property
    def p_a_W(self) -> Floats:
        """Closest point on A [m]."""
    @property
    def p_b_W(self) -> Floats:
        """Closest point on B [m]."""
    @property
    def n_BA_W(self) -> Floats:
        """Unit; zero where a clearance is zero, which leaves it open."""
    @property
    def touching_pairs(self) -> int:
        """Of triangles with a common point; only of a clearance."""
    @property
    def inside(self) -> bool:
        """One lies wholly in a solid of the other; only of a clearance."""
    @property
    def certified(self) -> bool:
        """The distance is proved to 1e-9 of the size."""


class Part:
    """A part, loaded or prepared once. Poses in queries are those of the frame P of its mesh."""
    @staticmethod
    def load(path: str, *, name: str = "", unit: str = "auto", scale: float = 0.0, pieces: str = "auto",
             close_holes: int = 0, density_kg_per_m3: float = 1000.0, threads: int = 1) -> Part:
        """A prepared part, or a mesh file, which is then repaired, cut into pieces and verified, as by `tactum prepare`.

        unit: of the mesh's numbers: auto, m, cm, mm, inch. scale: metres per unit instead; 0: as unit says. close_holes:
        holes of at most so many edges are closed. Raises Error where the mesh cannot be used.
        """
    @staticmethod
    def from_mesh(vertices: ArrayLike, triangles: ArrayLike, *, name: str = "", unit: str = "auto", scale: float = 0.0,
                  pieces: str = "auto", close_holes: int = 0, density_kg_per_m3: float = 1000.0,
                  threads: int = 1) -> Part:
        """The same of vertices (n, 3), in metres unless unit says otherwise, and triangles (m, 3), counter-clockwise seen
        from outside; both are copied."""
    def save(self, path: str) -> None:
        """Writes a part file, which load() and scenes read; whole or not at all."""
    @property
    def name(self) -> str: ...
    @property
    def report(self) -> dict[str, Any]:
        """Of its preparation: unit, repairs, mesh, pieces, verification."""
    @property
    def made_as(self) -> str:
        """How the pieces were made, and why."""
    @property
    def remarks(self) -> list[str]: ...
    @property
    def pieces(self) -> int:
        """Convex solid pieces; 0: it is felt by its surface."""
    @property
    def is_surface(self) -> bool: ...
    @property
    def size_m(self) -> float:
        """Diagonal of the bounding box [m]."""
    @property
    def volume_m3(self) -> float: ...
    @property
    def mass_kg(self) -> float: ...
    @property
    def density_kg_per_m3(self) -> float: ...
    @property
    def center_P(self) -> Floats:
        """Centre of mass [m]."""
    @property
    def inertia_B(self) -> Floats:
        """(3, 3), about the centre of mass [kg m^2]."""
    @property
    def vertices(self) -> Floats:
        """(n, 3), in P [m]; a view that cannot be written to."""
    @property
    def triangles(self) -> NDArray[np.int32]:
        """(m, 3); a view that cannot be written to."""


def clearance(a: Part, b: Part, X_WA: ArrayLike, X_WB: ArrayLike) -> Distance:
    """Exact clearance of two surfaces of any shape; zero where they touch, cross, or one lies in a solid of the other."""
def clearances(a: Part, b: Part, X_AB: ArrayLike) -> Floats:
    """The same for B at each of the poses (n, 4, 4) in A: (n,) [m]. Fast along a motion; no Python between the poses."""
def signed_distance(a: Part, b: Part, X_WA: ArrayLike, X_WB: ArrayLike) -> Distance:
    """Of two parts of solid pieces: the smallest over all pairs of pieces, negative by the depth of the deepest pair where
    they overlap [Gregory 2000, 4.1]. Raises Error where a part is felt by its surface."""


class Joint:
    def __init__(self, kind: str, *, axis_W: ArrayLike = (0, 0, 1), anchor_W: ArrayLike = (0, 0, 0), damping: float = 0.0,
                 friction: float = 0.0, stiffness: float = 0.0, rest: float = 0.0, lower: float = ...,
                 upper: float = ...) -> None:
        """kind: free, fixed, hinge, slider or ball. Axis and anchor [m] in the world as the bodies stand at the start;
        damping, friction, stiffness and positions in N m and rad for a hinge or ball, N and m for a slider."""


class World:
    """Bodies, put together in code; simulate() makes the Simulation."""
    def __init__(self, gravity_W: ArrayLike = (0, 0, 0)) -> None:
        """gravity_W: [m/s^2]."""
    def add(self, name: str, part: Part, X_WP: ArrayLike = ..., *, joint: Joint = ..., material: str = "",
            mass_kg: float | None = None, density_kg_per_m3: float | None = None, V_WB: ArrayLike = ...) -> int:
        """Adds a body with its part's mesh at X_WP and returns its number. Mass and inertia follow from the part's density
        unless one is given. V_WB: twist of the centre of mass at the start [m/s, rad/s]."""
    def join(self, body: str, parent: str, joint: Joint, contact: bool = False) -> None:
        """Joins a free body to another one; without contact the two never touch."""
    def friction(self, material_a: str, material_b: str, coefficient: float) -> None:
        """Coulomb's coefficient of bodies of two materials; 0 where none is given."""
    def restitution(self, material_a: str, material_b: str, coefficient: float) -> None: ...
    def simulate(self, tool: str | list[str] = "", *, device: str | list[str] = "premium-1.5-6dof",
                 rate_Hz: float = 1000.0, p_BH: ArrayLike | list[ArrayLike | None] | None = None) -> Simulation:
        """The world with the body `tool` in the hand, at p_BH in its frame [m]; the limits are the device's. With a list of
        tools there is a hand for each, and a list of devices and places may be given beside it."""


class Sample:
    def __init__(self, X_DH: ArrayLike, buttons: int = 0) -> None: ...
    @property
    def X_DH(self) -> Floats: ...
    @property
    def V_DH(self) -> Floats: ...
    @property
    def buttons(self) -> int: ...
    @property
    def valid(self) -> bool: ...


class Simulation:
    """A scene or a world, stepped by its caller: the frames of `tactum feel`, to the bit. The first pose is where the hand
    takes hold of the tool, which stays where it is; only the way from there moves it. Where the scene has several hands,
    poses and wrenches have an axis for them, in the order of the scene's tools."""
    @property
    def hands(self) -> int: ...
    @overload
    def step(self, X_DH: ArrayLike | Sample) -> tuple[Floats, NDArray[Any]]: ...
    @overload
    def step(self, X_DH: Sequence[ArrayLike | Sample]) -> tuple[Floats, NDArray[Any]]:
        """One frame, dt_s after the last, with a pose (4, 4) or Sample of the hand, or with one for each hand: a list, or an
        array (hands, 4, 4). Returns the wrench on the hand, at the handle, axes of D (6,) [N, N m], or (hands, 6), and the
        contacts, a structured array of contact_dtype: body_a, body_b, piece_a, piece_b, kind_a, feature_a, kind_b, feature_b
        (kinds: 0 vertex, 1 edge, 2 face), point (3,) [m] and normal (3,) from B to A in W, distance_m at the start of the
        frame, normal_force_N, friction_N of all points on the same surfaces, friction_coefficient, cone_used, grip (0 no
        friction, 1 sticks, 2 slips), patch, residual_m (by how much the frame missed what the contact asks; nan: penalty).
        """
    def run(self, X_DH: ArrayLike) -> Floats:
        """A frame for each pose (n, 4, 4), or (n, hands, 4, 4), without Python in between: the wrenches (n, 6), or
        (n, hands, 6)."""
    def open_hand(self) -> None:
        """Opens the devices of all hands, simulated or real; where one is simulated its hand moves as the scene says."""
    def read_hand(self, hand: int = 0) -> Sample:
        """What the device of a hand, counted from 0, measures now: read every hand before each step."""
    def write_hand(self, F_D: ArrayLike, hand: int = 0) -> bool:
        """Sets the wrench (6,) on a hand; False where its device did not take it."""
    def close_hand(self) -> None: ...
    def follow_hand(self, frames: int) -> tuple[Floats, Floats]:
        """So many frames led by the open hands, in C++: wrenches (n, 6) and poses X_DH (n, 4, 4); of several hands
        (n, hands, 6) and (n, hands, 4, 4)."""
    @property
    def hand_frames(self) -> int:
        """How many frames the motion of the scene's first hand lasts."""
    @property
    def contacts(self) -> NDArray[Any]: ...
    @property
    def X_WB(self) -> Floats:
        """Poses of all bodies: (bodies, 4, 4)."""
    @property
    def V_WB(self) -> Floats:
        """Twists of all bodies: (bodies, 6) [m/s, rad/s]."""
    @property
    def report(self) -> dict[str, Any]:
        """Of the last frame: index, time_s, flags, safety, grasped_body, penetrating, min_distance_m, X_WH, X_WH_proxy,
        F_W_contacts (on the grasped part, at its centre of mass), F_W_felt (before limits and safety), solver_iterations,
        exact_tests. What belongs to a hand is that of the first."""
    @property
    def hand_reports(self) -> list[dict[str, Any]]:
        """What the report has of each hand: safety, grasped_body, X_WH, X_WH_proxy, F_W_contacts, F_W_felt."""
    @property
    def bodies(self) -> list[str]: ...
    def body_mesh(self, body: int) -> tuple[Floats, NDArray[np.int32]]:
        """Vertices (n, 3) in B [m] and triangles (m, 3)."""
    @property
    def name(self) -> str: ...
    @property
    def device(self) -> str:
        """Of the first hand."""
    @property
    def devices(self) -> list[str]:
        """By hand."""
    @property
    def frames(self) -> int: ...
    @property
    def dt_s(self) -> float: ...
    @property
    def hash(self) -> int:
        """Of all frames so far: the same run has the same, on every machine."""


class Session:
    """One run of a scene on a device, in C++ from the first frame to the last; made by open_session()."""
    def run(self, frames: int = 0) -> int:
        """Runs on the virtual clock, as fast as it goes; 0: as long as the hand's motion. Returns the frames."""
    def start(self, frames: int = 0) -> None:
        """Starts the loop in real time on a thread of its own; 0: until stop()."""
    def stop(self) -> None:
        """Leads the wrench to zero, closes the device and ends the recording."""
    def status(self) -> dict[str, Any]: ...
    def trace(self) -> tuple[list[str], Floats]:
        """Column names and the table (frames, columns), with trace=True; units end the names (docs/trace.md)."""
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def goals(self) -> list[tuple[str, bool]]: ...
    @property
    def remarks(self) -> list[str]: ...
    @property
    def device(self) -> str: ...
    @property
    def rate_Hz(self) -> float: ...


class Recording:
    """A recorded run, read once: of `tactum feel --record` or open_session(record=...)."""
    def __init__(self, path: str) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def scene(self) -> str: ...
    @property
    def device(self) -> str: ...
    @property
    def version(self) -> str: ...
    @property
    def date(self) -> str: ...
    @property
    def dt_s(self) -> float: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def columns(self) -> list[str]: ...
    @property
    def table(self) -> Floats:
        """(frames, columns): a view that cannot be written to."""
    def column(self, name: str) -> Floats: ...
    @property
    def complete(self) -> bool: ...
    @property
    def wrong(self) -> str:
        """Why it is not complete."""
    def replay(self, *, response: str = "", settings_file: str = "", from_s: float = 0.0) -> dict[str, Any]:
        """Computes its frames again: first, frames, same (to the bit, from the first on), difference, largest force and
        torque."""
    def export_csv(self, path: str) -> int:
        """Writes a CSV table and returns its rows."""
    def export_hdf5(self, path: str) -> int:
        """Writes the HDF5 file of `tactum export --hdf5`, byte for byte, and returns its frames. Raises Error where the
        module was built without HDF5."""


def open(scene: str, *, device: str = "", other_devices: Sequence[str] = (), grip: str = "", response: str = "",
         settings: dict[str, Any] | str | None = None, rate_Hz: float = 0.0) -> Simulation: ...
def open_session(scene: str, *, device: str = "", other_devices: Sequence[str] = (), grip: str = "",
                 settings: dict[str, Any] | str | None = None, rate_Hz: float = 0.0, record: str = "", trace: bool = False) -> Session: ...
def pose(p: ArrayLike = (0, 0, 0), rotation: ArrayLike | None = None) -> Floats: ...
def scenes() -> list[tuple[str, str]]:
    """Names and descriptions of the scenes that come with the program."""
def devices() -> list[tuple[str, str]]:
    """Names and descriptions of the devices that can be asked for."""
