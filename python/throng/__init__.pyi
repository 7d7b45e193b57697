from os import PathLike
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

# The classes of LCM messages: a class and a module of each name, of which the class is meant.
from ._messages import *

# The classes of scene keys.
from ._scene_keys import *

RunSource = Union[str, PathLike[str], Scene]

Path = Union[str, PathLike[str]]
Progress = Union[None, bool, Callable[[int, int], object]]

__version__: str
__commit__: str

class Error(Exception): ...

class InputError(Error, ValueError):
    where: str
    file: Optional[str]
    line: Optional[int]
    def __init__(self, message: str, where: str = "") -> None: ...

class EnvironmentFault(Error, OSError):
    def __init__(self, message: str, where: str = "") -> None: ...

class Table(np.ndarray[Any, np.dtype[Any]]):
    def to_pandas(self) -> Any: ...

class _Names:
    groups: List[str]
    models: List[str]
    parts: List[List[str]]
    obstacles: List[str]
    def bodies(self, bodies: npt.ArrayLike) -> npt.NDArray[np.object_]: ...
    def part(self, bodies: npt.ArrayLike, parts: npt.ArrayLike) -> npt.NDArray[np.object_]: ...

class Run:
    scene: str
    seed: int
    run_id: str
    step_s: float
    hash: Optional[str]
    summary: Dict[str, Any]
    separation: Optional[Dict[str, Any]]
    notes: List[str]
    log: Optional[str]
    names: _Names
    people: Table
    events: Table
    trajectories: Table
    counters: Table
    proximity: Table
    closest_parts: Table
    contact_points: Table
    @property
    def contacts(self) -> Table: ...
    def view(self) -> Page: ...

def run(
    source: RunSource,
    *,
    seconds: Optional[float] = None,
    avatars: Optional[int] = None,
    seed: Optional[int] = None,
    steering: Optional[str] = None,
    part_volume: Union[None, str, Mapping[str, str]] = None,
    exact: bool = False,
    proximity: Optional[float] = None,
    closest_parts: Optional[float] = None,
    contact_points: bool = False,
    filter_groups: Optional[str] = None,
    filter_parts: Optional[str] = None,
    threads: Optional[int] = None,
    budget_ms: Optional[float] = None,
    budget_tests: Optional[int] = None,
    strategy: Optional[str] = None,
    simd: Optional[str] = None,
    pair_search: Optional[str] = None,
    fps: Optional[float] = None,
    unit: Optional[str] = None,
    heading_unit: Optional[str] = None,
    columns: Optional[str] = None,
    separator: Optional[str] = None,
    tracked_point: Optional[str] = None,
    strict: bool = False,
    sampling: Optional[str] = None,
    trajectories: bool = True,
    trajectory_fps: Optional[float] = None,
    log: Optional[Path] = None,
    states_hz: Optional[float] = None,
    publish_part_poses: bool = False,
    html: Optional[Path] = None,
    trajectory: Union[None, Path, Sequence[Path]] = None,
    trajectory_area: Union[None, int, str] = None,
    contacts: Optional[Path] = None,
    separation: Optional[Path] = None,
    trace_hash: Optional[Path] = None,
    view: bool = False,
    progress: Progress = None,
) -> Run: ...
def scenes() -> Dict[str, str]: ...

class Frame:
    @property
    def number(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def hash(self) -> str: ...
    @property
    def positions_m(self) -> npt.NDArray[np.float64]: ...
    @property
    def rotations_xyzw(self) -> npt.NDArray[np.float32]: ...
    @property
    def headings_rad(self) -> npt.NDArray[np.float32]: ...
    @property
    def speeds_mps(self) -> npt.NDArray[np.float32]: ...
    @property
    def present(self) -> npt.NDArray[np.bool_]: ...
    @property
    def joint_positions(self) -> npt.NDArray[np.float32]: ...
    @property
    def pairs(self) -> Table: ...
    @property
    def events(self) -> Table: ...
    @property
    def proximity(self) -> Table: ...
    @property
    def closest_parts(self) -> Table: ...
    @property
    def contact_points(self) -> Table: ...
    def part_poses(self, people: Iterable[int]) -> npt.NDArray[np.float64]: ...
    def distance(self, a: int, part_a: Union[None, int, str], b: int, part_b: Union[None, int, str]) -> Distance: ...

class Distance(NamedTuple):
    lo_m: float
    hi_m: float
    point_a_m: npt.NDArray[np.float64]
    point_b_m: npt.NDArray[np.float64]
    normal: npt.NDArray[np.float32]
    part_a: int
    part_b: int
    part_a_name: str
    part_b_name: str
    depth_m: float

class Simulation:
    names: _Names
    people: Table
    scene: str
    seed: int
    run_id: str
    step_s: float
    def __init__(
        self,
        source: RunSource,
        *,
        seconds: Optional[float] = None,
        avatars: Optional[int] = None,
        seed: Optional[int] = None,
        steering: Optional[str] = None,
        part_volume: Union[None, str, Mapping[str, str]] = None,
        exact: bool = False,
        proximity: Optional[float] = None,
        closest_parts: Optional[float] = None,
        contact_points: bool = False,
        filter_groups: Optional[str] = None,
        filter_parts: Optional[str] = None,
        threads: Optional[int] = None,
        budget_ms: Optional[float] = None,
        budget_tests: Optional[int] = None,
        strategy: Optional[str] = None,
        simd: Optional[str] = None,
        pair_search: Optional[str] = None,
        fps: Optional[float] = None,
        unit: Optional[str] = None,
        heading_unit: Optional[str] = None,
        columns: Optional[str] = None,
        separator: Optional[str] = None,
        tracked_point: Optional[str] = None,
        strict: bool = False,
        sampling: Optional[str] = None,
        trajectory_fps: Optional[float] = None,
        log: Optional[Path] = None,
        states_hz: Optional[float] = None,
        publish_part_poses: bool = False,
        html: Optional[Path] = None,
        trajectory: Union[None, Path, Sequence[Path]] = None,
        trajectory_area: Union[None, int, str] = None,
        contacts: Optional[Path] = None,
        separation: Optional[Path] = None,
        trace_hash: Optional[Path] = None,
        culling: Optional[bool] = None,
        joint_positions: Optional[bool] = None,
    ) -> None: ...
    def step(self) -> Frame: ...
    def finish(self) -> Table: ...
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...
    def save(self) -> bytes: ...
    def resume(self, state: Union[bytes, bytearray, memoryview]) -> Simulation: ...
    def set_pose(
        self,
        ids: npt.ArrayLike,
        positions_m: npt.ArrayLike,
        rotations_xyzw: Optional[npt.ArrayLike] = None,
        joint_positions: Optional[npt.ArrayLike] = None,
        velocities_mps: Optional[npt.ArrayLike] = None,
        gait: bool = True,
    ) -> int: ...
    def add(
        self,
        group: str,
        positions_m: npt.ArrayLike,
        headings_rad: Optional[npt.ArrayLike] = None,
        speeds_mps: npt.ArrayLike = 0.0,
    ) -> Any: ...
    def remove(self, ids: npt.ArrayLike) -> None: ...
    def set_goal(self, ids: npt.ArrayLike, goal: Any) -> None: ...
    def set_desired_speed(self, ids: npt.ArrayLike, mps: npt.ArrayLike) -> None: ...
    @property
    def frames(self) -> int: ...
    @property
    def stranded(self) -> int: ...
    @property
    def next_frame(self) -> int: ...
    @property
    def notes(self) -> List[str]: ...
    @property
    def step_ms(self) -> float: ...
    @property
    def hash(self) -> str: ...
    @property
    def joint_offsets(self) -> npt.NDArray[np.int64]: ...

class Model:
    def __init__(self, urdf: Path) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def height_m(self) -> float: ...
    @property
    def reach_m(self) -> float: ...
    @property
    def is_person(self) -> bool: ...
    @property
    def joint_names(self) -> List[str]: ...
    @property
    def joint_lower(self) -> npt.NDArray[np.float64]: ...
    @property
    def joint_upper(self) -> npt.NDArray[np.float64]: ...
    @property
    def part_names(self) -> List[str]: ...
    @property
    def notes(self) -> List[str]: ...
    @property
    def joint_count(self) -> int: ...
    @property
    def part_count(self) -> int: ...
    def poses(
        self,
        joint_positions: npt.ArrayLike,
        positions_m: Optional[npt.ArrayLike] = None,
        rotations_xyzw: Optional[npt.ArrayLike] = None,
        scales: Optional[npt.ArrayLike] = None,
    ) -> npt.NDArray[np.float64]: ...
    def vertices_m(self, part: int) -> npt.NDArray[np.float32]: ...
    def triangles(self, part: int) -> npt.NDArray[np.int32]: ...

class Body:
    def __init__(
        self,
        parts: Iterable[Union[Path, npt.ArrayLike, Tuple[npt.ArrayLike, npt.ArrayLike]]],
        names: Optional[Iterable[str]] = None,
        static: bool = False,
    ) -> None: ...
    @property
    def part_names(self) -> List[str]: ...
    @property
    def part_count(self) -> int: ...

class Culler:
    step_s: float
    def __init__(
        self,
        bodies: Union[Model, Body, Sequence[Union[Model, Body]]],
        exact: bool = False,
        part_volume: str = "ordop26",
        pair_search: str = "grid",
        threads: Optional[int] = None,
        step_s: float = 1.0,
        proximity: float = 0.0,
        closest_parts: float = 0.0,
        contact_points: bool = False,
    ) -> None: ...
    @property
    def proximity(self) -> Table: ...
    @property
    def closest_parts(self) -> Table: ...
    @property
    def contact_points(self) -> Table: ...
    def step(
        self,
        poses: Union[npt.ArrayLike, Sequence[npt.ArrayLike]],
        types: Optional[npt.ArrayLike] = None,
        ids: Optional[npt.ArrayLike] = None,
        scales: Optional[npt.ArrayLike] = None,
    ) -> Table: ...
    def finish(self) -> Table: ...
    def distance(self, a: int, part_a: Union[None, int, str], b: int, part_b: Union[None, int, str]) -> Distance: ...
    @property
    def pairs(self) -> Table: ...
    @property
    def events(self) -> Table: ...
    @property
    def contacts(self) -> Table: ...
    @property
    def frame(self) -> int: ...
    @property
    def hash(self) -> str: ...

def read_log(
    file: Path, trajectory_fps: Optional[float] = None, trajectories: bool = True, progress: Progress = None
) -> Run: ...

class LogReport(Dict[str, Any]): ...

def check(file: Path) -> LogReport: ...
def render(
    log: Path,
    frame: int,
    width: int = 1280,
    height: int = 720,
    eye_m: Optional[Sequence[float]] = None,
    target_m: Optional[Sequence[float]] = None,
) -> npt.NDArray[np.uint8]: ...

class Page:
    html: str
    height: int
    def __init__(self, text: str, height: int = 540) -> None: ...
    def save(self, file: Path) -> None: ...

def view(log: Union[Path, Run], limit_mb: float = 25, height: int = 540) -> Page: ...

class Recording:
    def __init__(
        self,
        file: Path,
        *,
        fps: Optional[float] = None,
        unit: Optional[str] = None,
        heading_unit: Optional[str] = None,
        columns: Optional[str] = None,
        separator: Optional[str] = None,
        tracked_point: Optional[str] = None,
        strict: bool = False,
    ) -> None: ...
    @property
    def people(self) -> Table: ...
    @property
    def samples(self) -> Table: ...
    @property
    def facts(self) -> Dict[str, Any]: ...
    @property
    def summary(self) -> Dict[str, Any]: ...
    def run(
        self,
        *,
        seconds: Optional[float] = None,
        avatars: Optional[int] = None,
        seed: Optional[int] = None,
        steering: Optional[str] = None,
        part_volume: Union[None, str, Mapping[str, str]] = None,
        exact: bool = False,
        proximity: Optional[float] = None,
        closest_parts: Optional[float] = None,
        contact_points: bool = False,
        filter_groups: Optional[str] = None,
        filter_parts: Optional[str] = None,
        threads: Optional[int] = None,
        budget_ms: Optional[float] = None,
        budget_tests: Optional[int] = None,
        strategy: Optional[str] = None,
        simd: Optional[str] = None,
        pair_search: Optional[str] = None,
        fps: Optional[float] = None,
        unit: Optional[str] = None,
        heading_unit: Optional[str] = None,
        columns: Optional[str] = None,
        separator: Optional[str] = None,
        tracked_point: Optional[str] = None,
        strict: bool = False,
        sampling: Optional[str] = None,
        trajectories: bool = True,
        trajectory_fps: Optional[float] = None,
        log: Optional[Path] = None,
        states_hz: Optional[float] = None,
        publish_part_poses: bool = False,
        html: Optional[Path] = None,
        trajectory: Union[None, Path, Sequence[Path]] = None,
        trajectory_area: Union[None, int, str] = None,
        contacts: Optional[Path] = None,
        separation: Optional[Path] = None,
        trace_hash: Optional[Path] = None,
        view: bool = False,
        progress: Progress = None,
    ) -> Run: ...

class Study(Table):
    @property
    def times(self) -> Table: ...
    @property
    def notes(self) -> List[str]: ...
    def save(self, file: Path) -> None: ...

def study(
    scenes: Union[RunSource, Sequence[RunSource]],
    *,
    seeds: Union[None, int, Iterable[int], Mapping[str, int]] = None,
    parameters: Optional[Mapping[str, Any]] = None,
    avatars: Optional[int] = None,
    seconds: Optional[float] = None,
    steering: Optional[str] = None,
    part_volume: Union[None, str, Mapping[str, str]] = None,
    exact: Optional[bool] = None,
    budget_tests: Optional[int] = None,
    strategy: Optional[str] = None,
    simd: Optional[str] = None,
    pair_search: Optional[str] = None,
    threads: Optional[int] = None,
    out: Optional[Path] = None,
    progress: Progress = None,
) -> Study: ...

@overload
def export(
    log: Path,
    channel: str,
    *,
    out: None = None,
    mcap: None = None,
    poses_hz: None = None,
    progress: Progress = None,
) -> Table: ...
@overload
def export(
    log: Path,
    channel: str,
    *,
    out: Path,
    mcap: None = None,
    poses_hz: None = None,
    progress: Progress = None,
) -> None: ...
@overload
def export(
    log: Path,
    channel: None = None,
    *,
    out: None = None,
    mcap: Path,
    poses_hz: Optional[float] = None,
    progress: Progress = None,
) -> None: ...

class Comparison:
    a: Dict[str, Any]
    b: Dict[str, Any]
    tables: Dict[str, Table]
    def figures(self, folder: Optional[Path] = None) -> Dict[str, Tuple[str, str]]: ...

def compare(
    a: Union[RunSource, Run],
    b: Union[RunSource, Run],
    seconds: Optional[float] = None,
    line: Optional[Sequence[float]] = None,
    threads: Optional[int] = None,
    progress: Progress = None,
) -> Comparison: ...
