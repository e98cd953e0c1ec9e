// tests/features/gz_lines.hpp: all lines of a gzip file, for reference answers of another program.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace flirt {

[[nodiscard]] inline std::vector<std::string> gz_lines(const std::filesystem::path& path) {
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  std::vector<char> block(1 << 16);
  for (int n = gzread(file, block.data(), 1 << 16); n > 0; n = gzread(file, block.data(), 1 << 16)) {
    text.append(block.data(), static_cast<std::size_t>(n));
  }
  gzclose(file);
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) { lines.push_back(line); }
  return lines;
}

}  // namespace flirt
