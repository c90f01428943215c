// What the report's page is made of besides its data: made of the files in this folder by make_page_files.py.
#pragma once

namespace lf::record::page {

extern const char* const library_script;  // uPlot, with its licence
extern const char* const library_style;
extern const char* const own_script;
extern const char* const own_style;

}  // namespace lf::record::page
