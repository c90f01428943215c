#!/usr/bin/env python3
"""Writes the report's scripts and styles as C++ constants. Usage: make_page_files.py PAGE_FOLDER OUTPUT.cpp

The scripts are put together in the order of SCRIPTS. What would end the element that holds a file is refused: a page that is cut short shows nothing.
"""
import pathlib
import sys

SCRIPTS = ("moment.js", "charts.js", "solids.js", "stage.js", "controls.js")
DELIMITER = "lanternfish"


def constant(name, text):
    """One constant; the compiler joins the pieces."""
    for end in ("</script", "</style", "<!--", f"){DELIMITER}\""):
        if end in text.lower():
            raise SystemExit(f"{name}: has {end}")
    pieces = [text[i:i + 8000] for i in range(0, len(text), 8000)]
    return f"const char* const {name} =\n" + "\n".join(f'    R"{DELIMITER}({piece}){DELIMITER}"' for piece in pieces) + ";\n"


def main():
    folder, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])

    def read(name):
        return (folder / name).read_text(encoding="utf-8")

    licence = "/*! uPlot 1.6.32\n" + read("uplot/LICENSE").replace("*/", "* /") + "*/\n"
    own = "(() => {\n'use strict';\n" + "".join(read(name) for name in SCRIPTS) + "})();\n"
    output.write_text("// Made by make_page_files.py.\n#include \"host_sim/record/page/page_files.hpp\"\n\nnamespace lf::record::page {\n\n" +
                      constant("library_script", licence + read("uplot/uPlot.iife.min.js")) + "\n" + constant("library_style", read("uplot/uPlot.min.css")) +
                      "\n" + constant("own_script", own) + "\n" + constant("own_style", read("report.css")) + "\n}  // namespace lf::record::page\n",
                      encoding="utf-8")


if __name__ == "__main__":
    main()
