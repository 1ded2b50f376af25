"""Pages in a real browser: nothing is missing, everything is drawn and can be read, on a laptop and on a phone."""
from __future__ import annotations

import io

import browser as chromium
import numpy as np
import pytest

from asemd import cli
from asemd.page import Page, Series

MELT = """
units lj
atom_style bond
region b block 0 8 0 8 0 8
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
molecule dimer dimer.txt
create_atoms 0 random 150 12345 NULL overlap 1.0 maxtry 1000 mol dimer 777
mass * 1.0
pair_style lj/cut 1.12246
pair_coeff * * 1.0 1.0
bond_style harmonic
bond_coeff 1 100.0 1.0
minimize 0 1e-4 30 300
velocity all create 1.0 4711
fix 1 all nve
thermo 10
run 200
"""
DIMER = """dimer

2 atoms
1 bonds

Coords

1 0 0 0
2 1 0 0

Types

1 1
2 2

Bonds

1 1 1 2

"""
# per plot: how many pixels are painted, and how many of them in colours that are not grey
PAINTED = """return [...document.querySelectorAll('.figure canvas')].map(c => {
  const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let all = 0, coloured = 0;
  for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 100) {
    all++; if (Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]) > 60) coloured++; }
  return [all, coloured]; })"""
# every text on the page with its colour and the colour behind it
TEXTS = """const rgb = c => { const m = c.match(/[\\d.]+/g).map(Number); return m.length < 4 ? [...m, 1] : m; };
  const all = document.querySelectorAll('h1, h2, h3, p, a, dt, dd, th, td, button, small, footer, .warning, code');
  return [...all].filter(e => e.offsetParent).map(e => {
    let b = e, back; do { back = rgb(getComputedStyle(b).backgroundColor); b = b.parentElement; } while (b && back[3] === 0);
    return [e.tagName + ' ' + e.textContent.slice(0, 30), rgb(getComputedStyle(e).color), back]; })"""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The page of a run with minimisation, bonds and a warning, plus a log-log plot."""
    folder = tmp_path_factory.mktemp("page")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        (folder / "in.melt").write_text(MELT)
        (folder / "dimer.txt").write_text(DIMER)
        assert cli.main(["run", "in.melt", "--quiet", "--html", "run.html"]) == 0
    return folder / "run.html"


@pytest.fixture(scope="module", params=["laptop", "phone"])
def shown(request, page, tmp_path_factory):
    """A browser of that size with the page in it."""
    browser = chromium.start(tmp_path_factory.mktemp(request.param), request.param)
    try:
        chromium.show(browser, page)
        yield browser
    finally:
        browser.quit()


def picture(browser) -> np.ndarray:
    """The pixels of the snapshot, (height, width, 3)."""
    image = pytest.importorskip("PIL.Image")
    stage = browser.find_element("css selector", ".stage")
    browser.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", stage)
    return np.array(image.open(io.BytesIO(stage.screenshot_as_png)).convert("RGB"), int)


def of_colour(pixels: np.ndarray, colour: str) -> int:
    """How many pixels have this hue, in any shade."""
    wanted = np.array([int(colour[i:i + 2], 16) for i in (1, 3, 5)], float)
    strong = pixels.max(axis=-1) - pixels.min(axis=-1) > 40
    unit = pixels / np.maximum(np.linalg.norm(pixels, axis=-1, keepdims=True), 1.0)
    return int((strong & (unit @ (wanted / np.linalg.norm(wanted)) > 0.985)).sum())


def test_no_errors_and_nothing_loaded(shown):
    assert chromium.errors(shown) == []
    loaded = shown.execute_script("return performance.getEntriesByType('resource').map(e => e.name)")
    assert [name for name in loaded if not name.startswith("data:")] == []
    assert shown.execute_script("return document.querySelectorAll('.failed').length") == 0


def test_every_plot_is_drawn(shown):
    painted = shown.execute_script(PAINTED)
    assert len(painted) >= 8
    for all_pixels, coloured in painted:
        assert all_pixels > 1500 and coloured > 300


def test_nothing_is_wider_than_the_screen(shown):
    width = shown.execute_script("return innerWidth")
    assert shown.execute_script("return document.documentElement.scrollWidth") <= width
    edges = shown.execute_script("return [...document.querySelectorAll('.part, .figure canvas, .stage canvas, h1, .facts div')]"
                                 ".map(e => e.getBoundingClientRect()).map(r => [r.left, r.right])")
    assert edges and all(left >= 0 and right <= width for left, right in edges)


def test_plots_stand_side_by_side_where_there_is_room(shown):
    tops = shown.execute_script("return [...document.querySelectorAll('.part.plot:not(.wide)')].map(e => e.getBoundingClientRect().top)")
    assert (tops[0] == tops[1]) == (shown.execute_script("return innerWidth") > 1000)


def test_the_snapshot_is_drawn_turns_and_hides_types(shown):
    before = picture(shown)
    blue, red = of_colour(before, "#4477aa"), of_colour(before, "#ee6677")
    assert blue > 500 and red > 500
    from selenium.webdriver import ActionChains
    stage = shown.find_element("css selector", ".stage")
    ActionChains(shown).move_to_element(stage).click_and_hold().move_by_offset(70, 25).release().perform()
    turned = picture(shown)
    assert (np.abs(turned - before).max(axis=-1) > 30).mean() > 0.01
    button = shown.find_elements("css selector", ".legend button")[1]
    shown.execute_script("arguments[0].click()", button)
    assert button.get_attribute("aria-pressed") == "false" and of_colour(picture(shown), "#ee6677") < 0.1 * red
    shown.execute_script("arguments[0].click()", button)
    assert of_colour(picture(shown), "#ee6677") > 0.5 * red
    assert chromium.errors(shown) == []


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_can_be_read(shown, theme):
    if shown.execute_script("return document.documentElement.dataset.theme") != theme:
        shown.execute_script("document.getElementById('theme').click()")
    for name, ink, paper in shown.execute_script(TEXTS):
        assert contrast(ink, paper) >= 4.5, f"{theme}: {name}"
    axes = shown.execute_script("return JSON.parse(document.getElementById('themes').textContent)")[theme]["axis"]["labelColor"]
    card = shown.execute_script("return getComputedStyle(document.querySelector('.part.plot')).backgroundColor")
    card = [int(c) for c in card.strip("rgb()").split(",")]
    assert contrast([int(axes[i:i + 2], 16) for i in (1, 3, 5)], card) >= 4.5


def contrast(a, b) -> float:
    """Ratio of luminances, as the Web Content Accessibility Guidelines define it."""
    def luminance(colour) -> float:
        c = np.array(colour[:3], float) / 255.0
        return float(np.where(c <= 0.03928, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_all_parts_of_a_run_are_there(page):
    text = page.read_text()
    for title in ("Snapshot", "Thermo", "Minimisation", "Conserved quantity", "Timing", "Plan", "Left out", "Temperature", "Pressure"):
        assert f">{title}</h" in text, title


def test_without_webgl_the_rest_is_there(page, tmp_path):
    browser = chromium.start(tmp_path, "laptop", "--disable-3d-apis")
    try:
        chromium.show(browser, page)
        assert "could not be drawn" in browser.find_element("css selector", ".snapshot .failed").text
        assert all(coloured > 300 for _, coloured in browser.execute_script(PAINTED))
    finally:
        browser.quit()


def test_loglog_values_are_told_when_touched(tmp_path):
    page = Page("Work and precision")
    steps = Series("timestep", [1, 2, 4], [4e-3, 1e-3, 2e-4], [3e-3, 8e-4, 1e-4], [5e-3, 2e-3, 3e-4], ["4", "2", "1"])
    page.loglog("Work", [steps], "seconds", "error", front=True, floor=1e-4, here=(2, 1e-3, "script"))
    browser = chromium.start(tmp_path / "profile", "laptop")
    try:
        chromium.show(browser, page.write(tmp_path / "work.html"))
        assert chromium.errors(browser) == []
        from selenium.webdriver import ActionChains
        canvas = browser.find_element("css selector", ".figure canvas")
        x, y = browser.execute_script("const v = document.querySelector('.figure').view, o = v.origin(), p = v.padding();"
                                      "return [o[0] + p.left + v.scale('x')(4), o[1] + p.top + v.scale('y')(2e-4)]")
        width, height = canvas.size["width"], canvas.size["height"]
        ActionChains(browser).move_to_element_with_offset(canvas, x - width / 2, y - height / 2).perform()
        told = browser.find_element("css selector", ".tip").text
        assert "0.0002" in told and "seconds" in told and "1" in told
    finally:
        browser.quit()
