"""What the replay page carries: unpacked again it is the recording, to the resolution promised, and it is small."""

import base64
import json
import re
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from replay_runs import falling_ball

from calibration.replay import ReferenceShape, replay_page, write_replay
from calibration.replay_payload import ABSENT, payload
from sim.recorded import Contacts, RecordedBody, RecordedJoint, Recording


def unpacked(packed: dict[str, Any]) -> dict[str, np.ndarray]:
    """Plain twin of the page's script: every array, (length, channels)."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(packed["data"])), dtype=np.uint8).reshape(2, -1)
    differences = np.ascontiguousarray(planes.T).view("<i2").ravel()
    arrays = {}
    for name, lie in packed["layout"].items():
        offset, step = np.array(lie["offset"]), np.array(lie["step"])
        size = lie["length"] * len(offset)
        part = differences[lie["first"] : lie["first"] + size].reshape(len(offset), lie["length"])
        whole = np.cumsum(part, axis=1, dtype=np.int16).T
        arrays[name] = np.where(whole == ABSENT, np.nan, offset + step * whole)
    return arrays


@pytest.fixture(scope="module")
def recording() -> Recording:
    return falling_ball(seconds=1.5)


def test_every_channel_is_resolved_to_a_65534th_of_its_range(recording: Recording) -> None:
    arrays = unpacked(payload(recording))
    times = len(recording.time)
    for name, values, centred in (
        ("pose", recording.pose.reshape(times, -1), False),
        ("force", recording.force.reshape(times, -1), True),
        ("used", recording.capacity_used, True),
        ("contact", np.hstack([recording.contacts.point, recording.contacts.force]), False),
    ):
        reach = np.abs(values).max(axis=0) if centred else 0.5 * np.ptp(values, axis=0)
        assert np.all(np.abs(arrays[name] - values) <= reach / 65534 * (1 + 1e-6) + 1e-15), name
    assert np.all(arrays["force"][recording.force.reshape(times, -1) == 0.0] == 0.0)
    np.testing.assert_array_equal(np.round(arrays["touching"][:, 0]), np.diff(recording.contacts.start))


def test_what_is_not_there_stays_so(recording: Recording) -> None:
    pose = recording.pose.copy()
    pose[:5, -1] = np.nan
    arrays = unpacked(payload(with_pose(recording, pose)))
    np.testing.assert_array_equal(np.isnan(arrays["pose"]), np.isnan(pose).reshape(len(pose), -1))


def test_a_body_put_elsewhere_is_not_drawn_on_the_way(recording: Recording) -> None:
    assert payload(recording)["jumps"] == []
    pose = recording.pose.copy()
    pose[20:, -1, 0] -= 5.0
    assert payload(with_pose(recording, pose))["jumps"] == [(len(recording.bodies) - 1, 20)]


def test_the_page_is_one_file_that_names_no_other(recording: Recording, tmp_path: Path) -> None:
    shape = ReferenceShape((np.array([[0.0, 0.0], [3.0, -0.4]]),), label="</script> & <b>")
    write_replay(recording, tmp_path / "replay.html", shape)
    page = (tmp_path / "replay.html").read_text(encoding="utf-8")
    assert page == replay_page(recording, shape)
    assert not re.search(r"\b(src|href)\s*=|https?://|@import|url\(|\bfetch\(|import\s*\(", page)
    assert "default-src 'none'" in page
    content = re.search(r'id="payload">(.*?)</script>', page, re.DOTALL)
    assert content
    assert json.loads(content[1])["reference"]["label"] == "</script> & <b>"


def test_a_minute_of_a_hundred_bodies_at_sixty_a_second_is_below_ten_megabytes() -> None:
    """Bodies and joints that shake all the time with some noise: nothing that packs well."""
    rng = np.random.default_rng(1)
    times, bodies, joints, touching = 3600, 110, 120, 12
    time = np.arange(times) / 60
    swing = np.sin(2 * np.pi * rng.uniform(0.5, 8.0, bodies * 3) * time[:, None]) + 1e-3 * rng.normal(
        size=(times, bodies * 3)
    )
    force = 1e5 * (np.sin(7.0 * time)[:, None, None] + 0.05 * rng.normal(size=(times, joints, 3)))
    joint = RecordedJoint("j", (0, 1), np.zeros((2, 2)), (0.0, 0.0), 0.5, (1e6, 1e6, 1e6))
    recording = Recording(
        title="noise",
        time=time,
        settings={},
        bodies=(RecordedBody("dynamic", (), True),) * bodies,
        pose=swing.reshape(times, bodies, 3),
        velocity=np.full((times, bodies, 2), 50.0),
        joints=(joint,) * joints,
        force=force,
        capacity_used=np.clip(time / 60, 0, 1)[:, None] * rng.uniform(size=joints),
        broken=np.zeros((times, joints), dtype=bool),
        peak=np.abs(force).max(axis=0),
        contacts=Contacts(
            touching * np.arange(times + 1),
            rng.normal(size=(touching * times, 2)),
            rng.normal(size=(touching * times, 2)),
        ),
        energy={},
    )
    assert len(replay_page(recording)) < 10e6


def test_forces_that_are_rounding_are_none() -> None:
    """Less than 1e-9 of what the joint can bear; of one without a limit all are told."""
    recording = falling_ball(0.1)
    capacity = np.array(recording.joints[0].maxima)
    force = recording.force.copy()
    force[:, 0] = 1e-12 * capacity
    peak = recording.peak.copy()
    peak[0] = 1e-12 * capacity
    small = Recording(**{**vars(recording), "force": force, "peak": peak})
    packed = payload(small)
    assert not unpacked(packed)["force"][:, :3].any()
    assert packed["joints"][0]["peak"] == [0.0, 0.0, 0.0]
    endless = RecordedJoint(**{**vars(recording.joints[0]), "maxima": (np.inf, np.inf, np.inf)})
    told = unpacked(payload(Recording(**{**vars(small), "joints": (endless, *recording.joints[1:])})))
    np.testing.assert_allclose(told["force"][:, :3], force[:, 0], rtol=1e-4)


def with_pose(recording: Recording, pose: np.ndarray) -> Recording:
    return Recording(**{**vars(recording), "pose": pose})
