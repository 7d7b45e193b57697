"""Classes of the maps in scene files. Written by scripts/docs.sh --update."""

# fmt: off
from typing import Any, Literal, Mapping, Optional, Sequence, Union

import numpy.typing as npt

from ._scene import SceneMap, SceneText

# A shapely geometry, or an array of N corners, N x 2.
Shape = Any

class Scene(SceneText):
    """A scene: a ground, agents that walk to goals, and obstacles.

    Args:
        name: name in results; this and all names below: 1 to 120 bytes of printable UTF-8 [the file's name].
        description: description in the list of throng scenes, one line [none].
        seed: seed of all random numbers [1].
        step_s: time between frames in seconds, at most 0.1 [1/60].
        duration_s: duration of a run in seconds; --seconds overrides it [10].
        kind: crowd; box: loose parts, box replaces ground, groups and obstacles; recorded: recording replaces
            groups, and the ground follows from it unless it is given [crowd].
        culling: contact detection: part_volume and exact [see its keys].
        planted_feet: feet stay in place on curves and while turning; false: they glide, which saves about 80
            ns per person and frame (docs/motion.md) [true].
        steering: steering: model and density_dependent_speed [see its keys].
        ground: where agents can walk: a rectangle {min_m: [x, y], max_m: [x, y]}, at least 0.1 m wide, or
            polygons, see docs/scenes.md [required of a crowd].
        groups: groups of agents [required of a crowd].
        box: loose parts of kind: box [required of a box].
        obstacles: solid bodies that agents avoid [none].
        recording: recorded people of kind: recorded [required of a recorded scene].
        group_filter: pairs of groups whose contacts and distances are found, such as robots: people, people:
            doors; a single name pairs with all; people, robots, obstacles and all name bodies of a kind,
            group:people the group of that name; see docs/contacts.md [all].
        part_filter: pairs of parts whose contacts and distances are found, by words of their names, such as
            hands: head; single words pair with all parts [all].
        proximity_m: margin in metres: pairs of parts within it are reported with bounds of their distance,
            see docs/contacts.md; at most 100, 0: off [0].
        closest_parts_m: margin in metres: the closest parts of each two avatars within it are reported; at
            most 100, 0: off [0].
        contact_points: report contact point, normal and penetration depth of every touching pair of parts;
            requires culling: {exact: true}, see docs/contacts.md [false].
        body_avoidance: bodies adapt their posture to neighbours and walls; standing people breathe, sway and
            hold their arms in several ways; requires planted_feet (docs/motion.md) [true].
        doors: doors that open and close [none].
        separation: required separation of robots from people, see docs/contacts.md [none].
        change_channel: LCM channel with messages that add, remove and redirect agents, see docs/control.md
            [none].
    """

    _keys = {"name": "", "description": "", "seed": "", "step_s": "", "duration_s": "", "kind": "", "culling": "culling", "planted_feet": "", "steering": "steering", "ground": "ground", "groups": "group", "box": "box", "obstacles": "obstacle", "recording": "recording", "group_filter": "", "part_filter": "", "proximity_m": "", "closest_parts_m": "", "contact_points": "", "body_avoidance": "", "doors": "door", "separation": "separation", "change_channel": ""}
    name: Optional[str]
    description: Optional[str]
    seed: Optional[int]
    step_s: Optional[float]
    duration_s: Optional[float]
    kind: Optional[Literal["crowd", "box", "recorded"]]
    culling: Optional[Union["Culling", Mapping[str, Any]]]
    planted_feet: Optional[bool]
    steering: Optional[Union["Steering", Mapping[str, Any]]]
    ground: Optional[Union["Ground", Shape, Mapping[str, Any]]]
    groups: Optional[Sequence[Union["Group", Mapping[str, Any]]]]
    box: Optional[Union["PartsBox", Mapping[str, Any]]]
    obstacles: Optional[Sequence[Union["Obstacle", Mapping[str, Any]]]]
    recording: Optional[Union["RecordedPeople", Mapping[str, Any]]]
    group_filter: Optional[str]
    part_filter: Optional[str]
    proximity_m: Optional[float]
    closest_parts_m: Optional[float]
    contact_points: Optional[bool]
    body_avoidance: Optional[bool]
    doors: Optional[Sequence[Union["Door", Mapping[str, Any]]]]
    separation: Optional[Union["Separation", Mapping[str, Any]]]
    change_channel: Optional[str]

    def __init__(
        self,
        *,
        name: Optional[str] = None,
        description: Optional[str] = None,
        seed: Optional[int] = None,
        step_s: Optional[float] = None,
        duration_s: Optional[float] = None,
        kind: Optional[Literal["crowd", "box", "recorded"]] = None,
        culling: Optional[Union["Culling", Mapping[str, Any]]] = None,
        planted_feet: Optional[bool] = None,
        steering: Optional[Union["Steering", Mapping[str, Any]]] = None,
        ground: Optional[Union["Ground", Shape, Mapping[str, Any]]] = None,
        groups: Optional[Sequence[Union["Group", Mapping[str, Any]]]] = None,
        box: Optional[Union["PartsBox", Mapping[str, Any]]] = None,
        obstacles: Optional[Sequence[Union["Obstacle", Mapping[str, Any]]]] = None,
        recording: Optional[Union["RecordedPeople", Mapping[str, Any]]] = None,
        group_filter: Optional[str] = None,
        part_filter: Optional[str] = None,
        proximity_m: Optional[float] = None,
        closest_parts_m: Optional[float] = None,
        contact_points: Optional[bool] = None,
        body_avoidance: Optional[bool] = None,
        doors: Optional[Sequence[Union["Door", Mapping[str, Any]]]] = None,
        separation: Optional[Union["Separation", Mapping[str, Any]]] = None,
        change_channel: Optional[str] = None,
    ) -> None:
        super().__init__(name=name, description=description, seed=seed, step_s=step_s, duration_s=duration_s, kind=kind, culling=culling, planted_feet=planted_feet, steering=steering, ground=ground, groups=groups, box=box, obstacles=obstacles, recording=recording, group_filter=group_filter, part_filter=part_filter, proximity_m=proximity_m, closest_parts_m=closest_parts_m, contact_points=contact_points, body_avoidance=body_avoidance, doors=doors, separation=separation, change_channel=change_channel)


class Culling(SceneMap):
    """Settings of contact detection.

    Args:
        part_volume: bounding volume of body parts: sphere, aabb, obb, kdop14, kdop18, kdop26, ordop14,
            ordop18 or ordop26, or a map by part, see docs/culling.md [ordop26].
        exact: decide contacts by triangle tests [false].
    """

    _keys = {"part_volume": "part_volumes", "exact": ""}
    part_volume: Optional[Union[Literal["sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "ordop14", "ordop18", "ordop26"], Mapping[str, Any]]]
    exact: Optional[bool]

    def __init__(
        self,
        *,
        part_volume: Optional[Union[Literal["sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "ordop14", "ordop18", "ordop26"], Mapping[str, Any]]] = None,
        exact: Optional[bool] = None,
    ) -> None:
        super().__init__(part_volume=part_volume, exact=exact)


class Steering(SceneMap):
    """Settings of the steering model.

    Args:
        model: steering model: orca, collision_free_speed or heuristic, see docs/motion.md [heuristic].
        density_dependent_speed: limit speeds by the density ahead (Weidmann 1993) [false].
    """

    _keys = {"model": "", "density_dependent_speed": ""}
    model: Optional[Literal["orca", "collision_free_speed", "heuristic"]]
    density_dependent_speed: Optional[bool]

    def __init__(
        self,
        *,
        model: Optional[Literal["orca", "collision_free_speed", "heuristic"]] = None,
        density_dependent_speed: Optional[bool] = None,
    ) -> None:
        super().__init__(model=model, density_dependent_speed=density_dependent_speed)


class Group(SceneMap):
    """Agents with one body model.

    Args:
        name: unique in the scene [group 1, group 2, ...].
        count: number of agents at the start [required, unless there are sources, spare agents, a density or
            positions].
        model: adult, or a URDF file relative to the scene file; its meshes may be .tri, .stl, .obj, .dae and
            many others, see docs/reliability.md [adult].
        spawn: rectangle in which agents start [required, if there is a count without positions].
        goals: goals of the route, in order [required, unless externally controlled].
        on_arrival: action after the last goal: loop (start again), stay there, or leave the scene [loop].
        sources: areas where agents enter during the run [none].
        premovement_s: time before an agent sets out, in seconds: {mean, std_dev, min, max}, or one number
            [0].
        desired_speed_mps: desired speed in m/s, 0.1 to 4, regardless of age: {mean, std_dev, min, max}, or
            one number for all agents [by age].
        height_m: body height in metres, as a distribution or a number; scales the model; people 0.5 to 2.5,
            robots 0.01 to 100 [people: by age; robots: height of the model].
        ages: ages, which determine desired speed and height [adults].
        gait_styles: gait styles [by age].
        radius_m: radius of the disc that steering keeps clear of others, in metres [people: 0.22 at 1.70 m,
            proportional to height; robots: circle that encloses them at the start, within 0.05 to 2].
        control_channel: LCM channel of an externally controlled group, see docs/control.md; the group then
            has neither goals nor sources, and the model's own height [none].
        look_at: [x, y] of the point that agents face while they stand: before setting out, while waiting, and
            where they stay [the next goal].
        density_per_m2: people per m2 of free ground in spawn at the start, at most 6; replaces count; placed
            by body outline instead of disc [count].
        after: trigger that lets the group start; premovement_s begins with it [the start, or entering].
        social_groups: agents that walk together, see docs/scenes.md#social-groups [all agents walk alone].
        spare: number of agents that the run can add later, see docs/control.md [0].
        externally_controlled: whether the program that steps the run moves the group, see docs/control.md;
            control_channel implies it [false].
        positions_m: [x, y] of each agent at the start, in place of count and spawn [random places in spawn].
        headings_rad: heading of each agent of positions_m at the start, counter-clockwise from the x axis
            [towards the goal].
        speeds_mps: speed of each agent of positions_m at the start, along its heading [the desired speed, or
            what agents ahead allow].
    """

    _keys = {"name": "", "count": "", "model": "", "spawn": "area", "goals": "goal", "on_arrival": "", "sources": "source", "premovement_s": "distribution", "desired_speed_mps": "distribution", "height_m": "distribution", "ages": "ages", "gait_styles": "gait_styles", "radius_m": "", "control_channel": "", "look_at": "", "density_per_m2": "", "after": "trigger", "social_groups": "social_groups", "spare": "", "externally_controlled": "", "positions_m": "starts", "headings_rad": "", "speeds_mps": ""}
    name: Optional[str]
    count: Optional[int]
    model: Optional[str]
    spawn: Optional[Union["Area", Shape, Mapping[str, Any]]]
    goals: Optional[Sequence[Union["Goal", Shape, Mapping[str, Any]]]]
    on_arrival: Optional[Literal["loop", "stay", "leave"]]
    sources: Optional[Sequence[Union["Source", Mapping[str, Any]]]]
    premovement_s: Optional[Union["Distribution", float, Mapping[str, Any]]]
    desired_speed_mps: Optional[Union["Distribution", float, Mapping[str, Any]]]
    height_m: Optional[Union["Distribution", float, Mapping[str, Any]]]
    ages: Optional[Union["Ages", Literal["adults", "children", "young", "middle_aged", "elderly", "impaired", "mixed"], Mapping[str, Any]]]
    gait_styles: Optional[Union["GaitStyles", Literal["plain", "relaxed", "brisk", "stiff", "pockets", "short_steps"], Mapping[str, Any]]]
    radius_m: Optional[float]
    control_channel: Optional[str]
    look_at: Optional[npt.ArrayLike]
    density_per_m2: Optional[float]
    after: Optional[Union["Trigger", float, Mapping[str, Any]]]
    social_groups: Optional[Union["SocialGroups", float, Mapping[str, Any]]]
    spare: Optional[int]
    externally_controlled: Optional[bool]
    positions_m: Optional[Union["Starts", npt.ArrayLike, Mapping[str, Any]]]
    headings_rad: Optional[npt.ArrayLike]
    speeds_mps: Optional[npt.ArrayLike]

    def __init__(
        self,
        *,
        name: Optional[str] = None,
        count: Optional[int] = None,
        model: Optional[str] = None,
        spawn: Optional[Union["Area", Shape, Mapping[str, Any]]] = None,
        goals: Optional[Sequence[Union["Goal", Shape, Mapping[str, Any]]]] = None,
        on_arrival: Optional[Literal["loop", "stay", "leave"]] = None,
        sources: Optional[Sequence[Union["Source", Mapping[str, Any]]]] = None,
        premovement_s: Optional[Union["Distribution", float, Mapping[str, Any]]] = None,
        desired_speed_mps: Optional[Union["Distribution", float, Mapping[str, Any]]] = None,
        height_m: Optional[Union["Distribution", float, Mapping[str, Any]]] = None,
        ages: Optional[Union["Ages", Literal["adults", "children", "young", "middle_aged", "elderly", "impaired", "mixed"], Mapping[str, Any]]] = None,
        gait_styles: Optional[Union["GaitStyles", Literal["plain", "relaxed", "brisk", "stiff", "pockets", "short_steps"], Mapping[str, Any]]] = None,
        radius_m: Optional[float] = None,
        control_channel: Optional[str] = None,
        look_at: Optional[npt.ArrayLike] = None,
        density_per_m2: Optional[float] = None,
        after: Optional[Union["Trigger", float, Mapping[str, Any]]] = None,
        social_groups: Optional[Union["SocialGroups", float, Mapping[str, Any]]] = None,
        spare: Optional[int] = None,
        externally_controlled: Optional[bool] = None,
        positions_m: Optional[Union["Starts", npt.ArrayLike, Mapping[str, Any]]] = None,
        headings_rad: Optional[npt.ArrayLike] = None,
        speeds_mps: Optional[npt.ArrayLike] = None,
    ) -> None:
        super().__init__(name=name, count=count, model=model, spawn=spawn, goals=goals, on_arrival=on_arrival, sources=sources, premovement_s=premovement_s, desired_speed_mps=desired_speed_mps, height_m=height_m, ages=ages, gait_styles=gait_styles, radius_m=radius_m, control_channel=control_channel, look_at=look_at, density_per_m2=density_per_m2, after=after, social_groups=social_groups, spare=spare, externally_controlled=externally_controlled, positions_m=positions_m, headings_rad=headings_rad, speeds_mps=speeds_mps)


class Ages(SceneMap):
    """One age, mixed (passers-by of a town), or shares of ages.

    Args:
        adults: of any age [0].
        children: 6 to 12 years [0].
        young: under 30 years [0].
        middle_aged: 30 to 50 years [0].
        elderly: over 50 years [0].
        impaired: people who walk with difficulty [0].
    """

    _keys = {"adults": "", "children": "", "young": "", "middle_aged": "", "elderly": "", "impaired": ""}
    adults: Optional[float]
    children: Optional[float]
    young: Optional[float]
    middle_aged: Optional[float]
    elderly: Optional[float]
    impaired: Optional[float]

    def __init__(
        self,
        *,
        adults: Optional[float] = None,
        children: Optional[float] = None,
        young: Optional[float] = None,
        middle_aged: Optional[float] = None,
        elderly: Optional[float] = None,
        impaired: Optional[float] = None,
    ) -> None:
        super().__init__(adults=adults, children=children, young=young, middle_aged=middle_aged, elderly=elderly, impaired=impaired)


class GaitStyles(SceneMap):
    """One gait style, or shares of gait styles.

    Args:
        plain: share of agents with this style [0].
        relaxed: share of agents with this style [0].
        brisk: share of agents with this style [0].
        stiff: share of agents with this style [0].
        pockets: share of agents with this style [0].
        short_steps: share of agents with this style [0].
    """

    _keys = {"plain": "", "relaxed": "", "brisk": "", "stiff": "", "pockets": "", "short_steps": ""}
    plain: Optional[float]
    relaxed: Optional[float]
    brisk: Optional[float]
    stiff: Optional[float]
    pockets: Optional[float]
    short_steps: Optional[float]

    def __init__(
        self,
        *,
        plain: Optional[float] = None,
        relaxed: Optional[float] = None,
        brisk: Optional[float] = None,
        stiff: Optional[float] = None,
        pockets: Optional[float] = None,
        short_steps: Optional[float] = None,
    ) -> None:
        super().__init__(plain=plain, relaxed=relaxed, brisk=brisk, stiff=stiff, pockets=pockets, short_steps=short_steps)


class Goal(SceneMap):
    """An area to reach, or the fastest of several.

    Args:
        min_m: south-west corner of a rectangle [required, or any_of].
        max_m: north-east corner of a rectangle [required, or any_of].
        polygon: corners [x, y] of a polygon, in either direction [required, or any_of].
        holes: holes of the polygon, each a list of corners [none].
        wkt: POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION as well-known text; pieces that touch or overlap are
            joined [required, or any_of].
        any_of: alternative areas; each agent chooses the one with the least expected time [required, or one
            area].
        wait_s: time at the goal before going on, in seconds: {mean, std_dev, min, max}, or one number for all
            agents [0].
        waypoint: true: the goal counts as reached on entering its area; false: each agent walks to its own
            place inside [false].
        capacity: maximum number of agents in each area; the others queue outside [any number; 1 with a
            queue].
        queue: agents are served one after another in the order of their arrival, see
            docs/scenes.md#queue-at-counters [none, unless there is a capacity].
    """

    _keys = {"min_m": "", "max_m": "", "polygon": "", "holes": "", "wkt": "", "any_of": "area", "wait_s": "distribution", "waypoint": "", "capacity": "", "queue": "queue"}
    min_m: Optional[npt.ArrayLike]
    max_m: Optional[npt.ArrayLike]
    polygon: Optional[npt.ArrayLike]
    holes: Optional[npt.ArrayLike]
    wkt: Optional[str]
    any_of: Optional[Sequence[Union["Area", Shape, Mapping[str, Any]]]]
    wait_s: Optional[Union["Distribution", float, Mapping[str, Any]]]
    waypoint: Optional[bool]
    capacity: Optional[int]
    queue: Optional[Union["Queue", Mapping[str, Any]]]

    def __init__(
        self,
        *,
        min_m: Optional[npt.ArrayLike] = None,
        max_m: Optional[npt.ArrayLike] = None,
        polygon: Optional[npt.ArrayLike] = None,
        holes: Optional[npt.ArrayLike] = None,
        wkt: Optional[str] = None,
        any_of: Optional[Sequence[Union["Area", Shape, Mapping[str, Any]]]] = None,
        wait_s: Optional[Union["Distribution", float, Mapping[str, Any]]] = None,
        waypoint: Optional[bool] = None,
        capacity: Optional[int] = None,
        queue: Optional[Union["Queue", Mapping[str, Any]]] = None,
    ) -> None:
        super().__init__(min_m=min_m, max_m=max_m, polygon=polygon, holes=holes, wkt=wkt, any_of=any_of, wait_s=wait_s, waypoint=waypoint, capacity=capacity, queue=queue)


class Queue(SceneMap):
    """Places of agents that wait for their turn.

    Args:
        spacing_m: distance between the centres of neighbours, in metres [0.9].
        line: corners [x, y] of the queue from its first to its last position; if it is full, it continues
            straight on beyond the end [straight back from the nearest wall].
    """

    _keys = {"spacing_m": "", "line": ""}
    spacing_m: Optional[float]
    line: Optional[npt.ArrayLike]

    def __init__(
        self,
        *,
        spacing_m: Optional[float] = None,
        line: Optional[npt.ArrayLike] = None,
    ) -> None:
        super().__init__(spacing_m=spacing_m, line=line)


class Source(SceneMap):
    """Area where agents enter during the run.

    Args:
        area: area in which agents appear where it is free; required.
        count: total number of agents that enter; their ids are reserved from the start; required.
        rate_per_s: agents per second; required.
        start_s: time of the first arrival, in seconds [0].
        arrivals: arrival process: even intervals, or poisson (random intervals with the same mean) [even].
        enters_mps: speed of entering agents, in m/s [desired speed, limited by agents ahead].
    """

    _keys = {"area": "area", "count": "", "rate_per_s": "", "start_s": "", "arrivals": "", "enters_mps": ""}
    area: Optional[Union["Area", Shape, Mapping[str, Any]]]
    count: Optional[int]
    rate_per_s: Optional[float]
    start_s: Optional[float]
    arrivals: Optional[Literal["even", "poisson"]]
    enters_mps: Optional[float]

    def __init__(
        self,
        *,
        area: Optional[Union["Area", Shape, Mapping[str, Any]]] = None,
        count: Optional[int] = None,
        rate_per_s: Optional[float] = None,
        start_s: Optional[float] = None,
        arrivals: Optional[Literal["even", "poisson"]] = None,
        enters_mps: Optional[float] = None,
    ) -> None:
        super().__init__(area=area, count=count, rate_per_s=rate_per_s, start_s=start_s, arrivals=arrivals, enters_mps=enters_mps)


class Trigger(SceneMap):
    """Number of seconds after the start, or after all agents of a group have reached a goal.

    Args:
        delay_s: delay after that, in seconds [0].
        group: group whose agents have to reach the goal; agents without a path to it do not count [the start
            of the run].
        goal: number of the goal on the group's route, counted from 1 [the last goal].
    """

    _keys = {"delay_s": "", "group": "", "goal": ""}
    delay_s: Optional[float]
    group: Optional[str]
    goal: Optional[int]

    def __init__(
        self,
        *,
        delay_s: Optional[float] = None,
        group: Optional[str] = None,
        goal: Optional[int] = None,
    ) -> None:
        super().__init__(delay_s=delay_s, group=group, goal=goal)


class SocialGroups(SceneMap):
    """Social groups: the share of agents in them, or a map.

    Args:
        share: share of agents that walk in social groups of two to four, 0 to 1 [0.6].
        pairs: relative number of social groups of two [0.75].
        threes: relative number of social groups of three [0.21].
        fours: relative number of social groups of four [0.04].
    """

    _keys = {"share": "", "pairs": "", "threes": "", "fours": ""}
    share: Optional[float]
    pairs: Optional[float]
    threes: Optional[float]
    fours: Optional[float]

    def __init__(
        self,
        *,
        share: Optional[float] = None,
        pairs: Optional[float] = None,
        threes: Optional[float] = None,
        fours: Optional[float] = None,
    ) -> None:
        super().__init__(share=share, pairs=pairs, threes=threes, fours=fours)


class Obstacle(SceneMap):
    """A solid body that does not move.

    Args:
        name: unique in the scene [obstacle 1, ...].
        kind: box, cylinder, mesh, polygon (upright over an outline) or wall (upright along a line); required.
        yaw_deg: rotation about z in degrees, counter-clockwise [0].
        position_m: [x, y] of the centre, of a mesh of its origin [required, except of a polygon or wall].
        bottom_m: height of the lower end above the ground, of a mesh of its lowest vertex; agents pass below
            an obstacle that is at least 0.1 m above the tallest avatar [0].
        size_m: box: edge lengths [x, y, z], from 0.001 [required of a box].
        diameter_m: cylinder: diameter [required of a cylinder].
        height_m: cylinder: length [required of a cylinder].
        file: mesh: a mesh file relative to the scene file: .tri, .stl, .obj, .dae, .ply and many others, see
            reliability [required of a mesh without vertices].
        polygon: polygon: corners [x, y]; a concave outline is divided into convex pieces, each an obstacle:
            NAME 1, ... [required of a polygon].
        holes: polygon: holes, each a list of corners [none].
        line: wall: corners [x, y] of its middle line; a closed wall repeats the first one. Each straight
            piece is an obstacle [required of a wall].
        thickness_m: wall: thickness [0.1].
        top_m: polygon, wall: height of the upper end above the ground [required of a polygon or wall].
        scale: mesh: metres per unit of the file, 0.001 for millimetres [1].
        up: mesh: axis of the file that points up; with y, its x stays x; with x, its -y becomes x [the axis
            that a .dae file states; y for glTF, VRML and X3D; otherwise z].
        vertices: mesh: vertices [x, y, z] in place of a file [file].
        triangles: mesh: three numbers of vertices per triangle, from 0, counter-clockwise seen from outside
            [required with vertices].
    """

    _keys = {"name": "", "kind": "", "yaw_deg": "", "position_m": "", "bottom_m": "", "size_m": "", "diameter_m": "", "height_m": "", "file": "", "polygon": "", "holes": "", "line": "", "thickness_m": "", "top_m": "", "scale": "", "up": "", "vertices": "", "triangles": ""}
    name: Optional[str]
    kind: Optional[Literal["box", "cylinder", "mesh", "polygon", "wall"]]
    yaw_deg: Optional[float]
    position_m: Optional[npt.ArrayLike]
    bottom_m: Optional[float]
    size_m: Optional[npt.ArrayLike]
    diameter_m: Optional[float]
    height_m: Optional[float]
    file: Optional[str]
    polygon: Optional[npt.ArrayLike]
    holes: Optional[npt.ArrayLike]
    line: Optional[npt.ArrayLike]
    thickness_m: Optional[float]
    top_m: Optional[float]
    scale: Optional[float]
    up: Optional[Literal["z", "y", "x"]]
    vertices: Optional[npt.ArrayLike]
    triangles: Optional[npt.ArrayLike]

    def __init__(
        self,
        *,
        name: Optional[str] = None,
        kind: Optional[Literal["box", "cylinder", "mesh", "polygon", "wall"]] = None,
        yaw_deg: Optional[float] = None,
        position_m: Optional[npt.ArrayLike] = None,
        bottom_m: Optional[float] = None,
        size_m: Optional[npt.ArrayLike] = None,
        diameter_m: Optional[float] = None,
        height_m: Optional[float] = None,
        file: Optional[str] = None,
        polygon: Optional[npt.ArrayLike] = None,
        holes: Optional[npt.ArrayLike] = None,
        line: Optional[npt.ArrayLike] = None,
        thickness_m: Optional[float] = None,
        top_m: Optional[float] = None,
        scale: Optional[float] = None,
        up: Optional[Literal["z", "y", "x"]] = None,
        vertices: Optional[npt.ArrayLike] = None,
        triangles: Optional[npt.ArrayLike] = None,
    ) -> None:
        super().__init__(name=name, kind=kind, yaw_deg=yaw_deg, position_m=position_m, bottom_m=bottom_m, size_m=size_m, diameter_m=diameter_m, height_m=height_m, file=file, polygon=polygon, holes=holes, line=line, thickness_m=thickness_m, top_m=top_m, scale=scale, up=up, vertices=vertices, triangles=triangles)


class Door(SceneMap):
    """A line segment that stops agents while it is closed.

    Args:
        name: unique among the doors [door 1, ...].
        from_m: [x, y] of one end [required, or area].
        to_m: [x, y] of the other end [required, or area].
        opens: list of triggers that open the door [open from the start].
        closes: list of triggers that close the door [never].
        area: area of the leaf instead of its ends; the leaf is the narrowest rectangle around it [none].
    """

    _keys = {"name": "", "from_m": "", "to_m": "", "opens": "trigger", "closes": "trigger", "area": "area"}
    name: Optional[str]
    from_m: Optional[npt.ArrayLike]
    to_m: Optional[npt.ArrayLike]
    opens: Optional[Sequence[Union["Trigger", float, Mapping[str, Any]]]]
    closes: Optional[Sequence[Union["Trigger", float, Mapping[str, Any]]]]
    area: Optional[Union["Area", Shape, Mapping[str, Any]]]

    def __init__(
        self,
        *,
        name: Optional[str] = None,
        from_m: Optional[npt.ArrayLike] = None,
        to_m: Optional[npt.ArrayLike] = None,
        opens: Optional[Sequence[Union["Trigger", float, Mapping[str, Any]]]] = None,
        closes: Optional[Sequence[Union["Trigger", float, Mapping[str, Any]]]] = None,
        area: Optional[Union["Area", Shape, Mapping[str, Any]]] = None,
    ) -> None:
        super().__init__(name=name, from_m=from_m, to_m=to_m, opens=opens, closes=closes, area=area)


class PartsBox(SceneMap):
    """Loose parts of a model that fly in a closed cube.

    Args:
        count: number of parts; required.
        edge_m: edge length of the cube, in metres, 0.1 to 1000; it is centred above the origin and stands on
            the ground; required.
        static_every: every n-th part stands still; 0: none [0].
        max_spin_radps: upper limit of the uniform distribution of spins, in rad/s [3].
        min_speed_mps: lower limit of the uniform distribution of speeds, in m/s [0.5].
        max_speed_mps: upper limit of the uniform distribution of speeds, in m/s [1.5].
        model: body model of the parts: adult, or a URDF file relative to the scene file [adult].
    """

    _keys = {"count": "", "edge_m": "", "static_every": "", "max_spin_radps": "", "min_speed_mps": "", "max_speed_mps": "", "model": ""}
    count: Optional[int]
    edge_m: Optional[float]
    static_every: Optional[int]
    max_spin_radps: Optional[float]
    min_speed_mps: Optional[float]
    max_speed_mps: Optional[float]
    model: Optional[str]

    def __init__(
        self,
        *,
        count: Optional[int] = None,
        edge_m: Optional[float] = None,
        static_every: Optional[int] = None,
        max_spin_radps: Optional[float] = None,
        min_speed_mps: Optional[float] = None,
        max_speed_mps: Optional[float] = None,
        model: Optional[str] = None,
    ) -> None:
        super().__init__(count=count, edge_m=edge_m, static_every=static_every, max_spin_radps=max_spin_radps, min_speed_mps=min_speed_mps, max_speed_mps=max_speed_mps, model=model)


class Separation(SceneMap):
    """Required separation of robots from people.

    Args:
        human_speed_mps: v_h: speed of the person towards the robot, in m/s, at most 100 [as measured, with
            exact].
        robot_speed_mps: v_r: speed of the robot towards the person, in m/s, at most 100 [as measured, with
            exact].
        reaction_s: T_r: time until the robot begins to stop, in seconds, at most 60; required.
        stopping_s: T_s: stopping time after that, in seconds, at most 600 [from deceleration_mps2].
        deceleration_mps2: deceleration of the stopping robot, in m/s2; above 0, at most 1000 [from
            stopping_s].
        intrusion_m: C: intrusion of a person before detection, in metres [0].
        human_uncertainty_m: Z_d: position uncertainty of the person, in metres [0].
        robot_uncertainty_m: Z_r: position uncertainty of the robot, in metres [0].
    """

    _keys = {"human_speed_mps": "", "robot_speed_mps": "", "reaction_s": "", "stopping_s": "", "deceleration_mps2": "", "intrusion_m": "", "human_uncertainty_m": "", "robot_uncertainty_m": ""}
    human_speed_mps: Optional[float]
    robot_speed_mps: Optional[float]
    reaction_s: Optional[float]
    stopping_s: Optional[float]
    deceleration_mps2: Optional[float]
    intrusion_m: Optional[float]
    human_uncertainty_m: Optional[float]
    robot_uncertainty_m: Optional[float]

    def __init__(
        self,
        *,
        human_speed_mps: Optional[float] = None,
        robot_speed_mps: Optional[float] = None,
        reaction_s: Optional[float] = None,
        stopping_s: Optional[float] = None,
        deceleration_mps2: Optional[float] = None,
        intrusion_m: Optional[float] = None,
        human_uncertainty_m: Optional[float] = None,
        robot_uncertainty_m: Optional[float] = None,
    ) -> None:
        super().__init__(human_speed_mps=human_speed_mps, robot_speed_mps=robot_speed_mps, reaction_s=reaction_s, stopping_s=stopping_s, deceleration_mps2=deceleration_mps2, intrusion_m=intrusion_m, human_uncertainty_m=human_uncertainty_m, robot_uncertainty_m=robot_uncertainty_m)


class RecordedPeople(SceneMap):
    """People who walk on recorded trajectories.

    Args:
        file: recording, relative to the scene file or to a folder named by an environment variable
            ($THRONG_RECORDINGS/jam.txt); its kind is detected by content, see docs/recordings.md; required.
        name: name of the recorded people in results [recorded].
        fps: recorded frames per second [as stated in the file, else required.
        unit_m: metres per unit of length: 0.01 for cm [as stated in the file].
        heading_unit: unit of headings in a table: rad or deg [as stated in the file, else rad].
        columns: columns of a table: id=pedID,t=time,x=posX,y=posY [by their names].
        separator: separator of columns: one character, or tab [detected in the first line].
        tracked_point: point that positions follow: head or centre of the body [by kind of file].
        start_s: start of the run after the first frame, in seconds [0].
        end_s: end of the run after the first frame, in seconds [the end].
        strict: treat anomalies (jumps, gaps, ...) as errors [false].
        sampling: smooth: recorded frames, and equal steps of at most 1/60 s between them; recorded: recorded
            frames alone [smooth].
        geometry: build walls around the walkable area of the file, if it has one [true].
        model: body model, as of a group [adult].
        height_m: body height, as of a group; overrides heights of the file [as recorded, else by age].
        ages: ages, as of a group [adults].
        gait_styles: gait styles, as of a group [by age].
    """

    _keys = {"file": "", "name": "", "fps": "", "unit_m": "", "heading_unit": "", "columns": "", "separator": "", "tracked_point": "", "start_s": "", "end_s": "", "strict": "", "sampling": "", "geometry": "", "model": "", "height_m": "distribution", "ages": "ages", "gait_styles": "gait_styles"}
    file: Optional[str]
    name: Optional[str]
    fps: Optional[float]
    unit_m: Optional[float]
    heading_unit: Optional[Literal["rad", "deg"]]
    columns: Optional[str]
    separator: Optional[str]
    tracked_point: Optional[Literal["centre", "head"]]
    start_s: Optional[float]
    end_s: Optional[float]
    strict: Optional[bool]
    sampling: Optional[Literal["smooth", "recorded"]]
    geometry: Optional[bool]
    model: Optional[str]
    height_m: Optional[Union["Distribution", float, Mapping[str, Any]]]
    ages: Optional[Union["Ages", Literal["adults", "children", "young", "middle_aged", "elderly", "impaired", "mixed"], Mapping[str, Any]]]
    gait_styles: Optional[Union["GaitStyles", Literal["plain", "relaxed", "brisk", "stiff", "pockets", "short_steps"], Mapping[str, Any]]]

    def __init__(
        self,
        *,
        file: Optional[str] = None,
        name: Optional[str] = None,
        fps: Optional[float] = None,
        unit_m: Optional[float] = None,
        heading_unit: Optional[Literal["rad", "deg"]] = None,
        columns: Optional[str] = None,
        separator: Optional[str] = None,
        tracked_point: Optional[Literal["centre", "head"]] = None,
        start_s: Optional[float] = None,
        end_s: Optional[float] = None,
        strict: Optional[bool] = None,
        sampling: Optional[Literal["smooth", "recorded"]] = None,
        geometry: Optional[bool] = None,
        model: Optional[str] = None,
        height_m: Optional[Union["Distribution", float, Mapping[str, Any]]] = None,
        ages: Optional[Union["Ages", Literal["adults", "children", "young", "middle_aged", "elderly", "impaired", "mixed"], Mapping[str, Any]]] = None,
        gait_styles: Optional[Union["GaitStyles", Literal["plain", "relaxed", "brisk", "stiff", "pockets", "short_steps"], Mapping[str, Any]]] = None,
    ) -> None:
        super().__init__(file=file, name=name, fps=fps, unit_m=unit_m, heading_unit=heading_unit, columns=columns, separator=separator, tracked_point=tracked_point, start_s=start_s, end_s=end_s, strict=strict, sampling=sampling, geometry=geometry, model=model, height_m=height_m, ages=ages, gait_styles=gait_styles)


class Area(SceneMap):
    """A rectangle, a polygon with holes, or well-known text, in metres.

    Args:
        min_m: south-west corner of a rectangle [required of a rectangle].
        max_m: north-east corner of a rectangle [required of a rectangle].
        polygon: corners [x, y] of a polygon, in either direction [required of a polygon].
        holes: holes of the polygon, each a list of corners [none].
        wkt: POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION as well-known text; pieces that touch or overlap are
            joined [required of text].
    """

    _keys = {"min_m": "", "max_m": "", "polygon": "", "holes": "", "wkt": ""}
    min_m: Optional[npt.ArrayLike]
    max_m: Optional[npt.ArrayLike]
    polygon: Optional[npt.ArrayLike]
    holes: Optional[npt.ArrayLike]
    wkt: Optional[str]

    def __init__(
        self,
        *,
        min_m: Optional[npt.ArrayLike] = None,
        max_m: Optional[npt.ArrayLike] = None,
        polygon: Optional[npt.ArrayLike] = None,
        holes: Optional[npt.ArrayLike] = None,
        wkt: Optional[str] = None,
    ) -> None:
        super().__init__(min_m=min_m, max_m=max_m, polygon=polygon, holes=holes, wkt=wkt)


class Ground(SceneMap):
    """Walkable ground: an area as above, or a file with its text.

    Args:
        min_m: south-west corner of a rectangle [required of a rectangle].
        max_m: north-east corner of a rectangle [required of a rectangle].
        polygon: corners [x, y] of a polygon, in either direction [required of a polygon].
        holes: holes of the polygon, each a list of corners [none].
        wkt: POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION as well-known text; pieces that touch or overlap are
            joined [required of text].
        file: file with well-known text, relative to the scene file [none].
        wall_height_m: height of walls along the edges, which are obstacles; edges without walls stop agents
            but make no contacts [0].
    """

    _keys = {"min_m": "", "max_m": "", "polygon": "", "holes": "", "wkt": "", "file": "", "wall_height_m": ""}
    min_m: Optional[npt.ArrayLike]
    max_m: Optional[npt.ArrayLike]
    polygon: Optional[npt.ArrayLike]
    holes: Optional[npt.ArrayLike]
    wkt: Optional[str]
    file: Optional[str]
    wall_height_m: Optional[float]

    def __init__(
        self,
        *,
        min_m: Optional[npt.ArrayLike] = None,
        max_m: Optional[npt.ArrayLike] = None,
        polygon: Optional[npt.ArrayLike] = None,
        holes: Optional[npt.ArrayLike] = None,
        wkt: Optional[str] = None,
        file: Optional[str] = None,
        wall_height_m: Optional[float] = None,
    ) -> None:
        super().__init__(min_m=min_m, max_m=max_m, polygon=polygon, holes=holes, wkt=wkt, file=file, wall_height_m=wall_height_m)


class Starts(SceneMap):
    """Places at the start: a list of [x, y], or a CSV file.

    Args:
        file: CSV file relative to the scene file, with the columns x_m, y_m and if known heading_rad and
            speed_mps; a row per agent; required.
    """

    _keys = {"file": ""}
    file: Optional[str]

    def __init__(
        self,
        *,
        file: Optional[str] = None,
    ) -> None:
        super().__init__(file=file)


class Distribution(SceneMap):
    """One number for all agents, or a truncated normal distribution.

    Args:
        mean: mean [that of the key with this distribution].
        std_dev: standard deviation [that of the key with this distribution].
        min: lower limit; lower draws are repeated [that of the key with this distribution].
        max: upper limit; higher draws are repeated [that of the key with this distribution].
    """

    _keys = {"mean": "", "std_dev": "", "min": "", "max": ""}
    mean: Optional[float]
    std_dev: Optional[float]
    min: Optional[float]
    max: Optional[float]

    def __init__(
        self,
        *,
        mean: Optional[float] = None,
        std_dev: Optional[float] = None,
        min: Optional[float] = None,
        max: Optional[float] = None,
    ) -> None:
        super().__init__(mean=mean, std_dev=std_dev, min=min, max=max)


# Classes by the name of their map.
MAPS = {"scene": Scene, "culling": Culling, "steering": Steering, "group": Group, "ages": Ages, "gait_styles": GaitStyles, "goal": Goal, "queue": Queue, "source": Source, "trigger": Trigger, "social_groups": SocialGroups, "obstacle": Obstacle, "door": Door, "box": PartsBox, "separation": Separation, "recording": RecordedPeople, "area": Area, "ground": Ground, "starts": Starts, "distribution": Distribution}
