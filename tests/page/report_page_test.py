#!/usr/bin/env python3
"""A run's report in a browser: pointer, finger, keys, light and dark. Usage: report_page_test.py DEMO_REPORT

DEMO_REPORT is the program that writes the report of a made-up run. Exit status 77 without a Chromium: skipped. LANTERNFISH_PICTURES=FOLDER keeps pictures.
"""
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import browser

demo_report = None


def number(text):
    return float(text.replace("−", "-"))


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.page = os.path.join(cls.folder.name, "report.html")
        subprocess.run([demo_report, cls.page], check=True)
        cls.browser = browser.Browser()
        cls.run_data = None

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.folder.cleanup()

    def setUp(self):
        b = self.browser
        b.messages.clear()
        b.requests.clear()
        b.size(1440, 900)
        b.dark(False)
        b.open(self.page)
        b.until("document.querySelectorAll('figure.lively').length === 4")
        b.settled()
        type(self).run_data = self.run_data or b.ask("JSON.parse(document.getElementById('run').textContent)")

    def tearDown(self):
        b = self.browser
        self.keep(self.id().split(".")[-1])
        self.assertEqual(b.messages, [], "the console is silent")
        self.assertEqual(b.requests, ["file://" + self.page], "nothing is asked for but the page")

    def keep(self, name):
        if folder := os.environ.get("LANTERNFISH_PICTURES"):
            self.browser.picture(pathlib.Path(folder) / f"{name}.png")

    def moment(self):
        return number(self.browser.ask("document.getElementById('now').textContent").split(" s")[0])

    def legend(self, chart):
        """{name: text} of a chart's values at its cursor."""
        pairs = self.browser.ask(f"""[...document.querySelectorAll('figure[data-chart="{chart}"] .u-legend .u-series')].map(
          row => [row.querySelector('.u-label').textContent, row.querySelector('.u-value').textContent])""")
        return dict(pairs)

    def ticks(self):
        return number(self.legend(0)["t"].removesuffix(" s"))

    def over(self, chart, x, y=0.5):
        return self.browser.place(f'figure[data-chart="{chart}"] .u-over', x, y)

    def shown_span(self):
        """Ends of what a chart shows, by its cursor at both: the pointer's moment is linear over the chart."""
        self.browser.move(self.over(0, 0.25))
        self.browser.settled()
        a = self.moment()
        self.browser.move(self.over(0, 0.75))
        self.browser.settled()
        b = self.moment()
        return a - (b - a) / 2, b + (b - a) / 2

    def recorded(self, chart, series, t):
        """The record's sample that is nearest to t."""
        data = self.run_data["charts"][chart]["series"][series]
        times = self.run_data["times"][data["t"]]
        return data["v"][min(range(len(times)), key=lambda i: abs(times[i] - t))]

    def tool(self):
        """Where the drawn tool is, mm."""
        text = self.browser.ask("document.getElementById('tool-place').textContent")
        return [number(part) for part in text.removeprefix("tool at ").split(" mm")[0].split(", ")]

    def tool_by_hand(self, t):
        """The same of the record, by the made-up robot's closed form (demo_run.cpp)."""
        turn, reach = 0.8 * math.sin(0.3 * t), 0.1 + 0.05 * math.cos(0.7 * t)
        return [1000 * (0.1 + reach + 0.15) * math.cos(turn), 1000 * (0.1 + reach + 0.15) * math.sin(turn), 400.0]

    def expect_tool_at(self, t):
        for drawn, true in zip(self.tool(), self.tool_by_hand(t)):
            self.assertAlmostEqual(drawn, true, delta=0.5 + 4.5 * 0.02)  # the moment is told to 0.01 s, the tool moves by at most 90 mm/s

    def test_begins_at_the_runs_begin_and_shows_all_of_it(self):
        self.assertAlmostEqual(self.moment(), self.run_data["from"], delta=0.01)
        low, high = self.shown_span()
        self.assertAlmostEqual(low, self.run_data["from"], delta=0.5)
        self.assertAlmostEqual(high, self.run_data["to"], delta=0.5)

    def test_a_pointer_over_one_chart_reads_all_charts_and_moves_the_robot(self):
        b = self.browser
        before = b.ask("document.querySelector('canvas').toDataURL()")
        b.move(self.over(1, 0.6))
        b.settled()
        t = self.moment()
        self.assertAlmostEqual(t, self.run_data["from"] + 0.6 * (self.run_data["to"] - self.run_data["from"]), delta=0.5)
        for chart, each in enumerate(self.run_data["charts"]):
            legend = self.legend(chart)
            at = number(legend["t"].removesuffix(" s"))
            self.assertAlmostEqual(at, t, delta=0.06)
            for index, series in enumerate(each["series"]):
                self.assertAlmostEqual(number(legend[series["name"]]), self.recorded(chart, index, at), delta=1e-3 * max(map(abs, (v for v in series["v"] if v is not None))))
        self.expect_tool_at(t)
        self.assertNotEqual(b.ask("document.querySelector('canvas').toDataURL()"), before)
        self.assertAlmostEqual(number(b.ask("document.getElementById('time').value")), t, delta=0.011)

    def test_dragging_zooms_every_chart_and_a_double_click_shows_the_run_again(self):
        b = self.browser
        length = self.run_data["to"] - self.run_data["from"]
        b.drag(self.over(2, 0.25), self.over(2, 0.5))
        b.settled()
        low, high = self.shown_span()
        self.assertAlmostEqual(low, self.run_data["from"] + 0.25 * length, delta=0.5)
        self.assertAlmostEqual(high, self.run_data["from"] + 0.5 * length, delta=0.5)
        self.keep("zoomed")
        b.double_click(self.over(3, 0.5))
        b.settled()
        low, high = self.shown_span()
        self.assertAlmostEqual(high - low, length, delta=1)

    def test_a_finger_zooms_and_reads_on_a_phone(self):
        b = self.browser
        b.size(360, 740, touch=True)
        b.until("document.querySelector('figure[data-chart=\"1\"] .uplot').clientWidth < 360")
        b.settled()
        self.assertLessEqual(b.ask("document.documentElement.scrollWidth"), 360, "nothing is wider than the screen")
        b.swipe(self.over(1, 0.3), self.over(1, 0.7))
        b.settled()
        t = self.moment()
        length = self.run_data["to"] - self.run_data["from"]
        self.assertAlmostEqual(t, self.run_data["from"] + 0.7 * length, delta=0.02 * length)
        self.assertAlmostEqual(self.ticks(), t, delta=0.06)
        low, high = self.shown_span()
        self.assertAlmostEqual(low, self.run_data["from"] + 0.3 * length, delta=0.03 * length)
        self.assertAlmostEqual(high, self.run_data["from"] + 0.7 * length, delta=0.03 * length)
        b.ask("document.getElementById('whole').click()")
        b.settled()
        self.keep("phone")

    def test_the_slider_works_by_keys_and_says_where_it_is(self):
        b = self.browser
        b.ask("document.getElementById('time').focus()")
        b.key("End")
        b.settled()
        self.assertAlmostEqual(self.moment(), self.run_data["to"], delta=0.011)
        b.key("Home")
        for _ in range(5):
            b.key("ArrowRight")
        b.settled()
        t = self.moment()
        self.assertGreater(t, self.run_data["from"])
        self.assertLess(t, self.run_data["from"] + 5)
        self.assertAlmostEqual(self.ticks(), t, delta=0.06)
        self.expect_tool_at(t)
        self.assertIn("boot", b.ask("document.getElementById('time').getAttribute('aria-valuetext')"))

    def test_every_control_is_reached_by_the_tab_key_and_has_a_name(self):
        b = self.browser
        wanted = set(b.ask("[...document.querySelectorAll('button, input, select, canvas[tabindex], .u-legend [role=button]')].map((e, i) => { e.dataset.stop = i; return i; })"))
        b.ask("document.activeElement.blur()")
        reached = set()
        for _ in range(len(wanted) + 5):
            b.key("Tab")
            stop = b.ask("document.activeElement.dataset.stop")
            if stop is not None:
                reached.add(int(stop))
        self.assertEqual(reached, wanted)
        nameless = b.ask("""[...document.querySelectorAll('[data-stop]')].filter(e => !(e.getAttribute('aria-label') || e.textContent.trim())).map(e => e.outerHTML)""")
        self.assertEqual(nameless, [])

    def test_a_legends_name_switches_its_line_by_key(self):
        b = self.browser
        b.ask("document.querySelector('figure[data-chart=\"0\"] .u-legend [role=button]').focus()")
        b.key("Enter", "\r")
        self.assertEqual(b.ask("document.activeElement.getAttribute('aria-pressed')"), "false")
        b.key("Enter", "\r")
        self.assertEqual(b.ask("document.activeElement.getAttribute('aria-pressed')"), "true")

    def test_plays_and_pauses(self):
        b = self.browser
        b.click("#play")
        start = self.run_data["from"]
        b.until(f"parseFloat(document.getElementById('now').textContent) > {start + 0.3}")
        self.assertEqual(b.ask("document.getElementById('play').textContent"), "Pause")
        b.click("#play")
        b.settled()
        t = self.moment()
        b.settled()
        self.assertEqual(self.moment(), t)
        self.assertEqual(b.ask("document.getElementById('play').textContent"), "Play")
        self.expect_tool_at(t)

    def test_ends_at_the_runs_end_when_it_plays(self):
        b = self.browser
        b.ask("document.getElementById('speed').value = '16'")
        b.ask("document.getElementById('time').focus()")
        b.key("End")
        for _ in range(20):
            b.key("ArrowLeft")
        b.click("#play")
        b.until("document.getElementById('play').textContent === 'Play'")
        self.assertAlmostEqual(self.moment(), self.run_data["to"], delta=0.011)

    def test_faults_are_on_the_time_axis_and_told_at_their_moment(self):
        b = self.browser
        fault = self.run_data["faults"][0]
        self.assertEqual(b.ask("document.querySelectorAll('#flags i').length"), len(self.run_data["faults"]))
        b.click("td[data-t] button")
        b.settled()
        self.assertAlmostEqual(self.moment(), fault["t"], delta=0.01)
        self.assertIn(fault["text"] + ": " + fault["reaction"], b.ask("document.getElementById('now').textContent"))
        # The flag in the chart: its colour at the fault's place, at the plot's upper edge.
        red = b.ask("""(() => {
          const plot = document.querySelector('figure[data-chart="1"] .uplot'), canvas = plot.querySelector('canvas'), over = plot.querySelector('.u-over');
          const scale = canvas.width / canvas.clientWidth, share = %f;
          const x = (over.offsetLeft + share * over.clientWidth) * scale + 3, y = over.offsetTop * scale + 2;
          return [...canvas.getContext('2d').getImageData(x, y, 1, 1).data];
        })()""" % ((fault["t"] - self.run_data["from"]) / (self.run_data["to"] - self.run_data["from"])))
        self.assertEqual(red[:3], [0xb3, 0x26, 0x1e])

    def test_shows_and_hides_and_turns_what_is_in_3d(self):
        b = self.browser
        seen = set()
        for button in ("[data-show=robot]", "[data-show=cloud]", "[data-show=panel]", "[data-view='0,0']", "[data-zoom='1.3']"):
            b.click("button" + button)
            b.settled()
            seen.add(b.ask("document.querySelector('canvas').toDataURL()"))
        self.assertEqual(len(seen), 5)
        b.ask("document.querySelector('canvas').focus()")
        b.key("ArrowLeft")
        b.settled()
        self.assertNotIn(b.ask("document.querySelector('canvas').toDataURL()"), seen)

    def test_follows_light_and_dark(self):
        b = self.browser
        light = b.ask("getComputedStyle(document.body).backgroundColor")
        b.dark(True)
        b.settled()
        b.settled()
        self.assertNotEqual(b.ask("getComputedStyle(document.body).backgroundColor"), light)
        b.move(self.over(1, 0.5))
        b.settled()
        # The lines are redrawn in the dark page's colours: some pixel has that of the first series.
        self.assertTrue(b.ask("""(() => {
          const canvas = document.querySelector('figure[data-chart="3"] canvas');
          const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
          for (let i = 0; i < pixels.length; i += 4) if (pixels[i] === 0x56 && pixels[i + 1] === 0xb4 && pixels[i + 2] === 0xe9) return true;
          return false;
        })()"""))

    def test_in_print_shows_the_drawings(self):
        b = self.browser
        b.call("Emulation.setEmulatedMedia", media="print")
        try:
            self.assertEqual(b.ask("[...document.querySelectorAll('.still')].map(e => getComputedStyle(e).display)"), ["block"] * 4)
            self.assertEqual(b.ask("getComputedStyle(document.querySelector('.uplot')).display"), "none")
        finally:
            b.call("Emulation.setEmulatedMedia", media="")


if __name__ == "__main__":
    if not browser.program():
        print("skipped: no Chromium: toolchain/setup.sh --browser")
        sys.exit(77)
    demo_report = sys.argv.pop(1)
    unittest.main(verbosity=2)
