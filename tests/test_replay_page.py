"""The replay page in a real browser: opens without a network, plays, and tells a joint's numbers when it is clicked."""

import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from replay_runs import falling_ball

from calibration.replay import ReferenceShape, write_replay
from sim.recorded import Recording

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    CHROMIUM is None or DRIVER is None, reason="no chromium and chromedriver (Debian: chromium, chromium-driver)"
)
FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars")
FLAGS += ("--disable-background-networking", "--disable-component-update", "--disable-sync", "--window-size=1280,900")


@pytest.fixture(scope="module")
def recording() -> Recording:
    return falling_ball()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture
def page(browser: Any, recording: Recording, tmp_path: Path) -> Any:
    """The page, opened and ready, without a network."""
    path = tmp_path / "replay.html"
    x = np.linspace(0.0, 3.0, 31)
    write_replay(recording, path, ReferenceShape((np.column_stack([x, -0.02 * x**2]),)))
    browser.execute_cdp_cmd("Network.enable", {})
    browser.execute_cdp_cmd(
        "Network.emulateNetworkConditions",
        {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0},
    )
    browser.get(path.as_uri())
    wait_until(lambda: browser.execute_script("return window.replay !== undefined"))
    yield browser
    assert [entry["message"] for entry in browser.get_log("browser")] == []


def wait_until(condition: Callable[[], Any], patience: float = 10.0) -> None:
    """Wait for a browser; a condition that never comes true fails the test."""
    start = time.monotonic()
    while not condition():
        assert time.monotonic() - start < patience
        time.sleep(0.02)


def settle(page: Any) -> None:
    """Let the page draw what it was asked for."""
    page.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))")


def click_joint(page: Any, j: int) -> None:
    from selenium.webdriver import ActionChains

    stage = page.find_element("id", "stage")
    x, y = page.execute_script(f"return replay.onScreen({j})")
    # Offsets count from the element's middle.
    ActionChains(page).move_to_element_with_offset(
        stage, round(x - stage.size["width"] / 2), round(y - stage.size["height"] / 2)
    ).click().perform()
    settle(page)


def card(page: Any, j: int) -> dict[str, list[str]]:
    """Cells of a joint's card by row: value, share, maximum, peak."""
    rows = page.find_elements("css selector", f'.card[data-joint="{j}"] tr[data-quantity]')
    return {
        row.get_attribute("data-quantity"): [cell.text for cell in row.find_elements("css selector", "td")[1:]]
        for row in rows
    }


def number(text: str) -> float:
    """A value as the page writes it, back in SI."""
    value, unit = text.replace("−", "-").split("\u202f")
    scale = {"k": 1e3, "M": 1e6, "m": 1e-3, "%": 1e-2}
    return float(value) * scale.get(unit[0], 1.0)


def test_it_asks_for_nothing_and_shows_what_was_recorded(page: Any, recording: Recording) -> None:
    assert page.execute_script("return performance.getEntriesByType('resource').length") == 0
    assert page.title == "Replay: A ball falls on a cantilever"
    assert "7 bodies · 6 joints · step 1/240" in page.find_element("id", "facts").text
    unpacked = page.execute_script(
        "const r = replay.recording;"
        "return r.time.map((_, k) => [r.pose(7, {k, next: k, share: 0}), r.force(0, 2, k), r.used(0, k)])"
    )
    poses, moments, used = zip(*unpacked, strict=True)
    np.testing.assert_allclose(poses, recording.pose[:, 7], atol=1e-4)
    np.testing.assert_allclose(moments, recording.force[:, 0, 2], atol=1.0)
    np.testing.assert_allclose(used, recording.capacity_used[:, 0], atol=1e-4)


def test_it_plays_pauses_and_ends(page: Any) -> None:
    now = "return replay.player.time"
    play = page.find_element("id", "play")
    assert page.execute_script(now) == 0.0
    play.click()
    wait_until(lambda: page.execute_script(now) > 0.2)
    play.click()
    stopped = page.execute_script(now)
    settle(page)
    assert page.execute_script(now) == stopped
    assert page.find_element("id", "clock").text.startswith(f"{stopped:.2f}")
    page.execute_script("replay.player.seek(2.9)")
    play.click()
    wait_until(lambda: page.execute_script("return !replay.player.playing"))
    assert page.execute_script(now) == pytest.approx(3.0)


def test_the_picture_changes_as_it_plays(page: Any) -> None:
    def picture() -> str:
        settle(page)
        return str(page.execute_script("return document.getElementById('stage').toDataURL()"))

    first = picture()
    assert picture() == first
    page.execute_script("replay.player.seek(0.25)")
    assert picture() != first
    page.execute_script("replay.player.seek(0)")
    assert picture() == first


@pytest.mark.parametrize("j", [0, 3])
def test_a_click_on_a_joint_shows_its_numbers(page: Any, recording: Recording, j: int) -> None:
    k = 6
    page.execute_script(f"replay.player.seek({recording.time[k]:.9f} + 1e-6)")
    settle(page)
    assert page.find_elements("css selector", ".card") == []
    click_joint(page, j)
    rows = card(page, j)
    for kind, name in enumerate("NQM"):
        value, share, most, peak = rows[name]
        maximum = recording.joints[j].maxima[kind]
        assert number(value) == pytest.approx(recording.force[k, j, kind], rel=2e-3)
        assert number(share) == pytest.approx(abs(recording.force[k, j, kind]) / maximum, abs=6e-4)
        assert number(most) == pytest.approx(maximum, rel=1e-3)
        assert number(peak) == pytest.approx(recording.peak[j, kind], rel=1e-3)
    assert number(rows["plastic used"][0]) == pytest.approx(recording.capacity_used[k, j], abs=6e-4)
    click_joint(page, j)
    assert page.find_elements("css selector", ".card") == []


def test_several_joints_and_a_broken_one(page: Any, recording: Recording) -> None:
    click_joint(page, 0)
    click_joint(page, 4)
    assert len(page.find_elements("css selector", ".card")) == 2
    assert len(page.find_elements("css selector", "#curves canvas")) == 4
    page.execute_script("replay.player.seek(1.0)")
    settle(page)
    when = recording.time[recording.broken[:, 0].argmax()]
    assert card(page, 0)["plastic used"] == ["100\u202f%", f"broken at {when:.3f}\u202fs"]
    assert card(page, 0)["M"][0].startswith("0")


def test_forces_are_drawn_to_a_scale_that_can_be_changed(page: Any) -> None:
    def legend() -> str:
        settle(page)
        return str(page.find_element("id", "legend").text)

    page.execute_script("replay.player.seek(0.2)")
    assert "M 20" in legend()
    page.execute_script(
        "const s = document.getElementById('force-scale'); s.value = 1; s.dispatchEvent(new Event('input'))"
    )
    assert "M 2\u202fkN" in legend()
    page.find_element("css selector", "[data-force=N]").click()
    page.find_element("css selector", "[data-force=M]").click()
    assert "N " in legend()
    assert "M " not in legend()


def test_the_energy_ledger_is_told(page: Any, recording: Recording) -> None:
    k = 20
    page.execute_script(f"replay.player.seek({recording.time[k]:.9f} + 1e-6)")
    settle(page)
    rows = page.find_elements("css selector", "#energy tr")
    told = {row.text.split()[0]: row.find_elements("css selector", "td")[1].text for row in rows}
    assert list(told) == list(recording.energy)
    largest = max(np.abs(values).max() for values in recording.energy.values())
    for name, values in recording.energy.items():
        assert number(told[name]) == pytest.approx(values[k], rel=1e-3, abs=1e-4 * largest)


def test_keys(page: Any) -> None:
    from selenium.webdriver import ActionChains, Keys

    def press(*keys: str) -> Any:
        ActionChains(page).send_keys(*keys).perform()
        settle(page)
        return page.execute_script("return [replay.player.time, replay.cards.chosen, replay.player.playing]")

    assert press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)[0] == pytest.approx(2 / 30)
    assert press(Keys.ARROW_LEFT)[0] == pytest.approx(1 / 30)
    assert press(Keys.END)[0] == pytest.approx(3.0)
    assert press(Keys.HOME)[0] == 0.0
    assert press(".")[1] == [0]
    assert press(".")[1] == [1]
    assert press(Keys.ESCAPE)[1] == []
    assert press(" ")[2]
    assert not press(" ")[2]


@pytest.mark.parametrize("lacking", ["window.DecompressionStream", "Array.prototype.findLastIndex"])
def test_a_browser_that_is_too_old_says_so(page: Any, lacking: str) -> None:
    """One plain message in place of the picture, and nothing in the console."""
    script = page.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": f"delete {lacking}"})
    try:
        page.refresh()
        wait_until(lambda: page.find_element("id", "message").text != "")
        assert "Take one from 2023 or later" in page.find_element("id", "message").text
        assert "fault" in page.find_element("id", "message").get_attribute("class")
    finally:
        page.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)


def test_it_fits_a_phone(page: Any) -> None:
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": 360, "height": 740, "deviceScaleFactor": 2, "mobile": True}
    )
    try:
        page.execute_script("replay.cards.choose([0, 3])")
        settle(page)
        assert page.execute_script("return document.documentElement.scrollWidth") <= 360
        for j in range(6):
            x, y = page.execute_script(f"return replay.onScreen({j})")
            assert 0 < x < 360
            assert 0 < y < 420
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
