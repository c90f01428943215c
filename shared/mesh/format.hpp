// Which format a mesh's file has. Inside this folder only.
#pragma once

#include <string>
#include <string_view>

namespace lf::mesh {

enum class Format { obj, stl, ply };

// By the name's extension, with which the first bytes have to agree. Throws InputError for other formats, by their names and with the remedy.
Format format_of(const std::string& file, std::string_view bytes);

// The size of a binary STL file is a function of the count in its header; no text's is.
bool has_size_of_binary_stl(std::string_view bytes);
// Begins with "solid", and is not binary: many programs begin the binary header so, too.
bool is_text_stl(std::string_view bytes);

}  // namespace lf::mesh
