"""N, Q and M against sectionproperties in one run: ``pytest benchmarks/test_capacity_speed.py``.

sectionproperties is given what it needs for the same answer: N and M by its geometric and plastic analysis, Q of a
catalogue section also by its warping analysis, which alone knows a shear area; polygons without warping.
"""

from itertools import cycle, islice

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture
from sectionproperties.analysis import Section as Peer
from sectionproperties.pre import Geometry
from sectionproperties.pre.library import i_section
from shapely import Polygon

from capacity import Capacity, capacity, catalogue, parse_material, parse_section, shapes

STEEL = parse_material("S235")
ANGLES = 2.0 * np.pi * np.arange(12) / 12
RADII = np.where(np.arange(12) % 2, 60.0, 100.0)
VERTICES = [(float(r * np.cos(a)), float(r * np.sin(a))) for r, a in zip(RADII, ANGLES, strict=True)]


def analysed(geometry: Geometry, size: float) -> Peer:
    peer = Peer(geometry.create_mesh([size]))
    peer.calculate_geometric_properties()
    peer.calculate_plastic_properties()
    return peer


def test_catalogue_section(benchmark: BenchmarkFixture) -> None:
    result = benchmark(lambda: capacity(parse_section("IPE 300"), STEEL))
    assert result.M_max > 0.0


def test_catalogue_section_by_sectionproperties_without_warping(benchmark: BenchmarkFixture) -> None:
    peer = benchmark(lambda: analysed(i_section(d=300, b=150, t_f=10.7, t_w=7.1, r=15, n_r=8), 50.0))
    assert peer.get_s()[0] > 0.0


def test_catalogue_section_by_sectionproperties_with_warping(benchmark: BenchmarkFixture) -> None:
    def run() -> Peer:
        peer = analysed(i_section(d=300, b=150, t_f=10.7, t_w=7.1, r=15, n_r=8), 50.0)
        peer.calculate_warping_properties()
        return peer

    assert benchmark(run).get_as()[1] > 0.0


def test_polygon_of_12_vertices(benchmark: BenchmarkFixture) -> None:
    metres = [(1e-3 * x, 1e-3 * y) for x, y in VERTICES]
    result = benchmark(lambda: capacity(shapes.polygon(metres), STEEL))
    assert result.M_max > 0.0


def test_polygon_of_12_vertices_by_sectionproperties(benchmark: BenchmarkFixture) -> None:
    peer = benchmark(lambda: analysed(Geometry(Polygon(VERTICES)), 500.0))
    assert peer.get_s()[0] > 0.0


def test_a_thousand_catalogue_sections(benchmark: BenchmarkFixture) -> None:
    entries = list(islice(cycle(catalogue.entries().values()), 1000))

    def run() -> list[Capacity]:
        return [capacity(entry.section(), STEEL) for entry in entries]

    assert len(benchmark(run)) == 1000
