#!/usr/bin/env python3
"""layers.py on trees of this test's making: what a layer must not include is found, what it may is not."""
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import layers  # noqa: E402


def found(path, text):
    """What is wrong with a tree of one file."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / path
        file.parent.mkdir(parents=True)
        file.write_text(text)
        return list(layers.faults(pathlib.Path(folder)))


class Layers(unittest.TestCase):
    def test_the_core_knows_nothing_of_the_hosted_side_nor_of_an_operating_system(self):
        for header in ('"hal/ports.hpp"', '"host_sim/world/world.hpp"', "<vector>", "<unistd.h>", "<poll.h>", "<sys/mman.h>", "<chrono>", "<opencv2/core.hpp>"):
            self.assertNotEqual(found("firmware/arm/a.cpp", f"#include {header}\n"), [], header)
        self.assertEqual(found("firmware/arm/a.cpp", '#include <array>\n#include "firmware/arm/b.hpp"\n'), [])

    def test_only_the_vehicles_side_and_a_few_files_know_posix(self):
        for header in ("unistd.h", "poll.h", "sys/mman.h", "sys/socket.h", "linux/can.h", "csignal", "sys/epoll.h"):
            text = f"#include <{header}>\n"
            for path in ("host_sim/devices/a.cpp", "hal/vision/a.cpp", "hal/config/a.cpp", "shared/can/a.hpp"):
                self.assertNotEqual(found(path, text), [], (path, header))
            self.assertEqual(found("hal/vehicle/a.cpp", text), [], header)

    def test_a_file_of_no_layer_is_named(self):
        self.assertIn("belongs to no layer", found("hal/elsewhere/a.cpp", "")[0])


if __name__ == "__main__":
    unittest.main()
