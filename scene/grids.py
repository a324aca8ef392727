"""Regular frames in a few lines: columns and beams on a grid, spelled out as nodes and members."""

from __future__ import annotations

import itertools

import msgspec

from capacity import InputError
from scene.model import Grid, Member, Node, Profile, Scene
from scene.quantities import Length


def spelled_out(scene: Scene) -> Scene:
    """``scene`` with the nodes and members of its grids among its own.

    Raises
    ------
    InputError
        When a grid has no bay or storey, or a name is taken.
    """
    nodes, members = dict(scene.nodes), dict(scene.members)
    for name, grid in scene.grids.items():
        for key in ("bays", "storeys"):
            sizes = getattr(grid, key)
            if not sizes or min(sizes) <= 0.0:
                raise InputError(f"grids.{name}.{key}", "there must be one, and all greater than zero", 'write ["4 m"]')
        new_nodes, new_members = _nodes(name, grid), _members(name, grid)
        taken = [*(new_nodes.keys() & nodes.keys()), *(new_members.keys() & members.keys())]
        if taken:
            raise InputError(f"grids.{name}", f'"{taken[0]}" is there already', "give the grid another name")
        nodes |= new_nodes
        members |= new_members
    return msgspec.structs.replace(scene, nodes=nodes, members=members, grids={})


def _nodes(name: str, grid: Grid) -> dict[str, Node]:
    xs = itertools.accumulate(grid.bays, initial=grid.at[0])
    ys = list(itertools.accumulate(grid.storeys, initial=grid.at[1]))
    return {
        f"{name}-{i}-{j}": Node((Length(x), Length(y)), grid.support if j == 0 else "free")
        for i, x in enumerate(xs)
        for j, y in enumerate(ys)
    }


def _members(name: str, grid: Grid) -> dict[str, Member]:
    lines, floors = range(len(grid.bays) + 1), range(1, len(grid.storeys) + 1)
    columns = {
        f"{name}-column-{i}-{j}": _member(f"{name}-{i}-{j - 1}", f"{name}-{i}-{j}", grid.columns)
        for i in lines
        for j in floors
    }
    beams = {
        f"{name}-beam-{i}-{j}": _member(f"{name}-{i}-{j}", f"{name}-{i + 1}-{j}", grid.beams)
        for i in lines[:-1]
        for j in floors
    }
    return columns | beams


def _member(start: str, end: str, profile: Profile) -> Member:
    return Member(start=start, end=end, **msgspec.structs.asdict(profile))
